// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/recognition.hpp"

#include "partpose/core/error.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>

namespace partpose {

double Recognition::total_ms() const {
  double sum = 0;
  for (const auto& stage : stages) sum += stage.measure_ms;
  return sum;
}

Result result_of(const Candidate& candidate, const Catalogue& catalogue) {
  const auto& view = catalogue.views[candidate.view_row];
  Result result;
  result.T_final = candidate.camera_from_model;
  result.candidate_id = candidate.id;
  result.icp_converged = candidate.icp_converged;
  result.icp_fitness = candidate.icp_fitness;
  result.match_distance = candidate.match_distance;
  result.model_id = catalogue.parts[view.part].id;
  result.model_name = catalogue.parts[view.part].name;
  result.view_id = view.id;
  return result;
}

namespace {

/// The steps with the scene's points before and after each; of several segments, those of the one decided on.
std::vector<MeasuredOperation> with_points(std::vector<MeasuredOperation> stages, const Recognition& r) {
  const auto count = [](const PointCloud& cloud) { return static_cast<int>(cloud.size()); };
  int points = r.num_of_points_input;
  for (auto& stage : stages) {
    if (stage.tag == "segmentation" || stage.tag == "decision") continue;
    stage.points_in = points;
    if (stage.tag == "preprocessing") points = count(r.preprocessed);
    if (stage.tag == "normal_estimation") points = count(r.with_normals);
    if (stage.tag == "refinement_cloud") points = count(r.refinement_scene);
    stage.points_out = points;
  }
  return stages;
}

}  // namespace

Extras extras_of(const Recognition& recognition, const Catalogue& catalogue) {
  Extras extras;
  for (const auto& candidate : recognition.candidates) {
    const auto& view = catalogue.views[candidate.view_row];
    const auto& part = catalogue.parts[view.part];
    CandidateExtras out;
    out.T_1 = part.T1;
    out.T_2 = view.T2;
    out.T_3 = candidate.T3;
    out.T_4 = candidate.T4;
    out.T_final = candidate.camera_from_model;
    out.icp_converged = candidate.icp_converged;
    out.icp_fitness = candidate.icp_fitness;
    out.id = candidate.id;
    out.match_distance = candidate.match_distance;
    out.model_id = part.id;
    out.model_name = part.name;
    out.num_of_points = view.num_of_points;
    out.num_of_points_refinement = static_cast<int>(view.cloud.size());
    out.view_id = view.id;
    out.score = candidate.score;
    out.verdict = !candidate.verified               ? "not looked at: a candidate of better fitness was accepted"
                  : candidate.verification.accepted ? "accepted"
                                                    : candidate.verification.reason;
    if (const auto& v = candidate.verification; candidate.verified && v.scene_points > 0) {
      out.visible_model_points = v.visible_model_points;
      out.unexplained_model_points = v.unexplained_model_points;
      out.scene_points = v.scene_points;
      out.explained_scene_points = v.explained_scene_points;
    }
    extras.candidate_extras.push_back(std::move(out));
  }
  extras.scene_extras = {recognition.num_of_points_input, static_cast<int>(recognition.preprocessed.size()),
                         static_cast<int>(recognition.refinement_scene.size()),
                         static_cast<int>(recognition.with_normals.size())};
  extras.time_profiling = with_points(recognition.stages, recognition);
  extras.reason = recognition.reason;
  extras.timestamp = recognition.result.timestamp;
  return extras;
}

std::string make_timestamp() {
  using namespace std::chrono;
  // Two calls within a millisecond would name the same folder: the later one is given the next millisecond.
  static std::atomic<std::int64_t> last_ms{0};
  std::int64_t now_ms = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
  std::int64_t previous = last_ms.load();
  do {
    now_ms = std::max(now_ms, previous + 1);
  } while (!last_ms.compare_exchange_weak(previous, now_ms));
  const std::time_t seconds = now_ms / 1000;
  std::tm local{};
  localtime_r(&seconds, &local);
  return fmt::format("{:04d}-{:02d}-{:02d}_{:02d}-{:02d}-{:02d}_{:03d}", local.tm_year + 1900, local.tm_mon + 1,
                     local.tm_mday, local.tm_hour, local.tm_min, local.tm_sec, now_ms % 1000);
}

std::string score_below(double score, double min_score) {
  return fmt::format("scores {:.2f}, below {:g}", std::floor(score * 100) / 100, min_score);
}

}  // namespace partpose
