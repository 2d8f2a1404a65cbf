// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/segment_view.hpp"

#include "partpose/core/random.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

const Intrinsics camera{.width = 100, .height = 80, .fx = 100, .fy = 100, .cx = 49.5, .cy = 39.5};

Segment rectangle(int u0, int v0, int u1, int v1) {
  Segment segment;
  for (int v = v0; v <= v1; ++v)
    for (int u = u0; u <= u1; ++u) segment.pixels.push_back(v * camera.width + u);
  return segment;
}

TEST(SegmentView, LocalNoiseIsThatOfASlantedPlane) {
  Random random(5);
  DepthImage depth(camera.width, camera.height);
  for (int v = 0; v < depth.height; ++v)
    for (int u = 0; u < depth.width; ++u)
      depth.at(u, v) = static_cast<float>(500 + 0.7 * u - 0.4 * v + 1.5 * random.normal_pair().first);
  EXPECT_NEAR(local_noise_mm(depth, rectangle(10, 10, 80, 70)), 1.5, 0.15);
  EXPECT_EQ(local_noise_mm(depth, rectangle(10, 10, 12, 70)), 0);  // too narrow for a window
}

TEST(SegmentView, TheNeighbourhoodKeepsPlaceAndLabels) {
  DepthImage depth(camera.width, camera.height);
  for (int i = 0; i < 8000; ++i) depth.z_mm[i] = 500 + i % 100;
  const Segment segment = rectangle(2, 30, 41, 49);  // 800 pixels, near the frame's edge
  const LabelledDepth view = neighbourhood(depth, camera, segment, 50, 200);
  EXPECT_NEAR(view.camera.fx, 50, 1e-9);
  int objects = 0;
  for (int v = 0; v < view.depth.height; ++v)
    for (int u = 0; u < view.depth.width; ++u) {
      const auto label = view.label[static_cast<std::size_t>(v) * view.depth.width + u];
      if (label == PixelLabel::nothing) continue;
      const Eigen::Vector2d full = camera.project(view.camera.unproject(u, v, view.depth.at(u, v)).cast<double>());
      EXPECT_NEAR(view.depth.at(u, v), 500 + full.x(), 1e-2);
      const bool inside = full.x() > 1.5 && full.x() < 41.5 && full.y() > 29.5 && full.y() < 49.5;
      EXPECT_EQ(label == PixelLabel::object, inside);
      objects += inside;
    }
  EXPECT_EQ(objects, 200);
  EXPECT_EQ(object_points(view).size(), 200u);
}

TEST(SegmentView, PiecesThatNearlyTouchArePairedOnce) {
  DepthImage depth(camera.width, camera.height);
  for (float& z : depth.z_mm) z = 500;
  const std::vector<Segment> apart = {rectangle(0, 0, 19, 19), rectangle(60, 0, 79, 19)};
  EXPECT_EQ(with_pairs(apart, depth, camera, 1000, 4).size(), 2u);
  const std::vector<Segment> near = {rectangle(0, 0, 19, 19), rectangle(23, 0, 42, 19)};
  const auto paired = with_pairs(near, depth, camera, 1000, 4);
  ASSERT_EQ(paired.size(), 3u);
  EXPECT_EQ(paired[2].pixels.size(), 800u);
  EXPECT_EQ(with_pairs(paired, depth, camera, 1000, 4).size(), 3u);
  EXPECT_EQ(with_pairs(near, depth, camera, 150, 4).size(), 2u);  // 43 px are 215 mm wide
  EXPECT_EQ(with_pairs(near, depth, camera, 1000, 0).size(), 2u);
}

TEST(SegmentView, CroppedIsTheSameFrame) {
  DepthImage depth(camera.width, camera.height);
  for (int i = 0; i < 8000; ++i) depth.z_mm[i] = 500 + i;
  LabelledDepth frame{camera, depth, std::vector<PixelLabel>(8000, PixelLabel::background)};
  const LabelledDepth part = cropped(frame, 10, 20, 200, 39);
  EXPECT_EQ(part.depth.width, 90);
  EXPECT_EQ(part.depth.height, 20);
  EXPECT_EQ(part.depth.at(3, 4), depth.at(13, 24));
  EXPECT_TRUE(part.camera.unproject(3, 4, 700).isApprox(camera.unproject(13, 24, 700)));
}

}  // namespace
}  // namespace partpose
