// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/pose_error.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace partpose {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void check_not_empty(std::span<const Eigen::Vector3f> vertices) {
  if (vertices.empty()) throw Error("a pose error needs the object's vertices, there are none");
}

std::vector<Eigen::Vector3d> placed(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& pose) {
  std::vector<Eigen::Vector3d> out;
  out.reserve(vertices.size());
  for (const auto& v : vertices) out.push_back(pose * v.cast<double>());
  return out;
}

/// With the whole K, and no guard for z <= 0.
std::vector<Eigen::Vector2d> projected(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& pose,
                                       const Eigen::Matrix3d& K) {
  const Eigen::Matrix3d rotation = K * pose.linear();
  const Eigen::Vector3d translation = K * pose.translation();
  std::vector<Eigen::Vector2d> out;
  out.reserve(vertices.size());
  for (const auto& v : vertices) out.push_back((rotation * v.cast<double>() + translation).hnormalized());
  return out;
}

/// The smallest over the symmetries of the largest over the vertices of what `squared_distance(symmetry)(vertex)` says;
/// a symmetry is left as soon as it cannot be the smallest. What is no number counts as infinite.
template <typename SquaredDistance>
double smallest_largest(std::size_t vertices, std::span<const Eigen::Isometry3d> symmetries,
                        const SquaredDistance& squared_distance) {
  if (symmetries.empty()) throw Error("the symmetries of an object hold the identity at least, there are none");
  double smallest = infinity;
  for (const auto& symmetry : symmetries) {
    const auto of_vertex = squared_distance(symmetry);
    double largest = 0;
    for (std::size_t i = 0; i < vertices && largest < smallest; ++i) {
      const double squared = of_vertex(i);
      largest = squared >= largest ? squared : (squared < largest ? largest : infinity);
    }
    smallest = std::min(smallest, largest);
  }
  return std::sqrt(smallest);
}

/// Exact nearest neighbours: the points sorted along one axis, searched outwards from the query.
class SortedPoints {
 public:
  explicit SortedPoints(std::vector<Eigen::Vector3d> points) : points_(std::move(points)) {
    Eigen::AlignedBox3d box;
    for (const auto& p : points_) box.extend(p);
    box.sizes().maxCoeff(&axis_);
    std::sort(points_.begin(), points_.end(), [&](const auto& a, const auto& b) { return a[axis_] < b[axis_]; });
  }

  double distance_to_nearest(const Eigen::Vector3d& query) const {
    const auto start = std::lower_bound(points_.begin(), points_.end(), query[axis_],
                                        [&](const auto& p, double value) { return p[axis_] < value; });
    double nearest = infinity;  // squared
    const auto beyond = [&](const Eigen::Vector3d& p) {
      const double along = p[axis_] - query[axis_];
      return along * along > nearest;
    };
    for (auto it = start; it != points_.end() && !beyond(*it); ++it)
      nearest = std::min(nearest, (*it - query).squaredNorm());
    for (auto it = start; it != points_.begin() && !beyond(*std::prev(it)); --it)
      nearest = std::min(nearest, (*std::prev(it) - query).squaredNorm());
    return std::sqrt(nearest);
  }

 private:
  std::vector<Eigen::Vector3d> points_;
  int axis_ = 0;
};

}  // namespace

double add_mm(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
              const Eigen::Isometry3d& truth) {
  check_not_empty(vertices);
  double sum = 0;
  for (const auto& v : vertices) sum += (estimate * v.cast<double>() - truth * v.cast<double>()).norm();
  return sum / static_cast<double>(vertices.size());
}

double adi_mm(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
              const Eigen::Isometry3d& truth) {
  check_not_empty(vertices);
  const SortedPoints estimated(placed(vertices, estimate));
  double sum = 0;
  for (const auto& v : vertices) sum += estimated.distance_to_nearest(truth * v.cast<double>());
  return sum / static_cast<double>(vertices.size());
}

double ad_mm(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
             const Eigen::Isometry3d& truth, bool symmetric) {
  return symmetric ? adi_mm(vertices, estimate, truth) : add_mm(vertices, estimate, truth);
}

double mssd_mm(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
               const Eigen::Isometry3d& truth, std::span<const Eigen::Isometry3d> symmetries) {
  check_not_empty(vertices);
  return smallest_largest(vertices.size(), symmetries, [&](const Eigen::Isometry3d& symmetry) {
    const Eigen::Isometry3d equivalent = truth * symmetry;
    const Eigen::Matrix3d turned = estimate.linear() - equivalent.linear();
    const Eigen::Vector3d moved = estimate.translation() - equivalent.translation();
    return [=](std::size_t i) { return (turned * vertices[i].cast<double>() + moved).squaredNorm(); };
  });
}

double mspd_px(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
               const Eigen::Isometry3d& truth, std::span<const Eigen::Isometry3d> symmetries,
               const Eigen::Matrix3d& K) {
  check_not_empty(vertices);
  const auto estimated = projected(vertices, estimate, K);
  return smallest_largest(vertices.size(), symmetries, [&](const Eigen::Isometry3d& symmetry) {
    const Eigen::Isometry3d equivalent = truth * symmetry;
    const Eigen::Matrix3d rotation = K * equivalent.linear();
    const Eigen::Vector3d translation = K * equivalent.translation();
    return [=, &estimated](std::size_t i) {
      const Eigen::Vector3d homogeneous = rotation * vertices[i].cast<double>() + translation;
      return (estimated[i] - homogeneous.hnormalized()).squaredNorm();
    };
  });
}

double projection_error_px(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
                           const Eigen::Isometry3d& truth, const Eigen::Matrix3d& K) {
  check_not_empty(vertices);
  const auto estimated = projected(vertices, estimate, K), right = projected(vertices, truth, K);
  double sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) sum += (estimated[i] - right[i]).norm();
  return sum / static_cast<double>(vertices.size());
}

DistanceImage distance_image(const DepthImage& depth, const Eigen::Matrix3d& K) {
  DistanceImage out{depth.width, depth.height, std::vector<double>(depth.z_mm.size(), 0.0)};
  std::size_t i = 0;
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u, ++i) {
      if (depth.z_mm[i] == 0) continue;
      const double x = (u - K(0, 2)) / K(0, 0), y = (v - K(1, 2)) / K(1, 1);
      out.mm[i] = depth.z_mm[i] * std::sqrt(x * x + y * y + 1);
    }
  }
  return out;
}

VisibleSurface visible_surface_discrepancy(const DistanceImage& measured, const DistanceImage& estimate,
                                           const DistanceImage& truth, double diameter_mm, std::span<const double> taus,
                                           const VsdOptions& options) {
  for (const auto* image : {&estimate, &truth})
    if (image->width != measured.width || image->height != measured.height)
      throw Error("VSD of images of different sizes: {} x {} and {} x {} px", measured.width, measured.height,
                  image->width, image->height);
  if (!(diameter_mm > 0)) throw Error("VSD: diameter {} mm: must be positive", diameter_mm);
  const auto delta = static_cast<float>(options.delta_mm);
  const auto is_visible = [&](double rendered, double seen) {
    return rendered > 0 && (seen == 0 || static_cast<float>(rendered) - static_cast<float>(seen) <= delta);
  };
  const double unit_mm = options.normalized_by_diameter ? diameter_mm : 1.0;

  VisibleSurface out;
  std::vector<int> apart(taus.size(), 0);
  for (std::size_t i = 0; i < measured.mm.size(); ++i) {
    const bool in_truth = is_visible(truth.mm[i], measured.mm[i]);
    const bool in_estimate = is_visible(estimate.mm[i], measured.mm[i]) || (in_truth && estimate.mm[i] > 0);
    out.visible_gt += in_truth;
    out.visible_estimate += in_estimate;
    out.union_px += in_truth || in_estimate;
    if (!in_truth || !in_estimate) continue;
    ++out.intersection_px;
    const double distance = std::abs(truth.mm[i] - estimate.mm[i]) / unit_mm;
    for (std::size_t k = 0; k < taus.size(); ++k) apart[k] += distance >= taus[k];
  }
  for (const int count : apart)
    out.vsd.push_back(out.union_px == 0 ? 1.0
                                        : static_cast<double>(count + out.union_px - out.intersection_px) /
                                              static_cast<double>(out.union_px));
  return out;
}

bool spheres_overlap(const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth, double diameter_mm) {
  return translation_error_mm(estimate, truth) < diameter_mm;
}

bool sphere_projections_overlap(const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth, double diameter_mm) {
  const Eigen::Vector3d p = estimate.translation(), q = truth.translation();
  if (p.z() == 0 || q.z() == 0) return false;
  const double distance = (p.hnormalized() - q.hnormalized()).norm();
  return distance < diameter_mm / 2 * (1 / p.z() + 1 / q.z());
}

std::span<const double> bop_fractions() {
  static constexpr std::array<double, 10> fractions = {
      0.05, 0.1, 0.15000000000000002, 0.2, 0.25, 0.3, 0.35000000000000003, 0.4, 0.45, 0.5};
  return fractions;
}

std::span<const double> bop_pixels() {
  static constexpr std::array<double, 10> pixels = {5, 10, 15, 20, 25, 30, 35, 40, 45, 50};
  return pixels;
}

double bop_pixel_factor(int image_width) { return 640.0 / image_width; }

}  // namespace partpose
