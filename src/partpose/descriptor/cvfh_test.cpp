// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// The comparison with PCL is in pipeline/descriptor_golden_test.cpp.
#include "partpose/descriptor/cvfh.hpp"

#include "partpose/descriptor/testing.hpp"
#include "partpose/descriptor/vfh.hpp"

namespace partpose {
namespace {

using namespace testing_clusters;

const CvfhOptions small = {.min_points = 100, .cluster_tolerance_distance = 4, .radius_normals = 5};

std::vector<Description> cvfh(const PointCloud& cloud, const CvfhOptions& options = small) {
  return make_descriptor(options)->describe(cloud);
}

TEST(Cvfh, EachFaceOfABoxGivesTheVfhAboutIt) {
  const auto cloud = box_view();
  const auto descriptions = cvfh(cloud);
  ASSERT_EQ(descriptions.size(), 3);
  const auto pose = corner_pose();
  const Eigen::Vector3d normals[] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  for (int i = 0; i < 3; ++i) {
    const auto& d = descriptions[i];
    EXPECT_TRUE(d.valid);
    EXPECT_FALSE(d.camera_from_reference);
    EXPECT_LT((d.centroid_mm - pose * normals[i].cwiseProduct(Eigen::Vector3d(30, 20, 12.5))).norm(), 3);
    EXPECT_GE(d.support, 100);
    EXPECT_LT(d.support, cloud.size() / 2);
    // The exact normal of the face differs from the mean of the estimated ones by rounding and a few edge points.
    const auto exact =
        vfh_about(d.centroid_mm.cast<float>(), (pose.linear() * normals[i]).cast<float>(), OrientedPoints(cloud), {});
    EXPECT_LT(l1(d.histogram, exact), 40);
    for (int other = 0; other < i; ++other) EXPECT_GT(l1(d.histogram, descriptions[other].histogram), 100);
  }
}

TEST(Cvfh, OfAPlaneIsItsVfh) {
  PointCloud cloud;
  for (int i = 0; i < 900; ++i)
    cloud.points.emplace_back(static_cast<float>(i % 30), 1.3f * static_cast<float>(i / 30), 600.0f);
  cloud.normals.assign(cloud.size(), {0, 0, -1});
  const auto descriptions = cvfh(cloud);
  ASSERT_EQ(descriptions.size(), 1);
  EXPECT_TRUE(descriptions[0].valid);
  EXPECT_EQ(descriptions[0].support, 900);
  EXPECT_EQ(descriptions[0].histogram, vfh(cloud, {}));
}

TEST(Cvfh, ASphereIsOneCluster) {
  Random random(3);
  const auto cloud = view_of(sphere(40, 60, 40), Eigen::Isometry3d(Eigen::Translation3d(30, -20, 600)), 8000, random);
  const auto descriptions = cvfh(cloud);
  ASSERT_EQ(descriptions.size(), 1);
  EXPECT_TRUE(descriptions[0].valid);
  EXPECT_GT(descriptions[0].support, cloud.size() * 9 / 10);
}

TEST(Cvfh, WithoutClustersItIsTheVfhOfTheWholeCloudAndNotValid) {
  const auto cloud = bracket_view(1);
  auto options = small;
  options.min_points = 100000;
  const auto descriptions = cvfh(cloud, options);
  ASSERT_EQ(descriptions.size(), 1);
  EXPECT_FALSE(descriptions[0].valid);
  EXPECT_EQ(descriptions[0].support, cloud.size());
  EXPECT_EQ(descriptions[0].histogram, vfh(cloud, {}));
  EXPECT_LT((descriptions[0].centroid_mm - centroid(cloud)).norm(), 1e-3);
}

TEST(Cvfh, BinsInPoints) {
  const auto cloud = box_view();
  auto options = small;
  options.use_normalized_bins = false;
  const auto per_cent = cvfh(cloud), points = cvfh(cloud, options);
  ASSERT_EQ(points.size(), per_cent.size());
  const double n = static_cast<double>(cloud.size());
  for (std::size_t d = 0; d < points.size(); ++d)
    for (int i = 0; i < vfh_bins; ++i)
      EXPECT_NEAR(per_cent[d].histogram[i], points[d].histogram[i] * 100 / (i < 4 * vfh_feature_bins ? n - 1 : n),
                  1e-4);
}

TEST(Cvfh, ThePointsOrderAndTheThreadsDoNotMatter) {
  for (const std::uint64_t seed : {3, 4, 5}) {
    const auto cloud = bracket_view(seed);
    const auto descriptions = cvfh(cloud);
    EXPECT_GE(descriptions.size(), 2);
    expect_same_bits(cvfh(shuffled(cloud, seed)), descriptions);
    const ThreadLimit one(1);
    expect_same_bits(cvfh(cloud), descriptions);
  }
}

TEST(Cvfh, TurningTheSceneAboutTheCameraDoesNotMatter) {
  Random random(6);
  for (const std::uint64_t seed : {6, 7, 8}) {
    const auto cloud = bracket_view(seed);
    const auto descriptions = cvfh(cloud);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Isometry3d turn(Eigen::Quaterniond(random_turn(random, between(random, 0, 3))));
      const auto turned = cvfh(transformed(cloud, turn));
      ASSERT_EQ(turned.size(), descriptions.size());
      for (std::size_t d = 0; d < turned.size(); ++d) {
        EXPECT_NEAR(turned[d].support, descriptions[d].support, 3);
        EXPECT_LT((turned[d].centroid_mm - turn * descriptions[d].centroid_mm).norm(), 0.1);
        EXPECT_LT(l1(turned[d].histogram, descriptions[d].histogram), 8) << "of 500";
      }
    }
  }
}

TEST(Cvfh, EachPointTwiceIsNearlyTheSame) {
  const auto cloud = bracket_view(9);
  auto twice = cloud;
  append(twice, cloud);
  auto doubled = small;
  doubled.min_points *= 2;
  const auto single = cvfh(cloud), both = cvfh(twice, doubled);
  ASSERT_EQ(both.size(), single.size());
  for (std::size_t d = 0; d < both.size(); ++d) {
    EXPECT_NEAR(both[d].support, 2 * single[d].support, 4);
    EXPECT_LT(l1(both[d].histogram, single[d].histogram), 5);
  }
}

TEST(Cvfh, MissingPointsAndNormalsAreLeftOut) {
  const auto cloud = bracket_view(10);
  auto with_missing = cloud;
  for (const std::size_t i : {0, 100, 500}) {
    with_missing.points.insert(with_missing.points.begin() + i, cloud.points[i]);
    with_missing.normals.insert(with_missing.normals.begin() + i, Eigen::Vector3f::Constant(NAN));
    with_missing.curvatures.insert(with_missing.curvatures.begin() + i, NAN);
  }
  with_missing.points.push_back({NAN, NAN, NAN});
  with_missing.normals.push_back({0, 0, -1});
  with_missing.curvatures.push_back(0);
  expect_same_bits(cvfh(with_missing), cvfh(cloud));
}

TEST(Cvfh, OfDegenerateClouds) {
  for (const auto& [name, cloud] : degenerate_clouds()) {
    SCOPED_TRACE(name);
    for (const int min_points : {1, 10, 1000}) {
      auto options = small;
      options.min_points = min_points;
      const auto descriptions = cvfh(cloud, options);
      expect_defined(descriptions);
      EXPECT_TRUE(name == "around the camera" || !descriptions.at(0).valid) << "no normal, no cluster";
    }
  }
  EXPECT_TRUE(cvfh(PointCloud{}).empty());
  PointCloud missing;
  missing.points = {{NAN, 0, 0}};
  missing.normals = {{0, 0, -1}};
  EXPECT_TRUE(cvfh(missing).empty());
}

TEST(Cvfh, NeedsNormals) {
  PointCloud cloud;
  cloud.points = {{0, 0, 600}};
  EXPECT_PRED2(mentions, error_of([&] { cvfh(cloud); }), "normals");
}

}  // namespace
}  // namespace partpose
