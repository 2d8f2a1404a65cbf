// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/frame_pieces.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/engine/object_points.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

/// A table at 700 mm, seen at a slant, with boxes on it.
class FramePiecesTest : public testing::Test {
 protected:
  FramePiecesTest() : depth(640, 480) {
    tilt.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
    tilt.translation() = Eigen::Vector3d(0, 0, 700);
    put(shapes::box(Eigen::Vector3f(900, 900, 2)), {0, 0, 0});
  }
  void put(const TriangleMesh& mesh, const Eigen::Vector3d& on_table) {
    Eigen::Isometry3d pose = tilt;
    pose.translation() += tilt.linear() * on_table;
    const DepthImage drawn = render(mesh, pose, camera).depth;
    for (std::size_t p = 0; p < depth.z_mm.size(); ++p)
      if (drawn.z_mm[p] > 0 && (depth.z_mm[p] == 0 || drawn.z_mm[p] < depth.z_mm[p])) depth.z_mm[p] = drawn.z_mm[p];
  }
  void add_noise(double sigma_mm) {
    Random random(5);
    for (float& z : depth.z_mm)
      if (z > 0) z += static_cast<float>(sigma_mm * random.normal_pair().first);
  }
  FramePieces split() const { return split_frame(depth, camera, {.largest_part_mm = 150, .smallest_part_mm = 30}); }

  const Intrinsics camera{640, 480, 615, 615, 319.5, 239.5};
  Eigen::Isometry3d tilt = Eigen::Isometry3d::Identity();
  DepthImage depth;
};

TEST_F(FramePiecesTest, FindsWhatStandsOnTheTable) {
  put(shapes::box(Eigen::Vector3f(60, 40, 30)), {-90, 0, -16});
  put(shapes::box(Eigen::Vector3f(50, 50, 30)), {90, 20, -16});
  add_noise(0.8);
  const FramePieces frame = split();
  ASSERT_TRUE(frame.table.has_value());
  EXPECT_NEAR(frame.table->rms_mm, 0.8 * std::cos(0.5), 0.25);
  ASSERT_EQ(frame.objects.size(), 2u);
  for (const auto& object : frame.objects) {
    EXPECT_GT(object.pixels, 1500);
    EXPECT_FALSE(object.whole_frame);
    // Nearly all of the box around each is its own.
    EXPECT_GT(object.pixels, 0.6 * (object.u1 - object.u0 + 1) * (object.v1 - object.v0 + 1));
  }
}

/// One plane holds most of what is seen of them.
TEST_F(FramePiecesTest, PartsSideBySideAreNoTable) {
  for (const double x : {-99.0, 0.0, 99.0}) put(shapes::box(Eigen::Vector3f(100, 60, 20)), {x, 0, -11});
  add_noise(0.8);
  const FramePieces frame = split();
  ASSERT_EQ(frame.objects.size(), 1u);
  EXPECT_TRUE(frame.objects[0].larger_than_a_part);
  EXPECT_GT(frame.objects[0].pixels, 10'000);
}

TEST_F(FramePiecesTest, AnEmptyTableHasNoObjects) {
  add_noise(0.8);
  EXPECT_TRUE(split().objects.empty());
}

TEST_F(FramePiecesTest, ABentTableIsStillATable) {
  put(shapes::box(Eigen::Vector3f(60, 40, 12)), {0, 0, -7});
  for (int v = 0; v < depth.height; ++v)
    for (int u = 0; u < depth.width; ++u)  // 12 mm from edge to middle, as a camera's lens may bend it
      if (depth.at(u, v) > 0) depth.at(u, v) += static_cast<float>(12 * std::pow((u - 320.0) / 320.0, 2));
  add_noise(0.8);
  const FramePieces frame = split();
  ASSERT_TRUE(frame.table.has_value());
  EXPECT_LT(frame.table->rms_mm, 1.2);
  ASSERT_EQ(frame.objects.size(), 1u);
  EXPECT_GT(frame.objects[0].pixels, 1500);
}

TEST_F(FramePiecesTest, APartAloneIsTheWholeFrame) {
  std::fill(depth.z_mm.begin(), depth.z_mm.end(), 0.0f);
  put(shapes::box(Eigen::Vector3f(60, 40, 30)), {0, 0, 0});
  const FramePieces frame = split();
  ASSERT_FALSE(frame.objects.empty());
  EXPECT_TRUE(frame.objects[0].whole_frame);
}

TEST_F(FramePiecesTest, TheWindowKeepsPlaceAndLabels) {
  put(shapes::box(Eigen::Vector3f(60, 40, 30)), {0, 0, -16});
  const FramePieces frame = split();
  ASSERT_EQ(frame.objects.size(), 1u);
  const FrameObject& object = frame.objects[0];
  const FrameWindow part = window(frame, object, object.u0 - 7, object.v0 - 3, object.u1 + 5, object.v1 + 9, 2);
  for (int v = 0; v < part.depth.height; ++v)
    for (int u = 0; u < part.depth.width; ++u) {
      const int full_u = object.u0 - 7 + 2 * u, full_v = object.v0 - 3 + 2 * v;
      EXPECT_EQ(part.depth.at(u, v), depth.at(full_u, full_v));
      const std::size_t p = static_cast<std::size_t>(v) * part.depth.width + u;
      EXPECT_EQ(part.label[p] == PixelLabel::object,
                object.labels.test(frame.label[static_cast<std::size_t>(full_v) * depth.width + full_u]));
      if (part.label[p] == PixelLabel::background) {
        EXPECT_NEAR(part.before_table_mm[p], 0, 3.5);
      }
      EXPECT_TRUE(part.camera.unproject(u, v, 700).isApprox(camera.unproject(full_u, full_v, 700), 1e-5f));
    }
}

TEST_F(FramePiecesTest, LocalNoiseIsThatOfNeighbouringPixels) {
  put(shapes::box(Eigen::Vector3f(100, 100, 40)), {0, 0, -21});
  add_noise(1.5);
  const FramePieces frame = split();
  ASSERT_FALSE(frame.objects.empty());
  EXPECT_NEAR(local_noise_mm(frame, frame.objects[0]), 1.5, 0.2);
}

TEST_F(FramePiecesTest, LocalNoiseOfSlenderObjectsIsThatOfSmallerWindows) {
  put(shapes::box(Eigen::Vector3f(4, 120, 40)), {0, 0, -21});
  add_noise(1.5);
  const FramePieces frame = split();
  ASSERT_FALSE(frame.objects.empty());
  const FrameObject& slender = frame.objects[0];
  EXPECT_LT(slender.u1 - slender.u0, 4);
  EXPECT_NEAR(local_noise_mm(frame, slender), 1.5, 0.3);
}

TEST_F(FramePiecesTest, ForegroundGrowsWhereNeighboursErrTogether) {
  put(shapes::box(Eigen::Vector3f(100, 100, 40)), {0, 0, -21});
  const DepthImage clean = depth;
  add_noise(1.5);
  const FramePieces independent = split();
  ASSERT_FALSE(independent.objects.empty());
  EXPECT_NEAR(neighbour_correlation(independent, independent.objects[0]).value(), 0, 0.06);
  EXPECT_EQ(independent.foreground_growth_px, 0);
  // The mean of three pixels in a row, as a matched window gives.
  const DepthImage noisy = depth;
  for (int v = 0; v < depth.height; ++v)
    for (int u = 1; u + 1 < depth.width; ++u) {
      float noise = 0;
      for (int du = -1; du <= 1; ++du) noise += (noisy.at(u + du, v) - clean.at(u + du, v)) / 3;
      depth.z_mm[static_cast<std::size_t>(v) * depth.width + u] = clean.at(u, v) + noise;
    }
  const FramePieces stereo = split();
  ASSERT_FALSE(stereo.objects.empty());
  EXPECT_GT(neighbour_correlation(stereo, stereo.objects[0]).value(), 0.2);
  EXPECT_GT(stereo.foreground_growth_px, 0);
  // What may have grown is not among the points.
  EXPECT_LT(object_points(stereo, stereo.objects[0], 2000).points_mm.size(),
            0.97 * object_points(independent, independent.objects[0], 2000).points_mm.size());
}

TEST_F(FramePiecesTest, PointsAreMeansOfBlocks) {
  put(shapes::box(Eigen::Vector3f(100, 100, 40)), {0, 0, -21});
  const FramePieces frame = split();
  ASSERT_FALSE(frame.objects.empty());
  const ObjectPoints points = object_points(frame, frame.objects[0], 500);
  EXPECT_GT(points.block_px, 1);
  EXPECT_GT(points.points_mm.size(), 350u);
  EXPECT_LT(points.points_mm.size(), 900u);
}

TEST(FramePieces, NothingIsNothing) {
  const DepthImage nothing(64, 48);
  EXPECT_TRUE(split_frame(nothing, {64, 48, 60, 60, 31.5, 23.5}, {}).objects.empty());
}

TEST(FindShadows, WhatIsNearerHidesWhatIsNotMeasuredBesideIt) {
  DepthImage depth(40, 1);
  std::fill(depth.z_mm.begin(), depth.z_mm.end(), 600.0f);
  for (int u = 20; u < 30; ++u) depth.z_mm[u] = 500;
  for (int u = 14; u < 20; ++u) depth.z_mm[u] = 0;  // beside the step
  for (int u = 34; u < 37; ++u) depth.z_mm[u] = 0;  // a hole in a flat surface
  FramePieces frame;
  frame.depth = &depth;
  for (const float z : depth.z_mm) frame.label.push_back(z > 0 ? FramePieces::background : FramePieces::not_measured);
  find_shadows(frame);
  for (int u = 0; u < 40; ++u) EXPECT_EQ(frame.shadow_of[u], u >= 14 && u < 20 ? 20 : -1) << u;
}

TEST(FindShadows, AShadowIsAsWideAsTheDisparityJumps) {
  for (const int gap : {70, 100}) {  // the disparity of 300 mm is 55 px more than that of 600 mm
    DepthImage depth(200, 1);
    for (int u = 0; u < 200; ++u) depth.z_mm[u] = u < 50 ? 600.0f : u < 50 + gap ? 0.0f : 300.0f;
    FramePieces frame;
    frame.depth = &depth;
    frame.camera.fx = 600;
    for (const float z : depth.z_mm) frame.label.push_back(z > 0 ? FramePieces::background : FramePieces::not_measured);
    find_shadows(frame);
    EXPECT_EQ(frame.shadow_of[60], gap == 70 ? 50 + gap : -1);
  }
}

}  // namespace
}  // namespace partpose
