// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/global_descriptor.hpp"

namespace partpose {

struct GoodOptions {
  int k_nn = 6;
  int num_of_bins = 6;
  float threshold = 200;
  bool ambiguous_frames = false;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
    visit("num_of_bins", self.num_of_bins, "bins along each side of an orthographic view, 1 to 100");
    visit("threshold", self.threshold,
          "points nearer than this to a plane of the frame have no vote on its sign [mm], >= 0");
    visit("ambiguous_frames", self.ambiguous_frames,
          "one description for each plausible frame where signs or order of the axes are in doubt");
  }
  void check() const;
};

/// Global Orthographic Object Descriptor (Kasaei et al. 2016) of the points alone: their reference frame by principal
/// components, and how they spread over n x n bins in the views along its three axes. Of 3 n n bins each n n sum up
/// to 1. The view of the highest entropy comes first, then the one of the smaller variance. camera_from_reference: x
/// along the largest spread, y along the second, origin at the mean of the points. Points that are not finite are left
/// out; no description without points. The same bits for any order of the points.
std::vector<Description> good(const PointCloud& cloud, const GoodOptions& options);

std::unique_ptr<GlobalDescriptor> make_descriptor(const GoodOptions& options);

}  // namespace partpose
