// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/voxel_grid.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <map>

namespace partpose {
namespace {

using namespace shapes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

struct Cell {
  Eigen::Vector3d points = Eigen::Vector3d::Zero(), normals = Eigen::Vector3d::Zero();
  double curvatures = 0;
  int count = 0;
};

/// Sums by cell, in the order z, y, x.
std::map<std::array<int, 3>, Cell> cells_of(const PointCloud& cloud, double voxel_mm) {
  std::map<std::array<int, 3>, Cell> cells;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p = cloud.points[i].cast<double>();
    if (!p.allFinite()) continue;
    const Eigen::Vector3i at = (p / voxel_mm).array().floor().cast<int>();
    auto& cell = cells[{at.z(), at.y(), at.x()}];
    cell.points += p;
    if (cloud.has_normals()) cell.normals += cloud.normals[i].cast<double>();
    if (cloud.has_curvatures()) cell.curvatures += cloud.curvatures[i];
    ++cell.count;
  }
  return cells;
}

TEST(VoxelGrid, CentroidsNormalsAndCurvaturesByBruteForce) {
  Random random(1);
  auto cloud = random_cube(random, 3000, 30, {10, -20, 15});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.normals.push_back(random_direction(random).cast<float>());
    cloud.curvatures.push_back(static_cast<float>(random.uniform() / 3));
    if (i % 11 == 0) cloud.points[i][static_cast<int>(i % 3)] = nan;
  }
  for (const float voxel : {1.0f, 3.0f, 7.7f, 1000.0f}) {
    const auto cells = cells_of(cloud, voxel);
    const auto thinned = voxel_grid(cloud, voxel);
    ASSERT_EQ(thinned.size(), cells.size());
    ASSERT_TRUE(thinned.has_normals());
    ASSERT_TRUE(thinned.has_curvatures());
    EXPECT_EQ(thinned.width, cells.size());
    EXPECT_EQ(thinned.height, 1);
    std::size_t i = 0;
    for (const auto& [key, cell] : cells) {
      EXPECT_LT((thinned.points[i].cast<double>() - cell.points / cell.count).norm(), 1e-5);
      EXPECT_LT((thinned.normals[i].cast<double>() - cell.normals.normalized()).norm(), 1e-4);
      EXPECT_NEAR(thinned.curvatures[i], cell.curvatures / cell.count, 1e-6);
      ++i;
    }
  }
}

TEST(VoxelGrid, TheGridGoesThroughTheOrigin) {
  PointCloud cloud;
  cloud.points = {{-0.1f, 0.5f, 0.5f}, {0.1f, 0.5f, 0.5f}, {1.9f, 0.5f, 0.5f}, {2.0f, 0.5f, 0.5f}};
  const auto thinned = voxel_grid(cloud, 2);
  const std::vector<Eigen::Vector3f> expected = {{-0.1f, 0.5f, 0.5f}, {1.0f, 0.5f, 0.5f}, {2.0f, 0.5f, 0.5f}};
  EXPECT_EQ(thinned.points, expected);
}

TEST(VoxelGrid, AddsNothingThatTheCloudDoesNotHave) {
  Random random(2);
  auto cloud = random_cube(random, 100, 5);
  EXPECT_TRUE(voxel_grid(cloud, 1).normals.empty());
  EXPECT_TRUE(voxel_grid(cloud, 1).curvatures.empty());
  EXPECT_TRUE(voxel_grid(PointCloud{}, 1).empty());
  cloud.points.assign(100, Eigen::Vector3f::Constant(nan));
  EXPECT_TRUE(voxel_grid(cloud, 1).empty());
}

TEST(VoxelGrid, OppositeNormalsDoNotBecomeNaN) {
  PointCloud cloud;
  cloud.points = {{0.2f, 0.2f, 0.2f}, {0.4f, 0.4f, 0.4f}};
  cloud.normals = {{0, 0, 1}, {0, 0, -1}};
  EXPECT_TRUE(voxel_grid(cloud, 1).normals.at(0).isZero());
}

TEST(VoxelGrid, OfAVoxelGridIsItself) {
  Random random(3);
  const auto once = voxel_grid(random_cube(random, 2000, 30), 4);
  EXPECT_TRUE(same_bits(voxel_grid(once, 4), once));
}

TEST(VoxelGrid, RefusesImpossibleSizes) {
  const PointCloud cloud;
  for (const float bad : {0.0f, -1.0f, nan})
    EXPECT_PRED2(mentions, error_of([&] { voxel_grid(cloud, bad); }), "voxel size");
}

}  // namespace
}  // namespace partpose
