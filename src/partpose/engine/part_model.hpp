// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"
#include "partpose/engine/depth_template.hpp"
#include "partpose/engine/surface_field.hpp"

#include <Eigen/Geometry>

#include <vector>

namespace partpose {

/// A part as it looks from one side.
struct PartView {
  /// Model frame to sight frame: origin in the centroid of what is visible, z along the line of sight through it.
  Eigen::Isometry3d sight_from_model = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector3f> visible_mm;  ///< some points spread over what is visible, model frame
};

/// All that the engine knows of a part, made from its mesh alone.
struct PartModel {
  PartModel(const TriangleMesh& mesh, double part_diameter_mm);

  double diameter_mm = 0;
  TemplateScale scale;
  std::vector<PartView> views;
  std::vector<DepthTemplate> templates;  ///< of each view
  SurfaceField field;
  std::vector<Eigen::Isometry3d> partners;  ///< model_from_model: turns that nearly put the part back onto itself
};

}  // namespace partpose
