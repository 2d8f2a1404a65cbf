// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/depth_image.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Nothing symmetric about it.
const Intrinsics odd_camera = {61, 47, 70.5, 91.25, 24.75, 29.125};

/// Every third pixel empty, the others between 300 and 900 mm.
DepthImage random_depth(const Intrinsics& camera, std::uint64_t seed) {
  Random random(seed);
  DepthImage depth(camera.width, camera.height);
  for (float& z : depth.z_mm)
    if (random.below(3) != 0) z = static_cast<float>(between(random, 300, 900));
  return depth;
}

TEST(Intrinsics, FieldOfViewReachesTheOuterPixelEdges) {
  const auto camera = Intrinsics::from_field_of_view(640, 480, 50, 40);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  const Eigen::Vector3d left = camera.unproject(-0.5, camera.cy, 1000).cast<double>();
  const Eigen::Vector3d right = camera.unproject(639.5, camera.cy, 1000).cast<double>();
  const Eigen::Vector3d top = camera.unproject(camera.cx, -0.5, 1000).cast<double>();
  const Eigen::Vector3d bottom = camera.unproject(camera.cx, 479.5, 1000).cast<double>();
  EXPECT_NEAR(angle_deg(left, Eigen::Vector3d::UnitZ()), 25, 1e-5);
  EXPECT_NEAR(angle_deg(right, Eigen::Vector3d::UnitZ()), 25, 1e-5);
  EXPECT_NEAR(angle_deg(top, Eigen::Vector3d::UnitZ()), 20, 1e-5);
  EXPECT_NEAR(angle_deg(bottom, Eigen::Vector3d::UnitZ()), 20, 1e-5);
  EXPECT_LT(left.x(), 0) << "x points right";
  EXPECT_LT(top.y(), 0) << "y points down";
}

TEST(Intrinsics, RefusesImpossibleFieldsOfView) {
  for (const double bad : {0.0, -10.0, 180.0, 200.0, infinity, static_cast<double>(nan)}) {
    EXPECT_PRED2(mentions, error_of([&] { Intrinsics::from_field_of_view(640, 480, bad, 40); }), "field of view");
    EXPECT_PRED2(mentions, error_of([&] { Intrinsics::from_field_of_view(640, 480, 50, bad); }), "field of view");
  }
  EXPECT_PRED2(mentions, error_of([] { Intrinsics::from_field_of_view(640, 480, 190, 40); }), "190");
  EXPECT_PRED2(mentions, error_of([] { Intrinsics::from_field_of_view(0, 480, 50, 40); }), "0 x 480 px");
}

TEST(Intrinsics, CheckNamesTheValue) {
  const auto with = [](auto change) {
    Intrinsics camera = odd_camera;
    change(camera);
    return error_of([&] { camera.check(); });
  };
  EXPECT_EQ(with([](auto&) {}), "no error");
  EXPECT_EQ(with([](auto& c) { c.width = 65536; }), "no error");
  EXPECT_PRED2(mentions, with([](auto& c) { c.width = 65537; }), "65537");
  EXPECT_PRED2(mentions, with([](auto& c) { c.height = 0; }), "61 x 0 px");
  EXPECT_PRED2(mentions, with([](auto& c) { c.height = -47; }), "-47");
  EXPECT_PRED2(mentions, with([](auto& c) { c.fx = 0; }), "fx = 0");
  EXPECT_PRED2(mentions, with([](auto& c) { c.fy = -3; }), "fy = -3");
  EXPECT_PRED2(mentions, with([](auto& c) { c.fy = infinity; }), "fy = inf");
  EXPECT_PRED2(mentions, with([](auto& c) { c.fx = nan; }), "fx = nan");
  EXPECT_PRED2(mentions, with([](auto& c) { c.cx = infinity; }), "cx = inf");
  EXPECT_PRED2(mentions, with([](auto& c) { c.cy = nan; }), "cy = nan");
}

TEST(Intrinsics, ProjectIsTheInverseOfUnproject) {
  Random random(11);
  for (int i = 0; i < 1000; ++i) {
    const double u = between(random, -100, 200), v = between(random, -100, 200), z = between(random, 50, 5000);
    const Eigen::Vector3f point = odd_camera.unproject(u, v, z);
    EXPECT_FLOAT_EQ(point.z(), static_cast<float>(z));
    const Eigen::Vector2d pixel = odd_camera.project(point.cast<double>());
    EXPECT_NEAR(pixel.x(), u, 1e-4);
    EXPECT_NEAR(pixel.y(), v, 1e-4);
  }
}

TEST(Intrinsics, ProjectsByHand) {
  // 10 mm to the right and 20 mm down at 100 mm.
  const Eigen::Vector2d pixel = odd_camera.project({10, 20, 100});
  EXPECT_DOUBLE_EQ(pixel.x(), 70.5 * 0.1 + 24.75);
  EXPECT_DOUBLE_EQ(pixel.y(), 91.25 * 0.2 + 29.125);
}

TEST(IntrinsicsCovering, CoversThePointsAndNotMuchMore) {
  Random random(5);
  auto cloud = random_cube(random, 200, 40, {100, -60, 500});
  const double pixel_rad = 1.0 / 300;
  for (const int margin : {0, 2, 7}) {
    const auto camera = intrinsics_covering(cloud, pixel_rad, margin);
    EXPECT_NO_THROW(camera.check());
    EXPECT_DOUBLE_EQ(camera.fx, 300);
    EXPECT_DOUBLE_EQ(camera.fy, 300);
    Eigen::AlignedBox2d pixels;
    for (const auto& p : cloud.points) pixels.extend(camera.project(p.cast<double>()));
    EXPECT_GE(pixels.min().minCoeff(), margin - 1e-6);
    EXPECT_LE(pixels.max().x(), camera.width - 1 - margin + 1e-6);
    EXPECT_LE(pixels.max().y(), camera.height - 1 - margin + 1e-6);
    EXPECT_LE(pixels.min().maxCoeff(), margin + 1 + 1e-6);
    EXPECT_GE(pixels.max().x(), camera.width - 2 - margin - 1e-6);
    EXPECT_GE(pixels.max().y(), camera.height - 2 - margin - 1e-6);
  }
}

TEST(IntrinsicsCovering, WidensItsPixelsWhereTheImageWouldBeTooLarge) {
  PointCloud cloud;
  cloud.points = {{-5000, 10, 1}, {5000, -20, 1}, {3, 4, 5}};
  const auto camera = intrinsics_covering(cloud, 0.01, 3, 500);
  EXPECT_NO_THROW(camera.check());
  EXPECT_LE(camera.width, 500);
  EXPECT_GE(camera.width, 499);
  EXPECT_LE(camera.height, 500);
  for (const auto& p : cloud.points) {
    const auto pixel = camera.project(p.cast<double>());
    EXPECT_GE(pixel.minCoeff(), 3 - 1e-6);
    EXPECT_LE(pixel.x(), camera.width - 4 + 1e-6);
    EXPECT_LE(pixel.y(), camera.height - 4 + 1e-6);
  }
}

TEST(IntrinsicsCovering, LeavesOutWhatIsBehindTheCamera) {
  Random random(6);
  auto cloud = random_cube(random, 50, 30, {0, 0, 400});
  const auto camera = intrinsics_covering(cloud, 0.01);
  cloud.points.emplace_back(1000.0f, 1000.0f, -1.0f);
  cloud.points.emplace_back(1000.0f, 1000.0f, 0.0f);
  cloud.points.emplace_back(nan, 0.0f, 400.0f);
  const auto same = intrinsics_covering(cloud, 0.01);
  EXPECT_EQ(camera.width, same.width);
  EXPECT_EQ(camera.height, same.height);
  EXPECT_EQ(camera.cx, same.cx);
}

TEST(IntrinsicsCovering, SaysWhatItCannotCover) {
  PointCloud cloud;
  EXPECT_PRED2(mentions, error_of([&] { intrinsics_covering(cloud, 0.01); }), "no point before the camera");
  cloud.points = {{0, 0, -5}};
  EXPECT_PRED2(mentions, error_of([&] { intrinsics_covering(cloud, 0.01); }), "no point before the camera");
  cloud.points = {{0, 0, 5}};
  EXPECT_EQ(error_of([&] { intrinsics_covering(cloud, 0.01); }), "no error");
  EXPECT_PRED2(mentions, error_of([&] { intrinsics_covering(cloud, 0); }), "pixel size 0");
  EXPECT_PRED2(mentions, error_of([&] { intrinsics_covering(cloud, nan); }), "pixel size nan");
}

TEST(DepthImage, IsStoredRowByRow) {
  DepthImage depth(4, 3);
  EXPECT_EQ(depth.z_mm, std::vector<float>(12, 0.0f));
  depth.at(3, 1) = 7;
  EXPECT_EQ(depth.z_mm[7], 7);
}

TEST(DepthImage, RoundTripKeepsTheBits) {
  const auto depth = random_depth(odd_camera, 21);
  for (const bool organized : {false, true}) {
    const auto again = to_depth_image(to_point_cloud(depth, odd_camera, organized), odd_camera);
    EXPECT_EQ(again.width, depth.width);
    EXPECT_EQ(again.height, depth.height);
    EXPECT_TRUE(same_bits(again.z_mm, depth.z_mm));
  }
}

TEST(DepthImage, OrganizedCloudHasOnePointPerPixel) {
  auto depth = random_depth(odd_camera, 22);
  depth.at(0, 0) = nan;
  depth.at(1, 0) = -500;
  const auto organized = to_point_cloud(depth, odd_camera, true);
  ASSERT_TRUE(organized.is_organized());
  ASSERT_EQ(organized.size(), depth.z_mm.size());
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const auto& p = organized.points[v * depth.width + u];
      if (depth.at(u, v) > 0)
        EXPECT_EQ(p, odd_camera.unproject(u, v, depth.at(u, v)));
      else
        EXPECT_TRUE(p.array().isNaN().all());
    }
  }
}

TEST(DepthImage, UnorganizedCloudIsTheOrganizedOneWithoutGaps) {
  const auto depth = random_depth(odd_camera, 23);
  const auto unorganized = to_point_cloud(depth, odd_camera);
  EXPECT_FALSE(unorganized.is_organized());
  EXPECT_TRUE(same_bits(unorganized, without_missing(to_point_cloud(depth, odd_camera, true))));
}

TEST(DepthImage, TheNearestPointWinsInAnyOrder) {
  PointCloud cloud;
  const auto near = odd_camera.unproject(10.2, 20.3, 400), far = odd_camera.unproject(9.8, 19.7, 500);
  for (const bool near_first : {false, true}) {
    cloud.points = near_first ? std::vector{near, far} : std::vector{far, near};
    EXPECT_EQ(to_depth_image(cloud, odd_camera).at(10, 20), 400);
  }
}

TEST(DepthImage, PixelsReachHalfAPixelAroundTheirCentres) {
  const auto lit = [](double u, double v) {
    PointCloud cloud;
    cloud.points = {odd_camera.unproject(u, v, 600)};
    const auto depth = to_depth_image(cloud, odd_camera);
    for (std::size_t i = 0; i < depth.z_mm.size(); ++i)
      if (depth.z_mm[i] != 0) return std::pair(static_cast<int>(i) % depth.width, static_cast<int>(i) / depth.width);
    return std::pair(-1, -1);
  };
  EXPECT_EQ(lit(10.49, 20.51), std::pair(10, 21));
  EXPECT_EQ(lit(-0.49, -0.49), std::pair(0, 0));
  EXPECT_EQ(lit(60.49, 46.49), std::pair(60, 46));
  EXPECT_EQ(lit(-0.51, 10), std::pair(-1, -1));
  EXPECT_EQ(lit(10, -0.51), std::pair(-1, -1));
  EXPECT_EQ(lit(60.51, 10), std::pair(-1, -1));
  EXPECT_EQ(lit(10, 46.51), std::pair(-1, -1));
}

TEST(DepthImage, DropsPointsThatCannotBeSeen) {
  PointCloud cloud;
  cloud.points = {{0, 0, -600}, {0, 0, 0}, {nan, 0, 600}, {0, 0, nan}, {1e30f, 0, 1e-30f}, {-1e6f, 3, 5}};
  for (const float z : to_depth_image(cloud, odd_camera).z_mm) EXPECT_EQ(z, 0);
}

}  // namespace
}  // namespace partpose
