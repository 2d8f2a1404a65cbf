// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/vfh.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace partpose {

namespace {

struct PairFeatures {
  float alpha = 0;  ///< rad, -pi to pi
  float phi = 0;    ///< cosine
  float theta = 0;  ///< cosine
  float distance_mm = 0;
};

/// The angles between two oriented points in their Darboux frame (Rusu et al. 2009, eq. 1 to 3); the frame stands at
/// the point whose normal is nearer to the line between them. Nothing when the points coincide or the frame is
/// undefined.
std::optional<PairFeatures> pair_features(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1,
                                          const Eigen::Vector3f& p2, const Eigen::Vector3f& n2) {
  PairFeatures features;
  Eigen::Vector3f line = p2 - p1;
  features.distance_mm = line.norm();
  if (features.distance_mm == 0) return std::nullopt;
  const float cosine1 = n1.dot(line) / features.distance_mm;
  const float cosine2 = n2.dot(line) / features.distance_mm;
  const bool swapped = std::abs(cosine1) < std::abs(cosine2);
  if (swapped) line = -line;
  const Eigen::Vector3f& u = swapped ? n2 : n1;
  const Eigen::Vector3f& other = swapped ? n1 : n2;
  features.theta = swapped ? -cosine2 : cosine1;
  Eigen::Vector3f v = line.cross(u);
  const float length = v.norm();
  if (length == 0) return std::nullopt;
  v /= length;
  features.phi = v.dot(other);
  features.alpha = std::atan2(u.cross(v).dot(other), u.dot(other));
  return features;
}

/// An angle's or a cosine's bin: PCL bins all three features over -pi to pi, so that cosines use the middle third
/// alone.
double angle_share(double value) { return (value + std::numbers::pi) / (2 * std::numbers::pi); }

int bin_of(double share, int bins) { return std::clamp(static_cast<int>(std::floor(share * bins)), 0, bins - 1); }

class Vfh final : public GlobalDescriptor {
 public:
  explicit Vfh(const VfhOptions& options) : options_(options) {}
  int bins() const override { return vfh_bins; }
  std::vector<Description> describe(const PointCloud& cloud) const override {
    if (cloud.empty()) return {};
    return {
        {.histogram = vfh(cloud, options_), .centroid_mm = centroid(cloud), .support = static_cast<int>(cloud.size())}};
  }

 private:
  VfhOptions options_;
};

}  // namespace

void VfhOptions::check() const { check_neighbours(k_nn); }

std::unique_ptr<GlobalDescriptor> make_descriptor(const VfhOptions& options) { return std::make_unique<Vfh>(options); }

std::vector<float> vfh(const PointCloud& cloud, const VfhOptions& options) {
  if (!cloud.has_normals()) throw Error("VFH needs a cloud with at least one point, and normals");
  const auto count = static_cast<double>(cloud.size());
  const Eigen::Vector3f centre = centroid(cloud).cast<float>();
  Eigen::Vector3d normal_sum = Eigen::Vector3d::Zero();
  for (const auto& n : cloud.normals) normal_sum += n.cast<double>();
  const Eigen::Vector3f mean_normal = (normal_sum / count).cast<float>();  // not of unit length, as in PCL

  float largest_distance = 0;
  for (const auto& p : cloud.points) largest_distance = std::max(largest_distance, (p - centre).norm());

  // Counted in whole points first: the sums are exact whatever the order of the points.
  std::vector<int> counts(vfh_bins, 0);
  const Eigen::Vector3f to_camera = -centre.normalized();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto features = pair_features(centre, mean_normal, cloud.points[i], cloud.normals[i]);
    if (features) {
      int* histogram = counts.data();
      for (const float feature : {features->alpha, features->phi, features->theta}) {
        ++histogram[bin_of(angle_share(feature), vfh_feature_bins)];
        histogram += vfh_feature_bins;
      }
      if (options.use_fill_size_component) {
        constexpr double step_mm = 10;
        ++histogram[options.use_normalized_distances
                        ? bin_of(features->distance_mm / largest_distance, vfh_feature_bins)
                        : std::clamp(static_cast<int>(std::lround(features->distance_mm / step_mm)), 0,
                                     vfh_feature_bins - 1)];
      }
    }
    ++counts[4 * vfh_feature_bins + bin_of((cloud.normals[i].dot(to_camera) + 1.0) / 2, vfh_viewpoint_bins)];
  }

  std::vector<float> histogram(counts.begin(), counts.end());
  if (options.use_normalized_bins) {
    // The pairs are one fewer than the points in PCL's count, which takes the centroid for one of them.
    const double pairs = std::max(count - 1, 1.0);
    for (int i = 0; i < vfh_bins; ++i)
      histogram[i] = static_cast<float>(counts[i] * 100.0 / (i < 4 * vfh_feature_bins ? pairs : count));
  }
  return histogram;
}

}  // namespace partpose
