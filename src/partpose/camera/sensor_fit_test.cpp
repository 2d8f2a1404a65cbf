// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/sensor_fit.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

const Intrinsics vga = Intrinsics::from_field_of_view(640, 480, 50, 40);

std::vector<DepthImage> captures(double z_mm, double tilt_deg, const StereoSensorOptions& sensor, int frames) {
  const Eigen::Isometry3d pose =
      Eigen::Translation3d(0, 0, z_mm) *
      Eigen::Isometry3d(Eigen::AngleAxisd(radians(tilt_deg), Eigen::Vector3d(1, 2, 0).normalized()));
  const auto ideal = render(plane_patch(9000, 9000), pose, vga).depth;
  std::vector<DepthImage> out;
  for (int f = 0; f < frames; ++f) out.push_back(stereo_capture(ideal, {}, vga, sensor, 40 + f).depth);
  return out;
}

StereoSensorFit fit_of(const std::vector<DepthImage>& frames, double unit_mm = 1) {
  SensorFitOptions options;
  options.baseline_mm = 55;
  options.depth_unit_mm = unit_mm;
  return fit_stereo_sensor(frames, vga, options);
}

TEST(SensorFit, RecoversTheSensorFromWalls) {
  struct Case {
    double z_mm, tilt_deg, noise_px, correlation_px, white_share;
  };
  for (const auto& c : {Case{500, 0, 0.08, 5, 0.1}, Case{700, 0, 0.08, 8, 0.05}, Case{700, 15, 0.06, 4, 0.2},
                        Case{1000, 25, 0.1, 6, 0.3}, Case{700, 10, 0.08, 2, 0.1}}) {
    StereoSensorOptions sensor;
    sensor.disparity_noise_px = c.noise_px;
    sensor.correlation_px = c.correlation_px;
    sensor.white_share = c.white_share;
    const auto fit = fit_of(captures(c.z_mm, c.tilt_deg, sensor, 1));
    SCOPED_TRACE(fmt::format("{} mm, {} deg", c.z_mm, c.tilt_deg));
    EXPECT_NEAR(fit.disparity_noise_px, c.noise_px, 0.05 * c.noise_px);
    EXPECT_NEAR(fit.correlation_px, c.correlation_px, 0.1 * c.correlation_px);
    EXPECT_NEAR(fit.white_share, c.white_share, 0.05);
    EXPECT_NEAR(fit.static_pattern_percent, 1, 0.35) << "the left band is not seen, and slow waves look like it";
    EXPECT_EQ(fit.subpixel_wave_px.has_value(), c.tilt_deg > 0);
    EXPECT_NEAR(fit.subpixel_wave_px.value_or(0.04), 0.04, 0.15 * 0.04);
    EXPECT_EQ(fit.depth_step_mm, 1);
    EXPECT_FALSE(fit.frozen_share || fit.temporal_noise_px);
    EXPECT_NEAR(fit.tilt_deg, c.tilt_deg, 0.5);
    EXPECT_EQ(fit.stereo.disparity_noise_px, fit.disparity_noise_px);
    EXPECT_EQ(error_of([&] { fit.stereo.check(); }), "no error");
  }
}

TEST(SensorFit, FindsBothSteps) {
  for (const double step : {1.0 / 16, 1.0 / 32}) {
    StereoSensorOptions sensor;
    sensor.disparity_step_px = step;
    sensor.depth_step_mm = 0.1;
    const auto fit = fit_of(captures(600, 5, sensor, 1), 0.1);
    EXPECT_EQ(fit.disparity_step_px, step);
    EXPECT_NEAR(fit.depth_step_mm.value(), 0.1, 1e-9);
    EXPECT_NEAR(fit.disparity_noise_px, 0.08, 0.004);
  }
  StereoSensorOptions sensor;
  sensor.disparity_step_px = 0;
  sensor.depth_step_mm = 0.4;
  const auto fit = fit_of(captures(600, 5, sensor, 1), 0.1);
  EXPECT_FALSE(fit.disparity_step_px);
  EXPECT_NEAR(fit.depth_step_mm.value(), 0.4, 1e-9);
}

TEST(SensorFit, SeveralFramesTellStaticFromTemporal) {
  for (const double frozen : {0.0, 0.7}) {
    StereoSensorOptions sensor;
    sensor.frozen_share = frozen;
    sensor.correlation_px = 5;
    const auto fit = fit_of(captures(700, 15, sensor, 4));
    EXPECT_EQ(fit.frames, 4);
    EXPECT_NEAR(fit.frozen_share.value(), frozen, 0.08);
    const double temporal = 0.08 * std::sqrt(0.95 * (1 - frozen) + 0.05);
    EXPECT_NEAR(fit.temporal_noise_px.value(), temporal, 0.06 * temporal);
    EXPECT_NEAR(fit.temporal_noise_mm.value(), fit.mm_per_px * temporal, 0.06 * fit.mm_per_px * temporal);
    EXPECT_NEAR(fit.disparity_noise_px, 0.08, 0.004);
  }
}

TEST(SensorFit, PlaneRmsIsTheFormulasWithoutPattern) {
  StereoSensorOptions sensor;
  sensor.static_pattern_percent = 0;
  sensor.subpixel_wave_px = 0;
  const auto fit = fit_of(captures(700, 0, sensor, 1));
  const double predicted = predicted_depth_noise_mm(sensor, vga, 700);
  EXPECT_NEAR(fit.plane_rms_mm, predicted, 0.1 * predicted) << "0.5 % at either end are dropped";
  EXPECT_NEAR(fit.subpixel_rms_px, fit.plane_rms_mm / fit.mm_per_px, 0.15 * fit.subpixel_rms_px);
  EXPECT_NEAR(fit.fill_rate, 1 - 53.9 / 640, 0.002) << "all but the left band";
}

TEST(SensorFit, OfARegion) {
  // A wall in the middle of the image, a ball beside it.
  StereoSensorOptions sensor;
  auto frames = captures(700, 10, sensor, 1);
  for (int v = 0; v < vga.height; ++v)
    for (int u = 0; u < 300; ++u) frames[0].at(u, v) = static_cast<float>(400 + (u * 7 + v * 13) % 90);
  EXPECT_PRED2(mentions, error_of([&] { fit_of(frames); }), "not a plane");
  SensorFitOptions options;
  options.baseline_mm = 55;
  options.region_px = {320, 60, 300, 360};
  std::vector<std::size_t> told;
  const auto progress = [&](std::string_view, std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 3u);
    told.push_back(done);
  };
  EXPECT_NEAR(fit_stereo_sensor(frames, vga, options, progress).disparity_noise_px, 0.08, 0.008);
  EXPECT_EQ(told, (std::vector<std::size_t>{1, 2, 3}));
  options.region_px = {320, 60, 400, 360};
  EXPECT_PRED2(mentions, error_of([&] { fit_stereo_sensor(frames, vga, options); }), "region 320 60 400 360");
}

TEST(SensorFit, BadInputSaysWhatWouldBeRight) {
  const auto frames = captures(700, 0, {}, 1);
  EXPECT_PRED2(mentions, error_of([&] { fit_stereo_sensor(frames, vga, {}); }), "no baseline");
  EXPECT_PRED2(mentions, error_of([&] { fit_of({}); }), "no frame");
  EXPECT_PRED2(mentions, error_of([&] { fit_of({DepthImage(640, 480)}); }), "only 0 measured pixels");
  EXPECT_PRED2(mentions, error_of([&] { fit_of({DepthImage(64, 48)}); }), "64 x 48");
  auto bad = frames;
  bad[0].at(1, 1) = -1;
  EXPECT_PRED2(mentions, error_of([&] { fit_of(bad); }), "depth of -1");
  DepthImage ball = render(sphere(300, 60, 30), Eigen::Isometry3d(Eigen::Translation3d(0, 0, 700)), vga).depth;
  EXPECT_PRED2(mentions, error_of([&] { fit_of({ball}); }), "not a plane");
  const auto moved_away = captures(900, 0, {}, 1);
  EXPECT_PRED2(mentions, error_of([&] { fit_of({frames[0], moved_away[0]}); }), "must not move");
  // A wall without any noise: everything 0, nothing divided by it.
  DepthImage still(640, 480);
  std::fill(still.z_mm.begin(), still.z_mm.end(), 700.0f);
  const auto fit = fit_of({still});
  EXPECT_LT(fit.disparity_noise_px, 1e-3);
  EXPECT_TRUE(std::isfinite(fit.correlation_px) && std::isfinite(fit.static_pattern_percent));
}

}  // namespace
}  // namespace partpose
