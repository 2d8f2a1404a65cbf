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

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
    visit("min_points", self.min_points, "minimum number of points in a cluster, >= 1");
    visit("cluster_tolerance_distance", self.cluster_tolerance_distance,
          "points of a cluster are at most this far from the next [mm], > 0");
    visit("eps_angle_threshold_deg", self.eps_angle_threshold_deg,
          "normals of neighbours in a cluster differ by at most this [deg], > 0");
    visit("radius_normals", self.radius_normals, "radius of the normals' neighbourhood [mm], > 0");
    visit("use_normalized_bins", self.use_normalized_bins, "bins in per cent of the points rather than in points");
  }
  void check() const;
};

std::unique_ptr<GlobalDescriptor> make_descriptor(const CvfhOptions& options);

}  // namespace partpose
