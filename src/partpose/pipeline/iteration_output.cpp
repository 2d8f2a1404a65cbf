// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/iteration_output.hpp"

#include "partpose/io/json.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/ply.hpp"

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
  return iteration;
}

}  // namespace partpose
