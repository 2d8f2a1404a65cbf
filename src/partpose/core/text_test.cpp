// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/text.hpp"

#include "partpose/core/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace partpose {
namespace {

/// The edit distance by its definition: drop, add or change the last letters.
std::size_t distance(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const auto shorter_a = a.substr(1), shorter_b = b.substr(1);
  if (a[0] == b[0]) return distance(shorter_a, shorter_b);
  return 1 + std::min({distance(shorter_a, b), distance(a, shorter_b), distance(shorter_a, shorter_b)});
}

TEST(NearestWord, FindsTheKeyThatWasMeant) {
  const std::vector<std::string> keys = {"voxel_size", "voxel_grid_flag", "scale_flag", "scale_factor", "xyz_limits"};
  EXPECT_EQ(nearest_word("voxel_size", keys), "voxel_size");
  EXPECT_EQ(nearest_word("voxelsize", keys), "voxel_size");
  EXPECT_EQ(nearest_word("voxel_sise", keys), "voxel_size");
  EXPECT_EQ(nearest_word("scale_flags", keys), "scale_flag");
  EXPECT_EQ(nearest_word("xyz_limit", keys), "xyz_limits");
  EXPECT_EQ(nearest_word("scale_facotr", keys), "scale_factor");
}

TEST(SimilarWord, IsNoneThatIsFarOff) {
  const std::vector<std::string> keys = {"voxel_size", "scale_flag", "fx"};
  EXPECT_EQ(similar_word("voxel_sise", keys), "voxel_size");
  EXPECT_EQ(similar_word("fz", keys), "fx");
  EXPECT_EQ(similar_word("nosuchkey", keys), "");
  EXPECT_EQ(similar_word("anything", {}), "");
}

TEST(NearestWord, TheFirstOfEquallyNear) {
  const std::vector<std::string> keys = {"abc", "abd"};
  EXPECT_EQ(nearest_word("abx", keys), "abc");
}

TEST(NearestWord, EmptyWords) {
  EXPECT_EQ(nearest_word("anything", {}), "");
  const std::vector<std::string> keys = {"long", "ab", ""};
  EXPECT_EQ(nearest_word("", keys), "");
  EXPECT_EQ(nearest_word("abc", keys), "ab");
}

TEST(NearestWord, NeedsTheFewestChanges) {
  Random random(1);
  const auto word = [&random] {
    std::string text(random.below(6), ' ');
    for (char& c : text) c = static_cast<char>('a' + random.below(3));
    return text;
  };
  for (int round = 0; round < 300; ++round) {
    std::vector<std::string> keys;
    for (int i = 0; i < 5; ++i) keys.push_back(word());
    const auto typed = word();
    std::size_t fewest = 100;
    for (const auto& key : keys) fewest = std::min(fewest, distance(typed, key));
    EXPECT_EQ(distance(typed, nearest_word(typed, keys)), fewest) << typed;
  }
}

}  // namespace
}  // namespace partpose
