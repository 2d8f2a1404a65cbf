// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <Eigen/Geometry>

#include <array>
#include <vector>

namespace partpose {

inline constexpr int crh_bins = 90;

/// Camera Roll Histogram (Aldoma et al. 2011) in the spatial domain: how much normal lies in each direction around the
/// line of sight to the centroid. 90 bins of 4 degrees, sum 1; all 0 when every normal is along the line of sight.
using CameraRollHistogram = std::array<float, crh_bins>;

/// Rotation that takes the direction to `centre_mm` to the z axis by the shortest way.
Eigen::Matrix3d sight_frame(const Eigen::Vector3d& centre_mm);

/// The cloud needs normals; `centre_mm` is its centroid, camera frame.
CameraRollHistogram camera_roll_histogram(const PointCloud& cloud, const Eigen::Vector3d& centre_mm);

/// As PCL stores it: the real Fourier series of the histogram, divided by its constant term:
/// 1, Re 1, Im 1, ..., Re 44, Im 44, Re 45.
std::array<float, crh_bins> crh_spectrum(const CameraRollHistogram& histogram);

struct RollPeak {
  double angle_rad = 0;    ///< how far the source must be turned about the line of sight (z of the sight frame)
  double correlation = 0;  ///< -1 to 1
};

/// The turns for which the source's histogram fits the target's best: local maxima of their circular correlation, best
/// first, at most `max_peaks`. Without any structure in either histogram: one peak at 0 with correlation 0.
std::vector<RollPeak> roll_peaks(const CameraRollHistogram& source, const CameraRollHistogram& target, int max_peaks);

}  // namespace partpose
