// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/icosphere.hpp"

#include "partpose/core/error.hpp"

#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace partpose {

std::vector<Eigen::Vector3d> icosphere_directions(int subdivide, bool use_vertices) {
  if (subdivide < 0 || subdivide > 4) throw Error("icosahedron subdivisions {}: must be 0 to 4", subdivide);
  const double golden = (1 + std::sqrt(5.0)) / 2;
  std::vector<Eigen::Vector3d> vertices = {{-1, golden, 0}, {1, golden, 0},  {-1, -golden, 0}, {1, -golden, 0},
                                           {0, -1, golden}, {0, 1, golden},  {0, -1, -golden}, {0, 1, -golden},
                                           {golden, 0, -1}, {golden, 0, 1},  {-golden, 0, -1}, {-golden, 0, 1}};
  for (auto& v : vertices) v.normalize();
  std::vector<std::array<int, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                           {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                           {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                           {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < subdivide; ++level) {
    std::map<std::pair<int, int>, int> midpoints;
    const auto midpoint = [&](int a, int b) {
      const auto [it, added] = midpoints.try_emplace(std::minmax(a, b), static_cast<int>(vertices.size()));
      if (added) vertices.push_back((vertices[a] + vertices[b]).normalized());
      return it->second;
    };
    std::vector<std::array<int, 3>> finer;
    finer.reserve(faces.size() * 4);
    for (const auto& [a, b, c] : faces) {
      const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  if (use_vertices) return vertices;
  std::vector<Eigen::Vector3d> centres;
  centres.reserve(faces.size());
  for (const auto& [a, b, c] : faces) centres.push_back((vertices[a] + vertices[b] + vertices[c]).normalized());
  return centres;
}

}  // namespace partpose
