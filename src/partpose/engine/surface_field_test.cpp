// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/surface_field.hpp"

#include "partpose/core/error.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace partpose {
namespace {

bool is_inside(const Eigen::Vector3d& p, const TriangleMesh& mesh) {
  // The solid angle that a closed surface fills around a place inside is 4 pi (van Oosterom and Strackee 1983).
  double angle = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d u = mesh.vertices[a].cast<double>() - p, v = mesh.vertices[b].cast<double>() - p;
    const Eigen::Vector3d w = mesh.vertices[c].cast<double>() - p;
    angle += 2 * std::atan2(u.dot(v.cross(w)), u.norm() * v.norm() * w.norm() + u.dot(v) * w.norm() +
                                                   u.dot(w) * v.norm() + v.dot(w) * u.norm());
  }
  return std::abs(angle) > 1;
}

TEST(SurfaceField, GivesTheSignedDistanceToTheMesh) {
  const TriangleMesh mesh = shapes::l_bracket();
  const SurfaceField field(mesh);
  Random random(1);
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3d p;
    for (int k = 0; k < 3; ++k) p[k] = shapes::between(random, box.min()[k] - 6, box.max()[k] + 6);
    const double distance = shapes::distance_to_mesh(p, mesh);
    const double truth = is_inside(p, mesh) ? -distance : distance;
    worst = std::max(worst, std::abs(field.at(p.cast<float>()).distance_mm - truth));
  }
  EXPECT_LT(worst, 0.6 * field.cell_mm());  // beside edges and in the middle of walls
}

TEST(SurfaceField, IsExactBesideAFlatFace) {
  const SurfaceField field(shapes::box(Eigen::Vector3f(60, 40, 20)));
  for (const float z : {10.5f, 12.f, 9.f, 10.f}) {
    const auto sample = field.at({3.3f, -7.1f, z});
    EXPECT_NEAR(sample.distance_mm, z - 10, 5e-3);
    EXPECT_TRUE(sample.gradient.isApprox(Eigen::Vector3f::UnitZ(), 1e-2f));
  }
}

TEST(SurfaceField, BeyondTheGridTheDistanceGoesOn) {
  const SurfaceField field(shapes::box(Eigen::Vector3f(60, 40, 20)));
  EXPECT_NEAR(field.at({0, 0, 110}).distance_mm, 100, 0.1);
}

TEST(SurfaceField, DrawsPointsToAWallThatIsThinnerThanACell) {
  const SurfaceField field(shapes::box(Eigen::Vector3f(100, 60, 1)), 5000);
  ASSERT_GT(field.cell_mm(), 2);
  for (float x = -40; x <= 40; x += 3.7f) {
    EXPECT_LT(std::abs(field.at({x, 5, 0.5f}).distance_mm), 0.5f * field.cell_mm());
    EXPECT_GT(field.at({x, 5, 4.5f}).gradient.z(), 0.9f);
    EXPECT_LT(field.at({x, 5, -4.5f}).gradient.z(), -0.9f);
  }
}

TEST(SurfaceField, NeedsASurface) { EXPECT_THROW(SurfaceField(TriangleMesh{}), Error); }

}  // namespace
}  // namespace partpose
