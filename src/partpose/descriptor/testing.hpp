// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// What the tests of the clustered descriptors share.
#pragma once

#include "partpose/core/parallel.hpp"
#include "partpose/descriptor/global_descriptor.hpp"
#include "partpose/geometry/normals.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace partpose::testing_clusters {

using namespace shapes;

/// The points of a mesh's surface that face the camera, with estimated normals and curvatures.
inline PointCloud view_of(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, int count,
                          Random& random, double noise_mm = 0) {
  const auto cloud = transformed(surface_points(mesh, count, random), camera_from_model);
  std::vector<int> facing;
  for (int i = 0; i < count; ++i)
    if (cloud.normals[i].dot(cloud.points[i]) < 0) facing.push_back(i);
  auto view = select(cloud, facing);
  for (auto& p : view.points)
    for (int axis = 0; axis < 3; ++axis) p[axis] += static_cast<float>(between(random, -noise_mm, noise_mm));
  estimate_normals(view, 5);
  return without_missing(view);
}

inline PointCloud bracket_view(std::uint64_t seed) {
  Random random(seed);
  const auto pose = random_pose(random, {60, -80, 600});
  return view_of(l_bracket(), pose, 8000, random, 0.3);
}

/// A box of 60 x 40 x 25 mm, one corner towards the camera.
inline Eigen::Isometry3d corner_pose() {
  Eigen::Isometry3d pose(Eigen::Translation3d(20, 10, 600));
  pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(-20, -10, -600)).toRotationMatrix();
  return pose;
}

inline PointCloud box_view() {
  Random random(5);
  return view_of(box({60, 40, 25}), corner_pose(), 16000, random);
}

inline PointCloud shuffled(const PointCloud& cloud, std::uint64_t seed) {
  std::vector<int> order(cloud.size());
  std::iota(order.begin(), order.end(), 0);
  Random random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return select(cloud, order);
}

inline double l1(const std::vector<float>& a, const std::vector<float>& b) {
  double distance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) distance += std::abs(static_cast<double>(a[i]) - b[i]);
  return distance;
}

inline double sum(const std::vector<float>& histogram, int begin, int end) {
  return std::accumulate(histogram.begin() + begin, histogram.begin() + end, 0.0);
}

inline void expect_same_bits(const std::vector<Description>& a, const std::vector<Description>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(same_bits(a[i].histogram, b[i].histogram));
    EXPECT_EQ(a[i].centroid_mm, b[i].centroid_mm);
    EXPECT_EQ(a[i].support, b[i].support);
    EXPECT_EQ(a[i].valid, b[i].valid);
    ASSERT_EQ(a[i].camera_from_reference.has_value(), b[i].camera_from_reference.has_value());
    if (a[i].camera_from_reference) {
      EXPECT_EQ(a[i].camera_from_reference->matrix(), b[i].camera_from_reference->matrix());
    }
  }
}

/// What every description of a cloud with points must be.
inline void expect_defined(const std::vector<Description>& descriptions) {
  ASSERT_FALSE(descriptions.empty());
  for (const auto& d : descriptions) {
    ASSERT_EQ(d.histogram.size(), 308);
    for (const float bin : d.histogram) ASSERT_TRUE(std::isfinite(bin) && bin >= 0) << bin;
    EXPECT_TRUE(d.centroid_mm.allFinite());
    EXPECT_GE(d.support, 1);
    EXPECT_TRUE(!d.camera_from_reference || is_rigid(d.camera_from_reference->matrix()));
  }
}

/// Clouds that have no size in some direction, each named.
inline std::vector<std::pair<std::string, PointCloud>> degenerate_clouds() {
  std::vector<std::pair<std::string, PointCloud>> clouds(6);
  Random random(1);
  clouds[0].first = "one point";
  clouds[0].second.points = {{10, 20, 600}};
  clouds[1].first = "the same point many times";
  clouds[1].second.points.assign(50, {10, 20, 600});
  clouds[2].first = "a line";
  for (int i = 0; i < 100; ++i) clouds[2].second.points.emplace_back(static_cast<float>(i), 5.0f, 600.0f);
  clouds[3].first = "the line of sight";
  for (int i = 0; i < 100; ++i) clouds[3].second.points.emplace_back(0.0f, 0.0f, 500.0f + static_cast<float>(i));
  clouds[4].first = "around the camera";
  clouds[4].second = random_cube(random, 200, 10);
  clouds[5].first = "two points";
  clouds[5].second.points = {{10, 20, 600}, {-10, 20, 600}};
  for (auto& [name, cloud] : clouds) {
    cloud.normals.assign(cloud.size(), {0, 0, -1});
    cloud.curvatures.assign(cloud.size(), 0);
  }
  return clouds;
}

}  // namespace partpose::testing_clusters
