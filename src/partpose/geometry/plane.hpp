// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace partpose {

/// { p : normal . p + offset_mm = 0 }, normal of unit length turned towards the camera (the origin): offset_mm >= 0, and
/// the signed distance is positive on the camera's side.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset_mm = 0;

  double signed_distance_mm(const Eigen::Vector3f& point_mm) const {
    return normal.dot(point_mm.cast<double>()) + offset_mm;
  }
};

struct PlaneOptions {
  float distance_threshold_mm = 10.f;  ///< a point this near to the plane belongs to it
  int max_hypotheses = 500;            ///< RANSAC draws; fewer when the best plane is already certain to 1 in 10^6
  std::uint64_t seed = 1;
};

struct PlaneFit {
  Plane plane;
  std::vector<int> inliers;  ///< indices of all points within the threshold
  double rms_mm = 0;         ///< of the inliers' distances
};

/// The dominant plane by RANSAC (Fischler and Bolles 1981), refined by least squares on its inliers until they settle.
/// Nothing when the points are fewer than three or all on one line.
std::optional<PlaneFit> fit_plane(const PointCloud& cloud, const PlaneOptions& options);

}  // namespace partpose
