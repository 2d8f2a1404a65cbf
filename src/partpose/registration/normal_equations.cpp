// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/normal_equations.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace partpose {

Vector6d NormalEquations::solve(double damping) const {
  const double extent_mm = weight > 0 ? std::sqrt(squared_extent_mm2 / weight) : 0.0;
  if (!(extent_mm > 0)) return Vector6d::Zero();
  Vector6d scale;
  scale << Eigen::Vector3d::Constant(1.0 / extent_mm), Eigen::Vector3d::Ones();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(Matrix6d(scale.asDiagonal() * hessian * scale.asDiagonal()));
  const double smallest = 1e-6 * solver.eigenvalues()[5];
  Vector6d solution = Vector6d::Zero();
  for (int k = 0; k < 6; ++k) {
    if (!(solver.eigenvalues()[k] > smallest)) continue;
    const Vector6d direction = solver.eigenvectors().col(k);
    solution -= direction * (direction.dot(scale.asDiagonal() * gradient) / (solver.eigenvalues()[k] + damping));
  }
  return scale.asDiagonal() * solution;
}

}  // namespace partpose
