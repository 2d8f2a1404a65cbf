// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/file.hpp"

#include "partpose/io/testing.hpp"

#include <thread>

namespace partpose {
namespace {

using namespace testing;

TEST(File, ReadsWhatWasWritten) {
  const TempFolder folder;
  std::string bytes(70000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7);
  write_file_atomically(folder / "a.bin", bytes);
  EXPECT_EQ(read_file(folder / "a.bin"), bytes);
  EXPECT_EQ(folder.files(), 1) << "the temporary file is still there";
}

TEST(File, ReplacesAnOldFile) {
  const TempFolder folder;
  write_file_atomically(folder / "a.bin", "a long old content");
  write_file_atomically(folder / "a.bin", "new");
  EXPECT_EQ(read_file(folder / "a.bin"), "new");
}

TEST(File, SaysWhyItCannotBeRead) {
  const TempFolder folder;
  const auto reading = [&](const std::string& name) { return error_of([&] { read_file(folder / name); }); };
  EXPECT_EQ(reading("missing.pcd"), (folder / "missing.pcd").string() + ": no such file");
  std::filesystem::create_directory(folder / "scenes");
  EXPECT_EQ(reading("scenes"), (folder / "scenes").string() + ": is a folder, a file is needed");
  folder.file("empty.ply", "");
  EXPECT_EQ(reading("empty.ply"), (folder / "empty.ply").string() + ": byte 0: the file is empty");
  std::filesystem::create_symlink("loop", folder / "loop");
  EXPECT_CONTAINS(reading("loop"), "loop: cannot be read: ");
  EXPECT_EQ(error_of([] { read_file("/dev/null"); }), "/dev/null: is not a regular file");
}

TEST(File, SaysThatAccessIsDenied) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const TempFolder folder;
  std::filesystem::permissions(folder.file("secret.stl", "x"), std::filesystem::perms::none);
  EXPECT_CONTAINS(error_of([&] { read_file(folder / "secret.stl"); }), "secret.stl: cannot be read: Permission denied");
}

TEST(File, SaysWhyItCannotBeWritten) {
  const TempFolder folder;
  EXPECT_CONTAINS(error_of([&] { write_file_atomically(folder / "no/such/folder.stl", "x"); }),
                  "no/such/folder.stl: cannot be written: No such file");
  std::filesystem::create_directory(folder / "taken");
  folder.file("taken/inside", "x");
  EXPECT_CONTAINS(error_of([&] { write_file_atomically(folder / "taken", "x"); }), "taken: cannot be written: ");
  EXPECT_EQ(folder.files(), 1) << "the temporary file is still there";
}

TEST(File, AReaderNeverSeesAHalfWrittenFile) {
  const TempFolder folder;
  const std::string a(300000, 'a'), b(500000, 'b');
  write_file_atomically(folder / "shared", a);
  const auto write_often = [&](const std::string& bytes) {
    for (int i = 0; i < 100; ++i) write_file_atomically(folder / "shared", bytes);
  };
  std::jthread first(write_often, a), second(write_often, b);
  for (int i = 0; i < 100; ++i) {
    const std::string seen = read_file(folder / "shared");
    EXPECT_TRUE(seen == a || seen == b);
  }
  first.join();
  second.join();
  EXPECT_EQ(folder.files(), 1);
  EXPECT_EQ(files_being_written(), 0);
}

TEST(File, WhatCouldNotBeWrittenIsNoLongerBeingWritten) {
  EXPECT_THROW(write_file_atomically("/nowhere/at/all", "x"), Error);
  EXPECT_EQ(files_being_written(), 0);
}

}  // namespace
}  // namespace partpose
