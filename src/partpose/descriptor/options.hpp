// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace partpose {

struct VfhOptions {
  int k_nn = 6;
  bool use_fill_size_component = true;
  bool use_normalized_bins = true;
  bool use_normalized_distances = true;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
    visit("use_fill_size_component", self.use_fill_size_component,
          "fill the 45 bins of the distances to the centroid; zeros otherwise");
    visit("use_normalized_bins", self.use_normalized_bins, "bins in per cent of the points rather than in points");
    visit("use_normalized_distances", self.use_normalized_distances,
          "distances to the centroid relative to the largest; otherwise in steps of 10 mm");
  }
  void check() const;
};

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

struct EsfOptions {
  int k_nn = 6;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
  }
  void check() const;
};

struct GoodOptions {
  int k_nn = 6;
  int num_of_bins = 6;
  float threshold = 200;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
    visit("num_of_bins", self.num_of_bins, "bins along each side of an orthographic view, >= 1");
    visit("threshold", self.threshold, "for the sign of the axes [mm], >= 0");
  }
  void check() const;
};

struct DescriptorOptions {
  VfhOptions vfh;
  CvfhOptions cvfh;
  CvfhOptions ourcvfh;
  EsfOptions esf;
  GoodOptions good;
};

}  // namespace partpose
