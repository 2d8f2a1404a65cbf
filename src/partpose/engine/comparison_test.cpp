// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/comparison.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace partpose {
namespace {

DepthComparison compare_depth(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                              const FrameWindow& frame, const SensorModel& sensor) {
  const Eigen::AlignedBox2d all(Eigen::Vector2d::Zero(), Eigen::Vector2d(frame.depth.width, frame.depth.height));
  return DepthComparer(frame, sensor)(mesh, camera_from_model, all);
}

/// A box of 60 x 40 x 20 mm, its face 490 mm before the camera, on a table at 510 mm.
class Comparison : public testing::Test {
 protected:
  Comparison() {
    pose.translation() = Eigen::Vector3d(0, 0, 500);
    frame.camera = {.width = 120, .height = 100, .fx = 500, .fy = 500, .cx = 59.5, .cy = 49.5};
    frame.depth = render(mesh, pose, frame.camera).depth;
    for (float& z : frame.depth.z_mm) {
      frame.label.push_back(z > 0 ? PixelLabel::object : PixelLabel::background);
      if (!(z > 0)) z = 510;
    }
  }
  DepthComparison at(double x, double z) const {
    Eigen::Isometry3d moved = pose;
    moved.translation() += Eigen::Vector3d(x, 0, z);
    return compare_depth(mesh, moved, frame, {.noise_mm = 0.5});
  }
  /// The box with a ridge along the middle of its face, 3 mm wide.
  TriangleMesh ridged(float height_mm) const {
    TriangleMesh out = mesh;
    const TriangleMesh ridge = shapes::box(Eigen::Vector3f(60, 3, height_mm));
    const int before = static_cast<int>(mesh.vertices.size());
    for (const auto& corner : ridge.vertices)
      out.vertices.push_back(corner - Eigen::Vector3f(0, 0, 10 + 0.5f * height_mm));
    for (const auto& [a, b, c] : ridge.triangles) out.triangles.push_back({a + before, b + before, c + before});
    return out;
  }
  /// What the camera sees of `shown` where the box lies, compared with the mesh.
  DepthComparison closer_look(const TriangleMesh& shown, const TriangleMesh& compared) const {
    FrameWindow measured = frame;
    const DepthImage depth = render(shown, pose, frame.camera).depth;
    for (std::size_t p = 0; p < depth.z_mm.size(); ++p)
      if (depth.z_mm[p] > 0) measured.depth.z_mm[p] = depth.z_mm[p];
    return compare_depth(compared, pose, measured, {.noise_mm = 0.5, .waves_px = 8, .edge_mm = 5});
  }
  TriangleMesh mesh = shapes::box(Eigen::Vector3f(60, 40, 20));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  FrameWindow frame;
};

TEST_F(Comparison, TheTruthExplainsAll) {
  const DepthComparison c = at(0, 0);
  EXPECT_NEAR(c.score(), 1, 1e-9);
  EXPECT_EQ(c.model, c.object);
  EXPECT_EQ(c.explained, c.model);
  EXPECT_EQ(c.unexplained + c.free_space + c.hidden + c.nothing, 0);
  // But for what might have grown over the table beside it.
  EXPECT_NEAR(c.log_likelihood, c.best_log_likelihood, 0.01 * c.best_log_likelihood);
}

TEST_F(Comparison, CountsHowFarDepthsAreOff) {
  const DepthComparison truth = at(0, 0);
  EXPECT_EQ(truth.near, truth.model);
  EXPECT_NEAR(truth.near_deviations, 0, 1e-6);
  EXPECT_NEAR(at(0, 1).near_deviations, 4 * truth.model, 0.2 * truth.model);  // two deviations each
}

TEST_F(Comparison, SlowWavesAreNoLocalDeviations) {
  const SensorModel sensor{.noise_mm = 0.5, .waves_px = 4};
  const auto with_error = [&](auto error_mm) {
    FrameWindow measured = frame;
    for (int v = 0; v < measured.depth.height; ++v)
      for (int u = 0; u < measured.depth.width; ++u)
        measured.depth.z_mm[static_cast<std::size_t>(v) * measured.depth.width + u] += error_mm(u, v);
    return compare_depth(mesh, pose, measured, sensor);
  };
  const DepthComparison slow = with_error([](int u, int) { return 0.5f * std::sin(0.05f * static_cast<float>(u)); });
  const DepthComparison quick = with_error([](int u, int v) { return (u + v) % 2 ? 0.35f : -0.35f; });
  EXPECT_NEAR(slow.log_likelihood, quick.log_likelihood, 0.05 * quick.log_likelihood);
  EXPECT_LT(slow.local_deviations, 0.02 * slow.object);
  EXPECT_GT(quick.local_deviations, 0.4 * quick.object);
}

TEST_F(Comparison, FineShapeTellsARidgeFromNone) {
  const TriangleMesh with_ridge = ridged(1);
  const FineShape both = closer_look(with_ridge, with_ridge).fine_shape;
  EXPECT_GT(both.pixels, 1000);
  EXPECT_NEAR(both.correlation(), 1, 1e-3);
  EXPECT_GT(both.gain(), 0.5);
  EXPECT_LT(both.gain(), 1);
  const FineShape only_part = closer_look(mesh, with_ridge).fine_shape;
  EXPECT_LT(only_part.correlation(), 0.2);
  EXPECT_LT(only_part.gain(), 0.1);
  EXPECT_LT(closer_look(with_ridge, mesh).fine_shape.correlation(), 0.2);
  EXPECT_EQ(FineShape().correlation(), 0);
  EXPECT_EQ(FineShape().gain(), 0);
}

TEST_F(Comparison, CountsJumpsInDepthThatBothHave) {
  const TriangleMesh with_ridge = ridged(8);
  const DepthComparison both = closer_look(with_ridge, with_ridge);
  EXPECT_GT(both.jumps, 200);  // both sides of 60 mm, at about a pixel a millimetre, in either
  EXPECT_EQ(both.common_jumps, both.jumps);
  const DepthComparison only_part = closer_look(mesh, with_ridge), only_object = closer_look(with_ridge, mesh);
  for (const auto& one : {only_part, only_object}) {
    EXPECT_NEAR(one.jumps, both.jumps / 2, 0.1 * both.jumps);
    EXPECT_EQ(one.common_jumps, 0);
  }
  EXPECT_EQ(closer_look(ridged(2), with_ridge).common_jumps, 0);                                // too low for an edge
  EXPECT_EQ(compare_depth(with_ridge, pose, frame, {.noise_mm = 0.5, .edge_mm = 5}).jumps, 0);  // not asked
}

TEST_F(Comparison, CountsWhereThePartIsWiderThanTheObject) {
  EXPECT_EQ(at(0, 0).narrower, 0);
  const DepthComparison wider = compare_depth(shapes::box(Eigen::Vector3f(62, 42, 20)), pose, frame, {.noise_mm = 0.5});
  EXPECT_GT(wider.narrower, 100);
  EXPECT_EQ(wider.narrower, wider.model_outline);
  EXPECT_EQ(wider.shown(), wider.model);
}

TEST_F(Comparison, AMatchedWindowAveragesSurfaces) {
  // Of a ridge 3 mm wide, seen 3 pixels wide, a window of 7 x 7 pixels makes 0.9 of its 2 mm.
  const TriangleMesh with_ridge = ridged(2);
  const DepthImage seen = render(with_ridge, pose, frame.camera).depth;
  for (int v = 3; v + 3 < seen.height; ++v)
    for (int u = 0; u < seen.width; ++u) {
      if (!(seen.at(u, v) > 0)) continue;
      float sum = 0;
      for (int k = -3; k <= 3; ++k) sum += seen.at(u, v + k) > 0 ? seen.at(u, v + k) : 490.0f;
      frame.depth.z_mm[static_cast<std::size_t>(v) * seen.width + u] = sum / 7;
    }
  SensorModel sensor{.noise_mm = 0.3, .outline_px = 1, .edge_mm = 5};
  const auto gain = [&] {
    const DepthComparison c = compare_depth(with_ridge, pose, frame, sensor);
    return c.log_likelihood / c.best_log_likelihood;
  };
  const double each_for_itself = gain();
  sensor.growth_px = 3;
  EXPECT_GT(gain(), each_for_itself + 0.05);
}

TEST_F(Comparison, CountsBothDirections) {
  const DepthComparison aside = at(12, 0);  // 12 mm are about 12 columns
  EXPECT_GT(aside.free_space, 400);
  EXPECT_GT(aside.unexplained, 300);
  EXPECT_LT(aside.score(), at(0, 0).score() - 0.15);
  EXPECT_LT(aside.log_likelihood, at(0, 0).log_likelihood);
}

TEST_F(Comparison, BeyondTheNoiseNothingIsExplained) {
  EXPECT_GT(at(0, 0.5).score(), 0.85);
  EXPECT_EQ(at(0, -2).explained, 0);
  EXPECT_LT(at(0, -2).score(), 0.01);
}

TEST_F(Comparison, PixelsThatThePartDoesNotCoverChangeNothing) {
  const DepthComparer compare(frame, {.noise_mm = 0.5, .outline_px = 2});
  Eigen::Isometry3d moved = pose;
  moved.translation().x() += 8;
  const DepthComparison whole =
      compare(mesh, moved, Eigen::AlignedBox2d(Eigen::Vector2d(0, 0), Eigen::Vector2d(119, 99)));
  const DepthComparison some =
      compare(mesh, moved, Eigen::AlignedBox2d(Eigen::Vector2d(20, 20), Eigen::Vector2d(110, 80)));
  EXPECT_EQ(some.model, whole.model);
  EXPECT_EQ(some.model_outline, whole.model_outline);
  EXPECT_EQ(some.free_space, whole.free_space);
  EXPECT_EQ(some.log_likelihood, whole.log_likelihood);
  EXPECT_EQ(some.score(), whole.score());
}

TEST(PaddedDepth, FindsTheNearestDepthWithinReach) {
  Random random(1);
  for (const int reach : {1, 2, 3, 5}) {
    DepthImage plain(11, 9);
    PaddedDepth padded(11, 9, reach);
    for (int v = 0; v < 9; ++v)
      for (int u = 0; u < 11; ++u)
        if (random.below(4) == 0) plain.at(u, v) = padded.row(v)[u] = static_cast<float>(400 + random.below(100));
    for (int v = 0; v < 9; ++v)
      for (int u = 0; u < 11; ++u) {
        float smallest = std::numeric_limits<float>::infinity();
        for (int vv = std::max(v - reach, 0); vv <= std::min(v + reach, 8); ++vv)
          for (int uu = std::max(u - reach, 0); uu <= std::min(u + reach, 10); ++uu)
            if (plain.at(uu, vv) > 0) smallest = std::min(smallest, std::abs(450 - plain.at(uu, vv)));
        EXPECT_EQ(padded.smallest_difference(450, u, v), smallest) << reach << ": " << u << ", " << v;
      }
  }
}

TEST_F(Comparison, WhatIsBeforeThePartBesideItHidesIt) {
  // A plate 50 mm before the part covers its right third.
  int covered = 0;
  for (int v = 0; v < frame.depth.height; ++v)
    for (int u = 70; u < frame.depth.width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * frame.depth.width + u;
      covered += frame.label[p] == PixelLabel::object;
      frame.depth.z_mm[p] = 440;
      frame.label[p] = PixelLabel::background;
    }
  const DepthComparison c = compare_depth(mesh, pose, frame, {.noise_mm = 0.5, .outline_px = 3, .growth_px = 3});
  EXPECT_EQ(c.hidden, covered);
  EXPECT_EQ(c.model_outline, 0);
}

TEST_F(Comparison, HolesCostLessThanFreeSpace) {
  const double before = at(12, 0).score();
  for (std::size_t p = 0; p < frame.label.size(); ++p)
    if (frame.label[p] == PixelLabel::background) frame.label[p] = PixelLabel::nothing, frame.depth.z_mm[p] = 0;
  EXPECT_GT(at(12, 0).nothing, 400);
  EXPECT_GT(at(12, 0).score(), before + 0.02);
}

TEST_F(Comparison, AGrownOutlineSpeaksForThePartNotForALargerOne) {
  // What is in front has grown by three pixels on each side, as a stereo camera's does.
  const DepthImage exact = frame.depth;
  for (int v = 0; v < exact.height; ++v)
    for (int u = 0; u < exact.width; ++u)
      for (int dv = -3; dv <= 3; ++dv)
        for (int du = -3; du <= 3; ++du)
          if (u + du >= 0 && v + dv >= 0 && u + du < exact.width && v + dv < exact.height &&
              exact.at(u + du, v + dv) < 500) {
            const std::size_t p = static_cast<std::size_t>(v) * exact.width + u;
            frame.depth.z_mm[p] = 490;
            frame.label[p] = PixelLabel::object;
          }
  const SensorModel stereo{.noise_mm = 0.5, .outline_px = 3, .growth_px = 3};
  const TriangleMesh larger = shapes::box(Eigen::Vector3f(65, 45, 20));
  EXPECT_GT(compare_depth(mesh, pose, frame, stereo).log_likelihood,
            compare_depth(larger, pose, frame, stereo).log_likelihood + 200);
  const SensorModel exact_outlines{.noise_mm = 0.5, .outline_px = 3};
  EXPECT_LT(compare_depth(mesh, pose, frame, exact_outlines).log_likelihood,
            compare_depth(larger, pose, frame, exact_outlines).log_likelihood);
}

}  // namespace
}  // namespace partpose
