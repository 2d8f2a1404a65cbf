// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/normal_equations.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>
#include <Eigen/QR>

namespace partpose {
namespace {

using namespace shapes;

struct Row {
  Eigen::Vector3d arm, normal;
  double residual = 0, weight = 1;
};

std::vector<Row> random_rows(Random& random, int count) {
  std::vector<Row> rows(count);
  for (auto& row : rows) {
    row.arm = 40 * random_direction(random);
    row.normal = random_direction(random);
    row.residual = between(random, -3, 3);
    row.weight = between(random, 0.1, 2);
  }
  return rows;
}

Vector6d solve(const std::vector<Row>& rows) {
  NormalEquations equations;
  for (const auto& row : rows) equations.add(row.arm, row.normal, row.residual, row.weight, row.arm.squaredNorm());
  return equations.solve();
}

/// Half of the derivative of the weighted squares of residual + normal . (turn x arm + shift), by finite differences.
Vector6d gradient_at(const std::vector<Row>& rows, const Vector6d& x) {
  const auto squares = [&rows](const Vector6d& at) {
    double sum = 0;
    for (const auto& row : rows) {
      const Eigen::Vector3d turn = at.head<3>(), shift = at.tail<3>();
      sum += row.weight * std::pow(row.residual + row.normal.dot(turn.cross(row.arm) + shift), 2);
    }
    return sum;
  };
  Vector6d gradient;
  for (int k = 0; k < 6; ++k) {
    const double h = k < 3 ? 1e-4 : 1e-2;
    const Vector6d step = h * Vector6d::Unit(k);
    gradient[k] = (squares(x + step) - squares(x - step)) / (4 * h);
  }
  return gradient;
}

TEST(NormalEquations, FindTheWeightedMinimum) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const auto rows = random_rows(random, 30);
    const Vector6d x = solve(rows);
    const Vector6d at_start = gradient_at(rows, Vector6d::Zero()), at_end = gradient_at(rows, x);
    EXPECT_LT(at_end.head<3>().norm(), 1e-6 * at_start.head<3>().norm());
    EXPECT_LT(at_end.tail<3>().norm(), 1e-6 * at_start.tail<3>().norm());
  }
}

TEST(NormalEquations, RecoverAMotionExactly) {
  Random random(2);
  const Vector6d truth = (Vector6d() << 0.02, -0.01, 0.03, 1, -2, 0.5).finished();
  auto rows = random_rows(random, 12);
  for (auto& row : rows)
    row.residual = -row.normal.dot(Eigen::Vector3d(truth.head<3>()).cross(row.arm) + truth.tail<3>());
  EXPECT_LT((solve(rows) - truth).norm(), 1e-9);
}

TEST(NormalEquations, APlaneDeterminesThreeDirections) {
  Random random(3);
  std::vector<Row> rows = random_rows(random, 200);
  for (auto& row : rows) {
    row.arm.z() = 0;
    row.normal = Eigen::Vector3d::UnitZ();
    row.residual = 2 + 0.01 * row.arm.x();
  }
  const Vector6d x = solve(rows);
  EXPECT_NEAR(x[1], 0.01, 1e-9) << "turn about y";
  EXPECT_NEAR(x[5], -2, 1e-9) << "shift along z";
  for (const int free : {2, 3, 4}) EXPECT_NEAR(x[free], 0, 1e-9);
}

TEST(NormalEquations, DoNotDependOnTheUnitOfLength) {
  Random random(4);
  auto rows = random_rows(random, 30);
  for (auto& row : rows) row.normal.z() = 0;  // along z nothing is determined
  const Vector6d in_mm = solve(rows);
  EXPECT_NEAR(in_mm[5], 0, 1e-9);
  for (auto& row : rows) row.arm *= 0.001, row.residual *= 0.001;
  const Vector6d in_m = solve(rows);
  EXPECT_LT((in_m.head<3>() - in_mm.head<3>()).norm(), 1e-9);
  EXPECT_LT((in_m.tail<3>() * 1000 - in_mm.tail<3>()).norm(), 1e-6);
}

TEST(NormalEquations, DampingHoldsWhatIsHardlyDetermined) {
  NormalEquations equations;
  equations.hessian.diagonal() << 100, 100, 100, 100, 100, 1;
  equations.gradient << 0, 0, 0, -100, 0, -1;
  equations.squared_extent_mm2 = equations.weight = 100;
  EXPECT_NEAR(equations.solve()[3], 1, 1e-9);
  EXPECT_NEAR(equations.solve()[5], 1, 1e-9);
  EXPECT_NEAR(equations.solve(4)[3], 100 / 104.0, 1e-9);
  EXPECT_NEAR(equations.solve(4)[5], 1 / 5.0, 1e-9);
}

TEST(NormalEquations, NothingDeterminesNothing) {
  EXPECT_EQ(NormalEquations{}.solve(), Vector6d::Zero());
  const Row at_the_centre = {Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), 3, 1};
  EXPECT_EQ(solve({at_the_centre}), Vector6d::Zero());
  auto without_weight = std::vector<Row>{{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), 3, 0}};
  EXPECT_EQ(solve(without_weight), Vector6d::Zero());
}

}  // namespace
}  // namespace partpose
