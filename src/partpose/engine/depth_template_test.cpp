// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/depth_template.hpp"

#include "partpose/core/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

namespace partpose {
namespace {

/// Points 1 mm apart of a plate of 60 x 20 mm about the origin whose depth grows by 0.5 mm a mm in x.
std::vector<Eigen::Vector3f> slanted_plate() {
  std::vector<Eigen::Vector3f> points;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 60; ++x) points.emplace_back(x - 29.5f, y - 9.5f, 0.5f * (static_cast<float>(x) - 29.5f));
  return points;
}

TEST(DepthTemplate, HoldsTheDepthsOfItsCells) {
  const TemplateScale scale = template_scale(64);
  ASSERT_NEAR(scale.cell_mm, 64.0 / 12, 1e-9);
  const DepthTemplate t = make_template(slanted_plate(), 0, 1, scale);
  int covered = 0;
  for (int v = 0; v < DepthTemplate::side; ++v)
    for (int u = 0; u < DepthTemplate::side; ++u) {
      const double x = (u - 7.5) * scale.cell_mm, y = (v - 7.5) * scale.cell_mm;
      const int value = t.cell[v * DepthTemplate::side + u];
      if (std::abs(x) > 35 || std::abs(y) > 15) {
        EXPECT_EQ(value, DepthTemplate::background);
      }
      if (std::abs(x) < 25 && std::abs(y) < 7) {
        EXPECT_NEAR((value - DepthTemplate::middle) * scale.depth_unit_mm, 0.5 * x, 0.8);
        ++covered;
      }
    }
  EXPECT_GT(covered, 10);
}

TEST(DepthTemplate, AQuarterTurnMovesTheCells) {
  const TemplateScale scale = template_scale(64);
  const DepthTemplate straight = make_template(slanted_plate(), 0, 1, scale);
  const DepthTemplate turned = make_template(slanted_plate(), std::numbers::pi / 2, 1, scale);
  int equal = 0;
  for (int v = 0; v < 16; ++v)
    for (int u = 0; u < 16; ++u)  // (x, y) goes to (-y, x)
      equal += std::abs(int{straight.cell[v * 16 + u]} - int{turned.cell[u * 16 + (15 - v)]}) <= 1;
  EXPECT_GE(equal, 250);
  EXPECT_EQ(quarter_turned(straight).cell, turned.cell);
  EXPECT_GT(capped_difference(straight, turned, scale.cap), 30 * scale.cap);
}

TEST(DepthTemplate, CappedDifferenceIsThePlainSum) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    DepthTemplate a, b;
    for (int i = 0; i < DepthTemplate::cells; ++i) {
      a.cell[i] = static_cast<std::uint8_t>(random.below(256));
      b.cell[i] = static_cast<std::uint8_t>(random.below(DepthTemplate::unknown));
      a.cell[i] = std::min<std::uint8_t>(a.cell[i], DepthTemplate::unknown - 1);
    }
    const int cap = 1 + static_cast<int>(random.below(255));
    int sum = 0;
    for (int i = 0; i < DepthTemplate::cells; ++i) sum += std::min(std::abs(int{a.cell[i]} - int{b.cell[i]}), cap);
    EXPECT_EQ(capped_difference(a, b, cap), sum);
    EXPECT_EQ(capped_difference(a, a, cap), 0);
  }
}

TEST(DepthTemplate, ScalesGoByHalfOctaves) {
  EXPECT_EQ(template_scale(100).cell_mm, template_scale(104).cell_mm);
  EXPECT_NEAR(template_scale(200).cell_mm, 2 * template_scale(100).cell_mm, 1e-9);
}

}  // namespace
}  // namespace partpose
