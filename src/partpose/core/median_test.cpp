// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/median.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(UpperMedian, IsTheMiddleOrTheUpperOfTwo) {
  EXPECT_EQ(upper_median<int>({7}), 7);
  EXPECT_EQ(upper_median<int>({9, 1, 4}), 4);
  EXPECT_EQ(upper_median<double>({3.5, 1, 2, 8}), 3.5);
}

}  // namespace
}  // namespace partpose
