// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"

#include <Eigen/Geometry>

#include <vector>

namespace partpose {

/// Which sides of a triangle are drawn. Of a closed surface that is wound outwards, the front, from which its corners
/// run counter-clockwise, is all that is ever seen from outside.
enum class Faces { both, front };

struct Rendering {
  DepthImage depth;           ///< z in mm of the nearest surface at each pixel centre, 0: none
  std::vector<int> triangle;  ///< index of the triangle seen at each pixel, row by row, -1: none
};

/// The depth of a mesh as an ideal pinhole camera sees it: exact (to float rounding) at pixel centres, parts nearer
/// than 1 mm cut away.
Rendering render(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& intrinsics,
                 Faces faces = Faces::both);

/// The depth of the same.
DepthImage render_depth(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                        const Intrinsics& intrinsics, Faces faces = Faces::both);

}  // namespace partpose
