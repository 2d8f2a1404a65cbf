// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/matching/descriptor_index.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

std::vector<float> random_histogram(Random& random, int bins) {
  std::vector<float> histogram(bins);
  for (float& value : histogram) value = random.below(3) == 0 ? static_cast<float>(between(random, 0, 20)) : 0.0f;
  return histogram;
}

TEST(DescriptorIndex, FindsWhatBruteForceFinds) {
  Random random(1);
  for (const int bins : {1, 7, 90, 308}) {
    DescriptorIndex index(bins);
    std::vector<std::vector<float>> rows;
    for (int r = 0; r < 300; ++r) {
      rows.push_back(random_histogram(random, bins));
      index.add(rows.back());
    }
    EXPECT_EQ(index.size(), 300);
    for (int round = 0; round < 10; ++round) {
      const auto query = random_histogram(random, bins);
      std::vector<double> distance(rows.size(), 0);
      for (std::size_t r = 0; r < rows.size(); ++r)
        for (int b = 0; b < bins; ++b) distance[r] += std::abs(static_cast<double>(rows[r][b]) - query[b]);
      auto sorted = distance;
      std::sort(sorted.begin(), sorted.end());
      const auto matches = index.nearest(query, 25);
      ASSERT_EQ(matches.size(), 25);
      for (std::size_t i = 0; i < matches.size(); ++i) {
        EXPECT_NEAR(matches[i].distance, sorted[i], 1e-5 * sorted[i] + 1e-6);
        EXPECT_NEAR(matches[i].distance, distance.at(matches[i].row), 1e-5 * sorted[i] + 1e-6);
        if (i > 0) {
          EXPECT_LE(matches[i - 1].distance, matches[i].distance);
          EXPECT_NE(matches[i - 1].row, matches[i].row);
        }
      }
    }
  }
}

TEST(DescriptorIndex, KeepsItsRows) {
  Random random(2);
  DescriptorIndex index(31);
  std::vector<std::vector<float>> rows;
  for (int r = 0; r < 20; ++r) {
    rows.push_back(random_histogram(random, 31));
    index.add(rows.back());
  }
  for (int r = 0; r < 20; ++r) {
    EXPECT_TRUE(std::equal(rows[r].begin(), rows[r].end(), index.row(r).begin(), index.row(r).end()));
    EXPECT_EQ(index.nearest(rows[r], 1).at(0).row, r);
    EXPECT_EQ(index.nearest(rows[r], 1).at(0).distance, 0);
  }
}

TEST(DescriptorIndex, OfEquallyNearTheEarlierComesFirst) {
  DescriptorIndex index(2);
  for (const auto& row : std::vector<std::vector<float>>{{9, 9}, {1, 0}, {0, 1}, {1, 0}, {-1, 0}, {5, 0}, {0, -1}})
    index.add(row);
  std::vector<int> found;
  for (const auto& match : index.nearest(std::vector<float>{0, 0}, 6)) found.push_back(match.row);
  EXPECT_EQ(found, (std::vector{1, 2, 3, 4, 6, 5}));
}

TEST(DescriptorIndex, NeverMoreThanItHolds) {
  DescriptorIndex index(3);
  const std::vector<float> query = {1, 2, 3};
  EXPECT_EQ(index.size(), 0);
  EXPECT_TRUE(index.nearest(query, 5).empty());
  index.add(query);
  index.add(std::vector<float>{0, 0, 0});
  EXPECT_EQ(index.nearest(query, 5).size(), 2);
  EXPECT_TRUE(index.nearest(query, 0).empty());
  EXPECT_TRUE(index.nearest(query, -1).empty());
}

TEST(DescriptorIndex, RefusesOtherLengths) {
  DescriptorIndex index(3);
  for (const std::size_t length : {0, 2, 4}) {
    const std::vector<float> wrong(length, 1.0f);
    const auto message = fmt::format("descriptor has {} bins, the index holds descriptors of 3", length);
    EXPECT_EQ(error_of([&] { index.add(wrong); }), message);
    EXPECT_EQ(error_of([&] { index.nearest(wrong, 1); }), message);
  }
  EXPECT_EQ(index.size(), 0) << "nothing of a refused histogram may stay";
}

}  // namespace
}  // namespace partpose
