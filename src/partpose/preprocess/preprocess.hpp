// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"
#include "partpose/geometry/plane.hpp"

#include <array>
#include <optional>

namespace partpose {

/// The steps run in the order of the keys, each only when its flag is set. Lengths are in mm after scaling.
struct PreprocessOptions {
  bool scale_flag = false;
  float scale_factor = 1000;
  bool xyz_filter_flag = false;
  std::array<float, 6> xyz_limits = {-10000, 10000, -10000, 10000, -10000, 10000};
  bool voxel_grid_flag = true;
  float voxel_size = 1;
  bool plane_removal_flag = false;
  float plane_removal_distance_threshold = 10;
  bool radius_outlier_removal_flag = false;
  float radius_outlier_removal_radius = 10;
  int radius_outlier_removal_min_points_in_radius = 50;
  bool statistical_outlier_removal_flag = false;
  int statistical_outlier_removal_num_of_k_nearest_neighbors = 50;
  float statistical_outlier_removal_std_deviation_multiplier = 1;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("scale_flag", self.scale_flag, "multiply all coordinates by scale_factor");
    visit("scale_factor", self.scale_factor, "1000 for clouds in metres; > 0");
    visit("xyz_filter_flag", self.xyz_filter_flag, "keep only the points within xyz_limits");
    visit("xyz_limits", self.xyz_limits, "x min, x max, y min, y max, z min, z max [mm], camera frame");
    visit("voxel_grid_flag", self.voxel_grid_flag, "replace the points of each voxel by their centroid");
    visit("voxel_size", self.voxel_size, "edge of a voxel [mm], > 0");
    visit("plane_removal_flag", self.plane_removal_flag, "remove the dominant plane (the table)");
    visit("plane_removal_distance_threshold", self.plane_removal_distance_threshold,
          "points this near to the plane are removed [mm], > 0");
    visit("radius_outlier_removal_flag", self.radius_outlier_removal_flag, "remove points with few neighbours");
    visit("radius_outlier_removal_radius", self.radius_outlier_removal_radius, "radius around each point [mm], > 0");
    visit("radius_outlier_removal_min_points_in_radius", self.radius_outlier_removal_min_points_in_radius,
          "a point is kept with at least so many others within the radius, >= 0");
    visit("statistical_outlier_removal_flag", self.statistical_outlier_removal_flag,
          "remove points whose mean distance to their neighbours is unusual");
    visit("statistical_outlier_removal_num_of_k_nearest_neighbors",
          self.statistical_outlier_removal_num_of_k_nearest_neighbors, "how many neighbours are looked at, 1 to 1000");
    visit("statistical_outlier_removal_std_deviation_multiplier",
          self.statistical_outlier_removal_std_deviation_multiplier,
          "a point is removed when its mean distance exceeds the cloud's mean by so many standard deviations");
  }
  void check() const;
};

struct PreprocessedScene {
  PointCloud cloud;              ///< camera frame, mm, finite points only
  std::optional<Plane> plane;    ///< the plane that was removed
};

/// Points that are not finite are dropped first. An empty cloud stays empty.
PreprocessedScene preprocess(const PointCloud& scene, const PreprocessOptions& options);

// The single steps, each a pure function.
PointCloud scaled(const PointCloud& cloud, float factor);
PointCloud cropped(const PointCloud& cloud, const std::array<float, 6>& xyz_limits_mm);
PointCloud without_radius_outliers(const PointCloud& cloud, float radius_mm, int min_points);
PointCloud without_statistical_outliers(const PointCloud& cloud, int neighbours, float deviations);

struct NormalEstimationOptions {
  float search_radius = 9;
  float normal_to_view_angle_deviation_degrees = 89;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("search_radius", self.search_radius, "radius of the neighbourhood that a normal is fitted to [mm], > 0");
    visit("normal_to_view_angle_deviation_degrees", self.normal_to_view_angle_deviation_degrees,
          "points whose normal is turned further than this from the camera's -z axis are dropped [deg], 0 to 180");
  }
  void check() const;
};

/// Normals and curvatures of a scene seen from the origin; points without a well-defined normal, or with one that is
/// turned too far away, are dropped.
PointCloud with_normals(PointCloud cloud, const NormalEstimationOptions& options);

}  // namespace partpose
