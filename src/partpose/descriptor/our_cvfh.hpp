// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/global_descriptor.hpp"

namespace partpose {

struct OurCvfhOptions {
  int k_nn = 6;
  int min_points = 200;
  float cluster_tolerance_distance = 9;
  float eps_angle_threshold_deg = 20;
  float radius_normals = 9;
  bool use_normalized_bins = true;
  float curvature_threshold = 0.03f;
  float refine_clusters = 1;
  float axis_ratio = 0.8f;
  float min_axis_value = 0.925f;
  float octant_sigma = 10;

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
    visit("refine_clusters", self.refine_clusters,
          "a cluster keeps the points whose normal is within this times eps_angle_threshold_deg of its mean, > 0");
    visit("axis_ratio", self.axis_ratio,
          "two axes whose signs are about equally clear, by more than this ratio, both give reference frames, 0 to 1");
    visit("min_axis_value", self.min_axis_value,
          "both axes' two sides balanced to more than this: both signs of both give frames (four), 0 to 1");
    visit("octant_sigma", self.octant_sigma,
          "points this near to a plane between octants count in part on its other side [mm], > 0");
  }
  void check() const;
};

inline constexpr int our_cvfh_octant_bins = 13;  ///< of the distance, in each of the 8 octants

/// Oriented, Unique and Repeatable CVFH (Aldoma et al. 2012): for each smooth cluster (smooth_clusters.hpp), refined to
/// the points whose normal is near its mean, one or more semi-global unique reference frames, and for each of them 308
/// bins: the three angles of the cluster's CVFH (135), the distances to the cluster's centroid of the points in each
/// octant of the frame (8 x 13), and the bins 59 to 127 of the viewpoint component (69).
///
/// `camera_from_reference` is the frame: origin at the cluster's centroid, z along its least variance and towards the
/// camera, x along one of the two others, to the side that more of the cloud lies on, right-handed. Signs (or axes)
/// that the cloud leaves open give up to four descriptions of one cluster. The largest cluster comes first. `support`
/// and `centroid_mm` are the refined cluster's. A cloud without clusters gets its plain VFH without the distance part,
/// not valid and without a frame. Points and normals that are not finite are left out. Same bits for any order of the
/// points and any thread count. The same numbers as PCL 1.13 but for what docs/descriptors.md lists.
std::unique_ptr<GlobalDescriptor> make_descriptor(const OurCvfhOptions& options);

}  // namespace partpose
