// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/surface_field.hpp"

#include "partpose/core/error.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(SurfaceField, GivesTheDistanceToTheMesh) {
  const TriangleMesh mesh = shapes::l_bracket();
  const SurfaceField field(mesh, 32);
  Random random(1);
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3d p;
    for (int k = 0; k < 3; ++k) p[k] = shapes::between(random, box.min()[k] - 6, box.max()[k] + 6);
    const double truth = shapes::distance_to_mesh(p, mesh);
    // Seen from the side that it lies on, whichever that is: the nearer answer of the two.
    const auto from = [&](double x) {
      return field.nearest(p.cast<float>(), Eigen::Vector3f::Constant(static_cast<float>(x))).distance_mm;
    };
    EXPECT_GE(from(1), truth - 1e-3);
    worst = std::max(worst, std::min(from(1), from(-1)) - truth);
  }
  EXPECT_LT(worst, 2.5);  // a cell of the grid is 2.5 mm wide
}

TEST(SurfaceField, IsExactOnAPlane) {
  const SurfaceField field(shapes::box(Eigen::Vector3f(60, 40, 20)), 24);
  for (const float z : {10.5f, 12.f, 9.f, 10.f}) {
    const auto nearest = field.nearest({3.3f, -7.1f, z}, {0, 0, 1});
    EXPECT_NEAR(nearest.distance_mm, std::abs(z - 10), 1e-4);
    EXPECT_NEAR(std::abs(nearest.direction.z()), 1, 1e-4);
  }
}

TEST(SurfaceField, TellsTheTwoSidesOfAThinWall) {
  // A plate of 1 mm in a grid of about 4 mm.
  const SurfaceField field(shapes::box(Eigen::Vector3f(100, 60, 1)), 24);
  for (float x = -40; x <= 40; x += 3.7f) {
    EXPECT_NEAR(field.nearest({x, 5, 0.5f}, {0, 0, 1}).distance_mm, 0, 1e-4);
    EXPECT_NEAR(field.nearest({x, 5, 0.5f}, {0, 0, -1}).distance_mm, 1, 1e-4);
    EXPECT_NEAR(field.nearest({x, 5, -0.5f}, {0, 0, -1}).distance_mm, 0, 1e-4);
    EXPECT_NEAR(field.nearest({x, 5, -0.5f}, {0, 0, 1}).distance_mm, 1, 1e-4);
  }
}

TEST(SurfaceField, NeedsASurface) { EXPECT_THROW(SurfaceField(TriangleMesh{}), Error); }

}  // namespace
}  // namespace partpose
