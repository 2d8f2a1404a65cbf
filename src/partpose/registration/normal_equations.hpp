// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace partpose {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The normal equations of residuals r + J x with x = (rotation vector, translation) about a centre.
struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double squared_extent_mm2 = 0;  ///< sum of the weighted squared distances of the points from the centre
  double weight = 0;

  /// `arm`: the point about the centre whose turn moves the residual along `normal`.
  void add(const Eigen::Vector3d& arm, const Eigen::Vector3d& normal, double residual, double w,
           double squared_radius_mm2) {
    Vector6d jacobian;
    jacobian << arm.cross(normal), normal;
    hessian += w * jacobian * jacobian.transpose();
    gradient += w * residual * jacobian;
    squared_extent_mm2 += w * squared_radius_mm2;
    weight += w;
  }

  /// The minimum in the directions that the residuals determine; the others stay 0. Rotations are scaled by the points'
  /// extent so that all six unknowns are lengths. Zero when nothing is determined. `damping`: added to each direction's
  /// weight, so that what is hardly determined hardly moves (Levenberg 1944).
  Vector6d solve(double damping = 0) const;
};

}  // namespace partpose
