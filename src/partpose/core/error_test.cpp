// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/error.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(Error, FormatsItsMessage) {
  EXPECT_STREQ(Error("{}: byte {}: broken", "part.stl", 84).what(), "part.stl: byte 84: broken");
}

TEST(Error, TakesAMessageWithoutArgumentsAsItIs) {
  EXPECT_STREQ(Error("key \"{a}\" 100 %").what(), "key \"{a}\" 100 %");
}

}  // namespace
}  // namespace partpose
