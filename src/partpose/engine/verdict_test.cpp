// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/verdict.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace partpose {
namespace {

DepthComparison good_comparison() {
  DepthComparison c;
  c.model = c.object = c.explained = 1000;
  c.local_deviations = 1000;
  c.log_likelihood = 2800;
  c.best_log_likelihood = 3500;
  return c;
}

TEST(Verdict, FallsWithWhatIsNotExplained) {
  const double good = probability_of_part(good_comparison());
  EXPECT_GT(good, 0.9);
  DepthComparison unexplained = good_comparison(), free_space = good_comparison();
  unexplained.unexplained = 250;
  free_space.free_space = 100;
  EXPECT_LT(probability_of_part(unexplained), 0.2);
  EXPECT_LT(probability_of_part(free_space), 0.3);
  EXPECT_EQ(probability_of_part({}), 0);
}

TEST(Verdict, WhatIsHiddenIsNotHeldAgainstAPart) {
  DepthComparison hidden = good_comparison();
  hidden.model = 1700;
  hidden.hidden = 700;
  EXPECT_NEAR(probability_of_part(hidden), probability_of_part(good_comparison()), 1e-9);
}

TEST(Verdict, SharesAddUpAndFavourTheLikelier) {
  const std::vector<double> values = {1000, 1000 - 200, -1000};
  const auto share = shares(values, 1);
  EXPECT_NEAR(std::accumulate(share.begin(), share.end(), 0.0), 1, 1e-12);
  EXPECT_NEAR(share[0] / share[1], std::exp(1.0), 1e-9);  // 200 pixels err together
  EXPECT_LT(share[2], 1e-3);
  EXPECT_TRUE(shares({}, 1).empty());
}

TEST(Verdict, AKeywayThatPointsAwayLooksTheSame) {
  const Intrinsics camera{120, 100, 500, 500, 59.5, 49.5};
  const TriangleMesh ball = shapes::sphere(25, 60, 30), bracket = shapes::l_bracket();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 500;
  Eigen::Isometry3d turned = pose;
  turned.linear() = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_TRUE(looks_the_same(ball, pose, ball, turned, camera, {.noise_mm = 0.5}));
  EXPECT_FALSE(looks_the_same(bracket, pose, bracket, turned, camera, {.noise_mm = 0.5}));
}

TEST(Verdict, TheCovarianceIsThatOfTheNormalEquations) {
  // Points on three faces of a box about the centre determine all six.
  Matrix6d hessian = Matrix6d::Zero();
  Random random(3);
  for (int i = 0; i < 4000; ++i) {
    Eigen::Vector3d arm = 40 * shapes::random_direction(random), normal = Eigen::Vector3d::Unit(i % 3);
    Vector6d row;
    row << arm.cross(normal), normal;
    hessian += row * row.transpose();
  }
  const Eigen::Vector3d centre(0, 0, 600);
  const Matrix6d independent = pose_covariance(hessian, centre, centre, {2, 2}, 1, 100);
  EXPECT_TRUE(independent.isApprox(4 * hessian.inverse(), 0.01));
  // Errors that neighbours share leave more of it.
  EXPECT_GT(pose_covariance(hessian, centre, centre, {0.5, 2}, 1, 100)(5, 5), 10 * independent(5, 5));
  // Elsewhere a turn moves the place as well.
  const Matrix6d aside = pose_covariance(hessian, centre, centre + Eigen::Vector3d(200, 0, 0), {2, 2}, 1, 100);
  EXPECT_NEAR(aside(5, 5), independent(5, 5) + 200 * 200 * independent(1, 1), 0.1 * aside(5, 5));
  // What the surface leaves free is not known better than the part's size tells.
  const Matrix6d nothing = pose_covariance(Matrix6d::Zero(), centre, centre, {2, 2}, 1, 100);
  EXPECT_NEAR(nothing(3, 3), 100 * 100, 1);
}

}  // namespace
}  // namespace partpose
