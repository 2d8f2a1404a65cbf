// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/model_files.hpp"

#include "partpose/io/testing.hpp"

namespace partpose {
namespace {

using namespace testing;

using Paths = std::vector<std::filesystem::path>;

TEST(ModelFiles, AFileIsItself) {
  const TempFolder folder;
  EXPECT_EQ(model_files(folder.file("part.stl", "x")), Paths{folder / "part.stl"});
  EXPECT_EQ(model_files(folder.file("part.obj", "x")), Paths{folder / "part.obj"}) << "whatever its name";
}

TEST(ModelFiles, OfAFolderByName) {
  const TempFolder folder;
  for (const char* name : {"c.stl", "B.STL", "a.Stl", "d.StP", "readme.md", "a.stl.bak", "stl", ".stl"})
    folder.file(name, "x");
  std::filesystem::create_directory(folder / "folder.stl");
  std::filesystem::create_directory(folder / "below");
  folder.file("below/deep.stl", "x");
  EXPECT_EQ(model_files(folder / ""), (Paths{folder / "B.STL", folder / "a.Stl", folder / "c.stl", folder / "d.StP"}));
}

TEST(ModelFiles, SaysWhatIsMissing) {
  const TempFolder folder;
  EXPECT_EQ(error_of([&] { model_files(folder / "none"); }), (folder / "none").string() + ": no such file or folder");
  std::filesystem::create_directory(folder / "empty");
  folder.file("empty/readme.md", "x");
  EXPECT_EQ(error_of([&] { model_files(folder / "empty"); }),
            (folder / "empty").string() +
                ": has no model files (nothing that ends with .stl, .step, .stp, .obj, .ply, .off, .3mf, .gltf, "
                ".glb)");
  std::filesystem::create_directory(folder / "empty/below");
  folder.file("empty/below/part.STL", "x");
  EXPECT_CONTAINS(error_of([&] { model_files(folder / "empty"); }),
                  ".glb); subfolders are not searched: give " + (folder / "empty/below").string() + " itself");
}

}  // namespace
}  // namespace partpose
