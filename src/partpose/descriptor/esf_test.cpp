// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// The comparison with PCL is in pipeline/esf_golden_test.cpp.
#include "partpose/descriptor/esf.hpp"

#include "partpose/core/parallel.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace partpose {
namespace {

using namespace shapes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

enum Part { a3_in, a3_out, a3_mixed, d3_in, d3_out, d3_mixed, d2_in, d2_out, d2_mixed, d2_ratio };

double part_sum(const std::vector<float>& histogram, int part) {
  return std::accumulate(histogram.begin() + 64 * part, histogram.begin() + 64 * (part + 1), 0.0);
}

double l1(const std::vector<float>& a, const std::vector<float>& b) {
  double distance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) distance += std::abs(static_cast<double>(a[i]) - b[i]);
  return distance;
}

PointCloud bracket(std::uint64_t seed, int count = 1500) {
  Random random(seed);
  return transformed(surface_points(l_bracket(), count, random), random_pose(random, {60, -80, 600}));
}

PointCloud shuffled(const PointCloud& cloud, std::uint64_t seed) {
  std::vector<int> order(cloud.size());
  std::iota(order.begin(), order.end(), 0);
  Random random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return select(cloud, order);
}

/// Distance between two draws from the same cloud.
double sampling_noise(const PointCloud& cloud) { return l1(esf(cloud, {.seed = 1}), esf(cloud, {.seed = 2})); }

TEST(Esf, SumsUpToOne) {
  const auto histogram = esf(bracket(1), {});
  ASSERT_EQ(histogram.size(), 640);
  EXPECT_NEAR(std::accumulate(histogram.begin(), histogram.end(), 0.0), 1, 1e-5);
  for (const float value : histogram) EXPECT_GE(value, 0);
}

/// Three points: one triangle, each time. Its sides are 3, 4 and 5.
TEST(Esf, OfOneTriangleByHand) {
  PointCloud cloud;
  cloud.points = {{0, 0, 600}, {3, 0, 600}, {0, 4, 600}};
  const auto histogram = esf(cloud, {.samples = 100});
  // The largest side stands for 5 and the only area for itself: bins 63 * length / 5.
  const auto lengths = [&](int bin) {
    double sum = 0;
    for (const int part : {d2_in, d2_out, d2_mixed}) sum += histogram[64 * part + bin];
    return sum;
  };
  for (const int bin : {38, 50, 63}) EXPECT_GT(lengths(bin), 0) << bin;
  double areas = 0, angles = 0;
  for (const int part : {d3_in, d3_out, d3_mixed}) areas += histogram[64 * part + 63];
  EXPECT_NEAR(areas, part_sum(histogram, d3_in) + part_sum(histogram, d3_out) + part_sum(histogram, d3_mixed), 1e-7);
  EXPECT_GT(areas, 0);
  // Angles of 36.87, 53.13 and 90 degrees: bins 63 * angle / 90.
  for (const int bin : {26, 37, 63}) {
    double sum = 0;
    for (const int part : {a3_in, a3_out, a3_mixed}) sum += histogram[64 * part + bin];
    EXPECT_GT(sum, 0) << bin;
    angles += sum;
  }
  EXPECT_NEAR(angles, part_sum(histogram, a3_in) + part_sum(histogram, a3_out) + part_sum(histogram, a3_mixed), 1e-7);
}

/// Sides within a dense plate are inside, sides between two far plates pass through nothing.
TEST(Esf, InsideAndOutside) {
  Random random(2);
  PointCloud plate, plates;
  for (int i = 0; i < 4000; ++i)
    plate.points.emplace_back(static_cast<float>(between(random, -50, 50)),
                              static_cast<float>(between(random, -50, 50)), 600.0f);
  const auto of_plate = esf(plate, {});
  EXPECT_GT(part_sum(of_plate, d2_in), 0.1);
  EXPECT_LT(part_sum(of_plate, d2_out) + part_sum(of_plate, d2_mixed), 0.01);
  EXPECT_LT(part_sum(of_plate, a3_out) + part_sum(of_plate, a3_mixed), 0.01);
  EXPECT_LT(part_sum(of_plate, d3_out) + part_sum(of_plate, d3_mixed), 0.01);

  // Sides between the plates: half of all, with weight 2 against 1/2 of the others, less those along the edges.
  for (const auto& p : plate.points) plates.points.push_back(p + Eigen::Vector3f(0, 0, p.x() > 0 ? 60.0f : -60.0f));
  const auto of_plates = esf(plates, {});
  EXPECT_GT(part_sum(of_plates, d2_out), 2 * part_sum(of_plates, d2_in));
  EXPECT_LT(part_sum(of_plates, d2_mixed), part_sum(of_plates, d2_out));
}

TEST(Esf, LengthsOnASphereFollowTheirLaw) {
  // The distance d of two random points of a sphere of radius r has the density d / (2 r^2), 0 to 2 r (Solomon 1978).
  Random random(3);
  PointCloud cloud;
  for (int i = 0; i < 5000; ++i) cloud.points.push_back((50 * random_direction(random)).cast<float>());
  const auto histogram = esf(cloud, {.samples = 200000});
  // Inside, outside and mixed sides differ in weight: bring them back to shares of all sides.
  std::array<double, 64> share{};
  double all = 0;
  for (int bin = 0; bin < 64; ++bin) {
    share[bin] =
        2.0 * histogram[64 * d2_in + bin] + 0.5 * histogram[64 * d2_out + bin] + 0.5 * histogram[64 * d2_mixed + bin];
    all += share[bin];
  }
  for (int bin = 1; bin < 63; ++bin) {
    const double expected = (std::pow((bin + 0.5) / 63, 2) - std::pow((bin - 0.5) / 63, 2));
    EXPECT_NEAR(share[bin] / all, expected, 0.05 * expected + 5e-4) << bin;
  }
}

TEST(Esf, ThePointsOrderDoesNotMatter) {
  for (const std::uint64_t seed : {3, 4, 5}) {
    const auto cloud = bracket(seed);
    EXPECT_TRUE(same_bits(esf(shuffled(cloud, seed), {}), esf(cloud, {})));
  }
}

TEST(Esf, EachPointTwiceIsTheSame) {
  const auto cloud = bracket(6);
  auto twice = cloud;
  append(twice, shuffled(cloud, 1));
  EXPECT_TRUE(same_bits(esf(twice, {}), esf(cloud, {})));
}

TEST(Esf, OneSeedOneHistogram) {
  const auto cloud = bracket(7);
  EXPECT_TRUE(same_bits(esf(cloud, {.seed = 5}), esf(cloud, {.seed = 5})));
  EXPECT_FALSE(same_bits(esf(cloud, {.seed = 5}), esf(cloud, {.seed = 6})));
  EXPECT_LT(sampling_noise(cloud), 0.08);
}

TEST(Esf, MoreSamplesLessNoise) {
  const auto cloud = bracket(8);
  const double few = l1(esf(cloud, {.samples = 2000, .seed = 1}), esf(cloud, {.samples = 2000, .seed = 2}));
  const double many = l1(esf(cloud, {.samples = 200000, .seed = 1}), esf(cloud, {.samples = 200000, .seed = 2}));
  EXPECT_LT(many, few / 4);
}

/// The voxel grid stands along the axes of the camera, so a turn changes which sides graze a voxel.
TEST(Esf, TurnsMovesAndScalesDoNotMatterMuch) {
  Random random(9);
  const auto cloud = bracket(9);
  const auto histogram = esf(cloud, {});
  const double noise = sampling_noise(cloud);
  for (int i = 0; i < 10; ++i)
    EXPECT_LT(l1(esf(transformed(cloud, random_pose(random, {10, 20, 700})), {}), histogram), 3 * noise);
  auto scaled = cloud;
  for (auto& p : scaled.points) p *= 4.0f;  // exact in binary: nothing changes at all
  EXPECT_TRUE(same_bits(esf(scaled, {}), histogram));
  Random other(10);
  EXPECT_GT(l1(esf(surface_points(box(Eigen::Vector3f(80, 50, 30)), 1500, other), {}), histogram), 6 * noise);
}

TEST(Esf, ThreadsDoNotMatter) {
  const auto cloud = bracket(11);
  const auto alone = [&] {
    const ThreadLimit one(1);
    return esf(cloud, {});
  }();
  std::vector<std::vector<float>> results(8);
  parallel_for(results.size(), [&](std::size_t i) { results[i] = esf(cloud, {}); });
  for (const auto& result : results) EXPECT_TRUE(same_bits(result, alone));
}

TEST(Esf, MissingPointsAreLeftOut) {
  const auto cloud = bracket(12);
  auto with_missing = cloud;
  with_missing.points.insert(with_missing.points.begin() + 7, {nan, 0, 600});
  with_missing.points.emplace_back(0.0f, std::numeric_limits<float>::infinity(), 600.0f);
  EXPECT_TRUE(same_bits(esf(with_missing, {}), esf(cloud, {})));
  const auto descriptions = make_descriptor(EsfOptions{})->describe(with_missing);
  ASSERT_EQ(descriptions.size(), 1);
  EXPECT_EQ(descriptions[0].support, cloud.size());
  EXPECT_LT((descriptions[0].centroid_mm - centroid(cloud)).norm(), 1e-4);
  EXPECT_FALSE(descriptions[0].camera_from_reference);
}

TEST(Esf, NoTriangleNoDescription) {
  PointCloud empty, one, two, same, line, missing;
  one.points = {{1, 2, 600}};
  two.points = {{1, 2, 600}, {4, 2, 600}};
  missing.points = {{nan, nan, nan}, {nan, 0, 1}, {0, 0, nan}};
  for (int i = 0; i < 20; ++i) {
    same.points.emplace_back(1.0f, 2.0f, 600.0f);
    line.points.emplace_back(0.0f, 0.0f, 600.0f + static_cast<float>(i));
  }
  const auto descriptor = make_descriptor(EsfOptions{});
  EXPECT_EQ(descriptor->bins(), 640);
  for (const auto* cloud : {&empty, &one, &two, &same, &line, &missing}) {
    EXPECT_EQ(esf(*cloud, {}), std::vector<float>(640, 0.0f));
    EXPECT_TRUE(descriptor->describe(*cloud).empty());
  }
}

TEST(Esf, ExtremeSizesAreDefined) {
  Random random(13);
  for (const float size : {1e-30f, 1e-3f, 1e6f, 1e30f}) {
    PointCloud cloud = random_cube(random, 300, 1);
    for (auto& p : cloud.points) p *= size;
    const auto histogram = esf(cloud, {.samples = 2000});
    EXPECT_NEAR(std::accumulate(histogram.begin(), histogram.end(), 0.0), 1, 1e-5) << size;
  }
}

TEST(Esf, CheckNamesTheKey) {
  EXPECT_PRED2(mentions, error_of([] { EsfOptions{.samples = 0}.check(); }), "samples 0");
  EXPECT_PRED2(mentions, error_of([] { EsfOptions{.samples = 20'000'000}.check(); }), "samples 20000000");
  EXPECT_PRED2(mentions, error_of([] { EsfOptions{.seed = -1}.check(); }), "seed -1");
}

}  // namespace
}  // namespace partpose
