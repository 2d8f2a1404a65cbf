// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"
#include "partpose/descriptor/options.hpp"

#include <memory>
#include <string>
#include <vector>

namespace partpose {

/// One histogram of a cloud. A clustered descriptor yields several for one cloud.
struct Description {
  std::vector<float> histogram;
};

/// A descriptor of a whole, segmented cloud with normals, seen from the origin. Immutable and thread-safe.
class GlobalDescriptor {
 public:
  virtual ~GlobalDescriptor() = default;
  virtual int bins() const = 0;
  /// Nothing for a cloud that the descriptor is not defined for (for example one without points).
  virtual std::vector<Description> describe(const PointCloud& cloud) const = 0;
};

/// By its name in the configuration. Throws Error for a name that this version does not have.
std::unique_ptr<GlobalDescriptor> make_global_descriptor(const std::string& name, const DescriptorOptions& options);

/// How many nearest neighbours the configuration asks for with this descriptor.
int neighbours_of(const std::string& name, const DescriptorOptions& options);

}  // namespace partpose
