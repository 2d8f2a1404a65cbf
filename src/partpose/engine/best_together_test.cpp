// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/best_together.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <random>

namespace partpose {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

std::vector<int> sorted(std::vector<int> items) {
  std::sort(items.begin(), items.end());
  return items;
}

TEST(BestTogether, TwoThatFitTakeThePlaceOfTheBestThatExcludesBoth) {
  const Eigen::Vector3d worth(5, 4, 3);
  Eigen::Matrix3d shared = Eigen::Matrix3d::Zero();
  shared(0, 1) = shared(1, 0) = shared(0, 2) = shared(2, 0) = never;
  EXPECT_EQ(sorted(best_together(worth, shared)), (std::vector<int>{1, 2}));
}

TEST(BestTogether, WhatIsSharedCountsOnce) {
  const Eigen::Vector2d worth(5, 4);
  Eigen::Matrix2d shared = Eigen::Matrix2d::Zero();
  shared(0, 1) = shared(1, 0) = 4.5;
  EXPECT_EQ(best_together(worth, shared), (std::vector<int>{0}));
  shared(0, 1) = shared(1, 0) = 3.5;
  EXPECT_EQ(sorted(best_together(worth, shared)), (std::vector<int>{0, 1}));
}

TEST(BestTogether, NothingOfNothing) {
  EXPECT_TRUE(best_together(Eigen::VectorXd(), Eigen::MatrixXd()).empty());
  EXPECT_TRUE(best_together(Eigen::Vector2d(0, -1), Eigen::Matrix2d::Zero()).empty());
}

TEST(BestTogether, IsNearlyAlwaysTheBestOfAllSets) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  int best_found = 0;
  constexpr int trials = 200, count = 10;
  for (int trial = 0; trial < trials; ++trial) {
    Eigen::VectorXd worth(count);
    Eigen::MatrixXd shared = Eigen::MatrixXd::Zero(count, count);
    for (int i = 0; i < count; ++i) {
      worth[i] = 1 + share(random);
      for (int j = 0; j < i; ++j)
        shared(i, j) = shared(j, i) = share(random) < 0.4 ? never : share(random) < 0.5 ? share(random) : 0;
    }
    const auto worth_of = [&](unsigned set) {
      double sum = 0;
      for (int i = 0; i < count; ++i) {
        if (!(set >> i & 1)) continue;
        sum += worth[i];
        for (int j = 0; j < i; ++j)
          if (set >> j & 1) sum -= shared(i, j);
      }
      return sum;
    };
    double best = 0;
    for (unsigned set = 0; set < 1u << count; ++set) best = std::max(best, worth_of(set));
    unsigned found = 0;
    for (const int i : best_together(worth, shared)) found |= 1u << i;
    EXPECT_GT(worth_of(found), 0.8 * best);
    best_found += worth_of(found) > best - 1e-9;
  }
  EXPECT_GT(best_found, 0.85 * trials);
}

}  // namespace
}  // namespace partpose
