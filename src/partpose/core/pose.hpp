// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <numbers>

namespace partpose {

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
constexpr double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// Angle between two rotations in degrees: acos((trace(R_a R_b^-1) - 1) / 2), clamped (reference, eq. 2.2).
double rotation_error_deg(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// Distance between two origins in mm (reference, eq. 2.3).
double translation_error_mm(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// The rotation by |omega| rad about omega (exponential map).
Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& omega_rad);

/// True when the upper 3x3 block is a proper rotation within `tolerance`, the last row is 0 0 0 1 and all is finite.
bool is_rigid(const Eigen::Matrix4d& matrix, double tolerance = 1e-4);

/// The nearest proper rotation (polar decomposition) with the same translation.
Eigen::Isometry3d nearest_rigid(const Eigen::Matrix4d& matrix);

}  // namespace partpose
