// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/verification/greedy_verification.hpp"

#include "partpose/core/error.hpp"
#include "partpose/geometry/kd_tree.hpp"

#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace partpose {

namespace {

/// The smallest z seen in each direction, in cells of equal size on the plane z = 1.
class DepthGrid {
 public:
  DepthGrid(const std::vector<Eigen::Vector3f>& points, float cell) : cell_(cell) {
    for (const auto& p : points) {
      const auto [it, added] = nearest_z_.try_emplace(key(p), p.z());
      if (!added) it->second = std::min(it->second, p.z());
    }
  }
  /// True when something lies more than `threshold_mm` in front of `p` in its cell.
  bool hides(const Eigen::Vector3f& p, float threshold_mm) const {
    const auto it = nearest_z_.find(key(p));
    return it != nearest_z_.end() && p.z() - it->second > threshold_mm;
  }

 private:
  std::int64_t key(const Eigen::Vector3f& p) const {
    const auto column = static_cast<std::int64_t>(std::floor(p.x() / p.z() / cell_));
    const auto row = static_cast<std::int64_t>(std::floor(p.y() / p.z() / cell_));
    return row * (std::int64_t{1} << 32) + column;
  }
  float cell_;
  std::unordered_map<std::int64_t, float> nearest_z_;
};

}  // namespace

void HypothesisVerificationOptions::check() const {
  if (!(model_representation_voxel_size > 0))
    throw Error("model_representation_voxel_size {}: must be positive", model_representation_voxel_size);
  if (!(inlier_threshold > 0)) throw Error("inlier_threshold {}: must be positive", inlier_threshold);
  if (!(occlusion_threshold >= 0)) throw Error("occlusion_threshold {}: must be 0 or more", occlusion_threshold);
  if (!(regularizer >= 0)) throw Error("regularizer {}: must be 0 or more", regularizer);
  if (!(voxel_mm() > 0)) throw Error("verification_voxel_size {}: must be positive", voxel_mm());
  if (!(min_scene_coverage >= 0 && min_scene_coverage <= 1))
    throw Error("min_scene_coverage {}: must be 0 to 1", min_scene_coverage);
}

Verification verify_greedy(const PointCloud& model, const Eigen::Isometry3d& camera_from_model, const PointCloud& scene,
                           const HypothesisVerificationOptions& options) {
  Verification out;
  out.scene_points = static_cast<int>(scene.size());
  if (scene.empty()) {
    out.reason = "the scene has no points";
    return out;
  }
  const PointCloud placed = transformed(model, camera_from_model);
  std::vector<Eigen::Vector3f> visible;
  visible.reserve(placed.size());
  if (options.occlusion_reasoning) {
    // Cells twice a voxel wide, so that a surface sampled once a voxel leaves no holes to see through.
    const auto mean_z = static_cast<float>(std::max(centroid(scene).z(), 1.0));
    const float cell = 2 * options.voxel_mm() / mean_z;
    const DepthGrid scene_surface(scene.points, cell), model_surface(placed.points, cell);
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const auto& p = placed.points[i];
      const bool away = placed.has_normals() && placed.normals[i].dot(p) >= 0;
      if (p.z() <= 0 || away || model_surface.hides(p, options.occlusion_threshold) ||
          scene_surface.hides(p, options.occlusion_threshold))
        continue;
      visible.push_back(p);
    }
  } else {
    visible = placed.points;
  }
  out.visible_model_points = static_cast<int>(visible.size());
  if (visible.empty()) {
    out.reason = "no point of the model would be visible";
    return out;
  }

  const float limit = options.inlier_threshold * options.inlier_threshold;
  const KdTree scene_tree(scene.points), model_tree(visible);
  for (const auto& p : visible) out.unexplained_model_points += scene_tree.nearest(p).squared_distance > limit;
  for (const auto& p : scene.points) out.explained_scene_points += model_tree.nearest(p).squared_distance <= limit;

  const double coverage = static_cast<double>(out.explained_scene_points) / out.scene_points;
  if (!(out.explained_scene_points > options.regularizer * static_cast<float>(out.unexplained_model_points))) {
    out.reason = fmt::format("{} explained scene points do not outweigh {} unexplained of {} visible model points",
                             out.explained_scene_points, out.unexplained_model_points, out.visible_model_points);
  } else if (coverage < options.min_scene_coverage) {
    out.reason = fmt::format("explains only {:.0f} % of the scene", 100 * coverage);
  } else {
    out.accepted = true;
  }
  return out;
}

}  // namespace partpose
