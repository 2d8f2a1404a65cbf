// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/smooth_clusters.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/normals.hpp"
#include "partpose/geometry/point_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>

namespace partpose {

namespace {

/// The points not yet in a cluster, cell by cell: each cell's are at its beginning, and one that is taken makes way for
/// the cell's last. A search therefore sees the few that are left instead of all neighbours.
class UntakenPoints {
 public:
  UntakenPoints(const PointCloud& cloud, float cell_mm)
      : grid_(cloud.points, cell_mm), cell_of_(cloud.size()), end_(grid_.cell_count()), runs_(grid_.cell_count()) {
    points_.reserve(cloud.size());
    for (std::size_t c = 0; c < grid_.cell_count(); ++c) {
      const auto cell = grid_.cell(c);
      end_[c] = cell.begin;
      for (int s = cell.begin; s < cell.end; ++s) {
        const int i = grid_.original(s);
        cell_of_[i] = static_cast<int>(c);
        points_.push_back({});
        if (cloud.normals[i].allFinite()) points_[end_[c]++] = {cloud.points[i], cloud.normals[i], i};
      }
    }
  }

  /// Moves the neighbours of point `i` from here to the end of `found`.
  void take_neighbours(const PointCloud& cloud, int i, float squared_tolerance, float cosine, std::vector<int>& found) {
    const Eigen::Vector3f point = cloud.points[i], normal = cloud.normals[i];
    for (const int c : cells_around(cell_of_[i])) {
      const int begin = grid_.cell(c).begin;
      for (int s = begin; s < end_[c];) {
        const auto& other = points_[s];
        if ((other.point - point).squaredNorm() <= squared_tolerance && other.normal.dot(normal) > cosine) {
          found.push_back(other.index);
          points_[s] = points_[--end_[c]];
        } else {
          ++s;
        }
      }
    }
  }

  /// Takes point `i` itself; false when it was taken before or has no normal.
  bool take(int i) {
    const int c = cell_of_[i];
    for (int s = grid_.cell(c).begin; s < end_[c]; ++s) {
      if (points_[s].index != i) continue;
      points_[s] = points_[--end_[c]];
      return true;
    }
    return false;
  }

 private:
  struct Point {
    Eigen::Vector3f point, normal;
    int index = -1;
  };

  /// Cell `c` and its neighbours that have points.
  const std::vector<int>& cells_around(int c) {
    auto& cells = runs_[c];
    if (cells.empty())
      for (const auto range : grid_.neighbourhood(c))
        for (int s = range.begin; s < range.end; s = grid_.cell(cells.back()).end)
          cells.push_back(cell_of_[grid_.original(s)]);
    return cells;
  }

  PointGrid grid_;
  std::vector<int> cell_of_;  ///< of each point of the cloud
  std::vector<int> end_;      ///< of the points left in each cell
  std::vector<std::vector<int>> runs_;
  std::vector<Point> points_;
};

/// Bits that rise with the number, negative ones included; -0 and 0 are the same.
std::uint32_t rising_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.f);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

}  // namespace

void SmoothClusterLimits::check() const {
  if (min_points < 1) throw Error("min_points {}: must be 1 or more", min_points);
  for (const auto& [key, value] : {std::pair{"cluster_tolerance_distance", cluster_tolerance_distance},
                                   {"eps_angle_threshold_deg", eps_angle_threshold_deg},
                                   {"radius_normals", radius_normals}})
    if (!(value > 0) || !std::isfinite(value)) throw Error("{} {}: must be positive", key, value);
  if (!(curvature_threshold >= 0)) throw Error("curvature_threshold {}: must be 0 or more", curvature_threshold);
}

float cosine_limit(float angle_rad) { return angle_rad < std::numbers::pi_v<float> ? std::cos(angle_rad) : -2.f; }

PointCloud sorted_by_position(const PointCloud& cloud) {
  if (cloud.empty()) return {};
  if (!cloud.has_normals()) throw Error("the descriptor needs normals: estimate them first");
  std::vector<int> finite;
  std::vector<std::uint64_t> keys;
  finite.reserve(cloud.size());
  keys.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite() || !cloud.normals[i].allFinite()) continue;
    finite.push_back(static_cast<int>(i));
    keys.push_back(std::uint64_t{rising_bits(cloud.points[i].x())} << 32 | rising_bits(cloud.points[i].y()));
  }
  auto order = order_by_key(keys);
  const auto rest_of = [&](int i) {
    const auto &p = cloud.points[finite[i]], &n = cloud.normals[finite[i]];
    return std::tuple(p.z(), n.x(), n.y(), n.z());
  };
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end = std::find_if(begin, order.end(), [&](int i) { return keys[i] != keys[*begin]; });
    if (end - begin > 1) std::sort(begin, end, [&](int a, int b) { return rest_of(a) < rest_of(b); });
    begin = end;
  }
  for (int& i : order) i = finite[i];
  auto sorted = select(cloud, order);
  if (!sorted.has_curvatures()) sorted.curvatures.assign(sorted.size(), 0.f);
  return sorted;
}

void set_means(SmoothCluster& cluster, const PointCloud& points) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  for (const int i : cluster.members) {
    centre += points.points[i].cast<double>();
    normal += points.normals[i].cast<double>();
  }
  cluster.centre_mm = (centre / static_cast<double>(cluster.members.size())).cast<float>();
  cluster.normal = normal.normalized().cast<float>();
}

SmoothClusters smooth_clusters(const PointCloud& cloud, const SmoothClusterLimits& limits) {
  SmoothClusters result;
  result.points.points.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!cloud.has_curvatures() || !(cloud.curvatures[i] > limits.curvature_threshold))
      result.points.points.push_back(cloud.points[i]);
  const auto& points = result.points;
  if (points.empty() || points.size() < static_cast<std::size_t>(limits.min_points)) return result;
  estimate_normals(result.points, limits.radius_normals);

  UntakenPoints untaken(points, limits.cluster_tolerance_distance);
  const float squared_tolerance = limits.cluster_tolerance_distance * limits.cluster_tolerance_distance;
  const float cosine = cosine_limit(static_cast<float>(radians(limits.eps_angle_threshold_deg)));
  std::vector<bool> seen(points.size(), false);
  for (std::size_t seed = 0; seed < points.size(); ++seed) {
    if (seen[seed] || !untaken.take(static_cast<int>(seed))) continue;
    SmoothCluster cluster{.members = {static_cast<int>(seed)}};
    for (std::size_t next = 0; next < cluster.members.size(); ++next) {
      seen[cluster.members[next]] = true;
      untaken.take_neighbours(points, cluster.members[next], squared_tolerance, cosine, cluster.members);
    }
    if (cluster.members.size() < static_cast<std::size_t>(limits.min_points)) continue;
    std::sort(cluster.members.begin(), cluster.members.end());
    set_means(cluster, points);
    result.clusters.push_back(std::move(cluster));
  }
  std::stable_sort(result.clusters.begin(), result.clusters.end(), [](const auto& a, const auto& b) {
    const auto key = [](const SmoothCluster& c) {
      return std::tuple(c.centre_mm.z(), c.centre_mm.y(), c.centre_mm.x());
    };
    return a.members.size() != b.members.size() ? a.members.size() > b.members.size() : key(a) < key(b);
  });
  return result;
}

}  // namespace partpose
