// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/progress.hpp"
#include "partpose/pipeline/global_pipeline.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace partpose {

/// What a scene shows. An empty name: none of the catalogue's parts.
struct GroundTruth {
  std::string model_name;
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  int model_id = -1;
  int view_id = -1;
};

/// Compares a result with the truth (appendix C.2.4; the reference's equations 2.2 and 2.3).
Evaluation evaluate(const Result& result, const GroundTruth& truth);

/// A dataset's view as a test scene.
struct ProtocolFrame {
  GroundTruth truth;
  Result result;
  Evaluation evaluation;
  double time_ms = 0;
};

struct ProtocolSummary {
  int frames = 0;
  int correct = 0;
  int wrong = 0;
  int none = 0;
  int pose_right = 0;  ///< correct, and within both limits
  double median_ms = 0;
  double p95_ms = 0;

  double correct_percent() const { return frames ? 100.0 * correct / frames : 0; }
  double wrong_percent() const { return frames ? 100.0 * wrong / frames : 0; }
  double none_percent() const { return frames ? 100.0 * none / frames : 0; }
  double pose_right_percent() const { return frames ? 100.0 * pose_right / frames : 0; }
};

/// Runs the pipeline on every view of every model of `test` (reference, 6.2.1: the ground-truth and the virtual-noise
/// protocol), one after the other so that the times are those of single frames.
/// `on_frame` sees each frame as it is done; may be empty.
std::vector<ProtocolFrame> run_protocol(
    const GlobalPipeline& pipeline, const Dataset& test, const Progress& progress = {},
    const std::function<void(const ProtocolFrame&, const Recognition&, const PointCloud& scene)>& on_frame = {});

/// Pose limits as in the reference's tables: 15 degrees and 15 mm, symmetry ignored.
ProtocolSummary summarize(const std::vector<ProtocolFrame>& frames, double limit_deg = 15, double limit_mm = 15);

}  // namespace partpose
