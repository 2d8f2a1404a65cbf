// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <vector>

namespace partpose {

/// A triangle mesh in millimetres, model frame. Triangles index `vertices`, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<int, 3>> triangles;

  /// Unit normal of triangle `t` by its winding; zero for a degenerate triangle.
  Eigen::Vector3f face_normal(std::size_t t) const;
};

/// Axis-aligned bounding box of the vertices, in mm; empty (Eigen's meaning) for a mesh without vertices.
Eigen::AlignedBox3d bounding_box(const TriangleMesh& mesh);

/// Vertices with equal coordinates made one; triangles keep their order.
TriangleMesh with_merged_vertices(const TriangleMesh& mesh);

/// The length of the bounding box's diagonal, in mm: the scale that size-relative options refer to.
double bounding_box_diagonal(const TriangleMesh& mesh);

/// The largest distance of two vertices, in mm; 0 for a mesh without vertices.
double diameter(const TriangleMesh& mesh);

}  // namespace partpose
