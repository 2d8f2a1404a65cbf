// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/crh.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <numeric>

namespace partpose {
namespace {

using namespace shapes;

/// The points of a bracket whose normals face the camera, off the optical axis.
PointCloud bracket_view(std::uint64_t seed) {
  Random random(seed);
  const auto cloud = transformed(surface_points(l_bracket(), 3000, random), random_pose(random, {60, -80, 600}));
  std::vector<int> facing;
  for (int i = 0; i < 3000; ++i)
    if (cloud.normals[i].dot(cloud.points[i]) < 0) facing.push_back(i);
  return select(cloud, facing);
}

CameraRollHistogram histogram_of(const PointCloud& cloud) { return camera_roll_histogram(cloud, centroid(cloud)); }

Eigen::Isometry3d roll_about_line_of_sight(const PointCloud& cloud, double angle_rad) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(angle_rad, centroid(cloud).normalized()));
}

/// Difference of two angles in degrees, whole turns aside.
double apart_deg(double a_rad, double b_rad) {
  return std::abs(degrees(std::remainder(a_rad - b_rad, 2 * std::numbers::pi)));
}

TEST(SightFrame, TurnsTheLineOfSightToZByTheShortestWay) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d centre = 600 * random_direction(random);
    const Eigen::Matrix3d frame = sight_frame(centre);
    EXPECT_LT((frame * frame.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(frame.determinant(), 1, 1e-12);
    EXPECT_LT((frame * centre.normalized() - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
    EXPECT_NEAR(degrees(Eigen::AngleAxisd(frame).angle()), angle_deg(centre, Eigen::Vector3d::UnitZ()), 1e-5);
  }
  EXPECT_LT((sight_frame({0, 0, 500}) - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((sight_frame({0, 0, -500}) * Eigen::Vector3d(0, 0, -1) - Eigen::Vector3d::UnitZ()).norm(), 1e-6);
}

TEST(CameraRollHistogram, BinsTurnFromMinusXTowardsMinusY) {
  const auto bin_of = [](double angle_deg) {
    PointCloud cloud;
    cloud.points = {{0, 0, 500}};
    cloud.normals = {
        Eigen::Vector3d(std::cos(radians(angle_deg)), std::sin(radians(angle_deg)), -1).normalized().cast<float>()};
    const auto histogram = camera_roll_histogram(cloud, {0, 0, 500});
    const auto filled = std::max_element(histogram.begin(), histogram.end());
    EXPECT_FLOAT_EQ(*filled, 1) << "all of the sum in one bin";
    return static_cast<int>(filled - histogram.begin());
  };
  for (int bin = 0; bin < crh_bins; ++bin) EXPECT_EQ(bin_of(-180 + 4 * bin + 2), bin);
  EXPECT_EQ(bin_of(180), 0);
}

TEST(CameraRollHistogram, WeighsByTheComponentAcrossTheLineOfSight) {
  PointCloud cloud;
  cloud.points.assign(3, {0, 0, 500});
  const auto tilted = [](double tilt_deg, double turn_deg) {
    return Eigen::Vector3f(Eigen::Vector3d(std::sin(radians(tilt_deg)) * std::cos(radians(turn_deg)),
                                           std::sin(radians(tilt_deg)) * std::sin(radians(turn_deg)),
                                           -std::cos(radians(tilt_deg)))
                               .cast<float>());
  };
  cloud.normals = {tilted(30, 2), tilted(90, 94), tilted(0, 0)};
  const auto histogram = camera_roll_histogram(cloud, {0, 0, 500});
  EXPECT_NEAR(histogram[45], 0.5 / 1.5, 1e-6);
  EXPECT_NEAR(histogram[68], 1.0 / 1.5, 1e-6);
}

TEST(CameraRollHistogram, SumsToOne) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto histogram = histogram_of(bracket_view(seed));
    EXPECT_NEAR(std::accumulate(histogram.begin(), histogram.end(), 0.0), 1, 1e-5);
  }
}

TEST(CameraRollHistogram, IsEmptyWhenAllNormalsAreAlongTheLineOfSight) {
  PointCloud cloud;
  cloud.points = {{0, 0, 500}, {10, 0, 500}};
  cloud.normals = {{0, 0, -1}, {0, 0, -1}};
  for (const float value : camera_roll_histogram(cloud, {0, 0, 500})) EXPECT_EQ(value, 0);
  cloud.normals.clear();
  EXPECT_PRED2(mentions, error_of([&] { camera_roll_histogram(cloud, {0, 0, 500}); }), "normals");
}

TEST(CameraRollHistogram, DoesNotDependOnTheDirectionToThePart) {
  // Turned about the camera, the part looks the same: only the frame of the line of sight tells the two apart.
  const auto cloud = bracket_view(4);
  const Eigen::Vector3d centre = centroid(cloud);
  const auto at_the_axis = transformed(cloud, Eigen::Isometry3d(sight_frame(centre)));
  const auto here = histogram_of(cloud), there = histogram_of(at_the_axis);
  double difference = 0;
  for (int i = 0; i < crh_bins; ++i) difference += std::abs(here[i] - there[i]);
  EXPECT_LT(difference, 0.01);
}

TEST(CrhSpectrum, IsTheFourierSeriesOfTheHistogram) {
  const auto histogram = histogram_of(bracket_view(5));
  const auto spectrum = crh_spectrum(histogram);
  EXPECT_EQ(spectrum[0], 1);
  // Summed up again, the series gives the histogram.
  for (int i = 0; i < crh_bins; ++i) {
    double value = spectrum[0] + spectrum[89] * (i % 2 == 0 ? 1 : -1);
    for (int k = 1; k < 45; ++k) {
      const double angle = 2 * std::numbers::pi * k * i / crh_bins;
      value += 2 * (spectrum[2 * k - 1] * std::cos(angle) - spectrum[2 * k] * std::sin(angle));
    }
    EXPECT_NEAR(value / crh_bins, histogram[i], 1e-6);
  }
}

TEST(CrhSpectrum, DoesNotDependOnTheHistogramsSum) {
  auto histogram = histogram_of(bracket_view(6));
  const auto spectrum = crh_spectrum(histogram);
  for (float& value : histogram) value *= 7;
  const auto of_scaled = crh_spectrum(histogram);
  for (int i = 0; i < crh_bins; ++i) EXPECT_NEAR(spectrum[i], of_scaled[i], 1e-6);
  for (const float value : crh_spectrum(CameraRollHistogram{})) EXPECT_EQ(value, 0);
}

TEST(RollPeaks, FindTheTurnFromSourceToTarget) {
  // Positive is from x towards y about the line of sight, away from the camera: clockwise in the image.
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const auto source = bracket_view(seed);
    for (const double angle_deg : {0.0, 1.0, 17.0, 90.0, 133.5, 180.0, 271.0, 358.0}) {
      const auto target = transformed(source, roll_about_line_of_sight(source, radians(angle_deg)));
      const auto peaks = roll_peaks(histogram_of(source), histogram_of(target), 4);
      ASSERT_FALSE(peaks.empty());
      // A bracket fills few of the 4 degree bins: of one normal, nobody knows where in its bin it lies.
      EXPECT_LT(apart_deg(peaks[0].angle_rad, radians(angle_deg)), 3) << "seed " << seed << ", " << angle_deg << " deg";
      EXPECT_GT(peaks[0].correlation, 0.8);
    }
  }
}

TEST(RollPeaks, WholeBinsAreExact) {
  const auto source = histogram_of(bracket_view(7));
  for (int shift = 0; shift < crh_bins; ++shift) {
    CameraRollHistogram target;
    for (int i = 0; i < crh_bins; ++i) target[(i + shift) % crh_bins] = source[i];
    const auto peaks = roll_peaks(source, target, 1);
    ASSERT_EQ(peaks.size(), 1);
    EXPECT_LT(apart_deg(peaks[0].angle_rad, radians(4.0 * shift)), 1e-9);
    EXPECT_NEAR(peaks[0].correlation, 1, 1e-12);
  }
}

TEST(RollPeaks, ComeBestFirstAndNotMoreThanAskedFor) {
  const auto source = histogram_of(bracket_view(8)), target = histogram_of(bracket_view(9));
  const auto all = roll_peaks(source, target, 1000);
  ASSERT_GT(all.size(), 3);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_GE(all[i - 1].correlation, all[i].correlation);
  for (const auto& peak : all) EXPECT_LE(std::abs(peak.correlation), 1 + 1e-12);
  for (const int most : {1, 2, 3}) {
    const auto some = roll_peaks(source, target, most);
    ASSERT_EQ(some.size(), most);
    for (int i = 0; i < most; ++i) EXPECT_EQ(some[i].angle_rad, all[i].angle_rad);
  }
}

TEST(RollPeaks, OfAFourfoldHistogramAreFour) {
  CameraRollHistogram square{}, turned{};
  for (const int bin : {3, 25, 26, 48, 70, 71}) square[bin] = bin % 2 == 1 && bin != 3 ? 0.125f : 0.25f;
  // Each quarter turn is 22.5 bins.
  for (int i = 0; i < crh_bins; ++i) turned[(i + 5) % crh_bins] = square[i];
  const auto peaks = roll_peaks(square, turned, 4);
  ASSERT_EQ(peaks.size(), 4);
  for (const auto& peak : peaks) EXPECT_LT(apart_deg(4 * peak.angle_rad, 4 * radians(20)), 4 * 1.5);
}

TEST(RollPeaks, WithoutStructureThereIsOneAtZero) {
  CameraRollHistogram flat, empty{};
  flat.fill(1.0f / crh_bins);
  const auto structured = histogram_of(bracket_view(10));
  for (const auto& [a, b] : {std::pair(flat, structured), std::pair(structured, flat), std::pair(empty, structured),
                             std::pair(flat, flat), std::pair(empty, empty)}) {
    const auto peaks = roll_peaks(a, b, 4);
    ASSERT_EQ(peaks.size(), 1);
    EXPECT_EQ(peaks[0].angle_rad, 0);
    EXPECT_EQ(peaks[0].correlation, 0);
  }
}

}  // namespace
}  // namespace partpose
