// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/descriptors.hpp"
#include "partpose/pipeline/config.hpp"
#include "partpose/pipeline/recognition.hpp"

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace partpose {

/// The online stage: matches a scene with the catalogue's views by a global descriptor, aligns, refines and verifies.
/// Immutable after construction and thread-safe. Options that concern the catalogue are those it was made with.
class GlobalPipeline final : public PartRecognizer {
 public:
  /// `step_notion` is told the name of each step as it begins; may be empty.
  GlobalPipeline(Catalogue catalogue, GlobalPipelineConfig config,
                 std::function<void(std::string_view)> step_notion = {});

  /// One object, segmented or to be segmented by `preprocessing`; camera frame.
  Recognition recognize(const PointCloud& scene) const;
  /// Throws Error for a depth image when the configuration scales scenes: it is in mm already.
  Recognition recognize(const Scene& scene) const override;

  const Catalogue& catalogue() const override { return catalogue_; }
  const GlobalPipelineConfig& config() const { return config_; }

 private:
  std::vector<Candidate> match(const PointCloud& scene) const;
  void coarse_align(std::vector<Candidate>& candidates, const PointCloud& scene, const KdTree& tree) const;
  void refine(std::vector<Candidate>& candidates, const PointCloud& scene, const KdTree& tree) const;
  int verify(std::vector<Candidate>& candidates, const PointCloud& scene) const;

  Catalogue catalogue_;
  GlobalPipelineConfig config_;
  std::function<void(std::string_view)> step_notion_;
  std::unique_ptr<GlobalDescriptor> descriptor_;
  std::vector<PointCloud> verification_models_;  ///< each part's surface at the verification's voxel size
};

}  // namespace partpose
