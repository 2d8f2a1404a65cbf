// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/descriptors.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST(GlobalDescriptor, VfhByItsName) {
  DescriptorOptions options;
  options.vfh.use_fill_size_component = false;
  const auto descriptor = make_global_descriptor("vfh", options);
  EXPECT_EQ(descriptor->bins(), vfh_bins);
  Random random(1);
  const auto cloud = transformed(surface_points(l_bracket(), 300, random), random_pose(random, {0, 0, 600}));
  const auto descriptions = descriptor->describe(cloud);
  ASSERT_EQ(descriptions.size(), 1);
  EXPECT_EQ(descriptions[0].histogram, vfh(cloud, options.vfh));
  EXPECT_NE(descriptions[0].histogram, vfh(cloud, {}));
  EXPECT_TRUE(descriptor->describe(PointCloud{}).empty());
}

TEST(GlobalDescriptor, AnUnknownNameGetsTheNearest) {
  EXPECT_EQ(error_of([] { make_global_descriptor("vhf", {}); }),
            "global_descriptor \"vhf\" is unknown; did you mean \"vfh\"?");
  EXPECT_PRED2(mentions, error_of([] { make_global_descriptor("our_cvfh", {}); }), "did you mean \"ourcvfh\"?");
  EXPECT_PRED2(mentions, error_of([] { make_global_descriptor("VFH", {}); }), "\"VFH\" is unknown");
  EXPECT_PRED2(mentions, error_of([] { make_global_descriptor("", {}); }), "is unknown");
}

TEST(GlobalDescriptor, EachNameHasItsOwnNumberOfNeighbours) {
  DescriptorOptions options;
  options.vfh.k_nn = 1;
  options.cvfh.k_nn = 2;
  options.ourcvfh.k_nn = 3;
  options.esf.k_nn = 4;
  options.good.k_nn = 5;
  EXPECT_EQ(neighbours_of("vfh", options), 1);
  EXPECT_EQ(neighbours_of("cvfh", options), 2);
  EXPECT_EQ(neighbours_of("ourcvfh", options), 3);
  EXPECT_EQ(neighbours_of("esf", options), 4);
  EXPECT_EQ(neighbours_of("good", options), 5);
}

template <typename Options, typename Change>
std::string check_with(const Change& change) {
  Options options;
  change(options);
  return error_of([&] { options.check(); });
}

TEST(DescriptorOptions, CheckNamesTheKey) {
  const auto nothing = [](auto&) {};
  const auto no_neighbours = [](auto& o) { o.k_nn = 0; };
  EXPECT_EQ(check_with<VfhOptions>(nothing), "no error");
  EXPECT_EQ(check_with<CvfhOptions>(nothing), "no error");
  EXPECT_EQ(check_with<EsfOptions>(nothing), "no error");
  EXPECT_EQ(check_with<GoodOptions>(nothing), "no error");
  EXPECT_PRED2(mentions, check_with<VfhOptions>(no_neighbours), "k_nn 0");
  EXPECT_PRED2(mentions, check_with<CvfhOptions>(no_neighbours), "k_nn 0");
  EXPECT_PRED2(mentions, check_with<EsfOptions>(no_neighbours), "k_nn 0");
  EXPECT_PRED2(mentions, check_with<GoodOptions>(no_neighbours), "k_nn 0");
  EXPECT_PRED2(mentions, check_with<CvfhOptions>([](auto& o) { o.min_points = 0; }), "min_points 0");
  EXPECT_PRED2(mentions, check_with<GoodOptions>([](auto& o) { o.num_of_bins = 0; }), "num_of_bins 0");
  for (const float bad : {-1.0f, nan}) {
    EXPECT_PRED2(mentions, check_with<CvfhOptions>([&](auto& o) { o.cluster_tolerance_distance = bad; }),
                 "cluster_tolerance_distance");
    EXPECT_PRED2(mentions, check_with<CvfhOptions>([&](auto& o) { o.eps_angle_threshold_deg = bad; }),
                 "eps_angle_threshold_deg");
    EXPECT_PRED2(mentions, check_with<CvfhOptions>([&](auto& o) { o.radius_normals = bad; }), "radius_normals");
    EXPECT_PRED2(mentions, check_with<GoodOptions>([&](auto& o) { o.threshold = bad; }), "threshold");
  }
}

}  // namespace
}  // namespace partpose
