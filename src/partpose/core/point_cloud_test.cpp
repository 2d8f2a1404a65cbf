// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/point_cloud.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Point i is (i, 2i, 3i), normal i along (i, 1, 0), curvature i / 100.
PointCloud numbered(int count, bool normals = true, bool curvatures = true) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i);
    cloud.points.emplace_back(x, 2 * x, 3 * x);
    if (normals) cloud.normals.push_back(Eigen::Vector3f(x, 1, 0).normalized());
    if (curvatures) cloud.curvatures.push_back(x / 100);
  }
  cloud.width = count;
  cloud.height = 1;
  return cloud;
}

TEST(PointCloud, KnowsWhatItHas) {
  EXPECT_FALSE(PointCloud{}.has_normals());
  EXPECT_FALSE(PointCloud{}.is_organized());
  auto cloud = numbered(6);
  EXPECT_TRUE(cloud.has_normals());
  EXPECT_TRUE(cloud.has_curvatures());
  EXPECT_FALSE(cloud.is_organized());
  cloud.width = 3, cloud.height = 2;
  EXPECT_TRUE(cloud.is_organized());
  cloud.normals.pop_back();
  EXPECT_FALSE(cloud.has_normals());
  cloud.points.pop_back();
  EXPECT_FALSE(cloud.is_organized());
}

TEST(PointCloud, SelectTakesIndicesInTheirOrder) {
  auto cloud = numbered(12);
  cloud.width = 4, cloud.height = 3;
  const auto some = select(cloud, std::vector{7, 0, 7, 11});
  const std::vector<int> expected = {7, 0, 7, 11};
  ASSERT_EQ(some.size(), 4);
  EXPECT_EQ(some.width, 4);
  EXPECT_EQ(some.height, 1);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(some.points[i], cloud.points[expected[i]]);
    EXPECT_EQ(some.normals[i], cloud.normals[expected[i]]);
    EXPECT_EQ(some.curvatures[i], cloud.curvatures[expected[i]]);
  }
  const auto bare = select(numbered(3, false, false), std::vector{1});
  EXPECT_TRUE(bare.normals.empty());
  EXPECT_TRUE(bare.curvatures.empty());
  EXPECT_TRUE(select(cloud, {}).empty());
}

TEST(PointCloud, EveryNthStartsWithTheFirst) {
  const auto cloud = numbered(10);
  EXPECT_TRUE(same_bits(every_nth(cloud, 1), cloud));
  EXPECT_TRUE(same_bits(every_nth(cloud, 4), select(cloud, std::vector{0, 4, 8})));
  EXPECT_TRUE(same_bits(every_nth(cloud, 9), select(cloud, std::vector{0, 9})));
  EXPECT_TRUE(same_bits(every_nth(cloud, 100), select(cloud, std::vector{0})));
  EXPECT_TRUE(every_nth(PointCloud{}, 3).empty());
}

TEST(PointCloud, WithoutMissingDropsWhatIsNotFinite) {
  auto cloud = numbered(6);
  cloud.width = 3, cloud.height = 2;
  cloud.points[1].y() = nan;
  cloud.points[3].z() = std::numeric_limits<float>::infinity();
  cloud.normals[4].x() = nan;
  EXPECT_TRUE(same_bits(without_missing(cloud), select(cloud, std::vector{0, 2, 5})));
  cloud.normals.clear();
  EXPECT_TRUE(same_bits(without_missing(cloud), select(cloud, std::vector{0, 2, 4, 5})));
  EXPECT_TRUE(without_missing(PointCloud{}).empty());
}

TEST(PointCloud, BeforeCameraKeepsWhatACameraCanSee) {
  auto cloud = numbered(8);
  const auto off_axis = [](double angle_deg) -> Eigen::Vector3f {
    return Eigen::Vector3d(0, std::sin(radians(angle_deg)), std::cos(radians(angle_deg))).cast<float>();
  };
  cloud.points = {{0, 0, 1e-3f},  {0, 0, 0},   {0, 0, -5},  off_axis(88.9),
                  off_axis(89.1), {nan, 0, 5}, {9, 9, 600}, {0, 0, nan}};
  cloud.width = 4, cloud.height = 2;
  EXPECT_TRUE(same_bits(before_camera(cloud), select(cloud, std::vector{0, 3, 6})));
  EXPECT_TRUE(before_camera(PointCloud{}).empty());
}

TEST(PointCloud, TransformedMovesPointsAndTurnsNormals) {
  Random random(1);
  const auto cloud = numbered(20);
  const auto pose = random_pose(random, {30, -40, 650});
  const auto moved_cloud = transformed(cloud, pose);
  for (int i = 0; i < 20; ++i) {
    EXPECT_LT((moved_cloud.points[i].cast<double>() - pose * cloud.points[i].cast<double>()).norm(), 2e-4);
    EXPECT_LT((moved_cloud.normals[i].cast<double>() - pose.linear() * cloud.normals[i].cast<double>()).norm(), 1e-6);
  }
  EXPECT_EQ(moved_cloud.curvatures, cloud.curvatures);
  EXPECT_EQ(moved_cloud.width, 20);
  const auto back = transformed(moved_cloud, pose.inverse());
  for (int i = 0; i < 20; ++i) EXPECT_LT((back.points[i] - cloud.points[i]).norm(), 5e-4);
}

TEST(PointCloud, TransformedKeepsMissingPointsMissing) {
  auto cloud = numbered(6);
  cloud.width = 3, cloud.height = 2;
  cloud.points[4] = Eigen::Vector3f::Constant(nan);
  Random random(2);
  const auto moved_cloud = transformed(cloud, random_pose(random));
  EXPECT_TRUE(moved_cloud.is_organized());
  EXPECT_TRUE(moved_cloud.points[4].array().isNaN().all());
}

TEST(PointCloud, CentroidIsTheMean) {
  EXPECT_EQ(centroid(PointCloud{}), Eigen::Vector3d::Zero());
  EXPECT_EQ(centroid(numbered(5)), Eigen::Vector3d(2, 4, 6));
  // A million points far away: a sum of floats would be off by millimetres.
  PointCloud far;
  far.points.assign(1000000, Eigen::Vector3f(100.1f, -3.3f, 812.7f));
  EXPECT_LT((centroid(far) - far.points[0].cast<double>()).norm(), 1e-8);
}

TEST(PointCloud, AppendPutsTheOtherBehind) {
  auto cloud = numbered(3);
  auto other = numbered(2);
  other.points[0].x() = -5;
  append(cloud, other);
  ASSERT_EQ(cloud.size(), 5);
  EXPECT_EQ(cloud.points[3].x(), -5);
  EXPECT_EQ(cloud.normals[4], other.normals[1]);
  EXPECT_EQ(cloud.curvatures[4], other.curvatures[1]);
  EXPECT_EQ(cloud.width, 5);
  EXPECT_EQ(cloud.height, 1);
}

TEST(PointCloud, AppendKeepsNormalsOnlyWhenBothHaveThem) {
  for (const bool first_has : {false, true}) {
    for (const bool second_has : {false, true}) {
      auto cloud = numbered(3, first_has, !first_has);
      append(cloud, numbered(2, second_has, !second_has));
      EXPECT_EQ(cloud.size(), 5);
      EXPECT_EQ(cloud.normals.size(), first_has && second_has ? 5 : 0);
      EXPECT_EQ(cloud.curvatures.size(), !first_has && !second_has ? 5 : 0);
    }
  }
}

TEST(PointCloud, AppendingToOrOfNothing) {
  PointCloud cloud;
  append(cloud, numbered(4));
  EXPECT_TRUE(same_bits(cloud, numbered(4)));
  append(cloud, PointCloud{});
  EXPECT_TRUE(same_bits(cloud, numbered(4)));
  PointCloud nothing;
  append(nothing, PointCloud{});
  EXPECT_TRUE(nothing.empty());
}

}  // namespace
}  // namespace partpose
