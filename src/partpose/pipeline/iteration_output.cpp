// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/iteration_output.hpp"

#include "partpose/core/hash.hpp"
#include "partpose/io/camera_json.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/io/png.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/pipeline/picture.hpp"
#include "partpose/preprocess/segmentation.hpp"

#include <algorithm>
#include <map>

namespace partpose {

namespace {

namespace fs = std::filesystem;

/// The candidate's view, as it is in the dataset, where the candidate lies; without a dataset the mesh's corners.
PointCloud placed_view(const Candidate& candidate, const Catalogue& catalogue) {
  const auto& view = catalogue.views[candidate.view_row];
  const auto& part = catalogue.parts[view.part];
  if (catalogue.dataset.folder.empty()) {
    PointCloud corners;
    corners.points = part.mesh.vertices;
    return transformed(corners, candidate.camera_from_model);
  }
  const PointCloud cloud = without_missing(read_pcd(catalogue.dataset.view_path(part.id, view.id)));
  return transformed(cloud, candidate.camera_from_model * (view.T2 * part.T1).inverse());
}

/// The scene from the sensor to the normals.
void write_scene(const fs::path& folder, const Recognition& recognition, const Scene& scene) {
  write_ply(folder / "scene_original.ply", scene.cloud);
  write_ply(folder / "scene_preprocessed.ply", recognition.preprocessed);
  write_ply(folder / "scene_cloud_w_normals.ply", recognition.with_normals);
  if (!scene.depth) return;
  const auto& z = scene.depth->z_mm;
  const float farthest_mm = z.empty() ? 0 : *std::max_element(z.begin(), z.end());
  const double unit_mm = farthest_mm < 6500 ? 0.1 : farthest_mm < 65000 ? 1.0 : farthest_mm / 65000.0;
  write_depth_png(folder / "scene_depth.png", *scene.depth, unit_mm);
  write_camera(folder / "scene_depth.camera.json", {*scene.intrinsics, unit_mm, {}});
}

void write_clouds(const fs::path& folder, const Recognition& recognition, const Catalogue& catalogue) {
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

/// Keeps meshes of parts in `folder`/meshes/, each written when it is first asked for and not there. The content is in
/// the name: another run's part of the same name does not replace it.
class SavedMeshes {
 public:
  SavedMeshes(const fs::path& folder, const Catalogue& catalogue) : folder_(folder), catalogue_(catalogue) {}

  /// The file of the part, relative to the folder.
  const std::string& of(const CataloguePart& part) {
    auto& name = name_of_[part.id];
    if (!name.empty()) return name;
    fs::create_directories(folder_ / "meshes");
    const auto named = [&](const std::string& hash) { return fmt::format("meshes/{}_{}.stl", part.name, hash); };
    if (catalogue_.dataset.folder.empty()) {
      name = named(content_hash(part.mesh));
      if (!fs::exists(folder_ / name)) write_stl(folder_ / name, part.mesh);
    } else {
      const std::string bytes = read_file(catalogue_.dataset.mesh_path(part.id));
      name = named(content_hash(bytes));
      if (!fs::exists(folder_ / name)) write_file_atomically(folder_ / name, bytes);
    }
    return name;
  }

 private:
  const fs::path& folder_;
  const Catalogue& catalogue_;
  std::map<int, std::string> name_of_;
};

/// All objects that were recognized, the result first; of a recognizer that knows no detections nothing.
Json json_of(const std::vector<Detection>& detections, const Catalogue& catalogue, SavedMeshes* meshes) {
  Json out = Json::array();
  for (const auto& detection : detections) {
    const CataloguePart& part = catalogue.parts[detection.part];
    out.push_back({{"model_name", part.name},
                   {"T", to_json(detection.camera_from_model)},
                   {"score", to_json(detection.score)},
                   {"confidence", detection.confidence},
                   {"mesh", meshes ? meshes->of(part) : ""}});
  }
  return out;
}

void write_pictures(const fs::path& folder, const Recognition& recognition, const PointCloud& scene,
                    const Catalogue& catalogue, const VisualizeOptions& steps) {
  const auto pixels =
      intrinsics_of(before_camera(recognition.preprocessed.empty() ? scene : recognition.preprocessed), 20);
  if (!pixels) return;  // nothing to be seen
  const Intrinsics& camera = *pixels;
  const DepthImage depth = to_depth_image(recognition.preprocessed, camera);
  const auto draw = [&](const Candidate& candidate, const Eigen::Isometry3d& camera_from_model) {
    const auto& part = catalogue.parts[catalogue.views[candidate.view_row].part];
    return draw_overlay(depth, camera, {{part.mesh, camera_from_model}});
  };
  const auto draw_all = [&](bool refined, std::vector<ColourImage> pictures = {}) {
    for (const auto& candidate : recognition.candidates)
      pictures.push_back(draw(
          candidate, refined ? candidate.camera_from_model : candidate.T4.inverse() * candidate.camera_from_model));
    return tile(pictures, 3);
  };
  if (steps.preprocess) write_png(folder / "visualize_preprocess.png", draw_overlay(depth, camera));
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

fs::path write_iteration(const fs::path& folder, const Recognition& recognition, const Scene& scene,
                         const Catalogue& catalogue, const GlobalPipelineConfig& config) {
  const DebugOptions& debug = config.debug;
  const bool seen = debug.save_point_clouds || debug.visualize_flag;
  const fs::path iteration = folder / recognition.result.timestamp;
  fs::create_directories(iteration);
  if (debug.save_extras_json || debug.visualize_flag) {
    Extras extras = extras_of(recognition, catalogue);
    extras.scene = scene.path.string();
    if (config.preprocessing.scale_flag) extras.scene_extras.input_unit_mm = config.preprocessing.scale_factor;
    SavedMeshes meshes(folder, catalogue);
    for (std::size_t i = 0; seen && i < recognition.candidates.size(); ++i)
      extras.candidate_extras[i].mesh =
          meshes.of(catalogue.parts[catalogue.views[recognition.candidates[i].view_row].part]);
    write_json(iteration / "extras.json", extras);
    if (!recognition.detections.empty())
      write_json_file(iteration / "detections.json",
                      json_of(recognition.detections, catalogue, seen ? &meshes : nullptr));
  }
  if (debug.save_used_dataset_json) write_json(iteration / "used_dataset.json", catalogue.dataset.out);
  if (debug.save_used_pipeline_config_json) write_json(iteration / "used_pipeline_config.json", config);
  if (seen) write_scene(iteration, recognition, scene);
  if (debug.save_point_clouds) write_clouds(iteration, recognition, catalogue);
  if (debug.visualize_flag) write_pictures(iteration, recognition, scene.cloud, catalogue, debug.visualize);
  write_json(iteration / "result.json", recognition.result);
  return iteration;
}

}  // namespace partpose
