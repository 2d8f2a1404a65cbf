// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/rasterizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace partpose {

namespace {

constexpr double near_mm = 1.0;

/// A vertex beyond the near plane: camera frame, and in pixels.
struct Corner {
  Eigen::Vector3d place_mm;
  double inverse_z, u, v;

  Corner() = default;
  Corner(const Eigen::Vector3d& place, const Intrinsics& camera)
      : place_mm(place),
        inverse_z(1 / place.z()),
        u(camera.fx * place.x() * inverse_z + camera.cx),
        v(camera.fy * place.y() * inverse_z + camera.cy) {}
};

/// Draws into a buffer of inverse depths, in which a plane is affine in pixel coordinates. `triangle`: what is seen at
/// each pixel; empty when nobody asks.
class Canvas {
 public:
  Canvas(const Intrinsics& camera, Faces faces, std::vector<float>& inverse_z, std::vector<int>& triangle)
      : camera_(camera),
        most_distance_(faces == Faces::front ? 0 : std::numeric_limits<double>::infinity()),
        per_fx_(1 / camera.fx),
        per_fy_(1 / camera.fy),
        last_u_(camera.width - 1),
        last_v_(camera.height - 1),
        inverse_z_(inverse_z.data()),
        triangle_(triangle.empty() ? nullptr : triangle.data()) {}

  /// Whether a triangle may cover a pixel. Without branches, since they would be taken at random.
  bool may_be_seen(const Corner& p0, const Corner& p1, const Corner& p2) const {
    const double u_min = std::min(std::min(p0.u, p1.u), p2.u), u_max = std::max(std::max(p0.u, p1.u), p2.u);
    const double v_min = std::min(std::min(p0.v, p1.v), p2.v), v_max = std::max(std::max(p0.v, p1.v), p2.v);
    const double distance = normal(p0, p1, p2).dot(p0.place_mm);
    // Most of a fine mesh falls between the pixel centres.
    return static_cast<bool>((u_max >= -tolerance_px) & (u_min <= last_u_ + tolerance_px) &
                             (std::ceil(u_min - tolerance_px) <= u_max + tolerance_px) & (v_max >= -tolerance_px) &
                             (v_min <= last_v_ + tolerance_px) &
                             (std::ceil(v_min - tolerance_px) <= v_max + tolerance_px) & (distance <= most_distance_) &
                             (distance != 0));  // degenerate, or seen exactly edge-on
  }

  /// Of those that may be seen.
  void draw(const Corner& p0, const Corner& p1, const Corner& p2, int index) {
    // From the top down.
    const Corner* upper_01 = p1.v < p0.v ? &p1 : &p0;
    const Corner* lower_01 = p1.v < p0.v ? &p0 : &p1;
    const Corner* top = p2.v < upper_01->v ? &p2 : upper_01;
    const Corner* rest = p2.v < upper_01->v ? upper_01 : &p2;
    const Corner* middle = rest->v < lower_01->v ? rest : lower_01;
    const Corner* bottom = rest->v < lower_01->v ? lower_01 : rest;
    const int first_row = row_from(top->v), last_row = row_to(bottom->v);
    if (!(bottom->v - top->v > tolerance_px)) return;

    const Eigen::Vector3d normal = this->normal(p0, p1, p2);
    const double distance = normal.dot(p0.place_mm);
    Face face;
    const double per_distance = 1 / distance;
    face.per_u = normal.x() * per_distance * per_fx_;
    face.per_v = normal.y() * per_distance * per_fy_;
    face.constant = normal.z() * per_distance - face.per_u * camera_.cx - face.per_v * camera_.cy;
    face.farthest = static_cast<float>(std::min({p0.inverse_z, p1.inverse_z, p2.inverse_z}));
    face.nearest = static_cast<float>(std::max({p0.inverse_z, p1.inverse_z, p2.inverse_z}));
    face.index = index;

    const Edge whole(*top, *bottom);
    int row = first_row;
    if (middle->v - top->v > tolerance_px) {
      const int end = std::min(last_row, row_to(middle->v));
      const Edge upper(*top, *middle);
      for (; row <= end; ++row) fill(face, row, whole.at(row), upper.at(row));
    }
    if (bottom->v - middle->v > tolerance_px) {
      const Edge lower(*middle, *bottom);
      for (; row <= last_row; ++row) fill(face, row, whole.at(row), lower.at(row));
    }
  }

 private:
  static constexpr double tolerance_px = 1e-9;  // so that no pixel centre falls between two triangles

  static Eigen::Vector3d normal(const Corner& p0, const Corner& p1, const Corner& p2) {
    return (p1.place_mm - p0.place_mm).cross(p2.place_mm - p0.place_mm);
  }

  struct Face {
    double per_u, per_v, constant;
    float farthest, nearest;  ///< inverse depths
    int index;
  };

  /// Where the line between two corners, the upper one first, meets a row.
  struct Edge {
    double u, v, slope, left, right;

    Edge(const Corner& a, const Corner& b)
        : u(a.u), v(a.v), slope((b.u - a.u) / (b.v - a.v)), left(std::min(a.u, b.u)), right(std::max(a.u, b.u)) {}
    double at(int row) const { return std::min(std::max(u + slope * (row - v), left), right); }
  };

  int row_from(double v) const {
    return static_cast<int>(std::ceil(std::min(std::max(v - tolerance_px, 0.0), last_v_ + 1)));
  }
  int row_to(double v) const {
    return static_cast<int>(std::floor(std::min(std::max(v + tolerance_px, -1.0), last_v_)));
  }

  void fill(const Face& face, int v, double end, double other_end) const {
    const double left = std::min(end, other_end), right = std::max(end, other_end);
    const int u0 = static_cast<int>(std::ceil(std::min(std::max(left - tolerance_px, 0.0), last_u_ + 1)));
    const int u1 = static_cast<int>(std::floor(std::min(std::max(right + tolerance_px, -1.0), last_u_)));
    if (u0 > u1) return;
    const auto start = static_cast<float>(face.per_u * u0 + face.per_v * v + face.constant);
    const auto step = static_cast<float>(face.per_u);
    const float farthest = face.farthest, nearest = face.nearest;
    // An edge-on triangle's plane is steep: what it covers is never outside its corners' depths.
    const auto inverse_at = [=](int i) {
      return std::min(std::max(start + step * static_cast<float>(i), farthest), nearest);
    };
    const std::size_t first = static_cast<std::size_t>(v) * camera_.width + u0;
    float* buffer = inverse_z_ + first;
    const int count = u1 - u0 + 1;
    if (!triangle_) {
#pragma omp simd
      for (int i = 0; i < count; ++i) buffer[i] = std::max(buffer[i], inverse_at(i));
      return;
    }
    int* owner = triangle_ + first;
    const int index = face.index;
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const float inverse = inverse_at(i);
      const bool in_front = inverse > buffer[i];
      buffer[i] = in_front ? inverse : buffer[i];
      owner[i] = in_front ? index : owner[i];
    }
  }

  const Intrinsics& camera_;
  double most_distance_;  ///< of a triangle's plane, along its normal: negative where its front is seen
  double per_fx_, per_fy_, last_u_, last_v_;
  float* inverse_z_;
  int* triangle_;
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

/// A mesh wholly beyond the near plane.
void draw_all(Canvas& canvas, const TriangleMesh& mesh, const std::vector<Corner>& corners) {
  std::vector<int> seen(mesh.triangles.size());
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    seen[count] = static_cast<int>(t);
    count += canvas.may_be_seen(corners[a], corners[b], corners[c]);
  }
  seen.resize(count);
  for (const int t : seen) {
    const auto& [a, b, c] = mesh.triangles[t];
    canvas.draw(corners[a], corners[b], corners[c], t);
  }
}

void draw_cut(Canvas& canvas, const TriangleMesh& mesh, const std::vector<Corner>& corners, const Intrinsics& camera) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const std::array<Eigen::Vector3d, 3> place = {corners[a].place_mm, corners[b].place_mm, corners[c].place_mm};
    const int beyond = (place[0].z() >= near_mm) + (place[1].z() >= near_mm) + (place[2].z() >= near_mm);
    const auto draw = [&](const Corner& p0, const Corner& p1, const Corner& p2) {
      if (canvas.may_be_seen(p0, p1, p2)) canvas.draw(p0, p1, p2, static_cast<int>(t));
    };
    if (beyond == 3) {
      draw(corners[a], corners[b], corners[c]);
    } else if (beyond > 0) {
      const auto polygon = beyond_near_plane(place);
      for (std::size_t k = 2; k < polygon.size(); ++k)
        draw({polygon[0], camera}, {polygon[k - 1], camera}, {polygon[k], camera});
    }
  }
}

void draw(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& camera, Faces faces,
          DepthImage& depth, std::vector<int>& triangle) {
  const std::size_t pixels = static_cast<std::size_t>(camera.width) * camera.height;
  std::vector<float>& inverse_z = depth.z_mm;  // inverted in place at the end
  depth.width = camera.width, depth.height = camera.height;
  inverse_z.assign(pixels, 0);
  std::vector<Corner> corners(mesh.vertices.size());
  double nearest_mm = near_mm;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = Corner(camera_from_model * mesh.vertices[i].cast<double>(), camera);
    nearest_mm = std::min(nearest_mm, corners[i].place_mm.z());
  }
  Canvas canvas(camera, faces, inverse_z, triangle);
  if (nearest_mm < near_mm) {
    draw_cut(canvas, mesh, corners, camera);
  } else {
    draw_all(canvas, mesh, corners);
  }
  for (float& value : inverse_z)
    if (value > 0) value = 1.0f / value;
}

}  // namespace

Rendering render(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& intrinsics,
                 Faces faces) {
  Rendering out;
  const std::size_t pixels = static_cast<std::size_t>(intrinsics.width) * intrinsics.height;
  out.triangle.assign(pixels, -1);
  draw(mesh, camera_from_model, intrinsics, faces, out.depth, out.triangle);
  return out;
}

DepthImage render_depth(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                        const Intrinsics& intrinsics, Faces faces) {
  DepthImage out;
  std::vector<int> nobody_asks;
  draw(mesh, camera_from_model, intrinsics, faces, out, nobody_asks);
  return out;
}

}  // namespace partpose
