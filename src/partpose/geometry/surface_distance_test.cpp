// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/surface_distance.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(SurfaceDistance, IsThatOfEveryTriangleTried) {
  Random random(1);
  TriangleMesh mesh = shapes::joined(shapes::l_bracket(), shapes::sphere(25, 24, 12));
  mesh.triangles.push_back({0, 0, 1});  // degenerate ones do no harm
  mesh.triangles.push_back({2, 2, 2});
  const SurfaceDistance surface(mesh);
  for (const auto& p : shapes::random_cube(random, 400, 120).points) {
    const Eigen::Vector3d query = p.cast<double>();
    const auto nearest = surface.nearest(query);
    EXPECT_NEAR(nearest.distance_mm, shapes::distance_to_mesh(query, mesh), 1e-4);
    EXPECT_NEAR((nearest.point_mm - query).norm(), nearest.distance_mm, 1e-9);
    EXPECT_GE(nearest.triangle, 0);
  }
}

TEST(SurfaceDistance, LimitAndEnough) {
  const SurfaceDistance surface(shapes::box({20, 20, 20}));
  EXPECT_EQ(surface.nearest({0, 0, 15}, 4).triangle, -1);
  EXPECT_NEAR(surface.nearest({0, 0, 15}, 6).distance_mm, 5, 1e-6);
  const auto any = surface.nearest({0, 0, 15}, 100, 20);
  EXPECT_GE(any.triangle, 0);
  EXPECT_LE(any.distance_mm, 20);
}

TEST(EvenSurfaceSamples, FollowTheAreaNotTheTriangles) {
  // One face of a box in a thousand triangles, the others in two each.
  const TriangleMesh box =
      shapes::joined(shapes::box({10, 10, 10}),
                     shapes::moved(shapes::plane_patch(10, 10, 22), Eigen::Isometry3d(Eigen::Translation3d(0, 0, 20))));
  const auto samples = even_surface_samples(box, 7000);
  ASSERT_EQ(samples.size(), 7000u);
  const auto above = std::count_if(samples.begin(), samples.end(), [](const auto& p) { return p.z() > 19; });
  EXPECT_NEAR(static_cast<double>(above), 1000, 10);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : samples) {
    mean += p / 7000;
    EXPECT_LT(shapes::distance_to_mesh(p, box), 1e-4);
  }
  EXPECT_LT((mean - Eigen::Vector3d(0, 0, 20.0 / 7)).norm(), 0.1);
  EXPECT_TRUE(even_surface_samples({}, 10).empty());
}

TEST(AlignToSurface, FindsTheWayBack) {
  Random random(2);
  const TriangleMesh mesh = shapes::l_bracket();
  const SurfaceDistance surface(mesh);
  const auto samples = even_surface_samples(mesh, 300);
  const Eigen::Vector3d centre(25, 15, 15);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Isometry3d start = shapes::random_motion(random, 8, 3, centre);
    const Eigen::Isometry3d back = align_to_surface(samples, surface, start, 0.5, centre);
    for (const auto& p : samples) EXPECT_LT((back * p - p).norm(), 0.01);
  }
}

TEST(AlignToSurface, ADetailDoesNotPull) {
  Random random(3);
  const TriangleMesh plain = shapes::box({60, 40, 20});
  const SurfaceDistance surface(plain);
  auto samples = even_surface_samples(plain, 300);
  for (int i = 0; i < 15; ++i) samples.emplace_back(25, 15, 30 + 0.1 * i);  // a pin that the surface has not
  const Eigen::Isometry3d back =
      align_to_surface(samples, surface, shapes::random_motion(random, 5, 2), 0.5, Eigen::Vector3d::Zero());
  EXPECT_LT((back.matrix() - Eigen::Matrix4d::Identity()).norm(), 0.05);
}

TEST(AlignToSurface, LeavesWhatIsFree) {
  const TriangleMesh ball = shapes::sphere(20, 60, 30);
  const SurfaceDistance surface(ball);
  Eigen::Isometry3d start(Eigen::Translation3d(1, -2, 1));
  start.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Isometry3d back =
      align_to_surface(even_surface_samples(ball, 300), surface, start, 0.5, Eigen::Vector3d::Zero());
  EXPECT_LT(back.translation().norm(), 0.05);
  EXPECT_LT(rotation_error_deg(back, start), 3);
}

}  // namespace
}  // namespace partpose
