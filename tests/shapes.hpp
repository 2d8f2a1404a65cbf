// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// What the tests of all rooms share: shapes whose truth is known, seeded random motions, and the message of an Error.
#pragma once

#include "partpose/core/error.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/core/point_cloud.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace partpose::shapes {

// Meshes: millimetres, closed (but for the patch), triangles counter-clockwise seen from outside.

inline void add_triangle(TriangleMesh& mesh, int a, int b, int c) { mesh.triangles.push_back({a, b, c}); }

inline void add_quad(TriangleMesh& mesh, int a, int b, int c, int d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

/// From `low` to `high`, 12 triangles.
inline TriangleMesh box(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                               corner & 4 ? high.z() : low.z());
  add_quad(mesh, 0, 2, 3, 1);
  add_quad(mesh, 4, 5, 7, 6);
  add_quad(mesh, 0, 1, 5, 4);
  add_quad(mesh, 2, 6, 7, 3);
  add_quad(mesh, 0, 4, 6, 2);
  add_quad(mesh, 1, 3, 7, 5);
  return mesh;
}

/// Centred at the origin.
inline TriangleMesh box(const Eigen::Vector3f& size) { return box(-0.5f * size, 0.5f * size); }

/// Meridians and parallels about z, centred at the origin, vertices on the sphere: 2 * segments * (rings - 1)
/// triangles.
inline TriangleMesh sphere(double radius, int segments, int rings) {
  TriangleMesh mesh;
  const auto point = [&](double polar, double azimuth) {
    return Eigen::Vector3f(Eigen::Vector3d(radius * std::sin(polar) * std::cos(azimuth),
                                           radius * std::sin(polar) * std::sin(azimuth), radius * std::cos(polar))
                               .cast<float>());
  };
  mesh.vertices.push_back(point(0, 0));
  for (int r = 1; r < rings; ++r)
    for (int s = 0; s < segments; ++s)
      mesh.vertices.push_back(point(std::numbers::pi * r / rings, 2 * std::numbers::pi * s / segments));
  mesh.vertices.emplace_back(0.0f, 0.0f, -static_cast<float>(radius));
  const auto at = [&](int r, int s) { return 1 + (r - 1) * segments + s % segments; };
  const int south = static_cast<int>(mesh.vertices.size()) - 1;
  for (int s = 0; s < segments; ++s) {
    add_triangle(mesh, 0, at(1, s), at(1, s + 1));
    for (int r = 1; r + 1 < rings; ++r) add_quad(mesh, at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s + 1));
    add_triangle(mesh, south, at(rings - 1, s + 1), at(rings - 1, s));
  }
  return mesh;
}

/// About z, centred at the origin, with flat ends: 4 * segments triangles.
inline TriangleMesh cylinder(double radius, double height, int segments) {
  TriangleMesh mesh;
  for (const double z : {-height / 2, height / 2}) {
    mesh.vertices.emplace_back(0.0f, 0.0f, static_cast<float>(z));
    for (int s = 0; s < segments; ++s) {
      const double azimuth = 2 * std::numbers::pi * s / segments;
      mesh.vertices.push_back(Eigen::Vector3d(radius * std::cos(azimuth), radius * std::sin(azimuth), z).cast<float>());
    }
  }
  const int top = segments + 1;
  for (int s = 0; s < segments; ++s) {
    const int a = 1 + s, b = 1 + (s + 1) % segments;
    add_triangle(mesh, 0, b, a);
    add_triangle(mesh, top, top + a, top + b);
    add_quad(mesh, a, b, top + b, top + a);
  }
  return mesh;
}

/// An L in the xy plane with legs of different lengths, drawn out along z: no symmetry but the mirror plane of its
/// middle. Its inner edge is at (thickness, thickness); one corner is the origin.
inline TriangleMesh l_bracket(float length_x, float length_y, float thickness, float width) {
  TriangleMesh mesh;
  const std::array<Eigen::Vector2f, 6> outline = {Eigen::Vector2f{0, 0},  {length_x, 0},         {length_x, thickness},
                                                  {thickness, thickness}, {thickness, length_y}, {0, length_y}};
  for (const float z : {0.0f, width})
    for (const auto& p : outline) mesh.vertices.emplace_back(p.x(), p.y(), z);
  add_quad(mesh, 0, 3, 2, 1);
  add_quad(mesh, 0, 5, 4, 3);
  add_quad(mesh, 6, 7, 8, 9);
  add_quad(mesh, 6, 9, 10, 11);
  for (int k = 0; k < 6; ++k) {
    const int next = (k + 1) % 6;
    add_quad(mesh, k, next, 6 + next, 6 + k);
  }
  return mesh;
}

/// 80 x 50 x 30 mm with 12 mm walls.
inline TriangleMesh l_bracket() { return l_bracket(80, 50, 12, 30); }

/// A rectangle in the xy plane centred at the origin, normal +z, cut into `cells` x `cells` x 2 triangles.
inline TriangleMesh plane_patch(float size_x, float size_y, int cells = 1) {
  TriangleMesh mesh;
  for (int r = 0; r <= cells; ++r)
    for (int c = 0; c <= cells; ++c)
      mesh.vertices.emplace_back(size_x * (static_cast<float>(c) / static_cast<float>(cells) - 0.5f),
                                 size_y * (static_cast<float>(r) / static_cast<float>(cells) - 0.5f), 0.0f);
  const auto at = [&](int r, int c) { return r * (cells + 1) + c; };
  for (int r = 0; r < cells; ++r)
    for (int c = 0; c < cells; ++c) add_quad(mesh, at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r + 1, c));
  return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const Eigen::Isometry3d& target_from_mesh) {
  for (auto& v : mesh.vertices) v = (target_from_mesh * v.cast<double>()).cast<float>();
  return mesh;
}

inline TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) add_triangle(mesh, first + a, first + b, first + c);
  return mesh;
}

/// Of a closed mesh; negative when its triangles face inwards.
inline double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += mesh.vertices[a].cast<double>().dot(mesh.vertices[b].cast<double>().cross(mesh.vertices[c].cast<double>()));
  return sum / 6;
}

/// Distance from a point to the nearest place on a triangle (Ericson 2005, 5.1.5).
inline double distance_to_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                   const Eigen::Vector3d& c) {
  const auto to_segment = [&p](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d edge = to - from;
    const double along = edge.squaredNorm() > 0 ? std::clamp((p - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0) : 0.0;
    return (p - from - along * edge).norm();
  };
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const bool above = normal.norm() > 0 && (b - a).cross(p - a).dot(normal) >= 0 &&
                     (c - b).cross(p - b).dot(normal) >= 0 && (a - c).cross(p - c).dot(normal) >= 0;
  if (above) return std::abs((p - a).dot(normal.normalized()));
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

/// Distance from a point to the nearest place on a mesh, by trying every triangle.
inline double distance_to_mesh(const Eigen::Vector3d& point, const TriangleMesh& mesh) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles)
    nearest = std::min(nearest, distance_to_triangle(point, mesh.vertices[a].cast<double>(),
                                                     mesh.vertices[b].cast<double>(), mesh.vertices[c].cast<double>()));
  return nearest;
}

/// Points spread evenly at random over a mesh's surface, with the normals of their triangles.
inline PointCloud surface_points(const TriangleMesh& mesh, int count, Random& random) {
  std::vector<double> area_up_to;
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d ab = (mesh.vertices[b] - mesh.vertices[a]).cast<double>();
    area += 0.5 * ab.cross((mesh.vertices[c] - mesh.vertices[a]).cast<double>()).norm();
    area_up_to.push_back(area);
  }
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const auto t =
        std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, area * random.uniform()) - area_up_to.begin();
    const auto& [a, b, c] = mesh.triangles[t];
    const double root = std::sqrt(random.uniform()), along = random.uniform();
    cloud.points.push_back(((1 - root) * mesh.vertices[a].cast<double>() +
                            root * (1 - along) * mesh.vertices[b].cast<double>() +
                            root * along * mesh.vertices[c].cast<double>())
                               .cast<float>());
    cloud.normals.push_back(mesh.face_normal(t));
  }
  cloud.width = count;
  cloud.height = 1;
  return cloud;
}

inline double between(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }

inline Eigen::Vector3d random_direction(Random& random) {
  const auto [x, y] = random.normal_pair();
  return Eigen::Vector3d(x, y, random.normal_pair().first).normalized();
}

/// Any rotation by `angle_rad`, about the origin.
inline Eigen::Matrix3d random_turn(Random& random, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, random_direction(random)).toRotationMatrix();
}

/// Any rotation at all, the origin put at `position_mm`.
inline Eigen::Isometry3d random_pose(Random& random, const Eigen::Vector3d& position_mm = Eigen::Vector3d::Zero()) {
  const auto [x, y] = random.normal_pair();
  const auto [z, w] = random.normal_pair();
  Eigen::Isometry3d pose(Eigen::Translation3d{position_mm});
  pose.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  return pose;
}

/// Turns by `angle_deg` about an axis through `centre_mm` and then moves by `distance_mm`, both in any direction.
inline Eigen::Isometry3d random_motion(Random& random, double angle_deg, double distance_mm,
                                       const Eigen::Vector3d& centre_mm = Eigen::Vector3d::Zero()) {
  const Eigen::Matrix3d turn = random_turn(random, radians(angle_deg));
  Eigen::Isometry3d motion(Eigen::Translation3d(centre_mm - turn * centre_mm + distance_mm * random_direction(random)));
  motion.linear() = turn;
  return motion;
}

/// Points evenly spread in the cube from -half_mm to half_mm about `centre_mm`, without normals.
inline PointCloud random_cube(Random& random, int count, double half_mm,
                              const Eigen::Vector3d& centre_mm = Eigen::Vector3d::Zero()) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double x = between(random, -half_mm, half_mm), y = between(random, -half_mm, half_mm);
    cloud.points.push_back((centre_mm + Eigen::Vector3d(x, y, between(random, -half_mm, half_mm))).cast<float>());
  }
  cloud.width = count;
  cloud.height = 1;
  return cloud;
}

/// Angle between two directions in degrees, precise for small ones too.
inline double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return degrees(std::atan2(a.cross(b).norm(), a.dot(b)));
}

/// Whether two vectors of plain values are the same bit for bit (NaN included).
template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline bool same_bits(const PointCloud& a, const PointCloud& b) {
  return same_bits(a.points, b.points) && same_bits(a.normals, b.normals) && same_bits(a.curvatures, b.curvatures) &&
         a.width == b.width && a.height == b.height;
}

/// The message of the Error that `call` throws.
template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// For EXPECT_PRED2(mentions, error_of(...), "part of the message").
inline bool mentions(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace partpose::shapes
