// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/global_pipeline.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/descriptor/descriptors.hpp"
#include "partpose/geometry/voxel_grid.hpp"
#include "partpose/preprocess/segmentation.hpp"

#include <algorithm>

namespace partpose {

namespace {

/// Fewer points than this say nothing about a pose.
constexpr std::size_t smallest_scene = 10;

/// So many pairs of clusters of a view and the scene are tried as alignments.
constexpr std::size_t most_reference_frames = 6;

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

GlobalPipeline::GlobalPipeline(Catalogue catalogue, GlobalPipelineConfig config,
                               std::function<void(std::string_view)> step_notion)
    : catalogue_(std::move(catalogue)), config_(std::move(config)), step_notion_(std::move(step_notion)) {
  config_.check();
  descriptor_ = make_global_descriptor(config_.global_descriptor, config_.descriptors);
  if (descriptor_->bins() != (catalogue_.index.size() ? static_cast<int>(catalogue_.index.row(0).size()) : 0))
    throw Error("the catalogue was made for another descriptor than \"{}\"", config_.global_descriptor);
  for (const auto& part : catalogue_.parts)
    verification_models_.push_back(voxel_grid(part.surface, config_.hypothesis_verification.voxel_mm()));
}

Recognition GlobalPipeline::recognize(const Scene& scene) const {
  if (scene.depth && config_.preprocessing.scale_flag)
    throw Error("a depth image is in mm by its camera; preprocessing.scale_flag would scale it again: switch it off");
  return recognize(scene.cloud);
}

Recognition GlobalPipeline::recognize(const PointCloud& scene) const {
  Recognition r;
  r.result.timestamp = make_timestamp();
  r.num_of_points_input = static_cast<int>(scene.size());
  Steps step(r.stages, step_notion_);

  step("preprocessing", [&] { r.preprocessed = preprocess(scene, config_.preprocessing).cloud; });
  step("normal_estimation", [&] { r.with_normals = with_normals(r.preprocessed, config_.normal_estimation); });
  if (r.with_normals.size() < smallest_scene) {
    const float mm = config_.preprocessing.scale_flag ? config_.preprocessing.scale_factor : 1;
    std::vector<float> z_mm;
    for (const auto& p : scene.points) z_mm.push_back(p.z() * mm);
    r.reason = fmt::format("{} of {} points are left after preprocessing and normal estimation, too few to match{}",
                           r.with_normals.size(), scene.size(), hint_of_unit(std::move(z_mm)));
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
  const std::size_t k = neighbours_of(config_.global_descriptor, config_.descriptors);
  // All pairs of a description of the scene and one of the catalogue, best first. A view counts by its best pair.
  struct Pair {
    Match match;
    const Description* description;
  };
  const auto descriptions = descriptor_->describe(scene);
  std::vector<Pair> pairs;
  for (const auto& description : descriptions)
    for (const Match& match : catalogue_.index.nearest(description.histogram, catalogue_.index.size()))
      pairs.push_back({match, &description});
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.match.distance < b.match.distance; });
  std::vector<int> candidate_of_view(catalogue_.views.size(), -1);
  std::vector<Candidate> candidates;
  for (const auto& [match, description] : pairs) {
    const auto& row = catalogue_.descriptions[match.row];
    int& index = candidate_of_view[row.view];
    if (index < 0) {
      if (candidates.size() == k) continue;
      index = static_cast<int>(candidates.size());
      candidates.push_back({.id = index, .view_row = row.view, .match_distance = match.distance});
    }
    auto& frames = candidates[index].reference_frames;
    if (row.camera_from_reference && description->camera_from_reference && frames.size() < most_reference_frames)
      frames.push_back({*row.camera_from_reference, *description->camera_from_reference});
  }
  return candidates;
}

void GlobalPipeline::coarse_align(std::vector<Candidate>& candidates, const PointCloud& scene,
                                  const KdTree& tree) const {
  const AlignmentFeatures scene_features = alignment_features(scene);
  parallel_for(candidates.size(), [&](std::size_t i) {
    const auto& view = catalogue_.views[candidates[i].view_row];
    const auto alignments =
        coarse_alignments(view.features, scene_features, candidates[i].reference_frames, config_.coarse_alignment);
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
    const auto share = [](int part_of, int all) {
      return all > 0 ? static_cast<float>(part_of) / static_cast<float>(all) : 0.0f;
    };
    const Verification& v = candidate.verification;
    candidate.score = share(v.explained_scene_points, v.scene_points) *
                      (1 - share(v.unexplained_model_points, v.visible_model_points));
    if (candidate.verification.accepted) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace partpose
