// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/calibration.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/random.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(Reliability, ByHand) {
  // Bin 9: 0.95 and 1.0, one of two right: |0.5 - 0.975|. Bin 2: 0.25, right: |1 - 0.25|. Bin 0: -1 counts as 0, wrong.
  const auto r = reliability({{0.95, true}, {1.0, false}, {0.25, true}, {-1.0, false}});
  ASSERT_EQ(r.bins.size(), 10u);
  EXPECT_EQ(r.count, 4);
  EXPECT_EQ(r.bins[9].count, 2);
  EXPECT_EQ(r.bins[9].right, 1);
  EXPECT_DOUBLE_EQ(r.bins[9].mean_confidence, 0.975);
  EXPECT_EQ(r.bins[2].count, 1);
  EXPECT_EQ(r.bins[0].count, 1);
  EXPECT_DOUBLE_EQ(r.expected_error, (2 * 0.475 + 0.75 + 0) / 4);
}

TEST(Reliability, OfTrueProbabilitiesIsSmall) {
  Random random(3);
  std::vector<std::pair<double, bool>> honest, boastful;
  for (int i = 0; i < 20000; ++i) {
    const double p = random.uniform();
    const bool right = random.uniform() < p;
    honest.emplace_back(p, right);
    boastful.emplace_back(0.5 + 0.5 * p, right);  // off by 0.25 on average
  }
  EXPECT_LT(reliability(honest).expected_error, 0.015);
  EXPECT_NEAR(reliability(boastful).expected_error, 0.25, 0.015);
}

TEST(Reliability, NothingAndNonsense) {
  EXPECT_EQ(reliability({}).count, 0);
  EXPECT_EQ(reliability({}).expected_error, 0);
  EXPECT_THROW(reliability({}, 0), Error);
}

}  // namespace
}  // namespace partpose
