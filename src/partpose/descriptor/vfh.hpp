// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"
#include "partpose/descriptor/options.hpp"

#include <vector>

namespace partpose {

inline constexpr int vfh_feature_bins = 45;     ///< of each of the three angles and of the distance
inline constexpr int vfh_viewpoint_bins = 128;  ///< of the angle between the line of sight and the normals
inline constexpr int vfh_bins = 4 * vfh_feature_bins + vfh_viewpoint_bins;

/// Viewpoint Feature Histogram (Rusu et al. 2010) of a cloud with normals, seen from the origin: 308 bins, the angles
/// alpha (atan2), phi and theta between the centroid's and each point's normal (45 bins each), the distances to the
/// centroid (45 bins, the shape distribution component of Aldoma et al. 2012), and the viewpoint component (128 bins).
/// The cloud must have at least one point, and normals. The same numbers as PCL 1.13 for the same points and normals
/// in mm, but for what docs/descriptors.md lists.
std::vector<float> vfh(const PointCloud& cloud, const VfhOptions& options);

}  // namespace partpose
