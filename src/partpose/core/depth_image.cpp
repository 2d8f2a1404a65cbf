// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/depth_image.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"

#include <cmath>
#include <limits>

namespace partpose {

Intrinsics Intrinsics::from_field_of_view(int width, int height, double horizontal_fov_deg, double vertical_fov_deg) {
  for (const double fov : {horizontal_fov_deg, vertical_fov_deg})
    if (!(fov > 0 && fov < 180)) throw Error("field of view {} deg: must lie between 0 and 180 deg", fov);
  Intrinsics camera;
  camera.width = width;
  camera.height = height;
  camera.fx = 0.5 * width / std::tan(0.5 * radians(horizontal_fov_deg));
  camera.fy = 0.5 * height / std::tan(0.5 * radians(vertical_fov_deg));
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  camera.check();
  return camera;
}

void Intrinsics::check() const {
  if (width < 1 || height < 1 || width > 65536 || height > 65536)
    throw Error("camera: size {} x {} px, must be between 1 and 65536 px a side", width, height);
  if (!(fx > 0 && fy > 0) || !std::isfinite(fx) || !std::isfinite(fy))
    throw Error("camera: focal length fx = {}, fy = {} px, must be positive", fx, fy);
  if (!std::isfinite(cx) || !std::isfinite(cy)) throw Error("camera: principal point cx = {}, cy = {} is not finite", cx, cy);
}

Intrinsics intrinsics_covering(const PointCloud& cloud, double pixel_size_rad, int margin_px, int widest_px) {
  if (!(pixel_size_rad > 0)) throw Error("pixel size {} rad: must be positive", pixel_size_rad);
  Eigen::AlignedBox2d extent;
  for (const auto& p : cloud.points)
    if (p.allFinite() && p.z() > 0) extent.extend(Eigen::Vector2d(p.x(), p.y()) / p.z());
  if (extent.isEmpty()) throw Error("the cloud has no point before the camera (z > 0)");
  Intrinsics camera;
  camera.fx = camera.fy = 1.0 / std::max(pixel_size_rad, extent.sizes().maxCoeff() / (widest_px - 1 - 2 * margin_px));
  const Eigen::Vector2d size = extent.sizes() * camera.fx + Eigen::Vector2d::Constant(1 + 2 * margin_px);
  camera.width = static_cast<int>(std::ceil(size.x()));
  camera.height = static_cast<int>(std::ceil(size.y()));
  camera.cx = margin_px - extent.min().x() * camera.fx;
  camera.cy = margin_px - extent.min().y() * camera.fy;
  return camera;
}

PointCloud to_point_cloud(const DepthImage& depth, const Intrinsics& intrinsics, bool organized) {
  PointCloud cloud;
  cloud.points.reserve(organized ? depth.z_mm.size() : depth.z_mm.size() / 4);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const float z = depth.at(u, v);
      if (z > 0) cloud.points.push_back(intrinsics.unproject(u, v, z));
      else if (organized) cloud.points.emplace_back(nan, nan, nan);
    }
  }
  cloud.width = organized ? depth.width : static_cast<int>(cloud.size());
  cloud.height = organized ? depth.height : 1;
  return cloud;
}

DepthImage to_depth_image(const PointCloud& cloud, const Intrinsics& intrinsics) {
  DepthImage depth(intrinsics.width, intrinsics.height);
  for (const auto& p : cloud.points) {
    if (!p.allFinite() || p.z() <= 0) continue;
    const Eigen::Vector2d pixel = intrinsics.project(p.cast<double>());
    const double u = std::floor(pixel.x() + 0.5), v = std::floor(pixel.y() + 0.5);
    if (!(u >= 0 && v >= 0 && u < depth.width && v < depth.height)) continue;
    float& z = depth.at(static_cast<int>(u), static_cast<int>(v));
    if (z == 0 || p.z() < z) z = p.z();
  }
  return depth;
}

}  // namespace partpose
