// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/stereo_sensor.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/core/parallel.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

const Intrinsics vga = Intrinsics::from_field_of_view(640, 480, 50, 40);

/// Every disturbance off.
StereoSensorOptions ideal() {
  StereoSensorOptions o;
  o.disparity_noise_px = o.subpixel_wave_px = o.static_pattern_percent = o.fattening_px = o.fattening_jitter_px = 0;
  o.mixed_pixel_probability = o.edge_loss_probability = o.disparity_step_px = o.depth_step_mm = 0;
  o.smoothing_px = o.edge_loss_px = 0;
  o.invalid_band = o.occlusion_shadow = false;
  o.grazing_drop_deg = {90, 90};
  return o;
}

Eigen::Isometry3d wall_pose(double z_mm, double tilt_deg) {
  return Eigen::Translation3d(0, 0, z_mm) *
         Eigen::Isometry3d(Eigen::AngleAxisd(radians(tilt_deg), Eigen::Vector3d(1, 2, 0).normalized()));
}
DepthImage wall(double z_mm, double tilt_deg = 0) {
  return render(plane_patch(9000, 9000), wall_pose(z_mm, tilt_deg), vga).depth;
}
DepthRenderer renderer(const TriangleMesh& mesh, const Eigen::Isometry3d& left_from_model) {
  return [=](const Eigen::Isometry3d& camera_from_left) {
    return render(mesh, camera_from_left * left_from_model, vga).depth;
  };
}
/// A plate of 120 x 90 mm at `front_mm` before a wall at `back_mm`.
TriangleMesh plate_before_wall(double front_mm, double back_mm) {
  return joined(moved(plane_patch(120, 90), Eigen::Isometry3d(Eigen::Translation3d(0, 0, front_mm))),
                moved(plane_patch(9000, 9000), Eigen::Isometry3d(Eigen::Translation3d(0, 0, back_mm))));
}

double disparity(double z_mm, const StereoSensorOptions& o) { return vga.fx * o.baseline_mm / z_mm; }

/// Measured minus ideal disparity, of the measured pixels; 0 elsewhere.
std::vector<double> disparity_errors(const DepthImage& measured, const DepthImage& truth,
                                     const StereoSensorOptions& o) {
  std::vector<double> errors;
  for (std::size_t p = 0; p < truth.z_mm.size(); ++p)
    errors.push_back(measured.z_mm[p] > 0 ? disparity(measured.z_mm[p], o) - disparity(truth.z_mm[p], o) : 0.0);
  return errors;
}
double covariance(const std::vector<double>& errors, int lag_u, int lag_v) {
  double sum = 0;
  int count = 0;
  for (int v = 0; v + lag_v < vga.height; ++v)
    for (int u = 0; u + lag_u < vga.width; ++u, ++count)
      sum += errors[v * vga.width + u] * errors[(v + lag_v) * vga.width + u + lag_u];
  return sum / count;
}
double rms_mm(const DepthImage& measured, const DepthImage& truth) {
  double sum = 0, count = 0;
  for (std::size_t p = 0; p < truth.z_mm.size(); ++p)
    if (measured.z_mm[p] > 0) {
      sum += std::pow(measured.z_mm[p] - truth.z_mm[p], 2);
      ++count;
    }
  return std::sqrt(sum / count);
}

TEST(StereoSensor, WithoutDisturbancesGivesTheIdealDepthBack) {
  Random random(3);
  const auto truth = render(l_bracket(), random_pose(random, {10, -20, 500}), vga).depth;
  const auto capture = stereo_capture(truth, {}, vga, ideal(), 1);
  for (std::size_t p = 0; p < truth.z_mm.size(); ++p) {
    EXPECT_NEAR(capture.depth.z_mm[p], truth.z_mm[p], 1e-3);
    EXPECT_EQ(capture.surface_pixel[p], truth.z_mm[p] > 0 ? static_cast<int>(p) : -1);
  }
}

TEST(StereoSensor, NoiseGrowsWithTheSquareOfTheDistance) {
  auto o = ideal();
  o.disparity_noise_px = 0.08;
  for (const double z : {500.0, 700.0, 1000.0}) {
    const auto truth = wall(z);
    const double closed_form = z * z * 0.08 / (vga.fx * 55);
    EXPECT_NEAR(predicted_depth_noise_mm(o, vga, z), closed_form, 1e-9);
    EXPECT_NEAR(rms_mm(stereo_capture(truth, {}, vga, o, 1).depth, truth), closed_form, 0.04 * closed_form);
  }
  EXPECT_NEAR(predicted_depth_noise_mm(o, vga, 700), 1.04, 0.005) << "facts: VGA, 0.08 px, 0.70 m";
}

TEST(StereoSensor, NoiseWavesAndStepsAddUp) {
  StereoSensorOptions o;
  o.static_pattern_percent = 0;
  const auto truth = wall(700, 5);  // tilted, so that the disparity passes through many pixels
  const double predicted = predicted_depth_noise_mm(o, vga, 700);
  EXPECT_NEAR(rms_mm(stereo_capture(truth, {}, vga, o, 1).depth, truth), predicted, 0.05 * predicted);
  EXPECT_NEAR(predicted, std::sqrt(1.0394 * 1.0394 * (1 + (0.0008 + 0.0000814) / 0.0064) + 1.0 / 12), 0.002);
}

TEST(StereoSensor, NoiseHasTheCorrelationAskedFor) {
  const auto truth = wall(700);
  for (const double length : {0.0, 2.0, 5.0, 10.0}) {
    auto o = ideal();
    o.disparity_noise_px = 0.1;
    o.correlation_px = length;
    o.white_share = 0.2;
    const auto errors = disparity_errors(stereo_capture(truth, {}, vga, o, 2).depth, truth, o);
    const double tolerance = length > 5 ? 0.06 : 0.04;
    EXPECT_NEAR(covariance(errors, 0, 0) / 0.01, 1, tolerance);
    for (const int lag : {1, 2, 3, 5, 8, 12}) {
      const double expected = length > 0 ? 0.8 * std::exp(-lag * lag / (length * length)) : 0;
      EXPECT_NEAR(covariance(errors, lag, 0) / 0.01, expected, tolerance) << length << " px, lag " << lag;
      EXPECT_NEAR(covariance(errors, 0, lag) / 0.01, expected, tolerance) << length << " px, lag " << lag;
    }
  }
}

TEST(StereoSensor, FrozenShareIsTheSameInEachFrame) {
  const auto truth = wall(700);
  auto o = ideal();
  o.disparity_noise_px = 0.1;
  o.white_share = 0;
  o.frozen_share = 0.6;
  const auto a = disparity_errors(stereo_capture(truth, {}, vga, o, 1).depth, truth, o);
  const auto b = disparity_errors(stereo_capture(truth, {}, vga, o, 2).depth, truth, o);
  double shared = 0;
  for (std::size_t p = 0; p < a.size(); ++p) shared += a[p] * b[p] / static_cast<double>(a.size());
  EXPECT_NEAR(shared / 0.01, 0.6, 0.06);
}

TEST(StereoSensor, WavesRepeatWithEachPixelOfDisparity) {
  auto o = ideal();
  o.subpixel_wave_px = 0.05;
  for (const double fraction : {0.0, 0.25, 0.5, 0.75}) {
    const auto truth = wall(disparity(1, o) / (40 + fraction));
    const auto errors = disparity_errors(stereo_capture(truth, {}, vga, o, 1).depth, truth, o);
    EXPECT_NEAR(errors[1000], 0.05 * std::sin(2 * std::numbers::pi * fraction), 1e-4);
  }
}

TEST(StereoSensor, InvalidBandIsAsWideAsTheDisparity) {
  auto o = ideal();
  o.invalid_band = true;
  for (const double z : {400.0, 700.0, 1500.0}) {
    const auto depth = stereo_capture(wall(z), {}, vga, o, 1).depth;
    const int first_seen = static_cast<int>(std::ceil(disparity(z, o) - 1e-3));
    for (int u = 0; u < vga.width; ++u) EXPECT_EQ(depth.at(u, 200) > 0, u >= first_seen) << u;
  }
}

TEST(StereoSensor, ShadowLiesLeftOfTheForegroundAndIsAsWideAsTheDisparitiesDiffer) {
  auto o = ideal();
  o.occlusion_shadow = true;
  const auto scene = renderer(plate_before_wall(500, 800), Eigen::Isometry3d::Identity());
  const auto truth = scene(Eigen::Isometry3d::Identity());
  const auto depth = stereo_capture(scene, vga, o, 1).depth;
  const int row = 240;
  int left = 0, right = vga.width - 1, missing_left = 0, missing_right = 0;
  while (truth.at(left, row) > 600) ++left;
  while (truth.at(right, row) > 600) --right;
  for (int u = 0; u < vga.width; ++u) {
    if (depth.at(u, row) > 0) continue;
    EXPECT_LT(u, left) << "the shadow is background";
    ++(u < left ? missing_left : missing_right);
  }
  EXPECT_NEAR(missing_left, disparity(500, o) - disparity(800, o), 1.5);
  EXPECT_EQ(missing_right, 0);
  for (int u = left - missing_left; u < left; ++u) EXPECT_EQ(depth.at(u, row), 0);
}

TEST(StereoSensor, ForegroundGrowsByTheFattening) {
  for (const int pixels : {0, 2, 5}) {
    auto o = ideal();
    o.fattening_px = pixels;
    for (const bool background : {true, false}) {
      const auto mesh = background ? plate_before_wall(500, 800)
                                   : moved(plane_patch(120, 90), Eigen::Isometry3d(Eigen::Translation3d(0, 0, 500)));
      const auto truth = render(mesh, Eigen::Isometry3d::Identity(), vga).depth;
      const auto capture = stereo_capture(truth, {}, vga, o, 1);
      const auto extent = [](const DepthImage& depth) {
        Eigen::AlignedBox2i box;
        for (int v = 0; v < depth.height; ++v)
          for (int u = 0; u < depth.width; ++u)
            if (depth.at(u, v) > 0 && depth.at(u, v) < 600) box.extend(Eigen::Vector2i(u, v));
        return box;
      };
      const auto before = extent(truth), after = extent(capture.depth);
      EXPECT_EQ(before.min() - after.min(), Eigen::Vector2i(pixels, pixels));
      EXPECT_EQ(after.max() - before.max(), Eigen::Vector2i(pixels, pixels));
      // What grew shows the plate's rim.
      const int source = capture.surface_pixel[after.min().y() * vga.width + after.min().x()];
      EXPECT_EQ(source, before.min().y() * vga.width + before.min().x());
    }
  }
}

TEST(StereoSensor, MatchingWindowLeavesPlanesAndEdgesAndRoundsCreases) {
  auto o = ideal();
  o.smoothing_px = 4;
  const auto plane = wall(700, 40);
  const auto same = stereo_capture(plane, {}, vga, o, 1).depth;
  for (std::size_t p = 0; p < plane.z_mm.size(); ++p) EXPECT_NEAR(same.z_mm[p], plane.z_mm[p], 0.01);

  const auto step = render(plate_before_wall(500, 800), Eigen::Isometry3d::Identity(), vga).depth;
  const auto step_seen = stereo_capture(step, {}, vga, o, 1).depth;
  for (std::size_t p = 0; p < step.z_mm.size(); ++p) EXPECT_NEAR(step_seen.z_mm[p], step.z_mm[p], 0.01);

  // A box's edge that points at the camera: the nearest line lies deeper, by less than the window's half width of
  // slope.
  const auto box_mesh = box(Eigen::Vector3f(100, 100, 100));
  Eigen::Isometry3d turned(Eigen::Translation3d(0, 0, 600));
  turned.rotate(Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::UnitY()));
  const auto crease = render(box_mesh, turned, vga).depth;
  const auto rounded = stereo_capture(crease, {}, vga, o, 1).depth;
  const float deeper = rounded.at(320, 240) - crease.at(320, 240);
  EXPECT_GT(deeper, 0.5);
  EXPECT_LT(deeper, 4 * 600 / vga.fx);
}

TEST(StereoSensor, MixedPixelsLieBetweenBothSides) {
  auto o = ideal();
  o.mixed_pixel_probability = 0.3;
  const auto truth = render(plate_before_wall(500, 800), Eigen::Isometry3d::Identity(), vga).depth;
  const auto depth = stereo_capture(truth, {}, vga, o, 1).depth;
  int mixed = 0, beside_edge = 0;
  for (int v = 1; v + 1 < vga.height; ++v)
    for (int u = 1; u + 1 < vga.width; ++u) {
      const bool edge = truth.at(u - 1, v) != truth.at(u, v) || truth.at(u + 1, v) != truth.at(u, v) ||
                        truth.at(u, v - 1) != truth.at(u, v) || truth.at(u, v + 1) != truth.at(u, v);
      beside_edge += edge;
      const bool between_both = depth.at(u, v) > 500.1 && depth.at(u, v) < 799.9;
      EXPECT_TRUE(edge || !between_both);
      mixed += between_both;
    }
  EXPECT_GT(beside_edge, 1000);
  EXPECT_NEAR(mixed, 0.3 * beside_edge, 4 * std::sqrt(0.21 * beside_edge));
}

TEST(StereoSensor, LossesHaveTheSharesAskedFor) {
  auto o = ideal();
  o.hole_share = 0.1;
  o.correlation_px = 3;
  const auto lost = [&](const DepthImage& truth) {
    const auto depth = stereo_capture(truth, {}, vga, o, 4).depth;
    return static_cast<double>(std::count(depth.z_mm.begin(), depth.z_mm.end(), 0.0f)) / depth.z_mm.size();
  };
  EXPECT_NEAR(lost(wall(700)), 0.1, 0.01);

  // Background beside an edge: a band of 4 px on each side of the plate is lost, wholly.
  o.hole_share = 0;
  o.edge_loss_px = 4;
  o.edge_loss_probability = 1;
  const auto step = render(plate_before_wall(500, 800), Eigen::Isometry3d::Identity(), vga).depth;
  const auto depth = stereo_capture(step, {}, vga, o, 4).depth;
  for (int u = 4; u + 4 < vga.width; ++u) {
    bool band = step.at(u, 240) > 600 && (step.at(u - 4, 240) < 600 || step.at(u + 4, 240) < 600);
    for (const int k : {1, 2, 3})
      band = band || (step.at(u, 240) > 600 && (step.at(u - k, 240) < 600 || step.at(u + k, 240) < 600));
    EXPECT_EQ(depth.at(u, 240) == 0, band) << u;
  }
}

TEST(StereoSensor, GrazingSurfacesAreDropped) {
  auto o = ideal();
  o.correlation_px = 2;
  o.grazing_drop_deg = {60, 80};
  // A wall turned about the vertical axis: on the axis the line of sight meets it at the angle it is turned by.
  for (const double turned_deg : {50.0, 70.0, 85.0}) {
    Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, 900));
    pose.rotate(Eigen::AngleAxisd(radians(turned_deg), Eigen::Vector3d::UnitX()));
    const auto truth = render(plane_patch(9000, 300), pose, vga).depth;
    const auto depth = stereo_capture(truth, {}, vga, o, 4).depth;
    double seen = 0, measured = 0;
    for (int v = 237; v < 243; ++v)
      for (int u = 300; u < 340; ++u) {
        seen += truth.at(u, v) > 0;
        measured += depth.at(u, v) > 0;
      }
    const double expected = turned_deg < 60 ? 1 : turned_deg > 80 ? 0 : 0.5;
    EXPECT_NEAR(measured / seen, expected, expected == 0.5 ? 0.25 : 0.01) << turned_deg;
  }
}

TEST(StereoSensor, TooNearIsMissing) {
  const auto o = ideal();
  const double nearest = disparity(1, o) / o.max_disparity_px;
  EXPECT_NEAR(nearest, 300, 1) << "facts: 0.30 m at VGA";
  EXPECT_EQ(stereo_capture(wall(nearest - 1), {}, vga, o, 1).depth.at(320, 240), 0);
  EXPECT_GT(stereo_capture(wall(nearest + 1), {}, vga, o, 1).depth.at(320, 240), 0);
}

TEST(StereoSensor, DisparityAndDepthAreQuantised) {
  auto o = ideal();
  o.disparity_noise_px = 0.1;
  o.disparity_step_px = 1.0 / 32;
  for (const float z : stereo_capture(wall(700), {}, vga, o, 1).depth.z_mm)
    EXPECT_NEAR(std::remainder(disparity(z, o), 1.0 / 32), 0, 1e-5);
  o.depth_step_mm = 0.5;
  for (const float z : stereo_capture(wall(700), {}, vga, o, 1).depth.z_mm) EXPECT_EQ(std::remainder(z, 0.5f), 0);
}

TEST(StereoSensor, StaticPatternIsTheUnitsOwn) {
  auto o = ideal();
  o.static_pattern_percent = 2;
  const auto pattern = static_pattern(640, 480, o);
  const auto [low, high] = std::minmax_element(pattern.begin(), pattern.end());
  EXPECT_NEAR(*high - *low, 0.02, 1e-4);
  double sum = 0, along_u = 0, along_v = 0, squares = 0;
  for (std::size_t p = 0; p < pattern.size(); ++p) {
    sum += pattern[p];
    along_u += pattern[p] * (static_cast<double>(p % 640) - 319.5);
    along_v += pattern[p] * (static_cast<double>(p / 640) - 239.5);
    squares += pattern[p] * pattern[p];
  }
  const double rms = std::sqrt(squares / pattern.size());
  EXPECT_NEAR(sum / pattern.size(), 0, 0.02 * rms) << "no mean error";
  EXPECT_NEAR(along_u / pattern.size() / 320, 0, 0.02 * rms) << "no tilt";
  EXPECT_NEAR(along_v / pattern.size() / 240, 0, 0.02 * rms);
  const auto truth = wall(700);
  const auto depth = stereo_capture(truth, {}, vga, o, 1).depth;
  for (std::size_t p = 0; p < pattern.size(); p += 101)
    EXPECT_NEAR(depth.z_mm[p] / truth.z_mm[p] - 1, pattern[p], 1e-6);
  EXPECT_TRUE(same_bits(depth.z_mm, stereo_capture(truth, {}, vga, o, 2).depth.z_mm)) << "the same in each frame";
  o.pattern_seed = 2;
  EXPECT_FALSE(same_bits(pattern, static_pattern(640, 480, o)));
}

TEST(StereoSensor, SameSeedSameBitsForAnyNumberOfThreads) {
  StereoSensorOptions o;
  o.frozen_share = 0.3;
  const auto scene = renderer(plate_before_wall(500, 800), wall_pose(0, 10));
  const auto many = stereo_capture(scene, vga, o, 9);
  const ThreadLimit one(1);
  const auto single = stereo_capture(scene, vga, o, 9);
  EXPECT_TRUE(same_bits(many.depth.z_mm, single.depth.z_mm));
  EXPECT_TRUE(same_bits(many.surface_pixel, single.surface_pixel));
  EXPECT_FALSE(same_bits(many.depth.z_mm, stereo_capture(scene, vga, o, 10).depth.z_mm));
}

TEST(StereoSensor, FarFromEdgesNoiseDoesNotDependOnWhatElseIsSeen) {
  const StereoSensorOptions o;
  const auto with =
      stereo_capture(renderer(plate_before_wall(500, 800), Eigen::Isometry3d::Identity()), vga, o, 3).depth;
  const auto without = stereo_capture(wall(800), {}, vga, o, 3).depth;
  for (int v = 0; v < vga.height; v += 7) EXPECT_EQ(with.at(600, v), without.at(600, v));
}

TEST(StereoSensor, OddInputIsAnErrorOrNothing) {
  EXPECT_PRED2(mentions, error_of([&] { stereo_capture(DepthImage(10, 10), {}, vga, {}, 1); }), "10 x 10");
  DepthImage bad(640, 480);
  bad.at(3, 4) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_PRED2(mentions, error_of([&] { stereo_capture(bad, {}, vga, {}, 1); }), "depth of nan");
  const auto nothing = stereo_capture(DepthImage(640, 480), DepthImage(640, 480), vga, {}, 1);
  EXPECT_EQ(std::count(nothing.depth.z_mm.begin(), nothing.depth.z_mm.end(), 0.0f), 640 * 480);
  const Intrinsics one_pixel{1, 1, 600, 600, 0, 0};
  DepthImage pixel(1, 1);
  pixel.z_mm[0] = 700;
  auto o = StereoSensorOptions{};
  o.invalid_band = false;
  EXPECT_NEAR(stereo_capture(pixel, {}, one_pixel, o, 1).depth.z_mm[0], 700, 10);

  const auto with = [](auto change) {
    StereoSensorOptions options;
    change(options);
    return error_of([&] { options.check(); });
  };
  EXPECT_EQ(with([](auto&) {}), "no error");
  EXPECT_PRED2(mentions, with([](auto& x) { x.baseline_mm = 0; }), "baseline_mm 0");
  EXPECT_PRED2(mentions, with([](auto& x) { x.disparity_noise_px = -1; }), "disparity_noise_px -1");
  EXPECT_PRED2(mentions, with([](auto& x) { x.correlation_px = 1e9; }), "correlation_px 1");
  EXPECT_PRED2(mentions, with([](auto& x) { x.grazing_drop_deg = {80, 70}; }), "grazing_drop_deg");
  EXPECT_PRED2(mentions, with([](auto& x) { x.white_share = 2; }), "white_share 2");
}

TEST(Capture, StereoNoiseGivesThePointsOfTheMeasuredDepth) {
  VirtualDepthCameraOptions options;
  options.noise.model = "stereo";
  options.noise_seed = 4;
  const Eigen::Isometry3d pose = wall_pose(600, 30);
  const auto cloud = capture(l_bracket(), pose, options, false, 7);
  const auto clean = render(l_bracket(), pose, options.intrinsics()).depth;
  ASSERT_GT(cloud.size(), 2000);
  EXPECT_EQ(cloud.normals.size(), cloud.size());
  double worst = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(std::remainder(cloud.points[i].z(), 1.0f), 0) << "whole millimetres";
    EXPECT_NEAR(cloud.normals[i].norm(), 1, 1e-5);
    worst = std::max(worst, distance_to_mesh(pose.inverse() * cloud.points[i].cast<double>(), l_bracket()));
  }
  EXPECT_GT(worst, 1);
  EXPECT_LT(worst, 20);
  const auto organized = capture(l_bracket(), pose, options, true, 7);
  EXPECT_TRUE(same_bits(without_missing(organized).points, cloud.points));
  EXPECT_FALSE(same_bits(capture(l_bracket(), pose, options, false, 8).points, cloud.points)) << "another frame";
  options.noise.stereo = StereoSensorOptions{};
  EXPECT_TRUE(same_bits(capture(l_bracket(), pose, options, false, 7).points, cloud.points)) << "a D415 is the default";
  options.noise.model = "sterio";
  EXPECT_PRED2(mentions, error_of([&] { options.check(); }), "did you mean \"stereo\"");
}

}  // namespace
}  // namespace partpose
