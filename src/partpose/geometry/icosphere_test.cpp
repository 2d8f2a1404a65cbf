// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/icosphere.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

double smallest_angle_deg(const std::vector<Eigen::Vector3d>& directions) {
  double largest_cosine = -1;
  for (std::size_t i = 0; i < directions.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) largest_cosine = std::max(largest_cosine, directions[i].dot(directions[k]));
  return degrees(std::acos(largest_cosine));
}

TEST(Icosphere, HasTheCountsOfTheReference) {
  const std::array<int, 5> vertices = {12, 42, 162, 642, 2562}, faces = {20, 80, 320, 1280, 5120};
  for (int level = 0; level <= 4; ++level) {
    EXPECT_EQ(icosphere_directions(level, true).size(), vertices[level]);
    EXPECT_EQ(icosphere_directions(level, false).size(), faces[level]);
  }
}

TEST(Icosphere, DirectionsAreUnitAndApart) {
  // The icosahedron's edges span 63.43 degrees, its faces 41.81; each subdivision about halves an angle.
  EXPECT_NEAR(smallest_angle_deg(icosphere_directions(0, true)), degrees(std::atan(2.0)), 1e-9);
  EXPECT_NEAR(smallest_angle_deg(icosphere_directions(0, false)), 180 - degrees(std::acos(-std::sqrt(5.0) / 3)), 1e-9);
  for (const bool use_vertices : {true, false}) {
    for (int level = 0; level <= 3; ++level) {
      const auto directions = icosphere_directions(level, use_vertices);
      for (const auto& d : directions) EXPECT_NEAR(d.norm(), 1, 1e-14);
      EXPECT_GT(smallest_angle_deg(directions), (use_vertices ? 54.0 : 30.0) / (1 << level));
    }
  }
}

TEST(Icosphere, LooksTheSameFromTheOtherSide) {
  for (const bool use_vertices : {true, false}) {
    for (int level = 0; level <= 2; ++level) {
      const auto directions = icosphere_directions(level, use_vertices);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const auto& d : directions) {
        sum += d;
        double nearest = 2;
        for (const auto& other : directions) nearest = std::min(nearest, (d + other).norm());
        EXPECT_LT(nearest, 1e-12) << "no direction opposite to " << d.transpose();
      }
      EXPECT_LT(sum.norm(), 1e-10);
    }
  }
}

TEST(Icosphere, FinerOnesKeepTheCoarserVertices) {
  const auto coarse = icosphere_directions(1, true), fine = icosphere_directions(2, true);
  for (std::size_t i = 0; i < coarse.size(); ++i) EXPECT_EQ(coarse[i], fine[i]);
}

TEST(Icosphere, RefusesOtherLevels) {
  for (const int bad : {-1, 5, 100})
    EXPECT_PRED2(mentions, error_of([&] { icosphere_directions(bad, true); }),
                 std::to_string(bad) + ": must be 0 to 4");
}

}  // namespace
}  // namespace partpose
