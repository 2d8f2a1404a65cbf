// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/global_descriptor.hpp"

namespace partpose {

struct CvfhOptions {
  int k_nn = 6;
  int min_points = 200;
  float cluster_tolerance_distance = 9;
  float eps_angle_threshold_deg = 20;
  float radius_normals = 9;
  bool use_normalized_bins = true;
  float curvature_threshold = 0.03f;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
    visit("min_points", self.min_points, "minimum number of points in a cluster, >= 1");
    visit("cluster_tolerance_distance", self.cluster_tolerance_distance,
          "points of a cluster are at most this far from the next [mm], > 0");
    visit("eps_angle_threshold_deg", self.eps_angle_threshold_deg,
          "normals of neighbours in a cluster differ by less than this [deg], > 0");
    visit("radius_normals", self.radius_normals,
          "radius of the neighbourhood of the normals that clusters are found by [mm], > 0");
    visit("use_normalized_bins", self.use_normalized_bins, "bins in per cent of the points rather than in points");
    visit("curvature_threshold", self.curvature_threshold,
          "points of a higher curvature belong to no cluster, 0 to 1/3 (1/3: none is left out)");
  }
  void check() const;
};

/// Clustered Viewpoint Feature Histogram (Aldoma et al. 2011): for each smooth cluster of the cloud
/// (smooth_clusters.hpp) the VFH of the whole cloud about the cluster's centroid and its mean normal, made unit length.
/// The largest cluster comes first. `support` and `centroid_mm` are the cluster's. A cloud without clusters gets its
/// plain VFH, not valid. Points and normals that are not finite are left out. Same bits for any order of the points and
/// any thread count. The same numbers as PCL 1.13 for the same points and normals in mm, but for what
/// docs/descriptors.md lists.
std::unique_ptr<GlobalDescriptor> make_descriptor(const CvfhOptions& options);

}  // namespace partpose
