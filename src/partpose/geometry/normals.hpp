// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

namespace partpose {

/// Sets normals and curvatures: the direction of least variance of all points within `radius_mm` (Hoppe et al. 1992),
/// turned towards `viewpoint_mm`; curvature = smallest eigenvalue over the sum of the three (Pauly et al. 2002), 0 to 1/3.
/// A point with fewer than three neighbours (itself included), or with all of them on one line, gets a NaN normal and
/// curvature. Points must be finite.
void estimate_normals(PointCloud& cloud, float radius_mm, const Eigen::Vector3f& viewpoint_mm = Eigen::Vector3f::Zero());

}  // namespace partpose
