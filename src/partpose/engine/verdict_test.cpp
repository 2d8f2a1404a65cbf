// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/verdict.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace partpose {
namespace {

/// Of a part seen with 1000 pixels, of which the object has some that are not the part's, and the part some that are
/// not the object's.
DepthComparison comparison_of(int unexplained, int free_space) {
  constexpr double agreement = 0.92;
  DepthComparison c;
  c.model = c.object = 1000;
  c.unexplained = unexplained;
  c.free_space = free_space;
  c.explained = 1000 - unexplained;
  c.near = c.explained;
  c.near_deviations = c.local_deviations = c.explained;
  c.log_likelihood = 2.8 * c.explained;
  c.best_log_likelihood = 3500;
  c.soft = 2 * agreement * c.explained;
  c.judged = 2 * c.explained + unexplained + free_space;
  return c;
}
DepthComparison good_comparison() { return comparison_of(0, 0); }

PartInFrame at_rest() {
  return {.noise_mm = 1, .relief_mm = 2, .extent_mm = 100, .diameter_mm = 100, .height_mm = 0.0};
}
double rough(const DepthComparison& comparison) { return rough_probability(comparison, at_rest()); }
double probability(const DepthComparison& comparison, const PartInFrame& part = at_rest()) {
  return probability_of_part(explanation_of(comparison, part));
}

TEST(Verdict, FallsWithWhatIsNotExplained) {
  EXPECT_GT(probability(good_comparison()), 0.9);
  EXPECT_LT(probability(comparison_of(250, 0)), 0.5);
  EXPECT_LT(probability(comparison_of(0, 250)), 0.3);
  EXPECT_EQ(probability({}), 0);
  const auto doubts = [](auto change) {
    DepthComparison c = good_comparison();
    change(c);
    return (1 - probability(c)) / (1 - probability(good_comparison()));
  };
  EXPECT_GT(doubts([](auto& c) { c.nothing = 200; }), 2);
  EXPECT_GT(doubts([](auto& c) { c.model_outline = c.narrower = 200; }), 2);
  EXPECT_GT(doubts([](auto& c) { c.near_deviations = 4 * c.near; }), 2);
  EXPECT_GT(doubts([](auto& c) { c.local_deviations = 9 * c.near; }), 2);  // steps and holes that the part has not
}

TEST(Verdict, EdgesAndFineShapeThatBothHaveSpeakForAPart) {
  PartInFrame part = at_rest();
  part.local_noise_mm = 0.4;  // of a camera that matches windows
  const auto odds = [&](const DepthComparison& c) {
    const double p = probability(c, part);
    return p / (1 - p);
  };
  DepthComparison plain = good_comparison(), same = plain, other = plain;
  plain.fine_shape = {.pixels = 1000, .measured = 300, .part = 300, .common = 150};
  same = other = plain;
  same.jumps = other.jumps = 200;
  same.common_jumps = 200;
  EXPECT_GT(odds(same), 2 * odds(other));
  same = other = plain;
  same.fine_shape.common = 300;
  other.fine_shape.common = 0;
  EXPECT_GT(odds(same), 2 * odds(plain));
  EXPECT_LT(odds(other), 0.5 * odds(plain));
  DepthComparison wider = plain;
  wider.model_outline = wider.narrower = 100;
  EXPECT_LT(odds(wider), 0.5 * odds(plain));
}

TEST(Verdict, AtFirstFallsWithWhatIsNotExplained) {
  EXPECT_GT(rough(good_comparison()), 0.9);
  EXPECT_LT(rough(comparison_of(250, 0)), 0.2);
  EXPECT_LT(rough(comparison_of(0, 100)), 0.3);
  EXPECT_EQ(rough({}), 0);
}

TEST(Verdict, AFlatViewSaysLess) {
  PartInFrame flat = at_rest();
  flat.relief_mm = 0.5;
  DepthComparison of_shape = good_comparison();
  of_shape.fine_shape = {.pixels = 1000, .measured = 300, .part = 300, .common = 200};
  EXPECT_GT(1 - probability(good_comparison(), flat), 2 * (1 - probability(of_shape)));
}

TEST(Verdict, NothingHangsInTheAirNorSinksNorIsSeenThroughNoise) {
  const DepthComparison c = good_comparison();
  const auto at_height = [](std::optional<double> height_mm) {
    PartInFrame part = at_rest();
    part.height_mm = height_mm;
    return part;
  };
  EXPECT_LT(probability(c, at_height(25)), 0.3);
  EXPECT_GT(1 - probability(c, at_height(-25)), 10 * (1 - probability(c)));
  // Where there is no table, and so high that the part stands on something else, nothing is known.
  EXPECT_EQ(probability(c, at_height({})), probability(c));
  EXPECT_EQ(probability(c, at_height(300)), probability(c));
  PartInFrame small = at_rest();
  small.extent_mm = 5;
  EXPECT_LT(probability(c, small), probability(c) - 0.05);
  EXPECT_LT(rough_probability(c, at_height(25)), 0.3);
  PartInFrame noisy = at_rest();
  noisy.noise_mm = 10;
  EXPECT_LT(rough_probability(c, noisy), 0.8);
}

TEST(Verdict, WhatIsHiddenIsNotHeldAgainstAPart) {
  DepthComparison hidden = good_comparison();
  hidden.model = 1700;
  hidden.hidden = 700;
  EXPECT_NEAR(rough(hidden), rough(good_comparison()), 1e-9);
  EXPECT_NEAR(probability(hidden), probability(good_comparison()), 1e-9);
}

TEST(Verdict, SharesAddUpAndFavourTheLikelier) {
  const std::vector<double> values = {10, 9, -10};
  const auto share = shares(values);
  EXPECT_NEAR(std::accumulate(share.begin(), share.end(), 0.0), 1, 1e-12);
  EXPECT_NEAR(share[0] / share[1], std::exp(1.0), 1e-9);
  EXPECT_LT(share[2], 1e-3);
  EXPECT_TRUE(shares({}).empty());
}

TEST(Verdict, PosesCompeteByLikelihoodAndByWhatTheyLieOn) {
  DepthComparison likelier = good_comparison();
  likelier.log_likelihood += 200;
  Explanation on_table = explanation_of(good_comparison(), at_rest());
  constexpr DepthNoise shared{.local_mm = 0, .total_mm = 1}, independent{.local_mm = 1, .total_mm = 1};
  const auto log_odds = [&](const DepthComparison& c, int stride) {
    return pose_log_odds(c, on_table, shared, stride);
  };
  EXPECT_NEAR(log_odds(likelier, 1) - log_odds(good_comparison(), 1), 1, 1e-9);  // 200 pixels err together
  EXPECT_NEAR(log_odds(likelier, 100) - log_odds(good_comparison(), 100), 200, 1e-9);
  EXPECT_NEAR(
      pose_log_odds(likelier, on_table, independent, 1) - pose_log_odds(good_comparison(), on_table, independent, 1),
      200, 1e-9);
  Explanation hanging = on_table, sunk = on_table;
  hanging.height = 0.1, hanging.height_deviations = 10;
  sunk.height = -0.1, sunk.height_deviations = -10;
  for (const auto& off : {hanging, sunk})
    EXPECT_LT(pose_log_odds(likelier, off, shared, 1), log_odds(good_comparison(), 1));
}

TEST(Verdict, AKeywayThatPointsAwayLooksTheSame) {
  const Intrinsics camera{120, 100, 500, 500, 59.5, 49.5};
  const TriangleMesh ball = shapes::sphere(25, 60, 30), bracket = shapes::l_bracket();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 500;
  Eigen::Isometry3d turned = pose;
  turned.linear() = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const auto alike = [&](const TriangleMesh& mesh) {
    return looks_the_same(render_depth(mesh, pose, camera), render_depth(mesh, turned, camera), {.noise_mm = 0.5});
  };
  EXPECT_TRUE(alike(ball));
  EXPECT_FALSE(alike(bracket));
}

TEST(Verdict, PolishingIsDampedByWavesAndForSmallParts) {
  const DepthNoise independent{1, 1}, waves{0.5, 1};
  EXPECT_NEAR(pixel_variance_mm2(independent, 1), 1, 1e-9);
  EXPECT_GT(pixel_variance_mm2(waves, 1), 50);
  EXPECT_NEAR(pixel_variance_mm2(waves, 100), 1, 1e-9);  // so far apart each errs for itself
  EXPECT_LT(polish_damping(independent, 1, 100), 1);     // of hundreds of pixels
  EXPECT_NEAR(polish_damping(waves, 1, 50), 4 * polish_damping(waves, 1, 100), 1e-9);
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
