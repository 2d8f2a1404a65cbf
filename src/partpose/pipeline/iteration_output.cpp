// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/iteration_output.hpp"

#include "partpose/io/json.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/io/png.hpp"
#include "partpose/pipeline/picture.hpp"
#include "partpose/preprocess/segmentation.hpp"

namespace partpose {

namespace {

namespace fs = std::filesystem;

/// The candidate's view, as it is in the dataset, where the candidate lies.
PointCloud placed_view(const Candidate& candidate, const Catalogue& catalogue) {
  const auto& view = catalogue.views[candidate.view_row];
  const auto& part = catalogue.parts[view.part];
  const PointCloud cloud = without_missing(read_pcd(catalogue.dataset.view_path(part.id, view.id)));
  return transformed(cloud, candidate.camera_from_model * (view.T2 * part.T1).inverse());
}

void write_clouds(const fs::path& folder, const Recognition& recognition, const PointCloud& scene,
                  const Catalogue& catalogue) {
  write_ply(folder / "scene_original.ply", scene);
  write_ply(folder / "scene_cloud_w_normals.ply", recognition.with_normals);
  write_pcd(folder / "scene_cloud_w_normals.pcd", recognition.with_normals);
  for (const auto& candidate : recognition.candidates)
    write_ply(folder / fmt::format("candidate_{}.ply", candidate.id), placed_view(candidate, catalogue));
  if (recognition.accepted < 0) return;
  const Candidate& accepted = recognition.candidates[recognition.accepted];
  const PointCloud partial = placed_view(accepted, catalogue);
  write_ply(folder / "result_partial.ply", partial);
  write_pcd(folder / "result_partial.pcd", partial);
  const auto& part = catalogue.parts[catalogue.views[accepted.view_row].part];
  write_ply(folder / "result_full.ply", transformed(part.surface, accepted.camera_from_model));
}

void write_pictures(const fs::path& folder, const Recognition& recognition, const PointCloud& scene,
                    const Catalogue& catalogue, const VisualizeOptions& steps) {
  const auto pixels = intrinsics_of(before_camera(recognition.preprocessed.empty() ? scene : recognition.preprocessed), 20);
  if (!pixels) return;  // nothing to be seen
  const Intrinsics& camera = *pixels;
  const DepthImage depth = to_depth_image(recognition.preprocessed, camera);
  const auto draw = [&](const Candidate& candidate, const Eigen::Isometry3d& camera_from_model) {
    const auto& part = catalogue.parts[catalogue.views[candidate.view_row].part];
    return draw_overlay(depth, camera, PlacedMesh{part.mesh, camera_from_model});
  };
  const auto draw_all = [&](bool refined, std::vector<ColourImage> pictures = {}) {
    for (const auto& candidate : recognition.candidates)
      pictures.push_back(draw(candidate, refined ? candidate.camera_from_model
                                                 : candidate.T4.inverse() * candidate.camera_from_model));
    return tile(pictures, 3);
  };
  if (steps.preprocess) write_png(folder / "visualize_preprocess.png", draw_overlay(depth, camera, std::nullopt));
  if (steps.normal_estimation)
    write_png(folder / "visualize_normal_estimation.png", draw_normals(recognition.with_normals, camera));
  if (!recognition.candidates.empty()) {
    if (steps.coarse_alignment) write_png(folder / "visualize_coarse_alignment.png", draw_all(false));
    if (steps.pose_refinement) write_png(folder / "visualize_pose_refinement.png", draw_all(true));
  }
  if (recognition.accepted < 0) return;
  const Candidate& accepted = recognition.candidates[recognition.accepted];
  const ColourImage result = draw(accepted, accepted.camera_from_model);
  if (steps.result) write_png(folder / "visualize_result.png", result);
  if (steps.result_with_candidates)
    write_png(folder / "visualize_result_with_candidates.png", draw_all(true, {result}));
}

}  // namespace

fs::path write_iteration(const fs::path& folder, const Recognition& recognition, const PointCloud& scene,
                         const Catalogue& catalogue, const GlobalPipelineConfig& config) {
  const fs::path iteration = folder / recognition.result.timestamp;
  fs::create_directories(iteration);
  write_json(iteration / "result.json", recognition.result);
  if (config.debug.save_extras_json) write_json(iteration / "extras.json", extras_of(recognition, catalogue));
  if (config.debug.save_used_dataset_json) write_json(iteration / "used_dataset.json", catalogue.dataset.out);
  if (config.debug.save_used_pipeline_config_json) write_json(iteration / "used_pipeline_config.json", config);
  if (config.debug.save_point_clouds) write_clouds(iteration, recognition, scene, catalogue);
  if (config.debug.visualize_flag) write_pictures(iteration, recognition, scene, catalogue, config.debug.visualize);
  return iteration;
}

}  // namespace partpose
