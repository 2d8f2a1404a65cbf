// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/point_layout.hpp"

#include "partpose/io/testing.hpp"

namespace partpose {
namespace {

using namespace testing;

constexpr PointNames names = {"x", "y", "z", "nx", "ny", "nz", "c"};

PointLayout layout_of(const std::vector<std::string_view>& columns) { return PointLayout::of(columns, names, "here"); }

TEST(PointLayout, FindsWhatAFileHas) {
  EXPECT_EQ(layout_of({"z", "rgb", "y", "x"}).columns(names), (std::vector<std::string_view>{"x", "y", "z"}));
  EXPECT_EQ(layout_of({"c", "x", "y", "z", "_", "_"}).columns(names),
            (std::vector<std::string_view>{"x", "y", "z", "c"}));
  EXPECT_EQ(layout_of({"nx", "nz", "ny", "x", "y", "z", "c"}).columns(names).size(), 7);
}

TEST(PointLayout, RefusesIncompleteAndRepeatedColumns) {
  const auto error = [](const std::vector<std::string_view>& columns) { return error_of([&] { layout_of(columns); }); };
  EXPECT_EQ(error({"x", "z"}), "here: a point cloud needs x, y and z");
  EXPECT_EQ(error({"x", "y", "z", "nx", "nz"}), "here: a normal needs nx, ny and nz");
  EXPECT_EQ(error({"x", "y", "z", "y"}), "here: y is there 2 times");
}

TEST(PointLayout, AppendsWhatItTookOut) {
  for (const bool normals : {false, true})
    for (const bool curvatures : {false, true}) {
      const auto cloud = random_cloud(9, 1, normals, curvatures);
      const auto layout = PointLayout::of(cloud);
      const auto rows = layout.rows(cloud);
      const std::size_t columns = layout.columns(names).size();
      ASSERT_EQ(rows.size(), 9 * columns);
      PointCloud again;
      for (std::size_t i = 0; i < 9; ++i) layout.append(again, std::span(rows).subspan(i * columns, columns));
      again.width = 9;
      again.height = 1;
      expect_same_cloud(again, cloud);
    }
}

}  // namespace
}  // namespace partpose
