// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/global_pipeline.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/descriptor/descriptors.hpp"
#include "partpose/geometry/voxel_grid.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>

namespace partpose {

namespace {

/// Fewer points than this say nothing about a pose.
constexpr std::size_t smallest_scene = 10;

/// Runs, names and times the steps.
class Steps {
 public:
  Steps(std::vector<MeasuredOperation>& stages, const std::function<void(std::string_view)>& step_notion)
      : stages_(stages), step_notion_(step_notion) {}
  template <typename Body>
  void operator()(const char* name, const Body& body) {
    if (step_notion_) step_notion_(name);
    const Stopwatch watch;
    body();
    stages_.push_back({watch.elapsed_ms(), name});
  }

 private:
  std::vector<MeasuredOperation>& stages_;
  const std::function<void(std::string_view)>& step_notion_;
};

}  // namespace

double Recognition::total_ms() const {
  double sum = 0;
  for (const auto& stage : stages) sum += stage.measure_ms;
  return sum;
}

GlobalPipeline::GlobalPipeline(Catalogue catalogue, GlobalPipelineConfig config)
    : catalogue_(std::move(catalogue)), config_(std::move(config)) {
  config_.check();
  descriptor_ = make_global_descriptor(config_.global_descriptor, config_.descriptors);
  if (descriptor_->bins() != (catalogue_.index.size() ? static_cast<int>(catalogue_.index.row(0).size()) : 0))
    throw Error("the catalogue was made for another descriptor than \"{}\"", config_.global_descriptor);
  for (const auto& part : catalogue_.parts)
    verification_models_.push_back(voxel_grid(part.surface, config_.hypothesis_verification.voxel_mm()));
}

Recognition GlobalPipeline::recognize(const PointCloud& scene,
                                      const std::function<void(std::string_view)>& step_notion) const {
  Recognition r;
  r.result.timestamp = make_timestamp();
  r.num_of_points_input = static_cast<int>(scene.size());
  Steps step(r.stages, step_notion);

  step("preprocessing", [&] { r.preprocessed = preprocess(scene, config_.preprocessing).cloud; });
  step("normal_estimation", [&] { r.with_normals = with_normals(r.preprocessed, config_.normal_estimation); });
  if (r.with_normals.size() < smallest_scene) {
    r.reason = fmt::format("{} of {} points are left after preprocessing and normal estimation, too few to match",
                           r.with_normals.size(), scene.size());
    return r;
  }
  step("matching", [&] { r.candidates = match(r.with_normals); });
  const auto& refinement = config_.pose_refinement;
  std::optional<KdTree> tree;
  step("refinement_cloud", [&] {
    r.refinement_scene = refinement.voxelize_scene ? voxel_grid(r.with_normals, refinement.voxel_size) : r.with_normals;
    tree.emplace(r.refinement_scene.points);
  });
  step("coarse_alignment", [&] { coarse_align(r.candidates, r.refinement_scene, *tree); });
  step("pose_refinement", [&] { refine(r.candidates, r.refinement_scene, *tree); });
  step("sorting", [&] {
    std::stable_sort(r.candidates.begin(), r.candidates.end(),
                     [](const auto& a, const auto& b) { return a.icp_fitness < b.icp_fitness; });
  });
  step("hypothesis_verification", [&] { r.accepted = verify(r.candidates, r.preprocessed); });

  if (r.accepted >= 0) {
    const std::string timestamp = r.result.timestamp;
    r.result = result_of(r.candidates[r.accepted], catalogue_);
    r.result.timestamp = timestamp;
  } else {
    r.reason = r.candidates.empty() ? "no descriptor could be computed"
                                    : "no candidate was accepted; the best one " + r.candidates[0].verification.reason;
  }
  return r;
}

std::vector<Candidate> GlobalPipeline::match(const PointCloud& scene) const {
  const int k = neighbours_of(config_.global_descriptor, config_.descriptors);
  // A view counts by its best cluster: the distances of all pairs, best first, each view once.
  std::vector<Match> matches;
  for (const auto& description : descriptor_->describe(scene)) {
    const auto found = catalogue_.index.nearest(description.histogram, catalogue_.index.size());
    matches.insert(matches.end(), found.begin(), found.end());
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const auto& a, const auto& b) { return a.distance < b.distance; });
  std::vector<bool> taken(catalogue_.views.size(), false);
  std::vector<Candidate> candidates;
  for (const auto& m : matches) {
    const int row = catalogue_.view_of_row[m.row];
    if (taken[row]) continue;
    taken[row] = true;
    Candidate candidate;
    candidate.id = static_cast<int>(candidates.size());
    candidate.view_row = row;
    candidate.match_distance = m.distance;
    candidates.push_back(candidate);
    if (static_cast<int>(candidates.size()) == k) break;
  }
  return candidates;
}

void GlobalPipeline::coarse_align(std::vector<Candidate>& candidates, const PointCloud& scene,
                                  const KdTree& tree) const {
  const AlignmentFeatures scene_features = alignment_features(scene);
  parallel_for(candidates.size(), [&](std::size_t i) {
    const auto& view = catalogue_.views[candidates[i].view_row];
    const auto alignments = coarse_alignments(view.features, scene_features, config_.coarse_alignment);
    constexpr std::size_t probes = 150;
    const PointCloud few = every_nth(view.cloud, std::max<std::size_t>(view.cloud.size() / probes, 1));
    double best = std::numeric_limits<double>::infinity();
    for (const auto& alignment : alignments) {
      const double distance = alignments.size() == 1 ? 0.0 : mean_nearest_distance_mm(few, alignment, tree);
      if (distance >= best) continue;
      best = distance;
      candidates[i].T3 = alignment;
    }
  });
}

void GlobalPipeline::refine(std::vector<Candidate>& candidates, const PointCloud& scene, const KdTree& tree) const {
  parallel_for(candidates.size(), [&](std::size_t i) {
    Candidate& candidate = candidates[i];
    const auto& view = catalogue_.views[candidate.view_row];
    const PointCloud aligned = transformed(view.cloud, candidate.T3);
    const IcpResult refined = icp(aligned, scene, tree, config_.pose_refinement);
    candidate.T4 = refined.target_from_source;
    candidate.icp_converged = refined.converged;
    double fitness = mean_nearest_distance_mm(aligned, candidate.T4, tree);
    if (config_.pose_refinement.two_sided_fitness)
      fitness = 0.5 * (fitness + mean_nearest_distance_mm(scene, candidate.T4.inverse(), KdTree(aligned.points)));
    candidate.icp_fitness = static_cast<float>(fitness);
    candidate.camera_from_model = candidate.T4 * candidate.T3 * view.T2 * catalogue_.parts[view.part].T1;
  });
}

int GlobalPipeline::verify(std::vector<Candidate>& candidates, const PointCloud& scene) const {
  const auto& options = config_.hypothesis_verification;
  const PointCloud thinned = voxel_grid(scene, options.voxel_mm());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Candidate& candidate = candidates[i];
    const int part = catalogue_.views[candidate.view_row].part;
    candidate.verification =
        verify_greedy({catalogue_.parts[part].mesh, verification_models_[part], candidate.camera_from_model}, scene,
                      thinned, options);
    candidate.verified = true;
    if (candidate.verification.accepted) return static_cast<int>(i);
  }
  return -1;
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

}  // namespace partpose
