// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace partpose {

/// One histogram of a cloud, and what it was measured on. A clustered descriptor yields several for one cloud.
struct Description {
  std::vector<float> histogram;
  Eigen::Vector3d centroid_mm = Eigen::Vector3d::Zero();  ///< of the support, camera frame
  int support = 0;                                        ///< points that it was measured on
  bool valid = true;  ///< false: no cluster was large enough, and the whole cloud stands for one
  std::optional<Eigen::Isometry3d> camera_from_reference =
      std::nullopt;  ///< the descriptor's own reference frame, if any
};

/// A descriptor of a whole, segmented cloud with normals, seen from the origin. Immutable and thread-safe.
class GlobalDescriptor {
 public:
  virtual ~GlobalDescriptor() = default;
  virtual int bins() const = 0;
  /// Nothing for a cloud that the descriptor is not defined for (for example one without points).
  virtual std::vector<Description> describe(const PointCloud& cloud) const = 0;
};

/// Throws Error unless the number of nearest neighbours is 1 or more.
void check_neighbours(int k_nn);

}  // namespace partpose
