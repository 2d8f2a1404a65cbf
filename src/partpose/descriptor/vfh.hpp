// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/global_descriptor.hpp"

#include <vector>

namespace partpose {

struct VfhOptions {
  int k_nn = 6;
  bool use_fill_size_component = true;
  bool use_normalized_bins = true;
  bool use_normalized_distances = true;
  bool leak_as_pcl = false;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
    visit("use_fill_size_component", self.use_fill_size_component,
          "fill the 45 bins of the distances to the centroid; zeros otherwise");
    visit("use_normalized_bins", self.use_normalized_bins, "bins in per cent of the points rather than in points");
    visit("use_normalized_distances", self.use_normalized_distances,
          "distances to the centroid relative to the largest; otherwise in steps of 10 mm");
    visit("leak_as_pcl", self.leak_as_pcl,
          "repeat a fault of PCL 1.13: two lengths d are sqrt(d^2 + 1), which matters for clouds in metres");
  }
  void check() const;
};

inline constexpr int vfh_feature_bins = 45;     ///< of each of the three angles and of the distance
inline constexpr int vfh_viewpoint_bins = 128;  ///< of the angle between the line of sight and the normals
inline constexpr int vfh_bins = 4 * vfh_feature_bins + vfh_viewpoint_bins;

/// Points with unit normals, their coordinates apart (structure of arrays) for loops that take eight at a time.
struct OrientedPoints {
  std::vector<float> x, y, z, normal_x, normal_y, normal_z;

  /// In the cloud's order. Points that are not finite, or have a normal that is not, are left out.
  explicit OrientedPoints(const PointCloud& cloud);
  std::size_t size() const { return x.size(); }
};

/// Viewpoint Feature Histogram (Rusu et al. 2010) of a cloud with normals, seen from the origin: 308 bins, the angles
/// alpha (atan2), phi and theta between the centroid's and each point's normal (45 bins each), the distances to the
/// centroid (45 bins, the shape distribution component of Aldoma et al. 2012), and the viewpoint component (128 bins).
/// The cloud must have at least one point, and normals; points or normals that are not finite do not count.
/// The same numbers as PCL 1.13 for the same points and normals in mm, but for what docs/descriptors.md lists.
std::vector<float> vfh(const PointCloud& cloud, const VfhOptions& options);

/// The same about a centroid and a normal of one's own: what CVFH and OUR-CVFH measure of each cluster.
std::vector<float> vfh_about(const Eigen::Vector3f& centre_mm, const Eigen::Vector3f& normal,
                             const OrientedPoints& points, const VfhOptions& options);

std::unique_ptr<GlobalDescriptor> make_descriptor(const VfhOptions& options);

}  // namespace partpose
