// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace partpose {

/// The convex hull of a set of points as triangles, counter-clockwise seen from outside. Triangles may be coplanar.
struct ConvexHull {
  std::vector<Eigen::Vector3d> vertices;       ///< in mm, only those that are corners of a triangle
  std::vector<int> original;                   ///< index of each vertex among the points given
  std::vector<std::array<int, 3>> triangles;   ///< indices into `vertices`
  std::vector<std::array<int, 3>> neighbours;  ///< of triangle t beyond the edge from its corner k to the next
  /// All points lie in one plane: the triangles cover the outline twice, once for either side.
  bool flat = false;

  double volume_mm3() const;
  /// Centre of gravity of the body; of the area when the hull is flat.
  Eigen::Vector3d centroid() const;
};

/// Quickhull (Barber, Dobkin and Huhdanpaa 1996) with exact predicates: coordinates are rounded to 2^-20 of the largest
/// extent, and whether a point lies above a triangle is decided in 64-bit integers. Duplicate, coplanar and nearly
/// coplanar points do no harm. Throws Error when a coordinate is not finite, and when all points are on one line.
ConvexHull convex_hull(std::span<const Eigen::Vector3f> points_mm);

/// The corners of the convex outline of points in a plane, counter-clockwise (Andrew's monotone chain, 1979).
/// `by_x_then_y`: the points in that order. `turn(a, b, c)`: positive when c is left of the line from a to b.
template <typename Turn>
std::vector<int> convex_outline(std::vector<int> by_x_then_y, const Turn& turn) {
  std::vector<int> outline;
  for (int half = 0; half < 2; ++half) {
    const std::size_t begin = outline.size();
    for (const int p : by_x_then_y) {
      while (outline.size() >= begin + 2 && turn(outline[outline.size() - 2], outline.back(), p) <= 0)
        outline.pop_back();
      outline.push_back(p);
    }
    if (!outline.empty()) outline.pop_back();  // the first of the other half
    std::reverse(by_x_then_y.begin(), by_x_then_y.end());
  }
  return outline;
}

/// The same for points with coordinates, as their indices.
std::vector<int> convex_outline(std::span<const Eigen::Vector2d> points);

}  // namespace partpose
