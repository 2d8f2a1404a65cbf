// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/surface_field.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace partpose {

/// From the nearest place on a triangle to the query (Ericson 2005, section 5.1.5).
Eigen::Vector3f SurfaceField::from_triangle(const Triangle& t, const Eigen::Vector3f& query_mm) {
  const Eigen::Vector3f ap = query_mm - t.a;
  const float d1 = t.ab.dot(ap), d2 = t.ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return ap;
  const Eigen::Vector3f bp = ap - t.ab;
  const float d3 = t.ab.dot(bp), d4 = t.ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return bp;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return ap - d1 / (d1 - d3) * t.ab;
  const Eigen::Vector3f cp = ap - t.ac;
  const float d5 = t.ab.dot(cp), d6 = t.ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return cp;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return ap - d2 / (d2 - d6) * t.ac;
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t.ac - t.ab);
  return t.normal * t.normal.dot(ap);
}

/// The nodes while the grid is filled, with the squared distances of what they name.
struct SurfaceField::Build {
  SurfaceField& field;
  std::vector<float> squared, squared_opposite;

  static constexpr float infinite = std::numeric_limits<float>::infinity();
  static constexpr float opposite_cosine = -0.2f;

  /// Whether `b` is turned against `a`.
  bool against(int a, int b) const {
    return field.triangles_[a].normal.dot(field.triangles_[b].normal) < opposite_cosine;
  }

  void offer(std::size_t node_index, const Eigen::Vector3f& place, int triangle) {
    Node& node = field.nodes_[node_index];
    if (triangle < 0 || triangle == node.nearest || triangle == node.opposite) return;
    const float distance = from_triangle(field.triangles_[triangle], place).squaredNorm();
    if (distance < squared[node_index]) {
      const int former = node.nearest;
      const float former_distance = squared[node_index];
      node.nearest = triangle;
      squared[node_index] = distance;
      if (node.opposite >= 0 && !against(triangle, node.opposite)) {
        node.opposite = -1;
        squared_opposite[node_index] = infinite;
      }
      if (former >= 0 && former_distance < squared_opposite[node_index] && against(triangle, former)) {
        node.opposite = former;
        squared_opposite[node_index] = former_distance;
      }
    } else if (distance < squared_opposite[node_index] && against(node.nearest, triangle)) {
      node.opposite = triangle;
      squared_opposite[node_index] = distance;
    }
  }

  /// Each triangle into the nodes about it.
  void splat() {
    for (int t = 0; t < static_cast<int>(field.triangles_.size()); ++t) {
      const auto& [a, ab, ac, normal] = field.triangles_[t];
      const Eigen::Vector3f b = a + ab, c = a + ac;
      const Eigen::Vector3f low = (a.cwiseMin(b).cwiseMin(c) - field.low_) / field.cell_mm_;
      const Eigen::Vector3f high = (a.cwiseMax(b).cwiseMax(c) - field.low_) / field.cell_mm_;
      Eigen::Vector3i first, last;
      for (int k = 0; k < 3; ++k) {
        first[k] = std::clamp(static_cast<int>(std::floor(low[k])), 0, field.size_[k] - 1);
        last[k] = std::clamp(static_cast<int>(std::ceil(high[k])), 0, field.size_[k] - 1);
      }
      for (int z = first.z(); z <= last.z(); ++z)
        for (int y = first.y(); y <= last.y(); ++y)
          for (int x = first.x(); x <= last.x(); ++x) {
            const Eigen::Vector3f place = field.position(x, y, z);
            if (std::abs(normal.dot(place - a)) < 2 * field.cell_mm_) offer(field.index(x, y, z), place, t);
          }
    }
  }

  /// What a node's neighbours name may be nearest to it as well (Danielsson 1980), in one direction through the grid.
  void sweep(bool forward) {
    const Eigen::Vector3i& n = field.size_;
    const int d = forward ? -1 : 1;
    const auto along = [&](int i, int count) { return forward ? i : count - 1 - i; };
    for (int k = 0; k < n.z(); ++k)
      for (int j = 0; j < n.y(); ++j)
        for (int i = 0; i < n.x(); ++i) {
          const int x = along(i, n.x()), y = along(j, n.y()), z = along(k, n.z());
          const Eigen::Vector3f place = field.position(x, y, z);
          const std::size_t here = field.index(x, y, z);
          const auto take = [&](int dx, int dy, int dz) {
            const int xx = x + dx, yy = y + dy, zz = z + dz;
            if (xx < 0 || yy < 0 || zz < 0 || xx >= n.x() || yy >= n.y() || zz >= n.z()) return;
            const Node other = field.nodes_[field.index(xx, yy, zz)];
            offer(here, place, other.nearest);
            offer(here, place, other.opposite);
          };
          take(d, 0, 0);
          take(0, d, 0);
          take(0, 0, d);
          take(-d, d, 0);
          take(d, d, 0);
          take(-d, 0, d);
          take(d, 0, d);
          take(0, -d, d);
          take(0, d, d);
        }
  }
};

SurfaceField::SurfaceField(const TriangleMesh& mesh, int cells_on_longest_side) {
  for (const auto& [a, b, c] : mesh.triangles) {
    Triangle t;
    t.a = mesh.vertices[a];
    t.ab = mesh.vertices[b] - t.a;
    t.ac = mesh.vertices[c] - t.a;
    t.normal = t.ab.cross(t.ac);
    const float doubled_area = t.normal.norm();
    if (!(doubled_area > 0) || !std::isfinite(doubled_area)) continue;
    t.normal /= doubled_area;
    triangles_.push_back(t);
  }
  if (triangles_.empty()) throw Error("the mesh has no triangle with an area");
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  const double longest_mm = box.sizes().maxCoeff();
  const double margin_mm = 0.1 * longest_mm;
  cell_mm_ = static_cast<float>(longest_mm / cells_on_longest_side);
  low_ = (box.min().array() - margin_mm).matrix().cast<float>();
  size_ = ((box.sizes().array() + 2 * margin_mm) / cell_mm_).ceil().cast<int>().matrix() + Eigen::Vector3i::Ones();
  nodes_.resize(static_cast<std::size_t>(size_.x()) * size_.y() * size_.z());
  Build build{*this, std::vector<float>(nodes_.size(), Build::infinite),
              std::vector<float>(nodes_.size(), Build::infinite)};
  build.splat();
  for (int round = 0; round < 2; ++round) {
    build.sweep(true);
    build.sweep(false);
  }
}

SurfaceField::Nearest SurfaceField::nearest(const Eigen::Vector3f& query_mm, const Eigen::Vector3f& to_camera) const {
  Eigen::Vector3i node;
  for (int k = 0; k < 3; ++k)
    node[k] = static_cast<int>(
        std::clamp((query_mm[k] - low_[k]) / cell_mm_ + 0.5f, 0.0f, static_cast<float>(size_[k]) - 0.5f));
  const Node& found = nodes_[index(node.x(), node.y(), node.z())];
  const Triangle* triangle = &triangles_[found.nearest];
  if (found.opposite >= 0 && triangle->normal.dot(to_camera) < 0) triangle = &triangles_[found.opposite];
  const Eigen::Vector3f offset = from_triangle(*triangle, query_mm);
  Nearest out;
  out.distance_mm = offset.norm();
  out.direction = out.distance_mm > 1e-4f * cell_mm_ ? Eigen::Vector3f(offset / out.distance_mm) : triangle->normal;
  return out;
}

}  // namespace partpose
