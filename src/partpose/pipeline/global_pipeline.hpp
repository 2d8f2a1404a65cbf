// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/descriptors.hpp"
#include "partpose/pipeline/catalogue.hpp"
#include "partpose/pipeline/config.hpp"
#include "partpose/pipeline/records.hpp"

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace partpose {

/// One hypothesis: a view of a part, and where it lies in the scene.
struct Candidate {
  int id = -1;        ///< rank in the matching
  int view_row = -1;  ///< index into Catalogue::views
  float match_distance = -1;
  std::vector<ReferenceFrames> reference_frames = {};    ///< of the descriptions that match, best match first
  Eigen::Isometry3d T3 = Eigen::Isometry3d::Identity();  ///< coarse alignment
  Eigen::Isometry3d T4 = Eigen::Isometry3d::Identity();  ///< refinement
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  bool icp_converged = false;
  float icp_fitness = -1;  ///< mm
  float score = -1;        ///< of render-and-compare, 0 to 1; -1: not rendered
  Verification verification = {};
  bool verified = false;  ///< false: a better candidate was accepted before this one's turn
};

/// What happened to one scene: the one record behind everything that shows results.
struct Recognition {
  Result result;
  std::vector<Candidate> candidates;  ///< in the order of the verification
  int accepted = -1;                  ///< index into candidates
  PointCloud preprocessed;            ///< camera frame
  PointCloud with_normals;            ///< camera frame
  PointCloud refinement_scene;        ///< camera frame
  int num_of_points_input = 0;
  std::vector<MeasuredOperation> stages;
  std::string reason;  ///< why nothing was recognized; empty when something was

  double total_ms() const;
};

/// The online stage: matches a scene with the catalogue's views by a global descriptor, aligns, refines and verifies.
/// Immutable after construction and thread-safe. Options that concern the catalogue are those it was made with.
class GlobalPipeline {
 public:
  GlobalPipeline(Catalogue catalogue, GlobalPipelineConfig config);

  /// One object, segmented or to be segmented by `preprocessing`; camera frame, the camera at the origin. An empty or
  /// degenerate scene gives a Recognition without a result.
  /// `step_notion` is told the name of each step as it begins.
  Recognition recognize(const PointCloud& scene, const std::function<void(std::string_view)>& step_notion = {}) const;

  const Catalogue& catalogue() const { return catalogue_; }
  const GlobalPipelineConfig& config() const { return config_; }

 private:
  std::vector<Candidate> match(const PointCloud& scene) const;
  void coarse_align(std::vector<Candidate>& candidates, const PointCloud& scene, const KdTree& tree) const;
  void refine(std::vector<Candidate>& candidates, const PointCloud& scene, const KdTree& tree) const;
  int verify(std::vector<Candidate>& candidates, const PointCloud& scene) const;

  Catalogue catalogue_;
  GlobalPipelineConfig config_;
  std::unique_ptr<GlobalDescriptor> descriptor_;
  std::vector<PointCloud> verification_models_;  ///< each part's surface at the verification's voxel size
};

/// What the candidate says, without a timestamp.
Result result_of(const Candidate& candidate, const Catalogue& catalogue);

/// Extras (C.2.3) of what happened.
Extras extras_of(const Recognition& recognition, const Catalogue& catalogue);

/// Local time to the millisecond, as in 2026-01-31_14-05-09_123; each call in a process gives another one.
std::string make_timestamp();

}  // namespace partpose
