// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// The comparison with PCL is in pipeline/descriptor_golden_test.cpp.
#include "partpose/descriptor/our_cvfh.hpp"

#include "partpose/descriptor/testing.hpp"
#include "partpose/descriptor/vfh.hpp"

namespace partpose {
namespace {

using namespace testing_clusters;

constexpr int octant_part = 3 * vfh_feature_bins, viewpoint_part = octant_part + 8 * our_cvfh_octant_bins;

const OurCvfhOptions small = {.min_points = 100, .cluster_tolerance_distance = 4, .radius_normals = 5};

std::vector<Description> our_cvfh(const PointCloud& cloud, const OurCvfhOptions& options = small) {
  return make_descriptor(options)->describe(cloud);
}

/// A square that faces the camera, in the middle of the image or beside it.
PointCloud square() {
  PointCloud cloud;
  for (int r = -15; r <= 15; ++r)
    for (int c = -15; c <= 15; ++c) cloud.points.emplace_back(static_cast<float>(c), static_cast<float>(r), 600.0f);
  cloud.normals.assign(cloud.size(), {0, 0, -1});
  return cloud;
}

TEST(OurCvfh, FramesStandOnTheFacesOfABox) {
  const auto cloud = box_view();
  const auto pose = corner_pose();
  auto options = small;
  options.axis_ratio = 1;  // one frame a cluster
  const auto descriptions = our_cvfh(cloud, options);
  ASSERT_EQ(descriptions.size(), 3);
  const Eigen::Vector3d normals[] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  for (int i = 0; i < 3; ++i) {
    const auto& d = descriptions[i];
    ASSERT_TRUE(d.camera_from_reference);
    const auto& frame = *d.camera_from_reference;
    EXPECT_TRUE(is_rigid(frame.matrix()));
    EXPECT_EQ(frame.translation(), d.centroid_mm);
    EXPECT_LT(angle_deg(frame.linear().col(2), pose.linear() * normals[i]), 1.5);
    EXPECT_LT(frame.linear().col(2).dot(d.centroid_mm), 0) << "towards the camera";
    // x lies along a side of the face, and most of the box lies on its positive side.
    const Eigen::Vector3d x = pose.linear().transpose() * frame.linear().col(0);
    EXPECT_GT(x.cwiseAbs().maxCoeff(), std::cos(radians(10)));
    double above = 0;
    for (const auto& p : cloud.points) above += frame.linear().col(0).dot(p.cast<double>() - d.centroid_mm);
    EXPECT_GT(above, 0);
  }
}

TEST(OurCvfh, BinsAreThoseOfCvfhButForTheOctants) {
  const auto cloud = box_view();
  const double n = static_cast<double>(cloud.size());
  for (const auto& d : our_cvfh(cloud)) {
    const Eigen::Vector3f normal = d.camera_from_reference->linear().col(2).cast<float>();
    const auto about = vfh_about(d.centroid_mm.cast<float>(), normal, OrientedPoints(cloud), {});
    EXPECT_EQ(std::vector<float>(d.histogram.begin() + viewpoint_part, d.histogram.end()),
              std::vector<float>(about.begin() + viewpoint_part, about.end()));
    for (int part = 0; part < 3; ++part)
      EXPECT_NEAR(sum(d.histogram, 45 * part, 45 * (part + 1)), 100 * n / (n - 1), 1e-2);
    EXPECT_NEAR(sum(d.histogram, octant_part, viewpoint_part), 100 * n / (n - 1), 1e-2);
  }
}

TEST(OurCvfh, OctantsCountDistancesInTheFrame) {
  const auto cloud = bracket_view(2);
  auto options = small;
  options.use_normalized_bins = false;
  options.octant_sigma = 1e-4f;  // each point in one octant
  const auto descriptions = our_cvfh(cloud, options);
  ASSERT_GE(descriptions.size(), 2);
  for (const auto& d : descriptions) {
    const Eigen::Isometry3d reference_from_camera = d.camera_from_reference->inverse();
    double largest = 0;
    for (const auto& p : cloud.points) largest = std::max(largest, (reference_from_camera * p.cast<double>()).norm());
    std::vector<float> expected(8 * our_cvfh_octant_bins, 0);
    for (const auto& point : cloud.points) {
      const Eigen::Vector3d p = reference_from_camera * point.cast<double>();
      const int octant = (p.x() > 0 ? 4 : 0) + (p.y() < 0 ? 2 : 0) + (p.z() > 0 ? 1 : 0);
      const int bin = std::min(static_cast<int>(our_cvfh_octant_bins * p.norm() / largest), our_cvfh_octant_bins - 1);
      ++expected[octant * our_cvfh_octant_bins + bin];
    }
    const std::vector<float> octants(d.histogram.begin() + octant_part, d.histogram.begin() + viewpoint_part);
    EXPECT_LE(l1(octants, expected), 4) << "a point or two on a border";
  }
}

TEST(OurCvfh, PointsNearAPlaneBetweenOctantsCountOnBothSides) {
  auto options = small;
  options.use_normalized_bins = false;
  const auto sharp = [&] {
    auto o = options;
    o.octant_sigma = 1e-4f;
    return our_cvfh(square(), o);
  }();
  options.octant_sigma = 1e6f;
  // With a width far beyond the part all octants get an eighth of every point.
  for (const auto& d : our_cvfh(square(), options))
    for (int octant = 0; octant < 8; ++octant) {
      const int begin = octant_part + octant * our_cvfh_octant_bins;
      EXPECT_NEAR(sum(d.histogram, begin, begin + our_cvfh_octant_bins), 961 / 8.0, 0.1);
    }
  // On the plane z = 0 itself both halves get the same, however sharp.
  for (const auto& d : sharp)
    for (int octant = 0; octant < 8; octant += 2)
      for (int bin = 0; bin < our_cvfh_octant_bins; ++bin) {
        const int i = octant_part + octant * our_cvfh_octant_bins + bin;
        EXPECT_NEAR(d.histogram[i], d.histogram[i + our_cvfh_octant_bins], 0.6);
      }
}

TEST(OurCvfh, ASquareHasFourFramesAQuarterTurnApart) {
  const auto descriptions = our_cvfh(square());
  ASSERT_EQ(descriptions.size(), 4);
  std::vector<double> angles_deg;
  for (const auto& d : descriptions) {
    const Eigen::Vector3d x = d.camera_from_reference->linear().col(0);
    EXPECT_NEAR(x.z(), 0, 1e-5);
    angles_deg.push_back(degrees(std::atan2(x.y(), x.x())));
    EXPECT_LT(l1(d.histogram, descriptions[0].histogram), 1) << "all look the same";
  }
  std::sort(angles_deg.begin(), angles_deg.end());
  for (int i = 1; i < 4; ++i) EXPECT_NEAR(angles_deg[i] - angles_deg[i - 1], 90, 1e-3);
}

TEST(OurCvfh, HowManyFramesIsUpToTheOptions) {
  const auto cloud = box_view();
  auto options = small;
  options.axis_ratio = 1;
  EXPECT_EQ(our_cvfh(cloud, options).size(), 3);
  options.axis_ratio = 0;
  options.min_axis_value = 1;
  EXPECT_EQ(our_cvfh(cloud, options).size(), 6);
  options.min_axis_value = 0;
  const auto four_each = our_cvfh(cloud, options);
  ASSERT_EQ(four_each.size(), 12);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(four_each[i].support, four_each[i / 4 * 4].support) << "of one cluster";
    EXPECT_LT(angle_deg(four_each[i].camera_from_reference->linear().col(2),
                        four_each[i / 4 * 4].camera_from_reference->linear().col(2)),
              1e-6);
  }
}

TEST(OurCvfh, RefinementKeepsThePointsWhoseNormalIsNearTheMean) {
  Random random(3);
  const auto cloud = view_of(sphere(40, 60, 40), Eigen::Isometry3d(Eigen::Translation3d(0, 0, 600)), 8000, random);
  auto options = small;
  options.axis_ratio = 1;
  options.refine_clusters = 100;
  const int all = our_cvfh(cloud, options).at(0).support;
  options.refine_clusters = 1;
  // A cap of 20 degrees of the hemisphere: 1 - cos 20 deg of its area.
  EXPECT_NEAR(our_cvfh(cloud, options).at(0).support, all * (1 - std::cos(radians(20))), 0.1 * all);
  EXPECT_GT(all, cloud.size() * 9 / 10);
  options.refine_clusters = 1e-6f;
  expect_defined(our_cvfh(cloud, options));
}

TEST(OurCvfh, WithoutClustersItIsThePlainVfhWithoutAFrame) {
  const auto cloud = bracket_view(1);
  auto options = small;
  options.min_points = 100000;
  const auto descriptions = our_cvfh(cloud, options);
  ASSERT_EQ(descriptions.size(), 1);
  EXPECT_FALSE(descriptions[0].valid);
  EXPECT_FALSE(descriptions[0].camera_from_reference);
  EXPECT_EQ(descriptions[0].support, cloud.size());
  EXPECT_EQ(descriptions[0].histogram, vfh(cloud, {.use_fill_size_component = false}));
}

TEST(OurCvfh, ThePointsOrderAndTheThreadsDoNotMatter) {
  for (const std::uint64_t seed : {3, 4, 5}) {
    const auto cloud = bracket_view(seed);
    const auto descriptions = our_cvfh(cloud);
    EXPECT_GE(descriptions.size(), 2);
    expect_same_bits(our_cvfh(shuffled(cloud, seed)), descriptions);
    const ThreadLimit one(1);
    expect_same_bits(our_cvfh(cloud), descriptions);
  }
}

TEST(OurCvfh, FramesTurnWithTheScene) {
  Random random(6);
  for (const std::uint64_t seed : {6, 7, 8}) {
    const auto cloud = bracket_view(seed);
    const auto descriptions = our_cvfh(cloud);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Isometry3d turn(Eigen::Quaterniond(random_turn(random, between(random, 0, 3))));
      const auto turned = our_cvfh(transformed(cloud, turn));
      ASSERT_EQ(turned.size(), descriptions.size());
      for (std::size_t d = 0; d < turned.size(); ++d) {
        const Eigen::Isometry3d expected = turn * *descriptions[d].camera_from_reference;
        EXPECT_LT(rotation_error_deg(*turned[d].camera_from_reference, expected), 1);
        EXPECT_LT(translation_error_mm(*turned[d].camera_from_reference, expected), 0.1);
        EXPECT_LT(l1(turned[d].histogram, descriptions[d].histogram), 8) << "of 500";
      }
    }
  }
}

TEST(OurCvfh, EachPointTwiceIsNearlyTheSame) {
  const auto cloud = bracket_view(9);
  auto twice = cloud;
  append(twice, cloud);
  auto doubled = small;
  doubled.min_points *= 2;
  const auto single = our_cvfh(cloud), both = our_cvfh(twice, doubled);
  ASSERT_EQ(both.size(), single.size());
  for (std::size_t d = 0; d < both.size(); ++d) {
    EXPECT_NEAR(both[d].support, 2 * single[d].support, 4);
    EXPECT_LT(rotation_error_deg(*both[d].camera_from_reference, *single[d].camera_from_reference), 1);
    EXPECT_LT(l1(both[d].histogram, single[d].histogram), 5);
  }
}

TEST(OurCvfh, MissingPointsAndNormalsAreLeftOut) {
  const auto cloud = bracket_view(10);
  auto with_missing = cloud;
  with_missing.points.insert(with_missing.points.begin() + 7, 2, Eigen::Vector3f(NAN, 0, 600));
  with_missing.normals.insert(with_missing.normals.begin() + 7, 2, Eigen::Vector3f(0, 0, -1));
  with_missing.curvatures.insert(with_missing.curvatures.begin() + 7, 2, 0.f);
  with_missing.points.push_back(cloud.points[3]);
  with_missing.normals.push_back(Eigen::Vector3f::Constant(NAN));
  with_missing.curvatures.push_back(NAN);
  expect_same_bits(our_cvfh(with_missing), our_cvfh(cloud));
}

TEST(OurCvfh, OfDegenerateClouds) {
  for (const auto& [name, cloud] : degenerate_clouds()) {
    SCOPED_TRACE(name);
    for (const int min_points : {1, 10, 1000}) {
      auto options = small;
      options.min_points = min_points;
      expect_defined(our_cvfh(cloud, options));
    }
  }
  EXPECT_TRUE(our_cvfh(PointCloud{}).empty());
}

/// Clusters of one, two and three points, and all in one plane.
TEST(OurCvfh, OfTinyClusters) {
  PointCloud cloud = square();
  auto options = small;
  options.min_points = 1;
  options.cluster_tolerance_distance = 0.5f;  // less than the points are apart
  const auto descriptions = our_cvfh(cloud, options);
  EXPECT_GE(descriptions.size(), cloud.size());
  expect_defined(descriptions);
  for (const auto& d : descriptions) ASSERT_EQ(d.support, 1);
}

TEST(OurCvfhOptions, CheckNamesTheKey) {
  const auto error_with = [](auto change) {
    OurCvfhOptions options;
    change(options);
    return error_of([&] { options.check(); });
  };
  EXPECT_EQ(error_with([](auto&) {}), "no error");
  EXPECT_PRED2(mentions, error_with([](auto& o) { o.k_nn = 0; }), "k_nn 0");
  EXPECT_PRED2(mentions, error_with([](auto& o) { o.min_points = 0; }), "min_points 0");
  EXPECT_PRED2(mentions, error_with([](auto& o) { o.radius_normals = -1; }), "radius_normals -1");
  EXPECT_PRED2(mentions, error_with([](auto& o) { o.refine_clusters = 0; }), "refine_clusters 0");
  EXPECT_PRED2(mentions, error_with([](auto& o) { o.axis_ratio = 1.5f; }), "axis_ratio 1.5");
  EXPECT_PRED2(mentions, error_with([](auto& o) { o.min_axis_value = NAN; }), "min_axis_value nan");
  EXPECT_PRED2(mentions, error_with([](auto& o) { o.octant_sigma = 0; }), "octant_sigma 0");
}

}  // namespace
}  // namespace partpose
