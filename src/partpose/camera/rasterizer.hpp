// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"

#include <Eigen/Geometry>

#include <vector>

namespace partpose {

struct Rendering {
  DepthImage depth;           ///< z in mm of the nearest surface at each pixel centre, 0: none
  std::vector<int> triangle;  ///< index of the triangle seen at each pixel, row by row, -1: none
};

/// The depth of a mesh as an ideal pinhole camera sees it: exact (to float rounding) at pixel centres, both sides of
/// each triangle drawn, parts nearer than 1 mm cut away.
Rendering render(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& intrinsics);

}  // namespace partpose
