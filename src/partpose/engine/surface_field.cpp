// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/surface_field.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace partpose {

namespace {

constexpr float margin_share = 0.1f;        // of the part's longest side, around it
constexpr float finest_share = 1 / 128.0f;  // of the longest side: finer cells gain nothing

/// Where on a triangle the place nearest to a query lies.
enum class Feature { face, corner_a, corner_b, corner_c, edge_ab, edge_bc, edge_ca };

struct Triangle {
  Eigen::Vector3f a, ab, ac, normal;
  std::array<int, 3> corner;

  /// From the nearest place on the triangle to the query (Ericson 2005, section 5.1.5).
  std::pair<Eigen::Vector3f, Feature> offset_to(const Eigen::Vector3f& query_mm) const {
    const Eigen::Vector3f ap = query_mm - a;
    const float d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return {ap, Feature::corner_a};
    const Eigen::Vector3f bp = ap - ab;
    const float d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return {bp, Feature::corner_b};
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {ap - d1 / (d1 - d3) * ab, Feature::edge_ab};
    const Eigen::Vector3f cp = ap - ac;
    const float d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return {cp, Feature::corner_c};
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {ap - d2 / (d2 - d6) * ac, Feature::edge_ca};
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
      return {bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (ac - ab), Feature::edge_bc};
    return {normal * normal.dot(ap), Feature::face};
  }
};

/// A part's triangles with the normals that tell inside from outside also beside edges and corners (Baerentzen and
/// Aanaes 2005).
class SignedTriangles {
 public:
  explicit SignedTriangles(const TriangleMesh& raw) {
    const TriangleMesh mesh = with_merged_vertices(raw);
    corner_normal_.assign(mesh.vertices.size(), Eigen::Vector3f::Zero());
    for (const auto& corner : mesh.triangles) {
      Triangle t;
      t.corner = corner;
      t.a = mesh.vertices[corner[0]];
      t.ab = mesh.vertices[corner[1]] - t.a;
      t.ac = mesh.vertices[corner[2]] - t.a;
      t.normal = t.ab.cross(t.ac);
      const float doubled_area = t.normal.norm();
      if (!(doubled_area > 0) || !std::isfinite(doubled_area)) continue;
      t.normal /= doubled_area;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3f& here = mesh.vertices[corner[k]];
        const Eigen::Vector3f to_next = (mesh.vertices[corner[(k + 1) % 3]] - here).normalized();
        const Eigen::Vector3f to_last = (mesh.vertices[corner[(k + 2) % 3]] - here).normalized();
        corner_normal_[corner[k]] += std::acos(std::clamp(to_next.dot(to_last), -1.0f, 1.0f)) * t.normal;
        edge_normal_.emplace(edge(corner[k], corner[(k + 1) % 3]), Eigen::Vector3f::Zero()).first->second += t.normal;
      }
      triangles_.push_back(t);
    }
    if (triangles_.empty()) throw Error("the mesh has no triangle with an area");
  }

  const std::vector<Triangle>& triangles() const { return triangles_; }

  float signed_distance_mm(int triangle, const Eigen::Vector3f& place_mm) const {
    const Triangle& t = triangles_[triangle];
    const auto [offset, feature] = t.offset_to(place_mm);
    const float distance = offset.norm();
    return offset.dot(normal(t, feature)) < 0 ? -distance : distance;
  }

 private:
  static std::pair<int, int> edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

  const Eigen::Vector3f& normal(const Triangle& t, Feature feature) const {
    switch (feature) {
      case Feature::corner_a:
        return corner_normal_[t.corner[0]];
      case Feature::corner_b:
        return corner_normal_[t.corner[1]];
      case Feature::corner_c:
        return corner_normal_[t.corner[2]];
      case Feature::edge_ab:
        return edge_normal_.at(edge(t.corner[0], t.corner[1]));
      case Feature::edge_bc:
        return edge_normal_.at(edge(t.corner[1], t.corner[2]));
      case Feature::edge_ca:
        return edge_normal_.at(edge(t.corner[2], t.corner[0]));
      case Feature::face:
        break;
    }
    return t.normal;
  }

  std::vector<Triangle> triangles_;
  std::vector<Eigen::Vector3f> corner_normal_;
  std::map<std::pair<int, int>, Eigen::Vector3f> edge_normal_;
};

/// The nearest triangle of each node of a grid.
class NearestTriangles {
 public:
  NearestTriangles(const std::vector<Triangle>& triangles, const Eigen::Vector3f& low, float cell_mm,
                   const Eigen::Vector3i& size)
      : triangles_(triangles),
        low_(low),
        cell_mm_(cell_mm),
        size_(size),
        nearest_(static_cast<std::size_t>(size.x()) * size.y() * size.z(), -1),
        squared_(nearest_.size(), std::numeric_limits<float>::infinity()) {
    splat();
    for (int octant = 0; octant < 8; ++octant) sweep(octant & 1, octant & 2, octant & 4);
  }

  const std::vector<int>& nearest() const { return nearest_; }
  Eigen::Vector3f place(int x, int y, int z) const {
    return low_ + cell_mm_ * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  }

 private:
  std::size_t index(int x, int y, int z) const { return (static_cast<std::size_t>(z) * size_.y() + y) * size_.x() + x; }

  void offer(std::size_t node, const Eigen::Vector3f& place, int triangle) {
    if (triangle < 0 || triangle == nearest_[node]) return;
    const float squared = triangles_[triangle].offset_to(place).first.squaredNorm();
    if (squared < squared_[node]) {
      squared_[node] = squared;
      nearest_[node] = triangle;
    }
  }

  /// Each triangle into the nodes about it.
  void splat() {
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      const Triangle& triangle = triangles_[t];
      const Eigen::Vector3f b = triangle.a + triangle.ab, c = triangle.a + triangle.ac;
      const Eigen::Vector3f low = (triangle.a.cwiseMin(b).cwiseMin(c) - low_) / cell_mm_;
      const Eigen::Vector3f high = (triangle.a.cwiseMax(b).cwiseMax(c) - low_) / cell_mm_;
      Eigen::Vector3i first, last;
      for (int k = 0; k < 3; ++k) {
        first[k] = std::clamp(static_cast<int>(std::floor(low[k])), 0, size_[k] - 1);
        last[k] = std::clamp(static_cast<int>(std::ceil(high[k])), 0, size_[k] - 1);
      }
      for (int z = first.z(); z <= last.z(); ++z)
        for (int y = first.y(); y <= last.y(); ++y)
          for (int x = first.x(); x <= last.x(); ++x) {
            const Eigen::Vector3f here = place(x, y, z);
            if (std::abs(triangle.normal.dot(here - triangle.a)) < 1.5f * cell_mm_) offer(index(x, y, z), here, t);
          }
    }
  }

  /// What a node's neighbours have may be nearest to it as well (Danielsson 1980), in one direction through the grid.
  void sweep(bool back_x, bool back_y, bool back_z) {
    const int dx = back_x ? 1 : -1, dy = back_y ? 1 : -1, dz = back_z ? 1 : -1;
    for (int k = 0; k < size_.z(); ++k)
      for (int j = 0; j < size_.y(); ++j)
        for (int i = 0; i < size_.x(); ++i) {
          const int x = back_x ? size_.x() - 1 - i : i, y = back_y ? size_.y() - 1 - j : j;
          const int z = back_z ? size_.z() - 1 - k : k;
          const std::size_t node = index(x, y, z);
          const int along_x = i > 0 ? nearest_[index(x + dx, y, z)] : -1;
          const int along_y = j > 0 ? nearest_[index(x, y + dy, z)] : -1;
          const int along_z = k > 0 ? nearest_[index(x, y, z + dz)] : -1;
          const int own = nearest_[node];
          if (along_x == own && along_y == own && along_z == own) continue;
          const Eigen::Vector3f here = place(x, y, z);
          offer(node, here, along_x);
          offer(node, here, along_y);
          offer(node, here, along_z);
        }
  }

  const std::vector<Triangle>& triangles_;
  Eigen::Vector3f low_;
  float cell_mm_;
  Eigen::Vector3i size_;
  std::vector<int> nearest_;
  std::vector<float> squared_;
};

}  // namespace

SurfaceField::SurfaceField(const TriangleMesh& mesh, int most_nodes) {
  const SignedTriangles triangles(mesh);
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  const double longest_mm = box.sizes().maxCoeff();
  const double margin_mm = margin_share * longest_mm;
  const Eigen::Vector3d extent_mm = box.sizes().array() + 2 * margin_mm;
  cell_mm_ = static_cast<float>(std::max(std::cbrt(extent_mm.prod() / most_nodes), finest_share * longest_mm));
  low_ = (box.min().array() - margin_mm).matrix().cast<float>();
  size_ = (extent_mm / cell_mm_).array().ceil().cast<int>().matrix() + Eigen::Vector3i::Ones();
  // No node is farther from the surface than the grid is long.
  unit_mm_ = static_cast<float>(extent_mm.norm() / std::numeric_limits<std::int16_t>::max());

  const NearestTriangles grid(triangles.triangles(), low_, cell_mm_, size_);
  const std::size_t nodes = grid.nearest().size();
  distance_.resize(nodes + 1);  // the last is read beside its neighbour, and not used
  for (std::size_t node = 0; node < nodes; ++node) {
    const int x = static_cast<int>(node % size_.x()), y = static_cast<int>(node / size_.x() % size_.y());
    const int z = static_cast<int>(node / size_.x() / size_.y());
    const float signed_mm = triangles.signed_distance_mm(grid.nearest()[node], grid.place(x, y, z));
    distance_[node] = static_cast<std::int16_t>(std::lround(signed_mm / unit_mm_));
  }
}

SurfaceField::Samples SurfaceField::at(const Lanes& x_mm, const Lanes& y_mm, const Lanes& z_mm) const {
  constexpr int n = Lanes::count;
  alignas(32) std::array<int, n> node;
  Lanes fx, fy, fz, beyond;
  const float per_mm = 1 / cell_mm_;
  // Just less than the last node, so that there is a next one to interpolate with.
  const float last_x = static_cast<float>(size_.x()) - 1.001f, last_y = static_cast<float>(size_.y()) - 1.001f;
  const float last_z = static_cast<float>(size_.z()) - 1.001f;
  const int row = size_.x(), layer = size_.x() * size_.y();
  for (int i = 0; i < n; ++i) {
    const float x = (x_mm.value[i] - low_.x()) * per_mm, y = (y_mm.value[i] - low_.y()) * per_mm;
    const float z = (z_mm.value[i] - low_.z()) * per_mm;
    const float in_x = std::min(std::max(x, 0.0f), last_x), in_y = std::min(std::max(y, 0.0f), last_y);
    const float in_z = std::min(std::max(z, 0.0f), last_z);
    const int ix = static_cast<int>(in_x), iy = static_cast<int>(in_y), iz = static_cast<int>(in_z);
    fx.value[i] = in_x - static_cast<float>(ix);
    fy.value[i] = in_y - static_cast<float>(iy);
    fz.value[i] = in_z - static_cast<float>(iz);
    beyond.value[i] = std::abs(x - in_x) + std::abs(y - in_y) + std::abs(z - in_z);
    node[i] = iz * layer + iy * row + ix;
  }

  // Two neighbours along x at each of the four (y, z) corners of the cell.
  std::array<Lanes, 4> near, far;
  const std::array<int, 4> corner = {0, row, layer, layer + row};
#ifdef __AVX2__
  // One by one: some processors take four times as long for a gather instruction.
  for (int k = 0; k < 4; ++k) {
    const auto pair_at = [&](int i) {
      std::int32_t pair;
      std::memcpy(&pair, distance_.data() + node[i] + corner[k], sizeof(pair));
      return pair;
    };
    const __m256i both = _mm256_setr_epi32(pair_at(0), pair_at(1), pair_at(2), pair_at(3), pair_at(4), pair_at(5),
                                           pair_at(6), pair_at(7));
    _mm256_store_ps(near[k].value, _mm256_cvtepi32_ps(_mm256_srai_epi32(_mm256_slli_epi32(both, 16), 16)));
    _mm256_store_ps(far[k].value, _mm256_cvtepi32_ps(_mm256_srai_epi32(both, 16)));
  }
#else
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < n; ++i) {
      near[k].value[i] = distance_[static_cast<std::size_t>(node[i]) + corner[k]];
      far[k].value[i] = distance_[static_cast<std::size_t>(node[i]) + corner[k] + 1];
    }
#endif

  Samples out;
  const float gradient_unit = unit_mm_ * per_mm;
  for (int i = 0; i < n; ++i) {
    const float x = fx.value[i], y = fy.value[i], z = fz.value[i];
    const float step00 = far[0].value[i] - near[0].value[i], step10 = far[1].value[i] - near[1].value[i];
    const float step01 = far[2].value[i] - near[2].value[i], step11 = far[3].value[i] - near[3].value[i];
    const float at00 = near[0].value[i] + x * step00, at10 = near[1].value[i] + x * step10;
    const float at01 = near[2].value[i] + x * step01, at11 = near[3].value[i] + x * step11;
    const float at0 = at00 + y * (at10 - at00), at1 = at01 + y * (at11 - at01);
    const float step_x0 = step00 + y * (step10 - step00), step_x1 = step01 + y * (step11 - step01);
    const float step_y0 = at10 - at00, step_y1 = at11 - at01;
    out.distance_mm.value[i] = unit_mm_ * (at0 + z * (at1 - at0)) + cell_mm_ * beyond.value[i];
    out.gradient_x.value[i] = gradient_unit * (step_x0 + z * (step_x1 - step_x0));
    out.gradient_y.value[i] = gradient_unit * (step_y0 + z * (step_y1 - step_y0));
    out.gradient_z.value[i] = gradient_unit * (at1 - at0);
  }
  return out;
}

SurfaceField::Sample SurfaceField::at(const Eigen::Vector3f& place_mm) const {
  Lanes x, y, z;
  for (int i = 0; i < Lanes::count; ++i)
    x.value[i] = place_mm.x(), y.value[i] = place_mm.y(), z.value[i] = place_mm.z();
  const Samples samples = at(x, y, z);
  return {samples.distance_mm.value[0],
          {samples.gradient_x.value[0], samples.gradient_y.value[0], samples.gradient_z.value[0]}};
}

}  // namespace partpose
