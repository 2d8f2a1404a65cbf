// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <Eigen/Core>

#include <vector>

namespace partpose {

/// Pinhole camera without distortion. Pixel centres are at integer coordinates; camera frame: x right, y down, z forward.
struct Intrinsics {
  int width = 0;   ///< px
  int height = 0;  ///< px
  double fx = 0;   ///< px
  double fy = 0;   ///< px
  double cx = 0;   ///< px
  double cy = 0;   ///< px

  /// The camera whose image edges lie at +-fov/2 and whose principal point is the image's centre.
  static Intrinsics from_field_of_view(int width, int height, double horizontal_fov_deg, double vertical_fov_deg);

  /// Throws Error unless the size is positive and at most 65536 px a side and the focal lengths are positive and finite.
  void check() const;

  /// Point in the camera frame (mm) at pixel (u, v) and depth z (mm).
  Eigen::Vector3f unproject(double u, double v, double z_mm) const {
    return Eigen::Vector3d((u - cx) / fx * z_mm, (v - cy) / fy * z_mm, z_mm).cast<float>();
  }
  /// Pixel coordinates of a point with z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& point_mm) const {
    return {fx * point_mm.x() / point_mm.z() + cx, fy * point_mm.y() / point_mm.z() + cy};
  }
};

/// The camera at the origin whose image just covers a cloud, with pixels `pixel_size_rad` wide at the optical axis (wider
/// where the image would exceed `widest_px` a side) and `margin_px` around. Points behind the camera do not count. Throws
/// Error when no point is before the camera.
Intrinsics intrinsics_covering(const PointCloud& cloud, double pixel_size_rad, int margin_px = 2, int widest_px = 2000);

/// Depth along the optical axis (z, not distance) in mm, row by row; 0 means no value.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<float> z_mm;

  DepthImage() = default;
  DepthImage(int width_px, int height_px)
      : width(width_px), height(height_px), z_mm(static_cast<std::size_t>(width_px) * height_px, 0.0f) {}

  float at(int u, int v) const { return z_mm[static_cast<std::size_t>(v) * width + u]; }
  float& at(int u, int v) { return z_mm[static_cast<std::size_t>(v) * width + u]; }
};

/// One point per pixel; missing ones are NaN when `organized`, left out otherwise.
PointCloud to_point_cloud(const DepthImage& depth, const Intrinsics& intrinsics, bool organized = false);

/// Each point into its nearest pixel, the nearest point wins. Points behind the camera or outside the image are dropped.
DepthImage to_depth_image(const PointCloud& cloud, const Intrinsics& intrinsics);

}  // namespace partpose
