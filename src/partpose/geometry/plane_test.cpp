// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/plane.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

struct Table {
  PointCloud cloud;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< towards the camera
  double offset_mm = 0;
};

/// A table 300 mm wide with Gaussian noise, and other points in a cube about it.
Table table(Random& random, int on_plane, int elsewhere, double noise_mm) {
  Table out;
  const auto pose = random_pose(random, {30, -50, 700});
  out.normal = pose.linear().col(2);
  if (out.normal.dot(pose.translation()) > 0) out.normal = -out.normal;
  out.offset_mm = -out.normal.dot(pose.translation());
  out.cloud = random_cube(random, elsewhere, 150, pose.translation());
  for (int i = 0; i < on_plane; ++i) {
    const double x = between(random, -150, 150), y = between(random, -150, 150);
    out.cloud.points.push_back((pose * Eigen::Vector3d(x, y, noise_mm * random.normal_pair().first)).cast<float>());
  }
  return out;
}

TEST(FitPlane, FindsATableAmongOtherThings) {
  Random random(1);
  for (int round = 0; round < 10; ++round) {
    // The second size is more than the fit's own sample of the points.
    const int scale = round % 2 == 0 ? 1 : 8;
    const auto truth = table(random, 900 * scale, 600 * scale, 1.0);
    const auto fit = fit_plane(truth.cloud, {.distance_threshold_mm = 4});
    ASSERT_TRUE(fit);
    EXPECT_LT(angle_deg(fit->plane.normal, truth.normal), 0.3);
    EXPECT_NEAR(fit->plane.offset_mm, truth.offset_mm, 4);
    EXPECT_NEAR(fit->plane.signed_distance_mm(Eigen::Vector3f(30, -50, 700)), 0, 0.4);
    EXPECT_NEAR(fit->plane.normal.norm(), 1, 1e-12);
  }
}

TEST(FitPlane, InliersAreAllPointsWithinTheThreshold) {
  Random random(2);
  auto truth = table(random, 3000, 1000, 1.5);
  for (std::size_t i = 0; i < truth.cloud.size(); i += 9) truth.cloud.points[i].y() = nan;
  const auto fit = fit_plane(truth.cloud, {.distance_threshold_mm = 3});
  ASSERT_TRUE(fit);
  std::vector<int> expected;
  double squared = 0;
  for (std::size_t i = 0; i < truth.cloud.size(); ++i) {
    const double distance = fit->plane.normal.dot(truth.cloud.points[i].cast<double>()) + fit->plane.offset_mm;
    if (!(std::abs(distance) <= 3)) continue;
    expected.push_back(static_cast<int>(i));
    squared += distance * distance;
  }
  EXPECT_EQ(fit->inliers, expected);
  EXPECT_GT(expected.size(), 2400);
  EXPECT_NEAR(fit->rms_mm, std::sqrt(squared / static_cast<double>(expected.size())), 1e-9);
}

TEST(FitPlane, IsTheLeastSquaresPlaneOfItsInliers) {
  Random random(3);
  const auto truth = table(random, 1500, 200, 1.0);
  const auto fit = fit_plane(truth.cloud, {.distance_threshold_mm = 20});
  ASSERT_TRUE(fit);
  const auto squared_sum = [&](const Plane& plane) {
    double sum = 0;
    for (const int i : fit->inliers) sum += std::pow(plane.signed_distance_mm(truth.cloud.points[i]), 2);
    return sum;
  };
  const Eigen::Vector3d pivot(30, -50, 700);
  for (int i = 0; i < 20; ++i) {
    Plane tilted;
    tilted.normal = random_turn(random, radians(0.2)) * fit->plane.normal;
    tilted.offset_mm = fit->plane.offset_mm + (fit->plane.normal - tilted.normal).dot(pivot);
    EXPECT_LT(squared_sum(fit->plane), squared_sum(tilted));
    for (const double shift : {-0.2, 0.2})
      EXPECT_LT(squared_sum(fit->plane), squared_sum({fit->plane.normal, fit->plane.offset_mm + shift}));
  }
}

TEST(FitPlane, TheNormalFacesTheCamera) {
  Random random(4);
  for (int round = 0; round < 30; ++round) {
    const auto truth = table(random, 200, 0, 0.1);
    const auto fit = fit_plane(truth.cloud, {});
    ASSERT_TRUE(fit);
    EXPECT_GE(fit->plane.offset_mm, 0);
    EXPECT_GE(fit->plane.signed_distance_mm(Eigen::Vector3f::Zero()), 0) << "the camera is on the positive side";
    EXPECT_LT(angle_deg(fit->plane.normal, truth.normal), 0.05);
  }
}

TEST(FitPlane, ThroughThreePointsIsExact) {
  PointCloud cloud;
  cloud.points = {{0, 0, 500}, {100, 0, 500}, {0, 100, 520}};
  const auto fit = fit_plane(cloud, {.distance_threshold_mm = 1});
  ASSERT_TRUE(fit);
  const Eigen::Vector3d truth = Eigen::Vector3d(0, 20, -100).normalized();
  EXPECT_LT((fit->plane.normal - truth).norm(), 1e-6);
  EXPECT_EQ(fit->inliers, (std::vector{0, 1, 2}));
  EXPECT_NEAR(fit->rms_mm, 0, 1e-4);
}

TEST(FitPlane, NothingForPointsWithoutAPlane) {
  PointCloud cloud;
  EXPECT_FALSE(fit_plane(cloud, {}));
  cloud.points = {{0, 0, 500}, {1, 0, 500}};
  EXPECT_FALSE(fit_plane(cloud, {}));
  cloud.points.assign(50, {3, 4, 500});
  EXPECT_FALSE(fit_plane(cloud, {}));
  cloud.points.assign(50, Eigen::Vector3f::Constant(nan));
  EXPECT_FALSE(fit_plane(cloud, {}));
  Random random(5);
  for (int line = 0; line < 20; ++line) {
    const Eigen::Vector3d direction = line == 0 ? Eigen::Vector3d(Eigen::Vector3d::UnitX()) : random_direction(random);
    cloud.points.clear();
    for (int i = 0; i < 100; ++i) cloud.points.push_back((Eigen::Vector3d(10, 20, 600) + i * direction).cast<float>());
    EXPECT_FALSE(fit_plane(cloud, {})) << "collinear along " << direction.transpose();
  }
}

TEST(FitPlane, SameSeedSamePlane) {
  Random random(6);
  const auto truth = table(random, 3000, 3000, 2);
  const auto first = fit_plane(truth.cloud, {.seed = 7}), again = fit_plane(truth.cloud, {.seed = 7});
  ASSERT_TRUE(first && again);
  EXPECT_EQ(first->plane.normal, again->plane.normal);
  EXPECT_EQ(first->plane.offset_mm, again->plane.offset_mm);
  EXPECT_EQ(first->inliers, again->inliers);
}

TEST(FitPlane, RefusesAnImpossibleThreshold) {
  for (const float bad : {0.0f, -1.0f, nan})
    EXPECT_PRED2(mentions, error_of([&] { fit_plane(PointCloud{}, {.distance_threshold_mm = bad}); }), "threshold");
}

}  // namespace
}  // namespace partpose
