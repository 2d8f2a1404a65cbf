// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/mesh.hpp"

#include <algorithm>
#include <cstring>
#include <unordered_map>
#include <utility>

namespace partpose {

Eigen::Vector3f TriangleMesh::face_normal(std::size_t t) const {
  const auto& [a, b, c] = triangles[t];
  const Eigen::Vector3d ab = (vertices[b] - vertices[a]).cast<double>();
  const Eigen::Vector3d ac = (vertices[c] - vertices[a]).cast<double>();
  const Eigen::Vector3d cross = ab.cross(ac);
  const double length = cross.norm();
  if (!(length > 0)) return Eigen::Vector3f::Zero();
  return (cross / length).cast<float>();
}

Eigen::AlignedBox3d bounding_box(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& v : mesh.vertices) box.extend(v.cast<double>());
  return box;
}

double bounding_box_diagonal(const TriangleMesh& mesh) {
  const auto box = bounding_box(mesh);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

double diameter(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  // From the farthest of the box's centre on: two vertices are no farther apart than their distances from it together.
  const Eigen::Vector3d centre = bounding_box(mesh).center();
  std::vector<std::pair<double, Eigen::Vector3d>> vertices;
  for (const auto& v : mesh.vertices) vertices.emplace_back((v.cast<double>() - centre).norm(), v.cast<double>());
  std::sort(vertices.begin(), vertices.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  double largest = 0;
  constexpr double rounding = 1 + 1e-12;
  for (std::size_t i = 0; i < vertices.size() && (vertices[i].first + vertices[0].first) * rounding > largest; ++i)
    for (std::size_t j = 0; j < i && (vertices[i].first + vertices[j].first) * rounding > largest; ++j)
      largest = std::max(largest, (vertices[i].second - vertices[j].second).norm());
  return largest;
}

TriangleMesh with_merged_vertices(const TriangleMesh& mesh) {
  struct Hash {
    std::size_t operator()(const std::array<std::uint32_t, 3>& k) const {
      std::size_t h = 1469598103934665603ull;
      for (const auto v : k) h = (h ^ v) * 1099511628211ull;
      return h ^ (h >> 29);
    }
  };
  TriangleMesh out;
  std::unordered_map<std::array<std::uint32_t, 3>, int, Hash> index_of;
  std::vector<int> new_index(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f v = mesh.vertices[i] + Eigen::Vector3f::Zero();  // -0 becomes +0
    std::array<std::uint32_t, 3> key;
    std::memcpy(key.data(), v.data(), sizeof(key));
    const auto [it, added] = index_of.try_emplace(key, static_cast<int>(out.vertices.size()));
    if (added) out.vertices.push_back(v);
    new_index[i] = it->second;
  }
  out.triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) out.triangles.push_back({new_index[t[0]], new_index[t[1]], new_index[t[2]]});
  return out;
}

}  // namespace partpose
