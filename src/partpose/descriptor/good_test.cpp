// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/good.hpp"

#include "partpose/core/parallel.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace partpose {
namespace {

using namespace shapes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

double l1(const std::vector<float>& a, const std::vector<float>& b) {
  double distance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) distance += std::abs(static_cast<double>(a[i]) - b[i]);
  return distance;
}

/// Descriptions of one frame.
Description one(const PointCloud& cloud, const GoodOptions& options = {}) {
  const auto descriptions = good(cloud, options);
  EXPECT_EQ(descriptions.size(), 1);
  return descriptions.empty() ? Description{} : descriptions[0];
}

/// The three axes differ in variance and in what lies on their two sides: nothing about its frame is in doubt.
PointCloud lopsided(std::uint64_t seed, int count = 3000) {
  Random random(seed);
  const auto feet = joined(box({0, 0, 0}, {30, 40, 10}), box({0, 0, 0}, {12, 12, 30}));
  return surface_points(joined(box({0, 0, 0}, {100, 10, 10}), feet), count, random);
}

PointCloud shuffled(const PointCloud& cloud, std::uint64_t seed) {
  std::vector<int> order(cloud.size());
  std::iota(order.begin(), order.end(), 0);
  Random random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return select(cloud, order);
}

Eigen::Matrix3d turn_of(const Description& description) { return description.camera_from_reference->linear(); }

TEST(Good, FrameAndViewsByHand) {
  // Four points: x spreads most, then y; the tails point to +x and +y, so the axes point to -x and -y.
  PointCloud cloud;
  cloud.points = {{30, 0, 600}, {-10, 6, 600}, {-10, -3, 600}, {-10, -3, 600}};
  const auto description = one(cloud, {.num_of_bins = 5, .threshold = 1000});
  EXPECT_TRUE(description.camera_from_reference->translation().isApprox(Eigen::Vector3d(0, 0, 600)));
  EXPECT_TRUE(turn_of(description).isApprox(Eigen::Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix(), 1e-9))
      << turn_of(description);
  // The longest side of the box is 40: bins of 8 mm from -20 to 20. x: -30 (outside) and 10 three times (bin 3);
  // y: 0 (bin 2), -6 (bin 1), 3 twice (bin 2); z: 0 (bin 2).
  std::vector<float> expected(75, 0.0f);
  expected[3 * 5 + 1] = 1.0f / 3;  // along z, x by y: the highest entropy, 0.92 bits
  expected[3 * 5 + 2] = 2.0f / 3;
  expected[25 + 3 * 5 + 2] = 1;     // along y, x by z: no variance
  expected[50 + 1 * 5 + 2] = 0.25;  // along x, y by z: 0.81 bits
  expected[50 + 2 * 5 + 2] = 0.75;
  EXPECT_LT(l1(description.histogram, expected), 1e-6);
}

TEST(Good, TheMajorityBeyondTheThresholdSettlesTheSign) {
  // Five points at -1 mm and two far ones at +10 mm along x; the mean is near 2.14 mm.
  PointCloud cloud;
  for (int i = 0; i < 5; ++i) cloud.points.emplace_back(-1.0f, 0.2f * static_cast<float>(i), 600.0f);
  for (int i = 0; i < 2; ++i) cloud.points.emplace_back(10.0f, 0.2f * static_cast<float>(i), 600.0f);
  // Threshold 1 mm: all vote, five against two for -x. Threshold 5 mm: only the far ones. 100 mm: nobody, and the
  // longer tail decides.
  EXPECT_LT(turn_of(one(cloud, {.threshold = 1}))(0, 0), 0);
  EXPECT_GT(turn_of(one(cloud, {.threshold = 5}))(0, 0), 0);
  EXPECT_LT(turn_of(one(cloud, {.threshold = 100}))(0, 0), 0);
}

TEST(Good, RigidMotionsMoveTheFrameAndNothingElse) {
  Random random(1);
  for (const float threshold : {0.0f, 15.0f, 200.0f}) {
    const GoodOptions options{.threshold = threshold};
    const auto cloud = lopsided(1);
    const auto reference = one(cloud, options);
    for (int i = 0; i < 100; ++i) {
      const auto motion = random_pose(random, {50, -30, 700});
      const auto moved = one(transformed(cloud, motion), options);
      // Of 3000 points some few lie within the rounding of a bin's border.
      EXPECT_LT(l1(moved.histogram, reference.histogram), 3e-3);
      const Eigen::Isometry3d expected = motion * *reference.camera_from_reference;
      EXPECT_LT((moved.camera_from_reference->matrix() - expected.matrix()).cwiseAbs().maxCoeff(), 1e-3);
      EXPECT_NEAR(turn_of(moved).determinant(), 1, 1e-9);
    }
  }
}

TEST(Good, ViewsOfAPartKeepTheirFrame) {
  // What a camera sees of a part, turned about the line of sight and moved: lopsided too, but for other reasons.
  Random random(2);
  int judged = 0;
  for (int view = 0; view < 20; ++view) {
    const auto whole = transformed(lopsided(3, 4000), random_pose(random, {0, 0, 600}));
    std::vector<int> facing;
    for (int i = 0; i < whole.size(); ++i)
      if (whole.normals[i].dot(whole.points[i]) < 0) facing.push_back(i);
    const auto cloud = select(whole, facing);
    if (good(cloud, {.ambiguous_frames = true}).size() > 1) continue;
    ++judged;
    const auto reference = one(cloud);
    const auto motion = random_pose(random, {20, 30, 500});
    const auto moved = one(transformed(cloud, motion));
    EXPECT_LT(l1(moved.histogram, reference.histogram), 3e-3);
    EXPECT_LT((moved.camera_from_reference->matrix() - (motion * *reference.camera_from_reference).matrix())
                  .cwiseAbs()
                  .maxCoeff(),
              1e-3);
  }
  EXPECT_GE(judged, 3);
}

TEST(Good, AMirrorImageIsAnother) {
  const auto cloud = lopsided(4);
  auto mirrored = cloud;
  for (auto& p : mirrored.points) p.x() = -p.x();
  EXPECT_GT(l1(one(mirrored).histogram, one(cloud).histogram), 0.1);
}

TEST(Good, ThePointsOrderDoesNotMatter) {
  for (const std::uint64_t seed : {5, 6, 7}) {
    const auto cloud = lopsided(seed);
    const auto a = one(cloud), b = one(shuffled(cloud, seed));
    EXPECT_TRUE(same_bits(a.histogram, b.histogram));
    EXPECT_EQ(a.camera_from_reference->matrix(), b.camera_from_reference->matrix());
  }
}

TEST(Good, EachPointTwiceIsTheSame) {
  const auto cloud = lopsided(8);
  auto twice = cloud;
  append(twice, shuffled(cloud, 1));
  const auto a = one(cloud), b = one(twice);
  EXPECT_TRUE(same_bits(a.histogram, b.histogram));
  EXPECT_EQ(a.camera_from_reference->matrix(), b.camera_from_reference->matrix());
}

TEST(Good, ThreadsDoNotMatter) {
  const auto cloud = lopsided(9);
  const auto alone = one(cloud);
  std::vector<std::vector<Description>> results(8);
  parallel_for(results.size(), [&](std::size_t i) { results[i] = good(cloud, {}); });
  for (const auto& result : results) EXPECT_TRUE(same_bits(result.at(0).histogram, alone.histogram));
}

TEST(Good, EachViewSumsUpToOne) {
  for (const int n : {1, 2, 5, 6, 15}) {
    const auto histogram = one(lopsided(10), {.num_of_bins = n}).histogram;
    ASSERT_EQ(histogram.size(), 3 * n * n);
    EXPECT_EQ(make_descriptor(GoodOptions{.num_of_bins = n})->bins(), 3 * n * n);
    for (int view = 0; view < 3; ++view)
      EXPECT_NEAR(std::accumulate(histogram.begin() + view * n * n, histogram.begin() + (view + 1) * n * n, 0.0), 1,
                  1e-5);
  }
}

TEST(Good, AmbiguousFramesHoldTheOneThatNoiseMakes) {
  // A box has no better side along any axis: the frame of one sample of points is among the frames of another.
  Random random(11);
  const auto mesh = box(Eigen::Vector3f(80, 50, 20));
  const GoodOptions options{.threshold = 5, .ambiguous_frames = true};
  for (int i = 0; i < 10; ++i) {
    const auto motion = random_pose(random, {0, 0, 600});
    const auto a = transformed(surface_points(mesh, 2000, random), motion);
    const auto b = transformed(surface_points(mesh, 2000, random), motion);
    const auto target = one(a, {.threshold = 5});
    const auto frames = good(b, options);
    EXPECT_EQ(frames.size(), 4);
    EXPECT_TRUE(same_bits(frames[0].histogram, one(b, {.threshold = 5}).histogram)) << "the definition's comes first";
    double nearest_deg = 180;
    for (const auto& frame : frames)
      nearest_deg =
          std::min(nearest_deg, degrees(Eigen::AngleAxisd(turn_of(frame).transpose() * turn_of(target)).angle()));
    EXPECT_LT(nearest_deg, 5);
  }
  EXPECT_EQ(good(lopsided(11), {.ambiguous_frames = true}).size(), 1) << "nothing is in doubt";
}

TEST(Good, AmbiguousFramesExchangeAxesOfEqualSpread) {
  Random random(12);
  const auto square = surface_points(box(Eigen::Vector3f(60, 60, 10)), 2000, random);
  const auto frames = good(square, {.threshold = 5, .ambiguous_frames = true});
  EXPECT_EQ(frames.size(), 8) << "two signs of two axes, in either order";
  for (const auto& frame : frames) EXPECT_NEAR(turn_of(frame).determinant(), 1, 1e-9);
}

TEST(Good, OfDegenerateClouds) {
  PointCloud single, same, line, plane, far;
  single.points = {{10, 20, 600}};
  far.points = {{3e38f, -3e38f, 3e38f}, {-3e38f, 3e38f, 3e38f}, {1, 2, 3}};
  for (int i = 0; i < 25; ++i) {
    same.points.emplace_back(1.0f, 2.0f, 600.0f);
    line.points.emplace_back(0.0f, 0.0f, 600.0f + 0.5f * static_cast<float>(i * i));
    plane.points.emplace_back(static_cast<float>(i % 5), static_cast<float>(i / 5), 600.0f);
  }
  Random random(13);
  PointCloud ball = surface_points(sphere(40, 40, 20), 2000, random);
  for (const auto* cloud : {&single, &same, &line, &plane, &far, &ball}) {
    for (const bool ambiguous : {false, true}) {
      const auto descriptions = good(*cloud, {.ambiguous_frames = ambiguous});
      ASSERT_FALSE(descriptions.empty());
      for (const auto& description : descriptions) {
        ASSERT_EQ(description.histogram.size(), 108);
        for (const float value : description.histogram) EXPECT_TRUE(std::isfinite(value) && value >= 0);
        EXPECT_NEAR(std::accumulate(description.histogram.begin(), description.histogram.end(), 0.0), 3, 1e-5);
        EXPECT_TRUE(turn_of(description).isUnitary(1e-9));
        EXPECT_NEAR(turn_of(description).determinant(), 1, 1e-9);
        EXPECT_EQ(description.support, cloud->size());
      }
      EXPECT_TRUE(same_bits(descriptions[0].histogram, good(shuffled(*cloud, 1), {})[0].histogram));
    }
  }
  EXPECT_LT(angle_deg(turn_of(one(line)).col(0), Eigen::Vector3d(0, 0, -1)), 1e-3) << "away from the longer tail";
  EXPECT_LT(angle_deg(turn_of(one(plane)).col(2).cwiseAbs(), Eigen::Vector3d(0, 0, 1)), 1e-3);
}

TEST(Good, MissingPointsAreLeftOut) {
  const auto cloud = lopsided(14);
  auto with_missing = cloud;
  with_missing.points.insert(with_missing.points.begin() + 7, {nan, 0, 600});
  EXPECT_TRUE(same_bits(one(with_missing).histogram, one(cloud).histogram));
  PointCloud nothing;
  EXPECT_TRUE(good(nothing, {}).empty());
  nothing.points = {{nan, nan, nan}};
  EXPECT_TRUE(good(nothing, {}).empty());
}

TEST(Good, CheckNamesTheKey) {
  EXPECT_PRED2(mentions, error_of([] { GoodOptions{.num_of_bins = 101}.check(); }), "num_of_bins 101");
}

}  // namespace
}  // namespace partpose
