// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/off.hpp"

#include "partpose/io/testing.hpp"

namespace partpose {
namespace {

using namespace testing;

const std::string pyramid =
    "OFF # a pyramid\n5 5 8\n0 0 0\n10 0 0\n10 10 0\n0 10 0 255 0 0\n# its top\n5 5 7.5\n"
    "4 3 2 1 0\n3 0 1 4 1 0 0\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";

TEST(Off, ReadsPolygonsAsFans) {
  const TempFolder folder;
  const auto mesh = read_off(folder.file("a.off", pyramid));
  ASSERT_EQ(mesh.vertices.size(), 5u);
  EXPECT_EQ(mesh.vertices[4], Eigen::Vector3f(5, 5, 7.5f));
  const std::vector<std::array<int, 3>> expected = {{3, 2, 1}, {3, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  EXPECT_EQ(mesh.triangles, expected);
}

TEST(Off, SaysWhatIsWrongAndWhere) {
  const TempFolder folder;
  const auto error = [&](const std::string& from, const std::string& to) {
    const auto path = folder.file("a.off", replaced(pyramid, from, to));
    return replaced(error_of([&] { read_off(path); }), path.string(), "");
  };
  EXPECT_EQ(error("OFF", "FOO"), ": line 1, byte 0: 'FOO' where 'OFF' is expected");
  EXPECT_EQ(error("5 5 8", "5 -5 8"), ": line 2, byte 18: '-5', the number of faces from 0 to 2147483647 expected");
  EXPECT_CONTAINS(error("10 10 0", "10 nan 0"), "line 5, byte 38: 'nan' where a coordinate");
  EXPECT_CONTAINS(error("3 1 2 4", "3 1 5 4"), "'5' where a corner from 0 to 4 is expected");
  EXPECT_CONTAINS(error("5 5 8", "5 6 8"), "the file ends here, the number of corners expected: truncated");
  EXPECT_CONTAINS(error("5 5 8", "5 0 8"), "has no triangles");
}

TEST(Off, SurvivesDamage) { survive_damage(pyramid, read_off); }

}  // namespace
}  // namespace partpose
