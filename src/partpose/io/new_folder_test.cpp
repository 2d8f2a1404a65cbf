// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/new_folder.hpp"

#include "partpose/io/testing.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace partpose {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path) { std::ofstream(path) << "x"; }

TEST(NewFolder, AppearsWhenFinishedAndReplacesItsOwnKind) {
  const testing::TempFolder temporary;
  const fs::path target = temporary / "made" / "";  // a slash at the end is a habit
  for (const char* name : {"first", "second"}) {
    NewFolder folder(target, "mark", {"first", "second"});
    write(folder.path() / "mark");
    write(folder.path() / name);
    EXPECT_EQ(fs::exists(target / name), false);
    folder.finish();
    EXPECT_TRUE(fs::exists(target / name));
  }
  EXPECT_FALSE(fs::exists(target / "first"));
  EXPECT_EQ(std::distance(fs::directory_iterator(temporary / ""), {}), 1);
}

TEST(NewFolder, LeavesNothingWhenNotFinished) {
  const testing::TempFolder temporary;
  { write(NewFolder(temporary / "made", "mark", {}).path() / "mark"); }
  EXPECT_TRUE(fs::is_empty(temporary / ""));
  fs::create_directories(temporary / "made.partial-999999999");  // of a process that is no more
  NewFolder(temporary / "made", "mark", {});
  EXPECT_TRUE(fs::is_empty(temporary / ""));
}

TEST(NewFolder, ReplacesNothingElse) {
  const testing::TempFolder temporary;
  const auto error = [&] { return shapes::error_of([&] { NewFolder(temporary / "made", "mark", {"data"}); }); };
  write(temporary / "made");
  EXPECT_PRED2(shapes::mentions, error(), "not a folder");
  fs::remove(temporary / "made");
  fs::create_directories(temporary / "made");
  EXPECT_EQ(error(), "no error");
  write(temporary / "made" / "data");
  EXPECT_PRED2(shapes::mentions, error(), "has no mark");
  write(temporary / "made" / "mark");
  EXPECT_EQ(error(), "no error");
  write(temporary / "made" / "mine");
  EXPECT_PRED2(shapes::mentions, error(), "mine");
  EXPECT_TRUE(fs::exists(temporary / "made" / "mine"));
}

}  // namespace
}  // namespace partpose
