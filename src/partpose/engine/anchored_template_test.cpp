// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/anchored_template.hpp"

#include "partpose/core/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

namespace partpose {
namespace {

constexpr int cap = 24;

SmallTemplate filled(std::uint8_t value) {
  SmallTemplate t;
  t.cell.fill(value);
  return t;
}

TEST(ExplainedSteps, NearerMayHideAndFartherForbids) {
  const SmallTemplate model = filled(100);
  EXPECT_EQ(explained_steps(model, filled(100), cap), cap * SmallTemplate::cells);
  EXPECT_EQ(explained_steps(model, filled(100 - cap), cap), 0);
  EXPECT_EQ(explained_steps(model, filled(1), cap), 0);
  EXPECT_EQ(explained_steps(model, filled(100 + cap), cap), -cap * SmallTemplate::cells);
  EXPECT_EQ(explained_steps(model, filled(SmallTemplate::background), cap), -cap * SmallTemplate::cells);
  EXPECT_EQ(explained_steps(model, filled(SmallTemplate::unknown), cap), 0);
  EXPECT_EQ(explained_steps(filled(SmallTemplate::background), filled(100), cap), 0);
}

TEST(ExplainedSteps, IsTheSumOverTheCells) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    SmallTemplate model, scene;
    int expected = 0;
    for (int i = 0; i < SmallTemplate::cells; ++i) {
      const int x = model.cell[i] = random.below(5) == 0 ? SmallTemplate::background : 1 + random.below(215);
      const int y = scene.cell[i] = random.below(5) == 0 ? 254 + random.below(2) : 1 + random.below(215);
      if (x == SmallTemplate::background || y == SmallTemplate::unknown) continue;
      expected += y > x ? cap - 2 * std::min(y - x, cap) : cap - std::min(x - y, cap);
    }
    EXPECT_EQ(explained_steps(model, scene, cap), expected);
    const CellSet surface = cells_with_surface(model), seen = cells_with_surface(scene);
    const auto unknown = std::count(scene.cell.begin(), scene.cell.end(), SmallTemplate::unknown);
    EXPECT_LE(expected, cap * most_explained_cells(std::popcount(surface), std::popcount(surface & seen),
                                                   static_cast<int>(unknown)));
  }
}

TEST(MostExplainedCells, AreThoseOfTheModelThatFitsBest) {
  SmallTemplate scene = filled(SmallTemplate::background);
  std::fill_n(scene.cell.begin(), 10, 100);
  std::fill_n(scene.cell.begin() + 10, 5, SmallTemplate::unknown);
  for (const int surface : {0, 4, 10, 13, 15, 20, 64}) {
    SmallTemplate model = filled(SmallTemplate::background);
    std::fill_n(model.cell.begin(), surface, 100);
    EXPECT_EQ(cap * most_explained_cells(surface, std::min(surface, 10), 5), explained_steps(model, scene, cap));
  }
}

TEST(SpreadPlaces, LieAllOverThePointsAndNotAtTheirEdge) {
  std::vector<Eigen::Vector3f> points;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 80; ++x) points.emplace_back(static_cast<float>(x), static_cast<float>(y), 500.0f);
  const std::vector<int> places = spread_places(points, 8);
  ASSERT_GE(places.size(), 6u);
  for (const int place : places) {
    EXPECT_GT(points[place].x(), 2);
    EXPECT_LT(points[place].x(), 77);
  }
  for (const auto& p : points) {
    const bool near = std::any_of(places.begin(), places.end(), [&](int i) { return (points[i] - p).norm() < 30; });
    EXPECT_TRUE(near) << p.transpose();
  }
  EXPECT_TRUE(spread_places({}, 8).empty());
}

}  // namespace
}  // namespace partpose
