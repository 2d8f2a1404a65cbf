// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/hash.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(ContentHash, IsFnv1a) {
  // The published test vectors (Fowler, Noll and Vo).
  EXPECT_EQ(content_hash(""), "cbf29ce484222325");
  EXPECT_EQ(content_hash("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(content_hash("foobar"), "85944171f73967e8");
}

TEST(ContentHash, CountsEveryByte) {
  EXPECT_NE(content_hash(std::string_view("a\0", 2)), content_hash("a"));
  EXPECT_NE(content_hash("\xff"), content_hash("\x7f"));
  EXPECT_EQ(content_hash(std::string(1000, 'x')).size(), 16);
}

}  // namespace
}  // namespace partpose
