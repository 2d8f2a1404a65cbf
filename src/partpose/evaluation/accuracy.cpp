// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/accuracy.hpp"

#include "partpose/core/pose.hpp"
#include "partpose/evaluation/pose_judge.hpp"
#include "partpose/io/pcd.hpp"

#include <algorithm>

namespace partpose {

Evaluation evaluate(const Result& result, const GroundTruth& truth) {
  Evaluation out;
  out.ground_truth_model_id = truth.model_id;
  out.ground_truth_model_name = truth.model_name;
  out.ground_truth_transformation_matrix = truth.camera_from_model;
  out.ground_truth_view_id = truth.view_id;
  out.timestamp = result.timestamp;
  out.recognized_correctly = result.model_name == truth.model_name;
  if (out.recognized_correctly && !truth.model_name.empty()) {
    out.rotation_error_deg = static_cast<float>(rotation_error_deg(result.T_final, truth.camera_from_model));
    out.translation_error_mm = static_cast<float>(translation_error_mm(result.T_final, truth.camera_from_model));
  }
  return out;
}

std::vector<ProtocolFrame> run_protocol(
    const GlobalPipeline& pipeline, const Dataset& test, const Progress& progress,
    const std::function<void(const ProtocolFrame&, const Recognition&, const PointCloud& scene)>& on_frame) {
  std::vector<ProtocolFrame> frames;
  const PoseJudge judge(pipeline.catalogue());
  const auto& camera = test.out.dataset_preparation_config.virtual_depth_camera;
  const std::size_t view_count = test.out.views.size(), count = test.out.models.size() * view_count;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& model = test.out.models[i / view_count];
    const auto& view = test.out.views[i % view_count];
    const PointCloud scene = read_pcd(test.view_path(model.id, view.id));
    const Recognition recognition = pipeline.recognize(scene);
    ProtocolFrame frame;
    frame.truth = {model.name, test.camera_from_model(i / view_count, i % view_count), model.id, view.id};
    frame.result = recognition.result;
    const Intrinsics intrinsics = camera.intrinsics();
    frame.evaluation = judge.judge(recognition.result, frame.truth,
                                   {intrinsics, to_depth_image(scene, intrinsics), AmbiguityOptions::of(camera.noise)});
    frame.time_ms = recognition.total_ms();
    if (on_frame) on_frame(frame, recognition, scene);
    frames.push_back(std::move(frame));
    if (progress) progress("recognizing views", i + 1, count);
  }
  return frames;
}

ProtocolSummary summarize(const std::vector<ProtocolFrame>& frames, double limit_deg, double limit_mm) {
  ProtocolSummary summary;
  std::vector<double> times;
  for (const auto& frame : frames) {
    ++summary.frames;
    times.push_back(frame.time_ms);
    if (frame.evaluation.recognized_correctly) {
      ++summary.correct;
      summary.pose_right +=
          frame.evaluation.rotation_error_deg < limit_deg && frame.evaluation.translation_error_mm < limit_mm;
    } else if (frame.result.candidate_id < 0) {
      ++summary.none;
    } else {
      ++summary.wrong;
    }
  }
  if (!times.empty()) {
    std::sort(times.begin(), times.end());
    summary.median_ms = times[times.size() / 2];
    summary.p95_ms = times[std::min(times.size() - 1, times.size() * 95 / 100)];
  }
  return summary;
}

}  // namespace partpose
