// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/io/png.hpp"

#include <Eigen/Geometry>

#include <vector>

namespace partpose {

struct PlacedMesh {
  const TriangleMesh& mesh;
  Eigen::Isometry3d camera_from_model;
};

/// The measured depth as a shaded relief (grey, black where nothing was measured) with the parts drawn over it at their
/// poses: shaded orange with a bright outline; red where one lies more than 5 mm before what was measured, blue where
/// it lies more than 5 mm behind. Of parts one behind the other the nearer one is seen. Small frames are enlarged.
ColourImage draw_overlay(const DepthImage& depth, const Intrinsics& camera, const std::vector<PlacedMesh>& parts = {});

/// Normals as colours: red, green, blue for x, y, -z from -1 to 1; black where there is no point. The cloud needs
/// normals.
ColourImage draw_normals(const PointCloud& cloud, const Intrinsics& camera);

/// Pictures of one size in rows of at most `columns`.
ColourImage tile(const std::vector<ColourImage>& pictures, int columns);

}  // namespace partpose
