// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"

#include <Eigen/Geometry>

/// The physical limit: how well a pose can be known from ranges with noise, whatever the method.
namespace partpose {

/// The Cramer-Rao bound of a pose (Cramer 1946; Rao 1945): no unbiased estimate has a smaller covariance than the
/// inverse of the Fisher information. A pixel whose line of sight d (unit vector) meets the surface at p, normal n,
/// measures the range r with independent normal noise of standard deviation sigma. Turned by a small w about the centre
/// c and moved by t (camera axes), the surface is met at r + dr,
///
///     dr = n . (w x (p - c) + t) / (n . d),   J = [(p - c) x n; n] / (n . d),   information = sum J J^T / sigma^2
///
/// (point-to-plane ICP's normal equations, each weighted by its angle of incidence; compare Censi, ICRA 2007, for laser
/// scans). What the outline tells is not in it: where pixels turn from part to background, the likelihood has no
/// derivative. Where no visible surface says more than a pixel does, the outline decides, and the bound means nothing.
struct PoseBound {
  /// Of a small rotation vector [rad] and translation [mm] of the part about its box's middle, in the camera's axes.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< zero unless `determined`
  int pixels = 0;                                                                ///< that see the part
  double weakest_mm = 0;  ///< standard deviation along the worst direction, turns at the part's radius; may be infinite
  bool determined = false;  ///< `weakest_mm` is below a pixel's size on the part

  double rotation_deg() const;    ///< root of the trace of the rotation's block
  double translation_mm() const;  ///< root of the trace of the translation's block
};

/// Of a part that is seen alone. `sigma_mm`: standard deviation along each line of sight, > 0.
PoseBound pose_bound(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& camera,
                     double sigma_mm);

}  // namespace partpose
