// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/rasterizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace partpose {

namespace {

constexpr double near_mm = 1.0;

/// Draws into a buffer of inverse depths, in which a plane is affine in pixel coordinates.
class Canvas {
 public:
  Canvas(const Intrinsics& camera, std::vector<float>& inverse_z, std::vector<int>& triangle)
      : camera_(camera), inverse_z_(inverse_z), triangle_(triangle) {}

  /// A triangle wholly beyond the near plane, corners in the camera frame and in pixels.
  void draw(const std::array<Eigen::Vector3d, 3>& corner, const std::array<Eigen::Vector2d, 3>& pixel, int index) {
    double u_min = 1e300, u_max = -1e300, v_min = 1e300, v_max = -1e300, z_min = 1e300, z_max = 0;
    for (int k = 0; k < 3; ++k) {
      u_min = std::min(u_min, pixel[k].x());
      u_max = std::max(u_max, pixel[k].x());
      v_min = std::min(v_min, pixel[k].y());
      v_max = std::max(v_max, pixel[k].y());
      z_min = std::min(z_min, corner[k].z());
      z_max = std::max(z_max, corner[k].z());
    }
    // Most of a fine mesh falls between the pixel centres.
    if (u_max < -tolerance_px || u_min > camera_.width - 1 + tolerance_px ||
        std::ceil(u_min - tolerance_px) > u_max + tolerance_px)
      return;
    const int first_row = static_cast<int>(std::ceil(std::clamp(v_min - tolerance_px, 0.0, double(camera_.height))));
    const int last_row = static_cast<int>(std::floor(std::clamp(v_max + tolerance_px, -1.0, camera_.height - 1.0)));
    if (first_row > last_row) return;

    const Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double distance = normal.dot(corner[0]);
    if (distance == 0) return;  // degenerate, or seen exactly edge-on
    const double per_u = normal.x() / (camera_.fx * distance);
    const double per_v = normal.y() / (camera_.fy * distance);
    const double constant = normal.z() / distance - per_u * camera_.cx - per_v * camera_.cy;
    const auto farthest = static_cast<float>(1.0 / z_max), nearest = static_cast<float>(1.0 / z_min);

    for (int v = first_row; v <= last_row; ++v) {
      const auto [left, right] = span(pixel, v);
      if (left > right) continue;
      const int u0 = static_cast<int>(std::ceil(std::clamp(left - tolerance_px, 0.0, double(camera_.width))));
      const int u1 = static_cast<int>(std::floor(std::clamp(right + tolerance_px, -1.0, camera_.width - 1.0)));
      if (u0 > u1) continue;
      const auto start = static_cast<float>(per_u * u0 + per_v * v + constant);
      const auto step = static_cast<float>(per_u);
      float* buffer = &inverse_z_[static_cast<std::size_t>(v) * camera_.width + u0];
      int* owner = &triangle_[static_cast<std::size_t>(v) * camera_.width + u0];
#pragma omp simd
      for (int i = 0; i <= u1 - u0; ++i) {
        // An edge-on triangle's plane is steep: what it covers is never outside its corners' depths.
        const float inverse = std::min(std::max(start + step * static_cast<float>(i), farthest), nearest);
        const bool in_front = inverse > buffer[i];
        buffer[i] = in_front ? inverse : buffer[i];
        owner[i] = in_front ? index : owner[i];
      }
    }
  }

 private:
  static constexpr double tolerance_px = 1e-9;  // so that no pixel centre falls between two triangles

  /// Where the triangle meets the row `v`: left and right end in pixels, left > right when it does not.
  static std::pair<double, double> span(const std::array<Eigen::Vector2d, 3>& pixel, double v) {
    double left = 1e300, right = -1e300;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d& a = pixel[k];
      const Eigen::Vector2d& b = pixel[(k + 1) % 3];
      const double low = std::min(a.y(), b.y()), high = std::max(a.y(), b.y());
      if (v < low - tolerance_px || v > high + tolerance_px) continue;
      if (high - low <= tolerance_px) {
        left = std::min({left, a.x(), b.x()});
        right = std::max({right, a.x(), b.x()});
        continue;
      }
      const double along = std::clamp((v - a.y()) / (b.y() - a.y()), 0.0, 1.0);
      const double u = a.x() + along * (b.x() - a.x());
      left = std::min(left, u);
      right = std::max(right, u);
    }
    return {left, right};
  }

  const Intrinsics& camera_;
  std::vector<float>& inverse_z_;
  std::vector<int>& triangle_;
};

/// The part of a triangle beyond the near plane: 0, 3 or 4 corners (Sutherland and Hodgman 1974).
std::vector<Eigen::Vector3d> beyond_near_plane(const std::array<Eigen::Vector3d, 3>& corner) {
  std::vector<Eigen::Vector3d> kept;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d& a = corner[k];
    const Eigen::Vector3d& b = corner[(k + 1) % 3];
    if (a.z() >= near_mm) kept.push_back(a);
    if ((a.z() >= near_mm) != (b.z() >= near_mm)) {
      kept.push_back(a + (near_mm - a.z()) / (b.z() - a.z()) * (b - a));
      kept.back().z() = near_mm;
    }
  }
  return kept;
}

}  // namespace

Rendering render(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& intrinsics) {
  Rendering out;
  out.depth = DepthImage(intrinsics.width, intrinsics.height);
  out.triangle.assign(out.depth.z_mm.size(), -1);
  std::vector<float>& inverse_z = out.depth.z_mm;  // inverted in place at the end

  std::vector<Eigen::Vector3d> vertices(mesh.vertices.size());
  std::vector<Eigen::Vector2d> pixels(mesh.vertices.size());  // of those beyond the near plane
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i] = camera_from_model * mesh.vertices[i].cast<double>();
    if (vertices[i].z() >= near_mm) pixels[i] = intrinsics.project(vertices[i]);
  }

  Canvas canvas(intrinsics, inverse_z, out.triangle);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const std::array<Eigen::Vector3d, 3> corner = {vertices[a], vertices[b], vertices[c]};
    const int beyond = (corner[0].z() >= near_mm) + (corner[1].z() >= near_mm) + (corner[2].z() >= near_mm);
    if (beyond == 3) {
      canvas.draw(corner, {pixels[a], pixels[b], pixels[c]}, static_cast<int>(t));
    } else if (beyond > 0) {
      const auto polygon = beyond_near_plane(corner);
      for (std::size_t k = 2; k < polygon.size(); ++k)
        canvas.draw(
            {polygon[0], polygon[k - 1], polygon[k]},
            {intrinsics.project(polygon[0]), intrinsics.project(polygon[k - 1]), intrinsics.project(polygon[k])},
            static_cast<int>(t));
    }
  }
  for (float& value : inverse_z)
    if (value > 0) value = 1.0f / value;
  return out;
}

}  // namespace partpose
