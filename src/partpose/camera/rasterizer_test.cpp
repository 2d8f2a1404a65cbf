// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/rasterizer.hpp"

#include "partpose/core/stopwatch.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <iostream>

namespace partpose {
namespace {

using namespace shapes;

const Intrinsics small_camera = Intrinsics::from_field_of_view(160, 120, 14, 10.5);
constexpr double exact_mm = 0.001;  ///< about ten roundings of a 32-bit depth at 650 mm

Eigen::Isometry3d at(double x, double y, double z) { return Eigen::Isometry3d(Eigen::Translation3d(x, y, z)); }

Eigen::Vector3d ray_through(double u, double v, const Intrinsics& camera) {
  return {(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1};
}

/// What one ray meets, tried against every triangle; all corners must be before the camera.
struct RayCast {
  double z_mm = 0;         ///< nearest, 0: none
  bool near_edge = false;  ///< passes some triangle's edge by less than a millionth of a pixel: rounding decides

  RayCast(const std::vector<std::array<Eigen::Vector3d, 3>>& triangles, int u, int v, const Intrinsics& camera) {
    const Eigen::Vector3d ray = ray_through(u, v, camera);
    const Eigen::Vector2d pixel(u, v);
    for (const auto& corner : triangles) {
      // The volumes that the ray and each edge span with the camera: of one sign when the ray goes through.
      std::array<double, 3> side;
      for (int k = 0; k < 3; ++k) side[k] = ray.dot(corner[k].cross(corner[(k + 1) % 3]));
      const auto [least, most] = std::minmax_element(side.begin(), side.end());
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d a = camera.project(corner[k]), edge = camera.project(corner[(k + 1) % 3]) - a;
        const double along =
            edge.squaredNorm() > 0 ? std::clamp((pixel - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0) : 0;
        near_edge = near_edge || (a + along * edge - pixel).norm() < 1e-6;
      }
      if (*least < 0 && *most > 0) continue;
      const Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
      const double z = normal.dot(corner[0]) / normal.dot(ray);
      if (z > 0 && (z_mm == 0 || z < z_mm)) z_mm = z;
    }
  }
};

/// The rendering of a mesh wholly before the camera against ray casting; returns how many pixels see it.
int expect_like_ray_casting(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                            const Intrinsics& camera) {
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;
  for (const auto& triangle : mesh.triangles) {
    auto& corners = triangles.emplace_back();
    for (int k = 0; k < 3; ++k) corners[k] = camera_from_model * mesh.vertices[triangle[k]].cast<double>();
  }
  const auto rendering = render(mesh, camera_from_model, camera);
  int seen = 0, near_edge = 0;
  double worst = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const RayCast truth(triangles, u, v, camera);
      const float z = rendering.depth.at(u, v);
      const int triangle = rendering.triangle[v * camera.width + u];
      EXPECT_EQ(z > 0, triangle >= 0);
      seen += z > 0;
      near_edge += truth.near_edge;
      if (truth.near_edge) continue;
      EXPECT_EQ(z > 0, truth.z_mm > 0) << "pixel " << u << ", " << v;
      if (!(z > 0 && truth.z_mm > 0)) continue;
      worst = std::max(worst, std::abs(z - truth.z_mm));
      // The triangle named must be one that is seen here.
      const auto& [a, b, c] = triangles.at(triangle);
      const Eigen::Vector3d normal = (b - a).cross(c - a);
      EXPECT_NEAR(normal.dot(a) / normal.dot(ray_through(u, v, camera)), truth.z_mm, exact_mm);
    }
  }
  EXPECT_LT(worst, exact_mm);
  EXPECT_LT(near_edge, 10) << "too many pixels left out";
  return seen;
}

TEST(Rasterizer, SphereLikeRayCastingOfTheSameMesh) {
  Random random(1);
  EXPECT_GT(expect_like_ray_casting(sphere(50, 40, 20), random_pose(random, {5, -3, 650}), small_camera), 7000);
}

TEST(Rasterizer, BracketLikeRayCastingAtManyPoses) {
  Random random(2);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d position(between(random, -60, 60), between(random, -40, 40), between(random, 300, 1200));
    expect_like_ray_casting(l_bracket(), random_pose(random, position), small_camera);
  }
}

TEST(Rasterizer, TrianglesThatPierceEachOtherLikeRayCasting) {
  Random random(3);
  for (int i = 0; i < 5; ++i) {
    TriangleMesh mesh;
    mesh.vertices = random_cube(random, 60, 60).points;
    for (int t = 0; t < 40; ++t)
      add_triangle(mesh, static_cast<int>(random.below(60)), static_cast<int>(random.below(60)),
                   static_cast<int>(random.below(60)));
    expect_like_ray_casting(mesh, at(0, 0, 500), small_camera);
  }
}

TEST(Rasterizer, SliversLikeRayCasting) {
  // Long triangles down to a thousandth of a pixel wide, at any angle, some of them nearly edge-on.
  Random random(4);
  TriangleMesh mesh;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3f middle = random_cube(random, 1, 50).points[0];
    const Eigen::Vector3f along = 60 * random_direction(random).cast<float>();
    const int first = static_cast<int>(mesh.vertices.size());
    const double width = std::pow(10, between(random, -3, 0));
    mesh.vertices.insert(mesh.vertices.end(),
                         {middle - along, middle + along, middle + (width * random_direction(random)).cast<float>()});
    add_triangle(mesh, first, first + 1, first + 2);
  }
  EXPECT_GT(expect_like_ray_casting(mesh, at(0, 0, 600), small_camera), 200);
}

/// Where a ray enters and leaves a box centred at the model's origin; nothing when it passes by.
std::optional<std::pair<double, double>> through_box(const Eigen::Vector3d& ray,
                                                     const Eigen::Isometry3d& camera_from_model,
                                                     const Eigen::Vector3d& size, double slack_mm) {
  const Eigen::Vector3d from = camera_from_model.inverse().translation();
  const Eigen::Vector3d direction = camera_from_model.linear().transpose() * ray;
  double enter = -1e300, leave = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = size[axis] / 2 + slack_mm;
    const double a = (-half - from[axis]) / direction[axis], b = (half - from[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter > leave) return std::nullopt;
  return std::pair(enter, leave);
}

TEST(Rasterizer, BoxIsExactAndWatertightAtManyPoses) {
  Random random(5);
  const Eigen::Vector3d size(60, 40, 25);
  const auto mesh = box(size.cast<float>());
  const auto camera = Intrinsics::from_field_of_view(96, 72, 14, 10.5);
  int inside = 0, pinholes = 0, strays = 0;
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    auto pose = random_pose(random, {between(random, -20, 20), between(random, -20, 20), between(random, 400, 800)});
    if (i % 10 == 0) pose.linear().setIdentity();  // faces along rows, columns and the line of sight
    const auto rendering = render(mesh, pose, camera);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const auto ray = ray_through(u, v, camera);
        const float z = rendering.depth.at(u, v);
        if (const auto hit = through_box(ray, pose, size, -1e-6)) {
          ++inside;
          pinholes += !(z > 0);
          worst = std::max(worst, std::abs(z - through_box(ray, pose, size, 0)->first));
        } else if (!through_box(ray, pose, size, 1e-6)) {
          strays += z > 0;
        }
      }
    }
  }
  EXPECT_GT(inside, 300000);
  EXPECT_EQ(pinholes, 0);
  EXPECT_EQ(strays, 0);
  EXPECT_LT(worst, exact_mm);
}

TEST(Rasterizer, AFinePlaneHasNoGapsWhereVerticesMeetPixelCentres) {
  // One millimetre a pixel: every vertex and edge of the patch goes through pixel centres.
  const Intrinsics camera = {101, 81, 500, 500, 50, 40};
  for (const double z : {500.0, 250.0, 1000.0}) {
    const auto rendering = render(plane_patch(200, 160, 200), at(0, 0, z), camera);
    const int half_x = std::min(50, static_cast<int>(100 * 500 / z)),
              half_y = std::min(40, static_cast<int>(80 * 500 / z));
    for (int v = 0; v < 81; ++v) {
      for (int u = 0; u < 101; ++u) {
        // The silhouette itself goes through pixel centres too; whether those are lit is left to rounding.
        if (std::abs(u - 50) < half_x && std::abs(v - 40) < half_y) {
          EXPECT_NEAR(rendering.depth.at(u, v), z, 1e-3) << u << ", " << v;
        }
      }
    }
  }
}

TEST(Rasterizer, TiltedPlaneIsExactAtAllPixels) {
  Random random(6);
  const auto camera = Intrinsics::from_field_of_view(640, 480, 50, 40);
  for (const int cells : {1, 40}) {
    for (int i = 0; i < 5; ++i) {
      Eigen::Isometry3d pose = at(0, 0, 650);
      pose.linear() = random_turn(random, radians(between(random, 0, 60)));
      const auto rendering = render(plane_patch(4000, 4000, cells), pose, camera);
      const Eigen::Vector3d normal = pose.linear().col(2);
      double worst = 0;
      int seen = 0;
      for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
          const float z = rendering.depth.at(u, v);
          if (!(z > 0)) continue;
          ++seen;
          const double truth = normal.dot(pose.translation()) / normal.dot(ray_through(u, v, camera));
          worst = std::max(worst, std::abs(z - truth) / truth);
        }
      }
      EXPECT_GT(seen, 250000);
      EXPECT_LT(worst, exact_mm / 650);
    }
  }
}

TEST(Rasterizer, FineSphereIsTheAnalyticOne) {
  constexpr double radius = 40;
  const auto camera = Intrinsics::from_field_of_view(320, 240, 10, 7.5);
  const Eigen::Vector3d centre(6, -4, 650);
  const auto rendering = render(sphere(radius, 320, 160), at(centre.x(), centre.y(), centre.z()), camera);
  int interior = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = ray_through(u, v, camera);
      const double a = ray.squaredNorm(), b = ray.dot(centre), c = centre.squaredNorm() - radius * radius;
      const double discriminant = b * b - a * c;
      const float z = rendering.depth.at(u, v);
      if (discriminant < 0) {
        EXPECT_EQ(z, 0) << "the mesh lies within the sphere";
        continue;
      }
      const double truth = (b - std::sqrt(discriminant)) / a;
      const double cosine = -ray.normalized().dot((truth * ray - centre) / radius);
      if (cosine < 0.5) continue;
      EXPECT_NEAR(z, truth, 0.01);
      ++interior;
    }
  }
  EXPECT_GT(interior, 20000);
}

TEST(Rasterizer, CutsAtTheNearPlane) {
  // A floor 100 mm below the camera from 1 m behind it to 1 m before it: every row below the horizon sees it.
  TriangleMesh floor;
  floor.vertices = {{-5000, 100, -1000}, {5000, 100, -1000}, {5000, 100, 1000}, {-5000, 100, 1000}};
  add_quad(floor, 0, 1, 2, 3);
  const Intrinsics camera = {80, 60, 40, 40, 40, 30};
  const auto rendering = render(floor, Eigen::Isometry3d::Identity(), camera);
  for (int v = 0; v < 60; ++v) {
    for (int u = 0; u < 80; ++u) {
      const double z = v > 30 ? 100 * 40.0 / (v - 30) : 1e300;
      if (std::abs(z - 1000) < 1) continue;  // the far edge of the floor
      EXPECT_NEAR(rendering.depth.at(u, v), z < 1000 ? z : 0, 1e-3) << u << ", " << v;
    }
  }
}

TEST(Rasterizer, CutsTrianglesWithOneOrTwoCornersBehindTheCamera) {
  Random random(7);
  const auto camera = Intrinsics::from_field_of_view(64, 48, 60, 50);
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    TriangleMesh mesh;
    for (int k = 0; k < 3; ++k)
      mesh.vertices.emplace_back(static_cast<float>(between(random, -100, 100)),
                                 static_cast<float>(between(random, -100, 100)),
                                 static_cast<float>(between(random, -100, 100)));
    add_triangle(mesh, 0, 1, 2);
    const auto rendering = render(mesh, Eigen::Isometry3d::Identity(), camera);
    std::array<Eigen::Vector3d, 3> corner;
    for (int k = 0; k < 3; ++k) corner[k] = mesh.vertices[k].cast<double>();
    const Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d ray = ray_through(u, v, camera);
        const double z = normal.dot(corner[0]) / normal.dot(ray);
        // Sine of the angle to the nearest edge's plane, positive when the point at z is inside.
        double inside = 1;
        for (int k = 0; k < 3; ++k) {
          const Eigen::Vector3d edge = corner[(k + 1) % 3] - corner[k];
          inside = std::min(inside, normal.cross(edge).normalized().dot(z * ray - corner[k]));
        }
        if (std::abs(z - 1) < 1e-3 || std::abs(inside) < 1e-3) continue;
        const float drawn = rendering.depth.at(u, v);
        const bool expected = z > 1 && inside > 0;
        EXPECT_NEAR(drawn, expected ? z : 0, 1e-4 * std::abs(z)) << "triangle " << i << ", pixel " << u << ", " << v;
        compared += expected;
      }
    }
  }
  EXPECT_GT(compared, 10000);
}

TEST(Rasterizer, FromInsideABoxAllIsSeen) {
  Random random(8);
  const Eigen::Vector3d size(300, 200, 250);
  const auto camera = Intrinsics::from_field_of_view(80, 60, 90, 80);
  for (int i = 0; i < 20; ++i) {
    const auto pose =
        random_pose(random, {between(random, -40, 40), between(random, -40, 40), between(random, -40, 40)});
    const auto rendering = render(box(size.cast<float>()), pose, camera);
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u)
        EXPECT_NEAR(rendering.depth.at(u, v), through_box(ray_through(u, v, camera), pose, size, 0)->second, 1e-3);
  }
}

TEST(Rasterizer, WhatLiesBehindOrBesideTheCameraIsNotDrawn) {
  for (const auto& pose : {at(0, 0, -500), at(0, 0, -31), at(3000, 0, 600), at(-3000, 0, 600), at(0, 3000, 600),
                           at(0, -3000, 600), at(0, 0, -1e6)}) {
    const auto rendering = render(box({60, 60, 60}), pose, small_camera);
    EXPECT_EQ(std::count(rendering.depth.z_mm.begin(), rendering.depth.z_mm.end(), 0.0f), 160 * 120);
    EXPECT_EQ(std::count(rendering.triangle.begin(), rendering.triangle.end(), -1), 160 * 120);
  }
}

TEST(Rasterizer, WhatLiesVeryFarBesideTheImageDoesNoHarm) {
  // A telescope: the triangles lie up to 10^12 px beside the image, more than an int holds.
  const auto camera = Intrinsics::from_field_of_view(64, 48, 1e-4, 1e-4);
  for (const auto& offset : {Eigen::Vector3d(1e4, 0, 2), Eigen::Vector3d(0, 1e4, 2)}) {
    const auto draw = [&] {
      const auto rendering = render(plane_patch(3000, 3000), at(offset.x(), offset.y(), offset.z()), camera);
      std::exit(std::count(rendering.triangle.begin(), rendering.triangle.end(), -1) == 64 * 48 ? 0 : 1);
    };
    EXPECT_EXIT(draw(), ::testing::ExitedWithCode(0), "") << offset.transpose();
  }
}

TEST(Rasterizer, AnEmptyMeshGivesAnEmptyImage) {
  const auto rendering = render(TriangleMesh{}, at(0, 0, 500), small_camera);
  EXPECT_EQ(rendering.depth.width, 160);
  EXPECT_EQ(rendering.depth.height, 120);
  EXPECT_EQ(rendering.depth.z_mm, std::vector<float>(160 * 120, 0.0f));
  EXPECT_EQ(rendering.triangle, std::vector<int>(160 * 120, -1));
}

TEST(Rasterizer, DegenerateTrianglesLeaveTheImageAsItIs) {
  const auto mesh = l_bracket();
  auto spoiled = mesh;
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    const int a = static_cast<int>(random.below(12)), b = static_cast<int>(random.below(12));
    add_triangle(spoiled, a, a, b);
    add_triangle(spoiled, a, b, b);
    add_triangle(spoiled, a, a, a);
  }
  const auto pose = random_pose(random, {0, 0, 500});
  const auto clean = render(mesh, pose, small_camera), dirty = render(spoiled, pose, small_camera);
  EXPECT_TRUE(same_bits(clean.depth.z_mm, dirty.depth.z_mm));
  EXPECT_EQ(clean.triangle, dirty.triangle);
}

TEST(Rasterizer, FacesSeenEdgeOnStayBetweenTheirCorners) {
  // A face whose plane holds the camera and the centres of a column of pixels: its depth there is anybody's guess, but
  // not beyond the box.
  const auto block = box({0, -30, 580}, {40, 30, 640});
  const Intrinsics camera = {101, 81, 500, 480, 50, 40};
  int on_column = 0;
  for (int u = 40; u <= 60; ++u) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.rotate(Eigen::AngleAxisd(std::atan((u - 50) / 500.0), Eigen::Vector3d::UnitY()));
    double nearest = 1e9, farthest = 0;
    for (const auto& v : block.vertices) {
      nearest = std::min(nearest, (pose * v.cast<double>()).z());
      farthest = std::max(farthest, (pose * v.cast<double>()).z());
    }
    const auto depth = render(block, pose, camera).depth;
    for (const float z : depth.z_mm) EXPECT_TRUE(z == 0 || (z > nearest - 1e-3 && z < farthest + 1e-3)) << z;
    for (int v = 20; v <= 60; ++v) on_column += depth.at(u, v) > 0;
  }
  EXPECT_GT(on_column, 100);
}

TEST(Rasterizer, BothSidesAreDrawn) {
  for (const double turn_deg : {0.0, 180.0}) {
    Eigen::Isometry3d pose = at(0, 0, 500);
    pose.rotate(Eigen::AngleAxisd(radians(turn_deg), Eigen::Vector3d::UnitX()));
    EXPECT_NEAR(render(plane_patch(1000, 1000), pose, small_camera).depth.at(80, 60), 500, 1e-3);
  }
}

TEST(Rasterizer, OfAClosedSurfaceTheFrontIsAllThatIsSeen) {
  Random random(11);
  for (int i = 0; i < 20; ++i) {
    const auto pose = random_pose(random, {0, 0, 500});
    for (const auto& mesh : {l_bracket(), sphere(30, 24, 12)}) {
      const DepthImage both = render_depth(mesh, pose, small_camera);
      const DepthImage front = render_depth(mesh, pose, small_camera, Faces::front);
      EXPECT_TRUE(same_bits(both.z_mm, render(mesh, pose, small_camera).depth.z_mm));
      int differing = 0;  // on the outline, where rounding decides
      for (std::size_t p = 0; p < both.z_mm.size(); ++p) differing += both.z_mm[p] != front.z_mm[p];
      EXPECT_LE(differing, 2);
    }
  }
  auto turned = plane_patch(1000, 1000);
  for (auto& [a, b, c] : turned.triangles) std::swap(b, c);
  const double seen = render_depth(plane_patch(1000, 1000), at(0, 0, 500), small_camera, Faces::front).at(80, 60) +
                      render_depth(turned, at(0, 0, 500), small_camera, Faces::front).at(80, 60);
  EXPECT_NEAR(seen, 500, 1e-3) << "of one side only";
}

TEST(Rasterizer, TheNearestOfSeveralSurfacesWinsInAnyOrder) {
  const auto near = moved(plane_patch(20, 20), at(0, 0, -30)), far = plane_patch(60, 60);
  const Intrinsics camera = {101, 101, 500, 500, 50, 50};
  for (const auto& mesh : {joined(near, far), joined(far, near)}) {
    const auto depth = render(mesh, at(0, 0, 500), camera).depth;
    EXPECT_NEAR(depth.at(50, 50), 470, 1e-3);
    EXPECT_NEAR(depth.at(25, 50), 500, 1e-3);
    EXPECT_EQ(depth.at(5, 50), 0);
  }
}

TEST(Rasterizer, IsFastEnoughForADataset) {
  const auto mesh = sphere(60, 100, 51);
  ASSERT_EQ(mesh.triangles.size(), 10000);
  const auto camera = Intrinsics::from_field_of_view(640, 480, 50, 40);
  Random random(10);
  const Stopwatch watch;
  for (int view = 0; view < 42; ++view) render(mesh, random_pose(random, {0, 0, 650}), camera);
  const double elapsed_ms = watch.elapsed_ms();
  std::cout << "42 views of 10,000 triangles at 640 x 480: " << elapsed_ms << " ms\n";
#ifdef NDEBUG
  EXPECT_LT(elapsed_ms, 1000);
#endif
}

}  // namespace
}  // namespace partpose
