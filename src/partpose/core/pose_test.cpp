// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/pose.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

namespace partpose {
namespace {

using namespace shapes;

/// The exponential map by its power series.
Eigen::Matrix3d exponential(const Eigen::Vector3d& omega) {
  Eigen::Matrix3d cross;
  cross << 0, -omega.z(), omega.y(), omega.z(), 0, -omega.x(), -omega.y(), omega.x(), 0;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), term = sum;
  for (int k = 1; k < 60; ++k) {
    term = term * cross / k;
    sum += term;
  }
  return sum;
}

TEST(Pose, DegreesAndRadians) {
  static_assert(radians(180) == std::numbers::pi);
  static_assert(degrees(std::numbers::pi / 2) == 90);
}

TEST(Pose, RotationErrorOfKnownAngles) {
  Random random(1);
  for (const double angle : {0.0, 0.01, 1.0, 45.0, 90.0, 135.0, 179.0, 180.0}) {
    for (int i = 0; i < 20; ++i) {
      const auto a = random_pose(random, {10, 20, 600});
      Eigen::Isometry3d b = a;
      b.linear() = random_turn(random, radians(angle)) * a.linear();
      // The arc cosine keeps half of the digits near 0 and 180 degrees.
      const double tolerance = angle == 0 || angle > 179.5 ? 5e-6 : 1e-7;
      EXPECT_NEAR(rotation_error_deg(a, b), angle, tolerance);
      EXPECT_NEAR(rotation_error_deg(b, a), angle, tolerance);
    }
  }
}

TEST(Pose, RotationErrorIsNeverNaN) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const auto a = random_pose(random);
    EXPECT_LT(rotation_error_deg(a, a), 5e-6);
    Eigen::Isometry3d opposite = a;
    opposite.linear() = random_turn(random, std::numbers::pi) * a.linear();
    EXPECT_GT(rotation_error_deg(a, opposite), 180 - 5e-6);
  }
}

TEST(Pose, ErrorsDoNotDependOnTheFrame) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const auto a = random_pose(random, {1, 2, 3}), b = random_pose(random, {-4, 5, 6}),
               t = random_pose(random, {7, 8, 9});
    EXPECT_NEAR(rotation_error_deg(t * a, t * b), rotation_error_deg(a, b), 1e-5);
    EXPECT_NEAR(rotation_error_deg(a * t, b * t), rotation_error_deg(a, b), 1e-5);
    EXPECT_NEAR(translation_error_mm(t * a, t * b), translation_error_mm(a, b), 1e-12);
  }
}

TEST(Pose, TranslationErrorIsTheDistanceOfTheOrigins) {
  Random random(4);
  const auto a = random_pose(random, {1, 2, 3}), b = random_pose(random, {4, -2, 15});
  EXPECT_DOUBLE_EQ(translation_error_mm(a, b), 13);
  EXPECT_EQ(translation_error_mm(a, a), 0);
}

TEST(Pose, RotationFromVectorIsTheExponentialMap) {
  Random random(5);
  for (const double angle : {1e-12, 1e-7, 1e-3, 0.5, 2.0, 3.14159, 6.0}) {
    const Eigen::Vector3d omega = angle * random_direction(random);
    EXPECT_LT((rotation_from_vector(omega) - exponential(omega)).cwiseAbs().maxCoeff(), 1e-13) << angle;
  }
}

TEST(Pose, RotationFromTinyVectors) {
  EXPECT_EQ(rotation_from_vector(Eigen::Vector3d::Zero()), Eigen::Matrix3d::Identity());
  EXPECT_EQ(rotation_from_vector({1e-310, 0, 0}), Eigen::Matrix3d::Identity());
  // To first order the matrix is 1 + [omega]x, with a sign that a transposed matrix gets wrong.
  const Eigen::Matrix3d tiny = rotation_from_vector({0, 0, 1e-9});
  EXPECT_DOUBLE_EQ(tiny(1, 0), 1e-9);
  EXPECT_DOUBLE_EQ(tiny(0, 1), -1e-9);
}

TEST(Pose, RecognizesRigidMatrices) {
  Random random(6);
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(is_rigid(random_pose(random, {100, -200, 650}).matrix(), 1e-12));

  const Eigen::Matrix4d pose = random_pose(random, {1, 2, 3}).matrix();
  const auto changed = [&pose](int row, int column, double value) {
    Eigen::Matrix4d matrix = pose;
    matrix(row, column) = value;
    return matrix;
  };
  EXPECT_TRUE(is_rigid(changed(0, 3, -1e7)));
  EXPECT_FALSE(is_rigid(changed(3, 3, 2)));
  EXPECT_FALSE(is_rigid(changed(3, 0, 0.01)));
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_FALSE(is_rigid(changed(row, column, bad)));

  Eigen::Matrix4d scaled = pose, mirrored = pose, sheared = pose;
  scaled.topLeftCorner<3, 3>() *= 1.001;
  mirrored.col(0) *= -1;
  sheared.col(0).head<3>() += 0.01 * sheared.col(1).head<3>();
  EXPECT_FALSE(is_rigid(scaled));
  EXPECT_FALSE(is_rigid(mirrored));
  EXPECT_FALSE(is_rigid(sheared));
  EXPECT_TRUE(is_rigid(scaled, 0.01)) << "the tolerance is the caller's";
  EXPECT_FALSE(is_rigid(Eigen::Matrix4d::Zero()));
}

TEST(Pose, NearestRigidOfARigidMatrixIsItself) {
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    const auto pose = random_pose(random, {10, 20, 30});
    EXPECT_LT((nearest_rigid(pose.matrix()).matrix() - pose.matrix()).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Pose, NearestRigidIsTheRotationOfThePolarDecomposition) {
  Random random(8);
  for (int i = 0; i < 50; ++i) {
    const auto pose = random_pose(random, {1, -2, 3});
    Eigen::Matrix3d noise;
    for (int k = 0; k < 9; ++k) noise(k) = between(random, -0.3, 0.3);
    Eigen::Matrix4d stretched = pose.matrix();
    stretched.topLeftCorner<3, 3>() = pose.linear() * (Eigen::Matrix3d::Identity() + noise * noise.transpose());
    EXPECT_LT((nearest_rigid(stretched).matrix() - pose.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Pose, NoRotationIsNearerThanTheNearest) {
  Random random(9);
  for (int i = 0; i < 50; ++i) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) matrix(r, c) = between(random, -1, 1);  // half of them mirror
    const auto nearest = nearest_rigid(matrix);
    EXPECT_TRUE(is_rigid(nearest.matrix(), 1e-12));
    EXPECT_EQ(nearest.translation(), (matrix.topRightCorner<3, 1>()));
    const auto distance = [&](const Eigen::Matrix3d& rotation) {
      return (rotation - matrix.topLeftCorner<3, 3>()).norm();
    };
    for (int k = 0; k < 20; ++k) {
      EXPECT_GE(distance(random_turn(random, 1e-3) * nearest.linear()), distance(nearest.linear()));
      EXPECT_GE(distance(random_turn(random, between(random, 0, 3)) * nearest.linear()), distance(nearest.linear()));
    }
  }
}

}  // namespace
}  // namespace partpose
