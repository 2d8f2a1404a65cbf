// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/preprocess/preprocess.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/kd_tree.hpp"
#include "partpose/geometry/normals.hpp"
#include "partpose/geometry/point_grid.hpp"
#include "partpose/geometry/voxel_grid.hpp"

#include <cmath>

namespace partpose {

namespace {

void must_be_positive(const char* key, double value) {
  if (!(value > 0)) throw Error("{} {}: must be positive", key, value);
}

template <typename Keep>
PointCloud filtered(const PointCloud& cloud, const Keep& keep) {
  std::vector<int> kept;
  kept.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (keep(i)) kept.push_back(static_cast<int>(i));
  return select(cloud, kept);
}

}  // namespace

void PreprocessOptions::check() const {
  must_be_positive("scale_factor", scale_factor);
  for (int axis = 0; axis < 3; ++axis)
    if (!(xyz_limits[2 * axis] < xyz_limits[2 * axis + 1]))
      throw Error("xyz_limits: the lower limit {} of {} must be below the upper {}", xyz_limits[2 * axis], "xyz"[axis],
                  xyz_limits[2 * axis + 1]);
  must_be_positive("voxel_size", voxel_size);
  must_be_positive("plane_removal_distance_threshold", plane_removal_distance_threshold);
  must_be_positive("radius_outlier_removal_radius", radius_outlier_removal_radius);
  if (radius_outlier_removal_min_points_in_radius < 0)
    throw Error("radius_outlier_removal_min_points_in_radius {}: must be 0 or more",
                radius_outlier_removal_min_points_in_radius);
  if (statistical_outlier_removal_num_of_k_nearest_neighbors < 1 ||
      statistical_outlier_removal_num_of_k_nearest_neighbors > 1000)
    throw Error("statistical_outlier_removal_num_of_k_nearest_neighbors {}: must be 1 to 1000",
                statistical_outlier_removal_num_of_k_nearest_neighbors);
  if (!std::isfinite(statistical_outlier_removal_std_deviation_multiplier))
    throw Error("statistical_outlier_removal_std_deviation_multiplier is not a finite number");
}

void NormalEstimationOptions::check() const {
  must_be_positive("search_radius", search_radius);
  if (!(normal_to_view_angle_deviation_degrees >= 0 && normal_to_view_angle_deviation_degrees <= 180))
    throw Error("normal_to_view_angle_deviation_degrees {}: must be 0 to 180", normal_to_view_angle_deviation_degrees);
}

PreprocessedScene preprocess(const PointCloud& scene, const PreprocessOptions& options) {
  PreprocessedScene out{without_missing(scene), std::nullopt};
  PointCloud& cloud = out.cloud;
  if (options.scale_flag) cloud = scaled(cloud, options.scale_factor);
  if (options.xyz_filter_flag) cloud = cropped(cloud, options.xyz_limits);
  if (options.voxel_grid_flag) cloud = voxel_grid(cloud, options.voxel_size);
  if (options.plane_removal_flag) {
    if (const auto fit = fit_plane(cloud, {.distance_threshold_mm = options.plane_removal_distance_threshold})) {
      std::vector<bool> on_plane(cloud.size(), false);
      for (const int i : fit->inliers) on_plane[i] = true;
      cloud = filtered(cloud, [&](std::size_t i) { return !on_plane[i]; });
      out.plane = fit->plane;
    }
  }
  if (options.radius_outlier_removal_flag)
    cloud = without_radius_outliers(cloud, options.radius_outlier_removal_radius,
                                    options.radius_outlier_removal_min_points_in_radius);
  if (options.statistical_outlier_removal_flag)
    cloud = without_statistical_outliers(cloud, options.statistical_outlier_removal_num_of_k_nearest_neighbors,
                                         options.statistical_outlier_removal_std_deviation_multiplier);
  return out;
}

PointCloud scaled(const PointCloud& cloud, float factor) {
  PointCloud out = cloud;
  for (auto& p : out.points) p *= factor;
  return out;
}

PointCloud cropped(const PointCloud& cloud, const std::array<float, 6>& limits) {
  return filtered(cloud, [&](std::size_t i) {
    const auto& p = cloud.points[i];
    return p.x() >= limits[0] && p.x() <= limits[1] && p.y() >= limits[2] && p.y() <= limits[3] && p.z() >= limits[4] &&
           p.z() <= limits[5];
  });
}

PointCloud without_radius_outliers(const PointCloud& cloud, float radius_mm, int min_points) {
  const PointGrid grid(cloud.points, radius_mm);
  std::vector<int> neighbours(cloud.size(), 0);
  parallel_for(grid.cell_count(), [&](std::size_t c) {
    const auto ranges = grid.neighbourhood(c);
    const auto cell = grid.cell(c);
    for (int s = cell.begin; s < cell.end; ++s) {
      const float x = grid.x()[s], y = grid.y()[s], z = grid.z()[s];
      int count = -1;  // the point itself is always within
      for (const auto range : ranges) {
        for (int i = range.begin; i < range.end; ++i) {
          const float dx = grid.x()[i] - x, dy = grid.y()[i] - y, dz = grid.z()[i] - z;
          count += dx * dx + dy * dy + dz * dz <= radius_mm * radius_mm;
        }
      }
      neighbours[grid.original(s)] = count;
    }
  }, 8);
  return filtered(cloud, [&](std::size_t i) { return neighbours[i] >= min_points; });
}

PointCloud without_statistical_outliers(const PointCloud& cloud, int neighbours, float deviations) {
  if (cloud.size() < 2) return cloud;
  const KdTree tree(cloud.points);
  std::vector<double> mean_distance(cloud.size());
  parallel_for(cloud.size(), [&](std::size_t i) {
    const auto found = tree.nearest_k(cloud.points[i], neighbours + 1);
    double sum = 0;
    for (const auto& n : found) sum += std::sqrt(static_cast<double>(n.squared_distance));
    mean_distance[i] = sum / static_cast<double>(std::max<std::size_t>(found.size() - 1, 1));
  }, 64);
  double sum = 0, squares = 0;
  for (const double d : mean_distance) sum += d, squares += d * d;
  const auto count = static_cast<double>(cloud.size());
  const double variance = std::max((squares - sum * sum / count) / (count - 1), 0.0);
  const double limit = sum / count + deviations * std::sqrt(variance);
  return filtered(cloud, [&](std::size_t i) { return mean_distance[i] <= limit; });
}

PointCloud with_normals(PointCloud cloud, const NormalEstimationOptions& options) {
  estimate_normals(cloud, options.search_radius);
  const double smallest_cosine = std::cos(radians(options.normal_to_view_angle_deviation_degrees));
  return filtered(cloud, [&](std::size_t i) {
    return cloud.normals[i].allFinite() && -cloud.normals[i].z() >= smallest_cosine;
  });
}

}  // namespace partpose
