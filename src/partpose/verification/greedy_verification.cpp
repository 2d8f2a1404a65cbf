// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/verification/greedy_verification.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/depth_image.hpp"
#include "partpose/core/error.hpp"
#include "partpose/geometry/kd_tree.hpp"

#include <cmath>

namespace partpose {

namespace {

/// How far `p` lies behind what `depth` shows in its direction, in mm; nothing where it shows nothing.
std::optional<float> depth_behind(const Eigen::Vector3f& p, const DepthImage& depth, const Intrinsics& camera) {
  const Eigen::Vector2d pixel = camera.project(p.cast<double>());
  const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
  if (u < 0 || v < 0 || u >= depth.width || v >= depth.height || !(depth.at(u, v) > 0)) return std::nullopt;
  return p.z() - depth.at(u, v);
}

/// What the camera would see of a part at its place.
struct SeenPart {
  std::vector<Eigen::Vector3f> sampled;  ///< the model's points that the scene should show
  std::vector<Eigen::Vector3f> surface;  ///< the rendered mesh, as a grid of points: what may explain a scene point
};

/// A model point should be in the scene where the rendered mesh shows it in its direction (it is neither hidden nor on a
/// wall so steep that no line of sight meets it) and where nothing of the scene lies before it.
SeenPart what_is_seen(const PointCloud& placed, const PlacedPart& part, const PointCloud& scene,
                      const HypothesisVerificationOptions& options) {
  SeenPart seen;
  const double mean_z_mm = centroid(placed).z();
  if (!(mean_z_mm > 0)) return seen;
  const Intrinsics camera = intrinsics_covering(placed, 0.5 * options.voxel_mm() / mean_z_mm);
  const DepthImage own = render(part.mesh, part.camera_from_model, camera).depth;
  const DepthImage others = to_depth_image(scene, camera);
  for (const auto& p : placed.points) {
    if (!(p.z() > 0)) continue;
    const auto behind_model = depth_behind(p, own, camera);
    const auto behind_scene = depth_behind(p, others, camera);
    if (behind_model && std::abs(*behind_model) <= options.occlusion_threshold &&
        !(behind_scene && *behind_scene > options.occlusion_threshold))
      seen.sampled.push_back(p);
  }
  seen.surface = to_point_cloud(own, camera).points;
  return seen;
}

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

Verification verify_greedy(const PlacedPart& part, const PointCloud& scene, const PointCloud& thinned_scene,
                           const HypothesisVerificationOptions& options) {
  Verification out;
  out.scene_points = static_cast<int>(thinned_scene.size());
  if (thinned_scene.empty()) {
    out.reason = "the scene has no points";
    return out;
  }
  const PointCloud placed = transformed(part.surface, part.camera_from_model);
  const SeenPart seen = options.occlusion_reasoning ? what_is_seen(placed, part, scene, options)
                                                   : SeenPart{placed.points, placed.points};
  out.visible_model_points = static_cast<int>(seen.sampled.size());
  if (seen.sampled.empty() || seen.surface.empty()) {
    out.reason = "no point of the model would be visible";
    return out;
  }

  const float limit = options.inlier_threshold * options.inlier_threshold;
  const KdTree scene_tree(thinned_scene.points), surface_tree(seen.surface);
  for (const auto& p : seen.sampled) out.unexplained_model_points += scene_tree.nearest(p).squared_distance > limit;
  for (const auto& p : thinned_scene.points)
    out.explained_scene_points += surface_tree.nearest(p).squared_distance <= limit;

  const double coverage = static_cast<double>(out.explained_scene_points) / out.scene_points;
  if (!(out.explained_scene_points > options.regularizer * static_cast<float>(out.unexplained_model_points))) {
    out.reason = fmt::format("explains {} scene points, not more than regularizer {} x {} unexplained of {} visible model "
                             "points", out.explained_scene_points, options.regularizer, out.unexplained_model_points,
                             out.visible_model_points);
  } else if (coverage < options.min_scene_coverage) {
    out.reason = fmt::format("explains only {:.0f} % of the scene", 100 * coverage);
  } else {
    out.accepted = true;
  }
  return out;
}

}  // namespace partpose
