// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

namespace partpose {
namespace {

TEST(Random, IsSplitMix64) {
  // The numbers of the public-domain reference implementation (Vigna 2015) for this seed.
  Random random(1234567);
  for (const std::uint64_t expected : {6457827717110365317ull, 3203168211198807973ull, 9817491932198370423ull,
                                       4593380528125082431ull, 16408922859458223821ull})
    EXPECT_EQ(random.next(), expected);
}

TEST(Random, SameSeedSameNumbers) {
  Random a(42), b(42), c(43);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const auto drawn = a.next();
    EXPECT_EQ(drawn, b.next());
    differs = differs || drawn != c.next();
  }
  EXPECT_TRUE(differs);
}

TEST(Random, UniformFillsTheUnitIntervalEvenly) {
  Random random(1);
  constexpr int count = 100000, parts = 20;
  std::array<int, parts> hits{};
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform();
    ASSERT_GE(x, 0);
    ASSERT_LT(x, 1);
    ++hits[static_cast<int>(x * parts)];
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / count, 0.5, 4 * std::sqrt(1.0 / 12 / count));
  EXPECT_NEAR(squares / count, 1.0 / 3, 0.004);
  for (const int h : hits) EXPECT_NEAR(h, count / parts, 4.5 * std::sqrt(count / parts));
}

TEST(Random, BelowStaysBelowAndReachesAll) {
  Random random(2);
  std::array<int, 7> hits{};
  for (int i = 0; i < 70000; ++i) ++hits.at(random.below(7));
  for (const int h : hits) EXPECT_NEAR(h, 10000, 4.5 * 100);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(random.below(1), 0);
}

TEST(Random, NormalPairsAreStandardNormal) {
  Random random(3);
  constexpr int count = 200000;
  double sum = 0, squares = 0, fourth = 0, product = 0, beyond_two = 0;
  for (int i = 0; i < count / 2; ++i) {
    const auto [a, b] = random.normal_pair();
    product += a * b;
    for (const double x : {a, b}) {
      ASSERT_TRUE(std::isfinite(x));
      sum += x;
      squares += x * x;
      fourth += x * x * x * x;
      beyond_two += std::abs(x) > 2;
    }
  }
  EXPECT_NEAR(sum / count, 0, 4 / std::sqrt(count));
  EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2.0 / count));
  EXPECT_NEAR(fourth / count, 3, 4 * std::sqrt(96.0 / count));
  EXPECT_NEAR(product / (count / 2), 0, 4 / std::sqrt(count / 2));
  EXPECT_NEAR(beyond_two / count, 0.0455, 0.002);
}

TEST(Random, EachItemHasItsOwnNumbersInAnyOrder) {
  constexpr int items = 1000;
  std::vector<std::uint64_t> forwards, backwards(items);
  for (int i = 0; i < items; ++i) forwards.push_back(Random(7, i).next());
  for (int i = items - 1; i >= 0; --i) {
    Random random(7, i);
    backwards[i] = random.next();
    for (int k = 0; k < i % 5; ++k) random.next();  // how much one item draws is nothing to the others
  }
  EXPECT_EQ(forwards, backwards);
  std::set<std::uint64_t> distinct(forwards.begin(), forwards.end());
  for (int i = 0; i < items; ++i) distinct.insert(Random(8, i).next());
  EXPECT_EQ(distinct.size(), 2 * items);
}

TEST(Random, ItemsAreIndependent) {
  // The first draws of successive items (pixels) and of the same item of successive seeds (frames) must look random.
  constexpr int items = 50000;
  double sum = 0, squares = 0, with_next_item = 0, with_next_seed = 0, previous = 0;
  for (int i = 0; i < items; ++i) {
    const double x = Random(9, i).normal_pair().first;
    sum += x;
    squares += x * x;
    with_next_item += x * previous;
    with_next_seed += x * Random(10, i).normal_pair().first;
    previous = x;
  }
  EXPECT_NEAR(sum / items, 0, 4 / std::sqrt(items));
  EXPECT_NEAR(squares / items, 1, 4 * std::sqrt(2.0 / items));
  EXPECT_NEAR(with_next_item / items, 0, 4 / std::sqrt(items));
  EXPECT_NEAR(with_next_seed / items, 0, 4 / std::sqrt(items));
}

}  // namespace
}  // namespace partpose
