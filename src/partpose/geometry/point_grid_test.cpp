// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/point_grid.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace partpose {
namespace {

using namespace shapes;

void expect_stably_sorted(const std::vector<std::uint64_t>& keys) {
  std::vector<int> expected(keys.size());
  std::iota(expected.begin(), expected.end(), 0);
  std::stable_sort(expected.begin(), expected.end(), [&keys](int a, int b) { return keys[a] < keys[b]; });
  EXPECT_EQ(order_by_key(keys), expected);
}

/// Each point's cell must be as its coordinates say, and each cell's neighbourhood must hold exactly the points of the
/// 27 cells around, and with them all points within one cell edge.
void expect_neighbourhoods_as_brute_force(const std::vector<Eigen::Vector3f>& points, float cell_mm) {
  const PointGrid grid(points, cell_mm);
  const auto cell_of = [cell_mm](const Eigen::Vector3f& p) {
    return Eigen::Vector3i((p.cast<double>() / static_cast<double>(cell_mm)).array().floor().cast<int>());
  };
  int covered = 0;
  for (std::size_t c = 0; c < grid.cell_count(); ++c) {
    const auto cell = grid.cell(c);
    ASSERT_LT(cell.begin, cell.end) << "an empty cell";
    EXPECT_EQ(cell.begin, covered);
    covered = cell.end;

    std::vector<int> found;
    for (const auto range : grid.neighbourhood(c))
      for (int s = range.begin; s < range.end; ++s) found.push_back(grid.original(s));
    std::sort(found.begin(), found.end());
    const Eigen::Vector3i here = cell_of(points[grid.original(cell.begin)]);
    std::vector<int> expected;
    for (std::size_t i = 0; i < points.size(); ++i)
      if ((cell_of(points[i]) - here).cwiseAbs().maxCoeff() <= 1) expected.push_back(static_cast<int>(i));
    EXPECT_EQ(found, expected);

    for (int s = cell.begin; s < cell.end; ++s) {
      const auto& p = points[grid.original(s)];
      EXPECT_EQ(p, Eigen::Vector3f(grid.x()[s], grid.y()[s], grid.z()[s]));
      EXPECT_EQ(cell_of(p), here);
      for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_TRUE((points[i] - p).norm() > cell_mm ||
                    std::binary_search(found.begin(), found.end(), static_cast<int>(i)));
    }
  }
  EXPECT_EQ(covered, points.size());
}

TEST(OrderByKey, IsAStableSort) {
  Random random(1);
  expect_stably_sorted({});
  expect_stably_sorted({5});
  expect_stably_sorted({7, 7, 7, 7});
  expect_stably_sorted({~0ull, 0, ~0ull, 1ull << 63, 0});
  for (const int count : {2, 10, 1000, 5000}) {
    for (const std::uint64_t mask : {0x7ull, 0x7ffull, 0x800ull, 0xfff000ull, 0x7fffffffffffffffull, ~0ull}) {
      std::vector<std::uint64_t> keys(count);
      for (auto& key : keys) key = random.next() & mask;
      expect_stably_sorted(keys);
      std::sort(keys.begin(), keys.end());
      expect_stably_sorted(keys);
      std::reverse(keys.begin(), keys.end());
      expect_stably_sorted(keys);
    }
  }
}

TEST(CellKey, SortsByZThenYThenX) {
  const auto key = [](float x, float y, float z) { return cell_key({x, y, z}, 2.0f); };
  EXPECT_LT(key(-1, 0, 0), key(1, 0, 0));
  EXPECT_LT(key(1000, 0, 0), key(-1000, 3, 0));
  EXPECT_LT(key(0, 1000, 0), key(0, -1000, 3));
  EXPECT_EQ(key(0, 0, 0), key(1.999f, 1.999f, 1.999f));
  EXPECT_NE(key(0, 0, 0), key(-0.001f, 0, 0));
  EXPECT_EQ(key(4, 4, 4) - key(2, 4, 4), 1);
}

TEST(CellKey, SaysWhenAPointIsTooFarAway) {
  constexpr float limit = 1 << 20;
  EXPECT_EQ(error_of([] { cell_key({limit - 3, -limit + 3, 0}, 1.0f); }), "no error");
  for (int axis = 0; axis < 3; ++axis) {
    for (const float bad : {limit + 1, -limit - 1, 1e30f, std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
      Eigen::Vector3f point(1, 2, 3);
      point[axis] = bad;
      EXPECT_PRED2(mentions, error_of([&] { cell_key(point, 1.0f); }), "too far");
    }
  }
}

TEST(PointGrid, NeighbourhoodsOfARandomCloud) {
  Random random(2);
  expect_neighbourhoods_as_brute_force(random_cube(random, 700, 20).points, 5);
  expect_neighbourhoods_as_brute_force(random_cube(random, 500, 20, {-300, 200, 650}).points, 7.3f);
  expect_neighbourhoods_as_brute_force(random_cube(random, 300, 2).points, 50);
  expect_neighbourhoods_as_brute_force(random_cube(random, 300, 100).points, 0.5f);
}

TEST(PointGrid, NeighbourhoodsOfPointsOnCellBorders) {
  Random random(3);
  std::vector<Eigen::Vector3f> points;
  const auto coordinate = [&random] { return 3.0f * static_cast<float>(random.below(7)) - 9.0f; };
  for (int i = 0; i < 300; ++i) points.push_back({coordinate(), coordinate(), coordinate()});
  expect_neighbourhoods_as_brute_force(points, 3);
}

TEST(PointGrid, FewPoints) {
  expect_neighbourhoods_as_brute_force({{-0.1f, -0.1f, -0.1f}}, 1);
  expect_neighbourhoods_as_brute_force({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, 2);
  EXPECT_EQ(PointGrid(std::vector<Eigen::Vector3f>{}, 1).cell_count(), 0);
}

TEST(PointGrid, RefusesImpossibleCellsAndCoordinates) {
  const std::vector<Eigen::Vector3f> points = {{1, 2, 3}};
  for (const float bad : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_PRED2(mentions, error_of([&] { PointGrid(points, bad); }), "cell size");
  const std::vector<Eigen::Vector3f> far = {{0, 0, 0}, {0, 2e6f, 0}};
  EXPECT_PRED2(mentions, error_of([&] { PointGrid(far, 1); }), "2000000 mm is too far");
  const std::vector<Eigen::Vector3f> missing = {{0, 0, std::numeric_limits<float>::quiet_NaN()}};
  EXPECT_PRED2(mentions, error_of([&] { PointGrid(missing, 1); }), "not finite");
}

}  // namespace
}  // namespace partpose
