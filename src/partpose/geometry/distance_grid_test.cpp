// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/distance_grid.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

double true_distance(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& query) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& p : points) nearest = std::min(nearest, (p - query).cast<double>().norm());
  return nearest;
}

/// Both points lie somewhere in their cells, so that the distance is right to a cell's diagonal, on average to half a
/// cell.
void expect_like_brute_force(const std::vector<Eigen::Vector3f>& points, float margin_mm, int cells, Random& random) {
  const DistanceGrid grid(points, margin_mm, cells);
  const double cell = grid.cell_mm();
  Eigen::AlignedBox3f box;
  for (const auto& p : points) box.extend(p);
  double sum = 0;
  constexpr int queries = 2000;
  for (int i = 0; i < queries; ++i) {
    Eigen::Vector3f query;
    for (int axis = 0; axis < 3; ++axis)
      query[axis] = static_cast<float>(between(random, box.min()[axis] - margin_mm, box.max()[axis] + margin_mm));
    const double error = std::abs(grid.at(query) - true_distance(points, query));
    EXPECT_LE(error, std::sqrt(3.0) * cell + 1e-3);
    sum += error;
  }
  EXPECT_LE(sum / queries, 0.6 * cell);
  for (const auto& p : points) EXPECT_LE(grid.at(p), 1e-6) << "a point is at itself";
}

TEST(DistanceGrid, LikeBruteForceToACell) {
  Random random(1);
  expect_like_brute_force(surface_points(l_bracket(), 1500, random).points, 20, 48, random);
  expect_like_brute_force(random_cube(random, 30, 50, {-100, 200, 650}).points, 10, 64, random);
  expect_like_brute_force(random_cube(random, 500, 5, {0, 0, 650}).points, 60, 20, random);
}

TEST(DistanceGrid, FlatAndTinyClouds) {
  Random random(2);
  auto flat = random_cube(random, 300, 40, {10, 20, 600}).points;
  for (auto& p : flat) p.z() = 600;
  expect_like_brute_force(flat, 15, 48, random);
  std::vector<Eigen::Vector3f> line;
  for (int i = 0; i < 50; ++i) line.emplace_back(2.0f * static_cast<float>(i), 5.0f, 600.0f);
  expect_like_brute_force(line, 10, 48, random);
  expect_like_brute_force({{1, 2, 3}}, 10, 48, random);
}

TEST(DistanceGrid, WithoutAMarginEveryPointIsStillInside) {
  Random random(3);
  const auto points = random_cube(random, 400, 33, {7, -9, 650}).points;
  const DistanceGrid grid(points, 0);
  for (const auto& p : points) EXPECT_LE(grid.at(p), 1e-4);
  const std::vector<Eigen::Vector3f> one = {{1, 2, 3}};
  EXPECT_LE(DistanceGrid(one, 0).at(one[0]), 1e-4);
}

TEST(DistanceGrid, OutsideTheWayToTheGridIsAdded) {
  Random random(4);
  const auto points = surface_points(l_bracket(), 500, random).points;
  const DistanceGrid grid(points, 10);
  const double diagonal = std::sqrt(3.0) * grid.cell_mm();
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3f query =
        (Eigen::Vector3d(40, 25, 15) + between(random, 100, 1000) * random_direction(random)).cast<float>();
    const double truth = true_distance(points, query);
    EXPECT_GE(grid.at(query), truth - diagonal);
    EXPECT_LE(grid.at(query), truth * std::sqrt(3.0) + diagonal + 20);
  }
}

TEST(DistanceGrid, NeedsAPoint) {
  EXPECT_PRED2(mentions, error_of([] { DistanceGrid(std::vector<Eigen::Vector3f>{}, 10); }), "at least one point");
}

}  // namespace
}  // namespace partpose
