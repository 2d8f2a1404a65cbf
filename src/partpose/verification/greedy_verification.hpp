// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"
#include "partpose/core/point_cloud.hpp"

#include <Eigen/Geometry>

#include <optional>
#include <string>

namespace partpose {

struct HypothesisVerificationOptions {
  float model_representation_voxel_size = 3;
  float inlier_threshold = 10;
  bool occlusion_reasoning = true;
  float occlusion_threshold = 6;
  float regularizer = 45;
  float verification_voxel_size = 5;
  std::optional<float> resolution;
  float min_scene_coverage = 0.8f;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("model_representation_voxel_size", self.model_representation_voxel_size,
          "voxel of the part's fused views [mm], > 0");
    visit("inlier_threshold", self.inlier_threshold, "model and scene points this near explain each other [mm], > 0");
    visit("occlusion_reasoning", self.occlusion_reasoning, "model points that cannot be seen do not count");
    visit("occlusion_threshold", self.occlusion_threshold,
          "a point this far behind the surface seen in its direction is hidden [mm], >= 0");
    visit("regularizer", self.regularizer,
          "how many explained scene points one visible but unexplained model point outweighs, >= 0");
    visit("verification_voxel_size", self.verification_voxel_size,
          "voxel of scene and model in the verification [mm], > 0");
    visit("resolution", self.resolution, "another name of verification_voxel_size, which it overrides");
    visit("min_scene_coverage", self.min_scene_coverage,
          "share of the scene's points that an accepted candidate explains, 0 to 1; 0 switches it off");
  }
  void check() const;
  float voxel_mm() const { return resolution.value_or(verification_voxel_size); }
};

/// How well a model at a pose and a scene explain each other.
struct Verification {
  bool accepted = false;
  int visible_model_points = 0;
  int unexplained_model_points = 0;
  int scene_points = 0;
  int explained_scene_points = 0;
  std::string reason;  ///< why it was not accepted, empty when it was
};

/// A part at a hypothesised pose.
struct PlacedPart {
  const TriangleMesh& mesh;     ///< model frame
  const PointCloud& surface;    ///< all views fused and thinned out by `voxel_mm()`, model frame
  Eigen::Isometry3d camera_from_model;
};

/// Greedy hypothesis verification (Aldoma et al. 2012, reference 3.5.6) of one candidate against the segmented scene,
/// camera frame, as it is and thinned out by `voxel_mm()`. Accepted when explained scene points > regularizer x
/// unexplained visible model points and, which the original does not ask, when enough of the scene is explained.
/// With occlusion reasoning a model point counts only where the camera could see it: not behind the rendered mesh, nor
/// behind the scene's points.
Verification verify_greedy(const PlacedPart& part, const PointCloud& scene, const PointCloud& thinned_scene,
                           const HypothesisVerificationOptions& options);

}  // namespace partpose
