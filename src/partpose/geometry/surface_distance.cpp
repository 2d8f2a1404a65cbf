// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/surface_distance.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace partpose {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Ericson 2005, Real-Time Collision Detection, 5.1.5: by the Voronoi region that the point lies in.
Eigen::Vector3d nearest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / std::max(d1 - d3, 1e-300) * ab;
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / std::max(d2 - d6, 1e-300) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / std::max(d4 - d3 + d5 - d6, 1e-300) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

double squared_distance(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& p) {
  return (box.min() - p).cwiseMax(p - box.max()).cwiseMax(0.f).squaredNorm();
}

}  // namespace

SurfaceDistance::SurfaceDistance(const TriangleMesh& mesh) : mesh_(mesh) {
  if (mesh_.triangles.empty()) throw Error("distances to a surface need a mesh with triangles");
  std::vector<Eigen::AlignedBox3f> boxes(mesh_.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    for (const int corner : mesh_.triangles[t]) boxes[t].extend(mesh_.vertices[corner]);
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(boxes.size());
  build(0, static_cast<int>(order_.size()), boxes, 0);
}

int SurfaceDistance::build(int begin, int end, const std::vector<Eigen::AlignedBox3f>& boxes, int level) {
  constexpr int leaf_size = 4;
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3f box;
  for (int i = begin; i < end; ++i) box.extend(boxes[order_[i]]);
  int right = -1;
  if (end - begin > leaf_size) {
    const int middle = level < deepest / 2 ? cheapest_split(begin, end, boxes) : (begin + end) / 2;
    build(begin, middle, boxes, level + 1);
    right = build(middle, end, boxes, level + 1);
  }
  nodes_[index] = {box, begin, end, right};
  return index;
}

int SurfaceDistance::cheapest_split(int begin, int end, const std::vector<Eigen::AlignedBox3f>& boxes) {
  // The surface area heuristic in bins along each axis (Wald 2007): long slivers, of which CAD meshes are full, make
  // bad boxes otherwise.
  constexpr int bins = 16;
  Eigen::AlignedBox3f centres;
  for (int i = begin; i < end; ++i) centres.extend(boxes[order_[i]].center());
  const auto area = [](const Eigen::AlignedBox3f& box) {
    const Eigen::Vector3f size = box.sizes();
    return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
  };
  const auto bin_of = [&](int triangle, int axis) {
    const float along = (boxes[triangle].center()[axis] - centres.min()[axis]) / centres.sizes()[axis];
    return std::min(bins - 1, static_cast<int>(along * bins));
  };
  float least = std::numeric_limits<float>::infinity();
  int best_axis = -1, best_bin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(centres.sizes()[axis] > 0)) continue;
    std::array<Eigen::AlignedBox3f, bins> box;
    std::array<int, bins> count{};
    for (int i = begin; i < end; ++i) {
      const int bin = bin_of(order_[i], axis);
      box[bin].extend(boxes[order_[i]]);
      ++count[bin];
    }
    std::array<float, bins> cost_above{};
    Eigen::AlignedBox3f above, below;
    for (int bin = bins - 1, so_far = 0; bin > 0; --bin) {
      above.extend(box[bin]);
      so_far += count[bin];
      cost_above[bin] = so_far ? static_cast<float>(so_far) * area(above) : 0;
    }
    for (int bin = 1, so_far = 0; bin < bins; ++bin) {
      below.extend(box[bin - 1]);
      so_far += count[bin - 1];
      if (so_far == 0 || so_far == end - begin) continue;
      const float cost = static_cast<float>(so_far) * area(below) + cost_above[bin];
      if (cost < least) {
        least = cost;
        best_axis = axis;
        best_bin = bin;
      }
    }
  }
  if (best_axis < 0) return (begin + end) / 2;
  const auto middle = std::partition(order_.begin() + begin, order_.begin() + end,
                                     [&](int triangle) { return bin_of(triangle, best_axis) < best_bin; });
  return static_cast<int>(middle - order_.begin());
}

SurfaceDistance::Nearest SurfaceDistance::nearest(const Eigen::Vector3d& query_mm, double limit_mm,
                                                  double enough_mm) const {
  const Eigen::Vector3f query = query_mm.cast<float>();
  Nearest best;
  double best_squared = limit_mm * limit_mm;
  const double enough_squared = enough_mm * enough_mm;
  // Boxes are of single precision: a little nearer than they seem.
  const auto box_distance = [&](int node) { return 0.999999 * squared_distance(nodes_[node].box, query); };
  struct Entry {
    int node;
    double squared;
  };
  std::array<Entry, deepest + 2> stack;  // one entry a level, and one more
  int depth = 0;
  stack[depth++] = {0, box_distance(0)};
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.squared >= best_squared) continue;
    const Node& node = nodes_[entry.node];
    if (node.right >= 0) {
      const int left = entry.node + 1;
      const double to_left = box_distance(left), to_right = box_distance(node.right);
      if (to_left < to_right) {
        stack[depth++] = {node.right, to_right};
        stack[depth++] = {left, to_left};
      } else {
        stack[depth++] = {left, to_left};
        stack[depth++] = {node.right, to_right};
      }
      continue;
    }
    for (int i = node.begin; i < node.end; ++i) {
      const auto& [a, b, c] = mesh_.triangles[order_[i]];
      const Eigen::Vector3d point =
          nearest_on_triangle(query_mm, mesh_.vertices[a].cast<double>(), mesh_.vertices[b].cast<double>(),
                              mesh_.vertices[c].cast<double>());
      const double squared = (point - query_mm).squaredNorm();
      if (squared < best_squared) {
        best_squared = squared;
        best.point_mm = point;
        best.triangle = order_[i];
        if (squared <= enough_squared) depth = 0;
      }
    }
  }
  if (best.triangle >= 0) best.distance_mm = std::sqrt(best_squared);
  return best;
}

std::vector<Eigen::Vector3d> even_surface_samples(const TriangleMesh& mesh, int count) {
  std::vector<double> area_up_to;
  area_up_to.reserve(mesh.triangles.size());
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d ab = (mesh.vertices[b] - mesh.vertices[a]).cast<double>();
    area += 0.5 * ab.cross((mesh.vertices[c] - mesh.vertices[a]).cast<double>()).norm();
    area_up_to.push_back(area);
  }
  std::vector<Eigen::Vector3d> samples;
  if (!(area > 0) || !std::isfinite(area)) return samples;
  samples.reserve(count);
  std::size_t t = 0;
  for (int i = 0; i < count; ++i) {
    while (t + 1 < area_up_to.size() && area_up_to[t] <= area * (i + 0.5) / count) ++t;
    const auto& [a, b, c] = mesh.triangles[t];
    // The R2 sequence (Roberts 2018), folded into the triangle.
    double along = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), across = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    if (along + across > 1) {
      along = 1 - along;
      across = 1 - across;
    }
    const Eigen::Vector3d corner = mesh.vertices[a].cast<double>();
    samples.push_back(corner + along * (mesh.vertices[b].cast<double>() - corner) +
                      across * (mesh.vertices[c].cast<double>() - corner));
  }
  return samples;
}

Eigen::Isometry3d align_to_surface(std::span<const Eigen::Vector3d> points_mm, const SurfaceDistance& surface,
                                   const Eigen::Isometry3d& start, double scale_mm,
                                   const Eigen::Vector3d& turn_centre_mm, int max_iterations) {
  Eigen::Isometry3d pose = start;
  double lever_squared = 0;
  for (const auto& p : points_mm) lever_squared += (p - turn_centre_mm).squaredNorm();
  const double lever = std::sqrt(lever_squared / static_cast<double>(std::max<std::size_t>(points_mm.size(), 1)));
  if (!(lever > 0)) return pose;
  double scale = std::max(scale_mm, 0.25 * lever);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    // Unknowns: a turn about the moved centre times `lever`, so that all six are lengths; and a shift.
    Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    const Eigen::Vector3d centre = pose * turn_centre_mm;
    for (const auto& p : points_mm) {
      const Eigen::Vector3d moved = pose * p;
      const auto nearest = surface.nearest(moved, infinity, 1e-3 * scale_mm);
      const Eigen::Vector3d off = moved - nearest.point_mm;
      const Eigen::Vector3d normal = nearest.distance_mm > 1e-6 * lever ? Eigen::Vector3d(off / nearest.distance_mm)
                                                                        : surface.normal(nearest.triangle);
      const double ratio = nearest.distance_mm / scale;
      const double weight = 1 / std::pow(1 + ratio * ratio, 2);
      Eigen::Matrix<double, 6, 1> row;
      row << (moved - centre).cross(normal) / lever, normal;
      hessian += weight * row * row.transpose();
      gradient += weight * nearest.distance_mm * row;
    }
    hessian.diagonal().array() += 1e-6 * hessian.trace() + 1e-12;
    const Eigen::Matrix<double, 6, 1> step = -hessian.ldlt().solve(gradient);
    if (!step.allFinite()) break;
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = rotation_from_vector(step.head<3>() / lever);
    motion.translation() = centre + step.tail<3>() - motion.linear() * centre;
    pose = motion * pose;
    if (scale <= scale_mm && step.norm() < 1e-7 * lever) break;
    scale = std::max(scale_mm, 0.5 * scale);
  }
  return nearest_rigid(pose.matrix());
}

}  // namespace partpose
