// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "recognition_output.hpp"

#include "output.hpp"

#include "partpose/pipeline/picture.hpp"
#include "partpose/preprocess/segmentation.hpp"

#include <optional>

namespace partpose::apps {

void print_pose(const Eigen::Isometry3d& pose) {
  for (int row = 0; row < 4; ++row) {
    const auto values = pose.matrix().row(row);
    fmt::print("  {:9.5f} {:9.5f} {:9.5f} {:10.3f}\n", values[0], values[1], values[2], values[3]);
  }
}

Json line_of(const std::filesystem::path& scene, const Recognition& recognition) {
  const Result& result = recognition.result;
  const bool found = recognition.accepted >= 0;
  Json line;
  line["scene"] = scene.string();
  line["model_name"] = found ? Json(result.model_name) : Json(nullptr);
  line["T_final"] = found ? to_json(result.T_final) : Json(nullptr);
  line["match_distance"] = found ? to_json(result.match_distance) : Json(nullptr);
  line["icp_fitness"] = found ? to_json(result.icp_fitness) : Json(nullptr);
  if (found && recognition.candidates[recognition.accepted].score >= 0)
    line["score"] = to_json(recognition.candidates[recognition.accepted].score);
  if (!found) line["reason"] = recognition.reason;
  line["time_ms"] = times_of(recognition.stages);
  return line;
}

void print_for_people(const std::filesystem::path& scene, const Recognition& recognition) {
  if (recognition.accepted < 0) {
    fmt::print("{}: nothing recognized: {} ({:.0f} ms)\n", scene.string(), recognition.reason, recognition.total_ms());
    return;
  }
  fmt::print("{}: {} ({:.0f} ms)\n", scene.string(), recognition.result.model_name, recognition.total_ms());
  print_pose(recognition.result.T_final);
}

ColourImage picture_of(const Scene& scene, const Recognition& recognition, const Catalogue& catalogue) {
  std::optional<PlacedMesh> part;
  if (recognition.accepted >= 0) {
    const auto& candidate = recognition.candidates[recognition.accepted];
    part.emplace(PlacedMesh{catalogue.parts[catalogue.views[candidate.view_row].part].mesh, candidate.camera_from_model});
  }
  if (scene.depth) return draw_overlay(*scene.depth, *scene.intrinsics, part);
  const PointCloud seen = before_camera(scene.cloud);
  const auto camera = intrinsics_of(seen, 10);
  if (!camera) return draw_overlay(DepthImage(64, 48), Intrinsics::from_field_of_view(64, 48, 50, 40), part);
  return draw_overlay(to_depth_image(seen, *camera), *camera, part);
}

}  // namespace partpose::apps
