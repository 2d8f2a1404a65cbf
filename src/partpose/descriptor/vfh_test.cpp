// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// The comparison with PCL is in pipeline/descriptor_golden_test.cpp.
#include "partpose/descriptor/vfh.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace partpose {
namespace {

using namespace shapes;

constexpr int distance_part = 3 * vfh_feature_bins, viewpoint_part = 4 * vfh_feature_bins;
constexpr int middle_bin = 22;  ///< of angle or cosine 0

const VfhOptions raw = {.use_fill_size_component = true, .use_normalized_bins = false};

PointCloud bracket_view(std::uint64_t seed) {
  Random random(seed);
  const auto cloud = transformed(surface_points(l_bracket(), 3000, random), random_pose(random, {60, -80, 600}));
  std::vector<int> facing;
  for (int i = 0; i < 3000; ++i)
    if (cloud.normals[i].dot(cloud.points[i]) < 0) facing.push_back(i);
  return select(cloud, facing);
}

/// A rectangle that faces the camera, without the point at its centre.
PointCloud facing_rectangle() {
  PointCloud cloud;
  for (int r = -5; r <= 5; ++r)
    for (int c = -5; c <= 5; ++c)
      if (r != 0 || c != 0)
        cloud.points.emplace_back(4.1f * static_cast<float>(c), 3.7f * static_cast<float>(r), 600.0f);
  cloud.normals.assign(cloud.size(), {0, 0, -1});
  return cloud;
}

double sum(const std::vector<float>& histogram, int begin, int end) {
  return std::accumulate(histogram.begin() + begin, histogram.begin() + end, 0.0);
}

double l1(const std::vector<float>& a, const std::vector<float>& b) {
  double distance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) distance += std::abs(static_cast<double>(a[i]) - b[i]);
  return distance;
}

TEST(Vfh, OfARectangleThatFacesTheCamera) {
  const auto cloud = facing_rectangle();
  const auto histogram = vfh(cloud, raw);
  ASSERT_EQ(histogram.size(), 308);
  const auto count = static_cast<float>(cloud.size());
  EXPECT_EQ(histogram[middle_bin], count) << "alpha: all normals are the mean normal";
  EXPECT_EQ(histogram[45 + middle_bin], count) << "phi";
  EXPECT_EQ(histogram[90 + middle_bin], count) << "theta: the normals stand upright on the lines to the centroid";
  EXPECT_EQ(histogram[viewpoint_part + 127], count) << "the normals point at the camera";

  std::vector<float> distances(vfh_feature_bins, 0);
  const double largest = std::hypot(20.5, 18.5);
  for (const auto& p : cloud.points)
    ++distances[std::min(static_cast<int>(45 * std::hypot(p.x(), p.y()) / largest), 44)];
  for (int i = 0; i < 45; ++i) EXPECT_EQ(histogram[distance_part + i], distances[i]) << "distance bin " << i;
}

TEST(Vfh, ViewpointBinIsTheAngleToTheLineOfSight) {
  for (const double tilt_deg : {0.0, 20.0, 45.0, 70.0, 88.0}) {
    const Eigen::Isometry3d tilt(Eigen::Translation3d(0, 0, 600) *
                                 Eigen::AngleAxisd(radians(tilt_deg), Eigen::Vector3d(3, -1, 0).normalized()) *
                                 Eigen::Translation3d(0, 0, -600));
    const auto cloud = transformed(facing_rectangle(), tilt);
    const int bin = std::min(static_cast<int>((std::cos(radians(tilt_deg)) + 1) / 2 * 128), 127);
    EXPECT_EQ(vfh(cloud, raw)[viewpoint_part + bin], static_cast<float>(cloud.size())) << tilt_deg;
  }
}

TEST(Vfh, AnglesOfARoofByHand) {
  // Two points beside the centroid on the x axis with normals tilted by 30 degrees, away from each other.
  const auto s = static_cast<float>(std::sin(radians(30))), c = static_cast<float>(std::cos(radians(30)));
  PointCloud cloud;
  cloud.points = {{-10, 0, 600}, {10, 0, 600}};
  cloud.normals = {{-s, 0, -c}, {s, 0, -c}};
  const auto histogram = vfh(cloud, raw);
  // The points' normals are nearer to the lines than the mean normal (0, 0, -c): the frame stands at each point, its
  // line towards the centroid: theta = -sin 30 for both; alpha = 30 degrees, phi = 0.
  const auto bin = [](double value) {
    return static_cast<int>(45 * (value + std::numbers::pi) / (2 * std::numbers::pi));
  };
  EXPECT_EQ(histogram[90 + bin(-0.5)], 2);
  EXPECT_EQ(histogram[45 + middle_bin], 2);
  EXPECT_EQ(histogram[bin(radians(30))], 2);
  EXPECT_EQ(histogram[viewpoint_part + static_cast<int>((c + 1) / 2 * 128)], 2);
}

TEST(Vfh, SumsOfTheParts) {
  const auto cloud = bracket_view(1);
  const auto n = static_cast<double>(cloud.size());
  const auto histogram = vfh(cloud, {});
  for (int part = 0; part < 4; ++part)
    EXPECT_NEAR(sum(histogram, 45 * part, 45 * (part + 1)), 100 * n / (n - 1), 1e-2) << part;
  EXPECT_NEAR(sum(histogram, viewpoint_part, vfh_bins), 100, 1e-2);

  const auto counts = vfh(cloud, raw);
  for (int part = 0; part < 4; ++part) EXPECT_EQ(sum(counts, 45 * part, 45 * (part + 1)), n) << part;
  EXPECT_EQ(sum(counts, viewpoint_part, vfh_bins), n);
  for (int i = 0; i < vfh_bins; ++i)
    EXPECT_NEAR(histogram[i], counts[i] * 100 / (i < viewpoint_part ? n - 1 : n), 1e-4);
}

TEST(Vfh, TheSizeComponentIsZeroWhenItIsNotAskedFor) {
  const auto cloud = bracket_view(2);
  const auto with = vfh(cloud, {}), without = vfh(cloud, {.use_fill_size_component = false});
  for (int i = 0; i < vfh_bins; ++i) {
    const bool size_component = i >= distance_part && i < viewpoint_part;
    EXPECT_EQ(without[i], size_component ? 0 : with[i]);
  }
}

TEST(Vfh, DistancesInStepsOfTenMillimetres) {
  PointCloud cloud;
  for (const float x : {3.0f, 8.0f, 12.0f, 18.0f, 500.0f}) {
    cloud.points.insert(cloud.points.end(), {{x, 0, 600}, {-x, 0, 600}});
  }
  cloud.normals.assign(cloud.size(), {0, 0, -1});
  const auto histogram =
      vfh(cloud, {.use_fill_size_component = true, .use_normalized_bins = false, .use_normalized_distances = false});
  const float* distances = &histogram[distance_part];
  EXPECT_EQ(distances[0], 2);
  EXPECT_EQ(distances[1], 4);
  EXPECT_EQ(distances[2], 2);
  EXPECT_EQ(distances[44], 2);
}

TEST(Vfh, ThePointsOrderDoesNotMatter) {
  for (const std::uint64_t seed : {3, 4, 5}) {
    const auto cloud = bracket_view(seed);
    std::vector<int> order(cloud.size());
    std::iota(order.begin(), order.end(), 0);
    Random random(seed);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    for (const VfhOptions& options : {VfhOptions{}, raw})
      EXPECT_TRUE(same_bits(vfh(select(cloud, order), options), vfh(cloud, options)));
  }
}

TEST(Vfh, TurningTheSceneAboutTheCameraDoesNotMatter) {
  Random random(6);
  for (const std::uint64_t seed : {6, 7, 8}) {
    const auto cloud = bracket_view(seed);
    for (int i = 0; i < 5; ++i) {
      // A roll about the line of sight first, then any turn. A point on a bin's border may fall either way.
      const Eigen::Isometry3d turn(i == 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(1.0, centroid(cloud).normalized()))
                                          : Eigen::Quaterniond(random_turn(random, between(random, 0, 3))));
      EXPECT_LT(l1(vfh(transformed(cloud, turn), {}), vfh(cloud, {})), 2.0);
    }
    EXPECT_GT(l1(vfh(cloud, {}), vfh(bracket_view(seed + 10), {})), 50) << "another view must differ";
  }
}

TEST(Vfh, EachPointTwiceIsNearlyTheSame) {
  const auto cloud = bracket_view(9);
  auto twice = cloud;
  append(twice, cloud);
  const auto single = vfh(cloud, raw);
  auto counts = vfh(twice, raw);
  for (float& c : counts) c /= 2;
  EXPECT_LE(l1(counts, single), 4);
  EXPECT_LT(l1(vfh(twice, {}), vfh(cloud, {})), 1);
}

TEST(Vfh, OfOnePoint) {
  PointCloud cloud;
  cloud.points = {{10, 20, 600}};
  cloud.normals = {{0, 0, -1}};
  const auto histogram = vfh(cloud, {});
  ASSERT_EQ(histogram.size(), 308);
  for (const float value : histogram) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(sum(histogram, 0, viewpoint_part), 0) << "there is no line to the centroid";
  EXPECT_FLOAT_EQ(static_cast<float>(sum(histogram, viewpoint_part, vfh_bins)), 100);
}

TEST(Vfh, OfDegenerateClouds) {
  PointCloud same, line, opposite, at_camera;
  for (int i = 0; i < 20; ++i) {
    same.points.emplace_back(1.0f, 2.0f, 600.0f);
    line.points.emplace_back(0.0f, 0.0f, 600.0f + static_cast<float>(i));
    opposite.points.emplace_back(static_cast<float>(i), 5.0f, 600.0f);
    at_camera.points.emplace_back(i % 2 == 0 ? 1.0f : -1.0f, 0.0f, 0.0f);
  }
  same.normals = line.normals = at_camera.normals = std::vector<Eigen::Vector3f>(20, {0, 0, -1});
  for (int i = 0; i < 20; ++i) opposite.normals.emplace_back(0.0f, 0.0f, i % 2 == 0 ? -1.0f : 1.0f);
  for (const auto* cloud : {&same, &line, &opposite, &at_camera}) {
    for (const bool normalized : {true, false}) {
      const auto histogram = vfh(*cloud, {.use_normalized_bins = normalized, .use_normalized_distances = normalized});
      ASSERT_EQ(histogram.size(), 308);
      for (const float value : histogram) EXPECT_TRUE(std::isfinite(value) && value >= 0);
      EXPECT_NEAR(sum(histogram, viewpoint_part, vfh_bins), normalized ? 100 : 20, 1e-3);
    }
  }
  EXPECT_EQ(sum(vfh(same, {}), 0, viewpoint_part), 0);
  EXPECT_EQ(sum(vfh(line, {}), 0, viewpoint_part), 0) << "normals along the line span no frame";
}

TEST(Vfh, NeedsPointsWithNormals) {
  PointCloud cloud;
  EXPECT_PRED2(mentions, error_of([&] { vfh(cloud, {}); }), "at least one point");
  cloud.points = {{0, 0, 600}};
  EXPECT_PRED2(mentions, error_of([&] { vfh(cloud, {}); }), "normals");
}

}  // namespace
}  // namespace partpose
