// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"
#include "partpose/engine/depth_template.hpp"

#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

namespace partpose {

/// Views of a part about places on its surface, in place of its middle: of a part that is partly hidden, or that
/// touches another, the middle is not known, but some place on it is.
struct AnchoredViews {
  static constexpr int per_view = 12;

  struct Anchor {
    /// Model frame to sight frame: origin in the place, z along the line of sight through it.
    Eigen::Isometry3f sight_from_model = Eigen::Isometry3f::Identity();
    std::int16_t view = 0;
  };
  std::vector<Anchor> anchors;
  std::vector<SmallTemplate> templates;  ///< about each anchor

  /// Adds those of one view: what is seen, in the camera's frame, `spacing_mm` between neighbouring points.
  void add(int view, const PointCloud& seen, const Eigen::Isometry3d& camera_from_model, double spacing_mm,
           const TemplateScale& scale);
};

/// `count` of the points, or fewer, spread over them and away from their edges: those nearest to the means of groups of
/// about one size (Lloyd 1982). Indices into `points`.
std::vector<int> spread_places(std::span<const Eigen::Vector3f> points, int count);

/// The mean of the points within `reach_mm` of a place.
Eigen::Vector3d local_mean(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& place, double reach_mm);

/// How much of a model's template a scene's explains, less what speaks against it, in steps of depth summed over the
/// cells where the model has a surface: `cap` where the two agree, down to 0 where the scene is nearer (something else
/// may hide the part there), down to -`cap` where it is farther or background (the part cannot be there). 0 where the
/// scene is unknown.
int explained_steps(const SmallTemplate& model, const SmallTemplate& scene, int cap);

/// The same of several scenes; `cap` at most 63.
void explained_steps(const SmallTemplate& model, std::span<const SmallTemplate> scenes, int cap, int* out);

}  // namespace partpose
