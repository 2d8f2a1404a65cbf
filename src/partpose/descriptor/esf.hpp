// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/global_descriptor.hpp"

#include <vector>

namespace partpose {

struct EsfOptions {
  int k_nn = 6;
  int samples = 20000;
  int seed = 1;
  bool steady_extent = true;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
    visit("samples", self.samples, "triangles drawn from the points, 1 to 10000000");
    visit("seed", self.seed, "of the draws, >= 0");
    visit("steady_extent", self.steady_extent,
          "lengths and areas relative to the mean of the largest of five draws; false: to the draw's largest, as PCL");
  }
  void check() const;
};

inline constexpr int esf_part_bins = 64;  ///< of each of the ten parts
inline constexpr int esf_bins = 10 * esf_part_bins;

/// Ensemble of Shape Functions (Wohlkinger and Vincze 2011): 640 bins that sum up to 1, from triangles drawn at random
/// among the points; normals are not used. Ten parts of 64 bins in PCL's order and with PCL's weights: angles (A3),
/// roots of areas (D3) and side lengths (D2), each for sides inside, outside and partly inside the shape; last the
/// share of a partly inside side that is inside. Points that are not finite are left out. All zero when no three points
/// span a triangle. The same distribution as PCL 1.13's, but for what docs/descriptors.md lists; the same bits for any
/// order of the points.
std::vector<float> esf(const PointCloud& cloud, const EsfOptions& options);

std::unique_ptr<GlobalDescriptor> make_descriptor(const EsfOptions& options);

}  // namespace partpose
