// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/scene.hpp"

#include "partpose/io/testing.hpp"

namespace partpose {
namespace {

using namespace testing;

TEST(Scene, SaysWhatElseAFileIs) {
  const TempFolder folder;
  const auto reading = [](const std::filesystem::path& path) { return error_of([&] { read_scene(path); }); };
  EXPECT_CONTAINS(reading(folder.file("part.STL", "x")),
                  "part.STL: is a model of a part, not a scene; models are given");
  EXPECT_CONTAINS(reading(folder.file("part.step", "x")), "part.step: is a model of a part, not a scene");
  EXPECT_CONTAINS(reading(folder.file("gt.json", "{}")),
                  "gt.json: a scene is a .png (16-bit depth), .pcd or .ply file");
  EXPECT_CONTAINS(reading(folder / "none.stl"), "none.stl: no such file");
}

TEST(Scene, AFolderIsToldWhichOfItsFilesToGive) {
  const TempFolder folder;
  const auto reading = [&] { return error_of([&] { read_scene(folder / ""); }); };
  EXPECT_CONTAINS(reading(), ": is a folder, a file is needed");
  folder.file("part.stl", "x");
  EXPECT_CONTAINS(reading(), ": is a folder, it holds models, which are given with --models");
  for (const char* name : {"a.png", "b.png", "c.PCD", "readme.md"}) folder.file(name, "x");
  EXPECT_CONTAINS(reading(), ": is a folder, a scene is a file; give its files: " + (folder / "*.PCD").string() + " " +
                                 (folder / "*.png").string());
}

}  // namespace
}  // namespace partpose
