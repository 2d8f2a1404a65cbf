// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/icp.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/registration/normal_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace partpose {

namespace {

struct Pair {
  int source = 0;
  int target = 0;
  float squared_distance = 0;
};

struct Pairs {
  std::vector<Pair> kept;
  double mean_squared_mm2 = 0;
};

Pairs find_pairs(const PointCloud& source, const PointCloud& target, const KdTree& tree,
                 const Eigen::Isometry3d& target_from_source, const PoseRefinementOptions& options) {
  const Eigen::Matrix3f rotation = target_from_source.linear().cast<float>();
  const Eigen::Vector3f translation = target_from_source.translation().cast<float>();
  const float limit = options.max_correspondence_distance * options.max_correspondence_distance;
  Pairs pairs;
  pairs.kept.reserve(source.size());
  for (std::size_t i = 0; i < source.size(); ++i) {
    const auto nearest = tree.nearest(rotation * source.points[i] + translation);
    if (nearest.index < 0 || nearest.squared_distance > limit) continue;
    if (options.enforce_same_direction_normals && (rotation * source.normals[i]).dot(target.normals[nearest.index]) < 0)
      continue;
    pairs.kept.push_back({static_cast<int>(i), nearest.index, nearest.squared_distance});
  }
  if (pairs.kept.empty()) return pairs;
  if (options.correspondence_gate_factor > 0) {
    std::vector<float> squared(pairs.kept.size());
    std::transform(pairs.kept.begin(), pairs.kept.end(), squared.begin(), [](const Pair& p) { return p.squared_distance; });
    const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
    std::nth_element(squared.begin(), middle, squared.end());
    const float gate = *middle * options.correspondence_gate_factor * options.correspondence_gate_factor;
    std::erase_if(pairs.kept, [gate](const Pair& p) { return p.squared_distance > gate; });
  }
  for (const auto& pair : pairs.kept) pairs.mean_squared_mm2 += pair.squared_distance;
  pairs.mean_squared_mm2 /= static_cast<double>(std::max<std::size_t>(pairs.kept.size(), 1));
  return pairs;
}

/// The motion that brings the source points (already at their present pose) nearer to their partners.
Eigen::Isometry3d best_step(const PointCloud& source, const PointCloud& target, const std::vector<Pair>& pairs,
                            const Eigen::Isometry3d& target_from_source, bool symmetric) {
  // One centre for both clouds: what the pairs do not determine stays where it is.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& pair : pairs)
    centre += target_from_source * source.points[pair.source].cast<double>() + target.points[pair.target].cast<double>();
  centre /= 2.0 * static_cast<double>(pairs.size());

  NormalEquations equations;
  const Eigen::Matrix3d rotation = target_from_source.linear();
  for (const auto& pair : pairs) {
    const Eigen::Vector3d p = target_from_source * source.points[pair.source].cast<double>() - centre;
    const Eigen::Vector3d q = target.points[pair.target].cast<double>() - centre;
    Eigen::Vector3d n = target.normals[pair.target].cast<double>();
    Eigen::Vector3d arm = p;
    if (symmetric) {
      n += rotation * source.normals[pair.source].cast<double>();
      const double length = n.norm();
      if (!(length > 1e-6)) continue;
      n /= length;  // the same weight as one point-to-plane pair
      arm = p + q;
    }
    equations.add(arm, n, (p - q).dot(n), 1.0, p.squaredNorm());
  }
  if (!(equations.squared_extent_mm2 > 0)) return Eigen::Isometry3d::Identity();
  const Vector6d solution = equations.solve();
  const Eigen::Vector3d turn = solution.head<3>(), shift = solution.tail<3>();

  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  if (symmetric) {
    // Half of the rotation before and half after the translation; the solution is the axis times tan(angle).
    const double angle = std::atan(turn.norm());
    const Eigen::Matrix3d half = rotation_from_vector(turn.norm() > 0 ? Eigen::Vector3d(turn.normalized() * angle) : turn);
    step.linear() = half * half;
    step.translation() = centre + half * (shift * std::cos(angle)) - step.linear() * centre;
  } else {
    step.linear() = rotation_from_vector(turn);
    step.translation() = centre + shift - step.linear() * centre;
  }
  return step;
}

/// Upper bound of how far `step` moves any of the source's points, by their bounding box.
double largest_motion_mm(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& target_from_source,
                         const Eigen::Isometry3d& step) {
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p = target_from_source * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
    largest = std::max(largest, (step * p - p).norm());
  }
  return largest;
}

}  // namespace

void PoseRefinementOptions::check() const {
  if (!(voxel_size > 0)) throw Error("voxel_size {}: must be positive", voxel_size);
  if (!(max_correspondence_distance > 0))
    throw Error("max_correspondence_distance {}: must be positive", max_correspondence_distance);
  if (max_iterations < 1) throw Error("max_iterations {}: must be 1 or more", max_iterations);
  if (!(transformation_epsilon >= 0)) throw Error("transformation_epsilon {}: must be 0 or more", transformation_epsilon);
  if (!(euclidean_fitness_epsilon >= 0))
    throw Error("euclidean_fitness_epsilon {}: must be 0 or more", euclidean_fitness_epsilon);
  if (!(correspondence_gate_factor >= 0))
    throw Error("correspondence_gate_factor {}: must be 0 or more", correspondence_gate_factor);
}

namespace {

/// Iterates from `start` until converged or `max_iterations` are done.
IcpResult iterate(const PointCloud& source, const PointCloud& target, const KdTree& target_tree,
                  const PoseRefinementOptions& options, const IcpResult& start) {
  Eigen::AlignedBox3d box;
  for (const auto& p : source.points) box.extend(p.cast<double>());

  IcpResult result = start;
  result.converged = false;
  // A start far from any fit wanders: given up when the pairs have not come nearer for some iterations.
  constexpr int patience = 10;
  constexpr double nearer = 0.995;
  double last_mean_squared = std::numeric_limits<double>::infinity(), best_mean_squared = last_mean_squared;
  int since_best = 0;
  for (; result.iterations < options.max_iterations; ++result.iterations) {
    const Pairs pairs = find_pairs(source, target, target_tree, result.target_from_source, options);
    result.pairs = static_cast<int>(pairs.kept.size());
    if (result.pairs < 6) return result;
    const Eigen::Isometry3d step =
        best_step(source, target, pairs.kept, result.target_from_source, options.use_symmetric_objective);
    const double motion = largest_motion_mm(box, result.target_from_source, step);
    result.target_from_source = step * result.target_from_source;
    if (motion <= options.transformation_epsilon &&
        std::abs(last_mean_squared - pairs.mean_squared_mm2) <= options.euclidean_fitness_epsilon) {
      result.converged = true;
      ++result.iterations;
      break;
    }
    last_mean_squared = pairs.mean_squared_mm2;
    since_best = pairs.mean_squared_mm2 < nearer * best_mean_squared ? 0 : since_best + 1;
    best_mean_squared = std::min(best_mean_squared, pairs.mean_squared_mm2);
    if (since_best >= patience) break;
  }
  return result;
}

}  // namespace

IcpResult icp(const PointCloud& source, const PointCloud& target, const KdTree& target_tree,
              const PoseRefinementOptions& options) {
  if (!source.has_normals() || !target.has_normals()) throw Error("ICP needs clouds with normals");
  // Most of the way is gone with a few hundred points, evenly picked; all of them give the last digits.
  constexpr std::size_t few = 250;
  IcpResult start;
  if (source.size() > 2 * few) {
    PoseRefinementOptions first = options;
    first.max_iterations = std::max(options.max_iterations / 2, 1);
    start = iterate(every_nth(source, source.size() / few), target, target_tree, first, start);
  }
  return iterate(source, target, target_tree, options, start);
}

double mean_nearest_distance_mm(const PointCloud& cloud, const Eigen::Isometry3d& tree_from_cloud, const KdTree& tree) {
  if (cloud.empty()) return 0;
  const Eigen::Isometry3f pose = tree_from_cloud.cast<float>();
  double sum = 0;
  for (const auto& p : cloud.points) sum += std::sqrt(static_cast<double>(tree.nearest(pose * p).squared_distance));
  return sum / static_cast<double>(cloud.size());
}

}  // namespace partpose
