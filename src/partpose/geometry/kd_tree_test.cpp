// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/kd_tree.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

std::vector<double> sorted_squared_distances(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& query) {
  std::vector<double> squared;
  for (const auto& p : points) squared.push_back((p.cast<double>() - query.cast<double>()).squaredNorm());
  std::sort(squared.begin(), squared.end());
  return squared;
}

void expect_like_brute_force(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& query, int k) {
  const KdTree tree(points);
  const auto truth = sorted_squared_distances(points, query);
  const auto near = [](double a) { return 1e-5 * a + 1e-9; };

  const auto nearest = tree.nearest(query);
  ASSERT_GE(nearest.index, 0);
  EXPECT_NEAR(nearest.squared_distance, truth[0], near(truth[0]));

  const auto found = tree.nearest_k(query, k);
  ASSERT_EQ(found.size(), std::min<std::size_t>(k, points.size()));
  std::vector<int> indices;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].squared_distance, truth[i], near(truth[i]));
    EXPECT_NEAR((points.at(found[i].index) - query).squaredNorm(), truth[i], near(truth[i]));
    indices.push_back(found[i].index);
  }
  std::sort(indices.begin(), indices.end());
  EXPECT_EQ(std::adjacent_find(indices.begin(), indices.end()), indices.end()) << "an index was given twice";
}

TEST(KdTree, FindsWhatBruteForceFinds) {
  Random random(1);
  for (const int count : {1, 2, 11, 12, 13, 25, 500}) {
    const auto points = random_cube(random, count, 50, {100, -200, 650}).points;
    for (int i = 0; i < 20; ++i)
      expect_like_brute_force(points, random_cube(random, 1, 70, {100, -200, 650}).points[0], 1 + i);
  }
}

TEST(KdTree, CopesWithPointsOfAGridAndWithDuplicates) {
  Random random(2);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 600; ++i)
    points.push_back({static_cast<float>(random.below(5)), static_cast<float>(random.below(5)), 7.0f});
  for (int i = 0; i < 20; ++i)
    expect_like_brute_force(points, {static_cast<float>(random.below(5)), static_cast<float>(random.below(5)), 7}, 50);
}

TEST(KdTree, ManyEqualPoints) { expect_like_brute_force(std::vector<Eigen::Vector3f>(100, {1, 2, 3}), {4, 6, 3}, 7); }

TEST(KdTree, FewerThanAskedFor) {
  const std::vector<Eigen::Vector3f> points = {{0, 0, 3}, {0, 0, 1}, {0, 0, 2}};
  const auto found = KdTree(points).nearest_k({0, 0, 0}, 10);
  ASSERT_EQ(found.size(), 3);
  EXPECT_EQ(found[0].index, 1);
  EXPECT_EQ(found[1].index, 2);
  EXPECT_EQ(found[2].index, 0);
  EXPECT_EQ(found[2].squared_distance, 9);
  EXPECT_TRUE(KdTree(points).nearest_k({0, 0, 0}, 0).empty());
  EXPECT_TRUE(KdTree(points).nearest_k({0, 0, 0}, -3).empty());
}

TEST(KdTree, AnEmptyTreeHasNoNearest) {
  const KdTree tree(std::vector<Eigen::Vector3f>{});
  EXPECT_EQ(tree.nearest({1, 2, 3}).index, -1);
  EXPECT_TRUE(tree.nearest_k({1, 2, 3}, 5).empty());
}

TEST(KdTree, OwnsItsPointsAndMayBeMoved) {
  Random random(3);
  auto points = random_cube(random, 100, 10).points;
  const auto before = points;
  KdTree first(points);
  points.assign(100, Eigen::Vector3f(1e6f, 1e6f, 1e6f));
  KdTree second(std::move(first));
  EXPECT_EQ(second.nearest(before[42]).squared_distance, 0);
  KdTree third(std::vector<Eigen::Vector3f>{});
  third = std::move(second);
  EXPECT_EQ(third.nearest(before[42]).index, 42);
}

}  // namespace
}  // namespace partpose
