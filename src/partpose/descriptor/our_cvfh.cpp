// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/our_cvfh.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/descriptor/smooth_clusters.hpp"
#include "partpose/descriptor/vfh.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace partpose {

namespace {

/// The cluster without the points whose normal is far from its mean (Aldoma et al. 2012, section 3.1); no members are
/// left when all are.
SmoothCluster refined(const SmoothCluster& cluster, const PointCloud& points, float cosine) {
  SmoothCluster near;
  for (const int i : cluster.members)
    if (points.normals[i].dot(cluster.normal) > cosine) near.members.push_back(i);
  if (!near.members.empty()) set_means(near, points);
  return near;
}

/// Directions of largest, middle and least variance of a cluster about its centre, points weighted by how much nearer
/// they are than the farthest (Tombari et al. 2010, eq. 5). With all equally far, all weigh the same.
Eigen::Matrix3d principal_axes(const SmoothCluster& cluster, const PointCloud& points) {
  const auto offset = [&](int i) { return Eigen::Vector3d((points.points[i] - cluster.centre_mm).cast<double>()); };
  double largest = 0;
  for (const int i : cluster.members) largest = std::max(largest, offset(i).norm());
  Eigen::Matrix3d weighted = Eigen::Matrix3d::Zero(), unweighted = Eigen::Matrix3d::Zero();
  double weights = 0;
  for (const int i : cluster.members) {
    const Eigen::Vector3d p = offset(i);
    const double weight = largest - p.norm();
    const Eigen::Matrix3d product = p * p.transpose();
    weighted += weight * product;
    unweighted += product;
    weights += weight;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(weights > 0 ? Eigen::Matrix3d(weighted / weights) : unweighted);
  return solver.eigenvectors().rowwise().reverse();
}

/// A direction turned to the side that more of the cloud lies on (sums of the distances from the plane through the
/// centre).
struct SignedAxis {
  Eigen::Vector3d direction;
  double balance = 1;  ///< smaller side over larger side: 1 when the sign is open
};

SignedAxis signed_axis(const Eigen::Vector3d& direction, const Eigen::Vector3f& centre, const OrientedPoints& points) {
  double plus = 0, minus = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double along = direction.x() * (static_cast<double>(points.x[i]) - centre.x()) +
                         direction.y() * (static_cast<double>(points.y[i]) - centre.y()) +
                         direction.z() * (static_cast<double>(points.z[i]) - centre.z());
    plus += std::max(along, 0.0);
    minus += std::max(-along, 0.0);
  }
  const double larger = std::max(plus, minus);
  return {plus < minus ? Eigen::Vector3d(-direction) : direction, larger > 0 ? std::min(plus, minus) / larger : 1.0};
}

/// The semi-global unique reference frames of a cluster (Aldoma et al. 2012, section 3.2): one when the sign of an axis
/// is clear, two when both axes are about equally clear, four when both are open.
std::vector<Eigen::Isometry3d> reference_frames(const SmoothCluster& cluster, const SmoothClusters& smooth,
                                                const OrientedPoints& points, const OurCvfhOptions& options) {
  const Eigen::Matrix3d axes = principal_axes(cluster, smooth.points);
  const auto first = signed_axis(axes.col(0), cluster.centre_mm, points);
  const auto second = signed_axis(axes.col(1), cluster.centre_mm, points);
  const bool away = axes.col(2).dot(cluster.normal.cast<double>()) < 0;
  const Eigen::Vector3d z = away ? Eigen::Vector3d(-axes.col(2)) : Eigen::Vector3d(axes.col(2));

  std::vector<Eigen::Vector3d> x_axes;
  const double clear = std::min(first.balance, second.balance), open = std::max(first.balance, second.balance);
  if (!(clear > options.axis_ratio * open))
    x_axes = {second.balance < first.balance ? second.direction : first.direction};
  else if (clear > options.min_axis_value)
    x_axes = {first.direction, -first.direction, second.direction, -second.direction};
  else
    x_axes = {first.direction, second.direction};

  std::vector<Eigen::Isometry3d> frames;
  for (const auto& x : x_axes) {
    Eigen::Isometry3d frame(Eigen::Translation3d(cluster.centre_mm.cast<double>()));
    frame.linear() << x, z.cross(x), z;
    frames.push_back(frame);
  }
  return frames;
}

/// Distances from the frame's origin, relative to the largest, in each octant (Aldoma et al. 2012, section 3.3): 13
/// bins for each of (x < 0, x > 0) times (y > 0, y < 0) times (z < 0, z > 0), z fastest. The order of the halves of y
/// is that of PCL, whose frames are left-handed. A point near a plane between octants counts on both of its sides.
void octant_distances(const Eigen::Isometry3d& camera_from_reference, const OrientedPoints& points, double sigma_mm,
                      double increment, float* histogram) {
  const Eigen::Matrix3f rotation = camera_from_reference.linear().cast<float>();
  const Eigen::Vector3f origin = camera_from_reference.translation().cast<float>();
  const std::size_t n = points.size();
  std::vector<Eigen::Vector3f> offsets(n);
  float largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    offsets[i] = rotation.transpose() * (Eigen::Vector3f(points.x[i], points.y[i], points.z[i]) - origin);
    largest = std::max(largest, offsets[i].norm());
  }
  const auto falloff = static_cast<float>(-0.5 / (sigma_mm * sigma_mm));
  const auto share_above = [falloff](float v) {
    return 0.5f + std::copysign(0.5f - 0.5f * std::exp(falloff * v * v), v);
  };
  std::array<std::array<double, our_cvfh_octant_bins>, 8> sums{};
  for (const auto& p : offsets) {
    const double share = largest > 0 ? p.norm() / static_cast<double>(largest) : 0.0;
    const int bin =
        std::clamp(static_cast<int>(std::ceil(share * our_cvfh_octant_bins)) - 1, 0, our_cvfh_octant_bins - 1);
    const double x = share_above(p.x()), y = share_above(-p.y()), z = share_above(p.z());
    const double low_low = (1 - x) * (1 - y), low_high = (1 - x) * y, high_low = x * (1 - y), high_high = x * y;
    sums[0][bin] += low_low * (1 - z);
    sums[1][bin] += low_low * z;
    sums[2][bin] += low_high * (1 - z);
    sums[3][bin] += low_high * z;
    sums[4][bin] += high_low * (1 - z);
    sums[5][bin] += high_low * z;
    sums[6][bin] += high_high * (1 - z);
    sums[7][bin] += high_high * z;
  }
  for (const auto& octant : sums)
    for (const double sum : octant) *histogram++ = static_cast<float>(sum * increment);
}

class OurCvfh final : public GlobalDescriptor {
 public:
  explicit OurCvfh(const OurCvfhOptions& options)
      : options_(options),
        vfh_options_{.use_fill_size_component = false,
                     .use_normalized_bins = options.use_normalized_bins,
                     .use_normalized_distances = false} {}

  int bins() const override { return vfh_bins; }

  std::vector<Description> describe(const PointCloud& unsorted) const override {
    const PointCloud cloud = sorted_by_position(unsorted);
    if (cloud.empty()) return {};
    const auto smooth = smooth_clusters(cloud, cluster_limits(options_));
    const float cosine =
        cosine_limit(static_cast<float>(radians(options_.eps_angle_threshold_deg)) * options_.refine_clusters);
    const OrientedPoints points(cloud);
    // The pairs are one fewer than the points in PCL's count.
    const double increment =
        options_.use_normalized_bins ? 100.0 / std::max(static_cast<double>(points.size()) - 1, 1.0) : 1.0;
    std::vector<Description> descriptions;
    for (const auto& whole_cluster : smooth.clusters) {
      const auto cluster = refined(whole_cluster, smooth.points, cosine);
      if (cluster.members.empty()) continue;
      const auto angles = vfh_about(cluster.centre_mm, cluster.normal, points, vfh_options_);
      for (const auto& frame : reference_frames(cluster, smooth, points, options_)) {
        auto& description = descriptions.emplace_back(Description{.histogram = angles,
                                                                  .centroid_mm = cluster.centre_mm.cast<double>(),
                                                                  .support = static_cast<int>(cluster.members.size()),
                                                                  .camera_from_reference = frame});
        octant_distances(frame, points, options_.octant_sigma, increment,
                         description.histogram.data() + 3 * vfh_feature_bins);
      }
    }
    if (descriptions.empty()) {
      descriptions = make_descriptor(vfh_options_)->describe(cloud);
      for (auto& description : descriptions) description.valid = false;
    }
    return descriptions;
  }

 private:
  OurCvfhOptions options_;
  VfhOptions vfh_options_;
};

}  // namespace

void OurCvfhOptions::check() const {
  check_neighbours(k_nn);
  cluster_limits(*this).check();
  if (!(refine_clusters > 0)) throw Error("refine_clusters {}: must be positive", refine_clusters);
  if (!(axis_ratio >= 0 && axis_ratio <= 1)) throw Error("axis_ratio {}: must be 0 to 1", axis_ratio);
  if (!(min_axis_value >= 0 && min_axis_value <= 1)) throw Error("min_axis_value {}: must be 0 to 1", min_axis_value);
  if (!(octant_sigma > 0)) throw Error("octant_sigma {}: must be positive", octant_sigma);
}

std::unique_ptr<GlobalDescriptor> make_descriptor(const OurCvfhOptions& options) {
  return std::make_unique<OurCvfh>(options);
}

}  // namespace partpose
