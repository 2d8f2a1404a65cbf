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

TEST(Error, IsOneLineWhateverAFileBroughtIntoIt) {
  EXPECT_STREQ(Error("{}: no such file", "two\nlines\t.stl").what(), "two lines .stl: no such file");
  EXPECT_STREQ(Error(std::string("a\r\nb")).what(), "a  b");
  EXPECT_STREQ(Error("caf\u00e9").what(), "caf\u00e9") << "letters stay";
}

}  // namespace
}  // namespace partpose
