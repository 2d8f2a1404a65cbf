// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace partpose {

/// Where a part's surface is nearest, from any place in or around it, in constant time: a grid whose nodes name the
/// nearest triangle, and the nearest of the triangles turned the other way. The distance itself is that to the
/// triangle, exact, so the grid may be coarse; and the second triangle tells the two sides of a wall that is thinner
/// than a cell. Immutable and thread-safe.
class SurfaceField {
 public:
  struct Nearest {
    float distance_mm = 0;
    Eigen::Vector3f direction = Eigen::Vector3f::UnitZ();  ///< unit, along which the distance grows; the normal at 0
  };

  /// Throws Error when the mesh has no triangle with an area.
  explicit SurfaceField(const TriangleMesh& mesh, int cells_on_longest_side = 48);

  /// The place on the surface nearest to `query_mm` (model frame), on a side that faces `to_camera` where there is one.
  Nearest nearest(const Eigen::Vector3f& query_mm, const Eigen::Vector3f& to_camera) const;

  std::size_t memory_bytes() const { return nodes_.size() * sizeof(Node) + triangles_.size() * sizeof(Triangle); }

 private:
  struct Triangle {
    Eigen::Vector3f a, ab, ac, normal;
  };
  struct Node {
    std::int32_t nearest = -1;   ///< triangle
    std::int32_t opposite = -1;  ///< triangle, turned against `nearest`; -1: none near by
  };
  struct Build;

  static Eigen::Vector3f from_triangle(const Triangle& t, const Eigen::Vector3f& query_mm);
  std::size_t index(int x, int y, int z) const { return (static_cast<std::size_t>(z) * size_.y() + y) * size_.x() + x; }
  Eigen::Vector3f position(int x, int y, int z) const {
    return low_ + cell_mm_ * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  }

  Eigen::Vector3f low_;
  float cell_mm_ = 1;
  Eigen::Vector3i size_;
  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace partpose
