// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/our_cvfh.hpp"

#include "partpose/core/error.hpp"

namespace partpose {

void OurCvfhOptions::check() const {
  check_neighbours(k_nn);
  if (min_points < 1) throw Error("min_points {}: must be 1 or more", min_points);
  if (!(cluster_tolerance_distance > 0))
    throw Error("cluster_tolerance_distance {}: must be positive", cluster_tolerance_distance);
  if (!(eps_angle_threshold_deg > 0))
    throw Error("eps_angle_threshold_deg {}: must be positive", eps_angle_threshold_deg);
  if (!(radius_normals > 0)) throw Error("radius_normals {}: must be positive", radius_normals);
}

std::unique_ptr<GlobalDescriptor> make_descriptor(const OurCvfhOptions&) {
  throw Error("global_descriptor \"ourcvfh\" is not in this version yet; use \"vfh\"");
}

}  // namespace partpose
