// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/plane.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/random.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace partpose {

namespace {

Plane plane_through(const Eigen::Vector3d& point, const Eigen::Vector3d& unit_normal) {
  Plane plane{unit_normal, -unit_normal.dot(point)};
  if (plane.offset_mm < 0) plane = {-plane.normal, -plane.offset_mm};
  return plane;
}

/// Least squares through the points whose distance to `near` is at most `threshold`.
std::optional<Plane> refit(const std::vector<Eigen::Vector3f>& points, const Plane& near, double threshold) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  const Eigen::Vector3d origin = points.front().cast<double>();
  double count = 0;
  for (const auto& p : points) {
    if (std::abs(near.signed_distance_mm(p)) > threshold) continue;
    const Eigen::Vector3d d = p.cast<double>() - origin;
    sum += d;
    products += d * d.transpose();
    ++count;
  }
  if (count < 3) return std::nullopt;
  const Eigen::Vector3d mean = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(products / count - mean * mean.transpose());
  if (!(solver.eigenvalues()[1] > 1e-9 * solver.eigenvalues()[2])) return std::nullopt;
  return plane_through(origin + mean, solver.eigenvectors().col(0));
}

}  // namespace

std::optional<PlaneFit> fit_plane(const PointCloud& cloud, const PlaneOptions& options) {
  if (!(options.distance_threshold_mm > 0))
    throw Error("plane distance threshold {} mm: must be positive", options.distance_threshold_mm);
  // Hypotheses are scored on a subset: 2,000 points tell shares to about one per cent.
  constexpr std::size_t scored_points = 2000;
  std::vector<Eigen::Vector3f> all;
  all.reserve(cloud.size());
  for (const auto& p : cloud.points)
    if (p.allFinite()) all.push_back(p);
  if (all.size() < 3) return std::nullopt;
  Random random(options.seed);
  std::vector<Eigen::Vector3f> sample;
  if (all.size() <= scored_points) {
    sample = all;
  } else {
    for (std::size_t i = 0; i < scored_points; ++i) sample.push_back(all[random.below(all.size())]);
  }

  std::optional<Plane> best;
  int best_count = 0;
  double needed = options.max_hypotheses;
  for (int draw = 0; draw < options.max_hypotheses && draw < needed; ++draw) {
    const Eigen::Vector3d a = sample[random.below(sample.size())].cast<double>();
    const Eigen::Vector3d b = sample[random.below(sample.size())].cast<double>();
    const Eigen::Vector3d c = sample[random.below(sample.size())].cast<double>();
    const Eigen::Vector3d cross = (b - a).cross(c - a);
    if (!(cross.norm() > 1e-6 * (b - a).norm() * (c - a).norm())) continue;
    const Plane plane = plane_through(a, cross.normalized());
    int count = 0;
    for (const auto& p : sample) count += std::abs(plane.signed_distance_mm(p)) <= options.distance_threshold_mm;
    if (count <= best_count) continue;
    best = plane;
    best_count = count;
    const double share = static_cast<double>(count) / static_cast<double>(sample.size());
    if (share < 1) needed = std::log(1e-6) / std::log(1 - share * share * share);
    else needed = 0;
  }
  if (!best) return std::nullopt;

  PlaneFit fit{*best, {}, 0};
  for (int round = 0; round < 5; ++round) {
    const auto refined = refit(all, fit.plane, options.distance_threshold_mm);
    if (!refined) return std::nullopt;
    const bool settled = (refined->normal - fit.plane.normal).norm() < 1e-7 &&
                         std::abs(refined->offset_mm - fit.plane.offset_mm) < 1e-4;
    fit.plane = *refined;
    if (settled) break;
  }
  double squared = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    const double distance = fit.plane.signed_distance_mm(cloud.points[i]);
    if (std::abs(distance) > options.distance_threshold_mm) continue;
    fit.inliers.push_back(static_cast<int>(i));
    squared += distance * distance;
  }
  fit.rms_mm = fit.inliers.empty() ? 0.0 : std::sqrt(squared / static_cast<double>(fit.inliers.size()));
  return fit;
}

}  // namespace partpose
