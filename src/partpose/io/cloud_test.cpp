// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/cloud.hpp"

#include "partpose/io/pcd.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/io/testing.hpp"

namespace partpose {
namespace {

using namespace testing;

TEST(Cloud, ReadsByExtensionInAnyCase) {
  const TempFolder folder;
  const auto cloud = random_cloud(6, 1, true, true);
  for (const char* name : {"a.pcd", "b.PCD", "c.x.Pcd"}) {
    write_pcd(folder / name, cloud);
    expect_same_cloud(read_cloud(folder / name), cloud);
  }
  for (const char* name : {"a.ply", "b.PLY"}) {
    write_ply(folder / name, cloud);
    expect_same_cloud(read_cloud(folder / name), cloud);
  }
}

TEST(Cloud, SaysWhatIsWrongWithThePath) {
  const TempFolder folder;
  const auto reading = [&](const std::string& name) { return error_of([&] { read_cloud(folder / name); }); };
  folder.file("a.xyz", "1 2 3");
  EXPECT_EQ(reading("a.xyz"), (folder / "a.xyz").string() + ": extension '.xyz', a point cloud is a .pcd or .ply file");
  folder.file("a", "1 2 3");
  EXPECT_CONTAINS(reading("a"), "a: extension '', a point cloud is a .pcd or .ply file");
  EXPECT_CONTAINS(reading("missing.ply"), "missing.ply: no such file");
  std::filesystem::create_directory(folder / "folder.pcd");
  EXPECT_CONTAINS(reading("folder.pcd"), "folder.pcd: is a folder, a file is needed");
  EXPECT_CONTAINS(reading(""), "is a folder, a file is needed");
  folder.file("empty.pcd", "");
  EXPECT_CONTAINS(reading("empty.pcd"), "empty.pcd: byte 0: the file is empty");
  folder.file("a.ply", "# .PCD v0.7");
  EXPECT_CONTAINS(reading("a.ply"), "a.ply: line 1, byte 0: '#', 'ply' expected: not a PLY file");
}

}  // namespace
}  // namespace partpose
