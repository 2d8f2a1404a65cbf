// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/union_find.hpp"

#include "partpose/core/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace partpose {
namespace {

TEST(UnionFind, SetsAreKnownByTheirSmallest) {
  UnionFind sets(4);
  EXPECT_EQ(sets.add(), 4);
  EXPECT_EQ(sets.size(), 5u);
  sets.join(4, 2);
  sets.join(3, 4);
  EXPECT_EQ(sets.find(3), 2);
  EXPECT_EQ(sets.find(1), 1);
  sets.join(1, 3);
  EXPECT_EQ(sets.find(4), 1);
  EXPECT_EQ(sets.find(0), 0);
}

TEST(UnionFind, AgreesWithRelabelling) {
  constexpr int count = 60;
  Random random(3);
  UnionFind sets(count);
  std::vector<int> smallest(count);
  for (int i = 0; i < count; ++i) smallest[i] = i;
  for (int k = 0; k < count; ++k) {
    const int a = static_cast<int>(random.below(count)), b = static_cast<int>(random.below(count));
    sets.join(a, b);
    const int from = std::max(smallest[a], smallest[b]), to = std::min(smallest[a], smallest[b]);
    std::replace(smallest.begin(), smallest.end(), from, to);
    for (int i = 0; i < count; ++i) ASSERT_EQ(sets.find(i), smallest[i]);
  }
}

}  // namespace
}  // namespace partpose
