// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/cvfh.hpp"

#include "partpose/descriptor/smooth_clusters.hpp"
#include "partpose/descriptor/vfh.hpp"

namespace partpose {

namespace {

class Cvfh final : public GlobalDescriptor {
 public:
  explicit Cvfh(const CvfhOptions& options)
      : vfh_options_{.use_normalized_bins = options.use_normalized_bins}, limits_(cluster_limits(options)) {}

  int bins() const override { return vfh_bins; }

  std::vector<Description> describe(const PointCloud& unsorted) const override {
    const PointCloud cloud = sorted_by_position(unsorted);
    if (cloud.empty()) return {};
    const auto clusters = smooth_clusters(cloud, limits_).clusters;
    if (clusters.empty()) {
      auto whole = make_descriptor(vfh_options_)->describe(cloud);
      for (auto& description : whole) description.valid = false;
      return whole;
    }
    const OrientedPoints points(cloud);
    std::vector<Description> descriptions;
    for (const auto& cluster : clusters)
      descriptions.push_back({.histogram = vfh_about(cluster.centre_mm, cluster.normal, points, vfh_options_),
                              .centroid_mm = cluster.centre_mm.cast<double>(),
                              .support = static_cast<int>(cluster.members.size())});
    return descriptions;
  }

 private:
  VfhOptions vfh_options_;
  SmoothClusterLimits limits_;
};

}  // namespace

void CvfhOptions::check() const {
  check_neighbours(k_nn);
  cluster_limits(*this).check();
}

std::unique_ptr<GlobalDescriptor> make_descriptor(const CvfhOptions& options) {
  return std::make_unique<Cvfh>(options);
}

}  // namespace partpose
