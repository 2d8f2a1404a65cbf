// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/preprocess/segmentation.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace partpose {
namespace {

using namespace shapes;

const Intrinsics camera = Intrinsics::from_field_of_view(320, 240, 40, 30);
const SegmentationOptions parts_of_fifty_mm = {.largest_part_mm = 70, .smallest_part_mm = 40};

/// A ball in the scene, camera frame, mm.
struct Ball {
  Eigen::Vector3d centre;
  double radius = 0;
};

struct Scene {
  DepthImage depth;
  std::vector<std::vector<int>> pixels_of_balls;
};

/// Balls before a table (or none) that fills the image, seen by rays; exact, or with noise along z.
Scene scene_of(const std::vector<Ball>& balls, bool with_table, double noise_mm = 0) {
  Random random(1);
  Scene scene{DepthImage(camera.width, camera.height), std::vector<std::vector<int>>(balls.size())};
  const Eigen::Vector3d normal = Eigen::Vector3d(0.1, -0.5, -1).normalized();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
      double z = with_table ? normal.dot(Eigen::Vector3d(0, 0, 700)) / normal.dot(ray) : 0;
      int seen = -1;
      for (int b = 0; b < static_cast<int>(balls.size()); ++b) {
        const double along = ray.dot(balls[b].centre);
        const double discriminant =
            along * along - ray.squaredNorm() * (balls[b].centre.squaredNorm() - balls[b].radius * balls[b].radius);
        if (discriminant < 0) continue;
        const double hit = (along - std::sqrt(discriminant)) / ray.squaredNorm();
        if (z > 0 && hit > z) continue;
        z = hit;
        seen = b;
      }
      if (seen >= 0) scene.pixels_of_balls[seen].push_back(v * camera.width + u);
      if (z > 0) scene.depth.at(u, v) = static_cast<float>(z + noise_mm * random.normal_pair().first);
    }
  }
  return scene;
}

/// Share of the pixels in either that are in both.
double overlap(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return static_cast<double>(both.size()) / static_cast<double>(a.size() + b.size() - both.size());
}

double best_overlap(const std::vector<Segment>& segments, const std::vector<int>& pixels) {
  double best = 0;
  for (const auto& segment : segments) best = std::max(best, overlap(segment.pixels, pixels));
  return best;
}

void expect_well_formed(const std::vector<Segment>& segments, const DepthImage& depth) {
  for (const auto& segment : segments) {
    EXPECT_TRUE(std::is_sorted(segment.pixels.begin(), segment.pixels.end(), std::less_equal<>()))
        << "rising, none twice";
    for (const int pixel : segment.pixels) ASSERT_GT(depth.z_mm.at(pixel), 0);
  }
  for (std::size_t i = 1; i < segments.size(); ++i)
    EXPECT_GE(segments[i - 1].pixels.size(), segments[i].pixels.size()) << "largest first";
}

TEST(Segmentation, BallsOnATableAreSegments) {
  for (const double noise : {0.0, 1.0}) {
    const auto scene = scene_of({{{-100, 20, 620}, 25}, {{90, -30, 640}, 25}, {{20, 70, 590}, 25}}, true, noise);
    const auto segments = segment(scene.depth, camera, parts_of_fifty_mm);
    expect_well_formed(segments, scene.depth);
    for (const auto& pixels : scene.pixels_of_balls) {
      ASSERT_GT(pixels.size(), 500);
      EXPECT_GT(best_overlap(segments, pixels), 0.9) << "noise " << noise;
    }
    for (const auto& segment : segments) EXPECT_FALSE(segment.whole_frame);
  }
}

TEST(Segmentation, DepthJumpsSeparateWhatTouchesInTheImage) {
  const auto scene = scene_of({{{-15, 0, 500}, 25}, {{25, 0, 620}, 25}}, true);
  const auto segments = segment(scene.depth, camera, parts_of_fifty_mm);
  for (const auto& pixels : scene.pixels_of_balls) EXPECT_GT(best_overlap(segments, pixels), 0.9);
}

TEST(Segmentation, APartAloneIsTheWholeFrame) {
  const auto scene = scene_of({{{10, 0, 600}, 25}}, false);
  const auto segments = segment(scene.depth, camera, parts_of_fifty_mm);
  expect_well_formed(segments, scene.depth);
  ASSERT_FALSE(segments.empty());
  EXPECT_TRUE(segments[0].whole_frame);
  EXPECT_EQ(segments[0].pixels, scene.pixels_of_balls[0]);
}

TEST(Segmentation, AnEmptyTableHasNoSegments) {
  for (const double noise : {0.0, 1.0})
    EXPECT_TRUE(segment(scene_of({}, true, noise).depth, camera, parts_of_fifty_mm).empty());
}

TEST(Segmentation, NothingMeasuredIsNothing) {
  EXPECT_TRUE(segment(DepthImage(camera.width, camera.height), camera, {}).empty());
  DepthImage few(camera.width, camera.height);
  for (int i = 0; i < 10; ++i) few.at(100 + i, 50) = 600;
  EXPECT_TRUE(segment(few, camera, {}).empty());
}

TEST(Segmentation, WhatIsTooLargeOrTooSmallIsDropped) {
  const auto scene = scene_of({{{-110, 0, 620}, 45}, {{60, 0, 600}, 25}, {{0, 80, 590}, 4}}, true);
  const auto segments = segment(scene.depth, camera, {.largest_part_mm = 55, .smallest_part_mm = 40, .min_pixels = 20});
  EXPECT_LT(best_overlap(segments, scene.pixels_of_balls[0]), 0.9);
  EXPECT_GT(best_overlap(segments, scene.pixels_of_balls[1]), 0.9);
  EXPECT_LT(best_overlap(segments, scene.pixels_of_balls[2]), 0.1);
}

TEST(Segmentation, NoMoreSegmentsThanAskedFor) {
  std::vector<Ball> balls;
  for (int r = -1; r <= 1; ++r)
    for (int c = -2; c <= 2; ++c) balls.push_back({{90.0 * c, 75.0 * r, 600 + 30.0 * r}, 20});
  const auto scene = scene_of(balls, true);
  const auto all = segment(scene.depth, camera, {.largest_part_mm = 60, .smallest_part_mm = 30, .most_segments = 100});
  EXPECT_GE(all.size(), 15);
  const auto some = segment(scene.depth, camera, {.largest_part_mm = 60, .smallest_part_mm = 30, .most_segments = 4});
  ASSERT_EQ(some.size(), 4);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(some[i].pixels, all[i].pixels);
}

TEST(WhyNothingStandsOut, NamesAnEmptyImageAndAnotherUnit) {
  DepthImage depth(20, 10);
  EXPECT_EQ(why_nothing_stands_out(depth), "no pixel of it has a depth");
  const auto all_at = [&](float z_mm) {
    std::fill(depth.z_mm.begin(), depth.z_mm.end(), z_mm);
    depth.z_mm[3] = 5000;  // one pixel says nothing
    return why_nothing_stands_out(depth);
  };
  EXPECT_TRUE(shapes::mentions(all_at(0.6f), "less than 0.6 mm away: is it in metres?"));
  EXPECT_TRUE(shapes::mentions(all_at(60), "less than 60 mm away: is it in another unit than stated?"));
  EXPECT_TRUE(shapes::mentions(all_at(6'000), "more than 6 m away"));
  EXPECT_TRUE(shapes::mentions(all_at(600'000), "more than 600 m away"));
  EXPECT_FALSE(shapes::mentions(all_at(600), "away"));
}

TEST(HintOfThinning, OfEverySecondPoint) {
  DepthImage depth(40, 40);
  for (int v = 5; v < 35; ++v)
    for (int u = 5; u < 35; ++u) depth.at(u, v) = 600;
  EXPECT_EQ(hint_of_thinning(depth), "");
  for (int i = 0; i < 1600; ++i)
    if (i % 9 == 0) depth.z_mm[i] = 0;  // what a camera does not measure
  EXPECT_EQ(hint_of_thinning(depth), "");
  for (int i = 0; i < 1600; ++i)
    if (i % 2 == 0) depth.z_mm[i] = 0;
  EXPECT_TRUE(shapes::mentions(hint_of_thinning(depth), "the cloud seems to be thinned: give all points"));
}

TEST(AngularSpacing, IsThePixelOfTheCamera) {
  ASSERT_GT(camera.fy, camera.fx) << "the nearest pixels are those above and below";
  const auto scene = scene_of({{{0, 0, 500}, 60}}, false);
  EXPECT_NEAR(angular_spacing_rad(to_point_cloud(scene.depth, camera)).value(), 1 / camera.fy, 1e-3 / camera.fy);
  EXPECT_NEAR(angular_spacing_rad(to_point_cloud(scene.depth, camera, true)).value(), 1 / camera.fy, 1e-3 / camera.fy);
}

TEST(AngularSpacing, NeedsTwoDirections) {
  PointCloud cloud;
  EXPECT_FALSE(angular_spacing_rad(cloud).has_value());
  cloud.points = {{1, 2, 600}, {1, 2, -600}};
  EXPECT_FALSE(angular_spacing_rad(cloud).has_value());
  cloud.points = {{0, 0, 600}, {0, 0, 700}};
  EXPECT_FALSE(angular_spacing_rad(cloud).has_value());
}

TEST(PixelGrid, IsThatOfTheCamera) {
  const Intrinsics camera{200, 150, 613.7, 598.2, 101.3, 72.9};
  DepthImage depth(200, 150);
  Random random(3);
  for (int v = 30; v < 110; ++v)
    for (int u = 40; u < 170; ++u)
      if (random.uniform() < 0.8) depth.at(u, v) = static_cast<float>(500 + 0.3 * u + 4 * random.uniform());
  const PointCloud cloud = to_point_cloud(depth, camera);
  const auto grid = pixel_grid_of(cloud);
  ASSERT_TRUE(grid.has_value());
  EXPECT_NEAR(grid->fx, camera.fx, 0.05);
  EXPECT_NEAR(grid->fy, camera.fy, 0.05);
  // Each point has a pixel of its own, where it was.
  const DepthImage again = to_depth_image(cloud, *grid);
  EXPECT_EQ(std::count_if(again.z_mm.begin(), again.z_mm.end(), [](float z) { return z > 0; }),
            static_cast<std::ptrdiff_t>(cloud.size()));
}

TEST(PixelGrid, ScatteredPointsHaveNone) {
  Random random(4);
  PointCloud cloud;
  for (int i = 0; i < 3000; ++i)
    cloud.points.emplace_back(100 * random.uniform() - 50, 80 * random.uniform() - 40, 500 + 20 * random.uniform());
  EXPECT_FALSE(pixel_grid_of(cloud).has_value());
  EXPECT_FALSE(pixel_grid_of({}).has_value());
}

}  // namespace
}  // namespace partpose
