// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "recognition_output.hpp"

#include "output.hpp"
#include "terminal.hpp"

#include "partpose/pipeline/picture.hpp"
#include "partpose/preprocess/segmentation.hpp"

#include <algorithm>
#include <cmath>

namespace partpose::apps {

std::string text_of(const Eigen::Isometry3d& pose) {
  std::string text;
  for (int row = 0; row < 4; ++row) {
    const auto values = pose.matrix().row(row);
    text += fmt::format("  {:9.5f} {:9.5f} {:9.5f} {:10.3f}\n", values[0], values[1], values[2], values[3]);
  }
  return text;
}

namespace {

double rounded(double value) { return std::round(value * 1e6) / 1e6; }

Json json_of(const Alternative& alternative, const Catalogue& catalogue) {
  return {{"model_name", catalogue.parts[alternative.part].name},
          {"T", to_json(alternative.camera_from_model)},
          {"probability", rounded(alternative.probability)}};
}

/// Only some recognizers say how sure they are.
bool states_certainty(const Detection& detection) { return detection.confidence > 0; }

void add_certainty(Json& line, const Detection& detection, const Catalogue& catalogue) {
  line["confidence"] = rounded(detection.confidence);
  line["covariance"] = Json::array();
  for (int row = 0; row < 6; ++row)
    line["covariance"].push_back(
        std::vector<double>(detection.covariance.row(row).begin(), detection.covariance.row(row).end()));
  line["alternatives"] = Json::array();
  for (const auto& alternative : detection.alternatives)
    line["alternatives"].push_back(json_of(alternative, catalogue));
  if (detection.explanation) line["explanation"] = to_json(*detection.explanation);
}

/// All objects of the frame, the result first.
Json detections_of(const Recognition& recognition, const Catalogue& catalogue) {
  Json detections = Json::array();
  for (const auto& detection : recognition.detections) {
    Json one;
    one["model_name"] = catalogue.parts[detection.part].name;
    one["T"] = to_json(detection.camera_from_model);
    one["score"] = to_json(detection.score);
    if (states_certainty(detection)) add_certainty(one, detection, catalogue);
    detections.push_back(std::move(one));
  }
  if (!detections.empty() || recognition.accepted < 0) return detections;
  Json one;
  one["model_name"] = recognition.result.model_name;
  one["T"] = to_json(recognition.result.T_final);
  if (const float score = recognition.candidates[recognition.accepted].score; score >= 0) one["score"] = to_json(score);
  detections.push_back(std::move(one));
  return detections;
}

std::string alternatives_text(const Detection& detection, const Catalogue& catalogue) {
  std::string text;
  for (const auto& alternative : detection.alternatives)
    text += fmt::format("  or, with probability {:.2f}: {}\n{}", alternative.probability,
                        catalogue.parts[alternative.part].name, text_of(alternative.camera_from_model));
  return text;
}

}  // namespace

std::string certainty_text(float score, const Detection* detection) {
  std::string text;
  // Nothing is certain.
  const auto shown = [](double probability) { return std::min(probability, 0.99); };
  if (score >= 0) text += fmt::format(", score {:.2f}", shown(score));
  if (detection && states_certainty(*detection))
    text += fmt::format(", confidence {:.2f}", shown(detection->confidence));
  return text;
}

Json line_of(const std::filesystem::path& scene, const Recognition& recognition, const Catalogue& catalogue) {
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
  line["detections"] = detections_of(recognition, catalogue);
  if (!found) line["reason"] = recognition.reason;
  line["time_ms"] = times_of(recognition.stages);
  return line;
}

std::string text_for_people(const std::filesystem::path& scene, const Recognition& recognition,
                            const Catalogue& catalogue) {
  if (recognition.accepted < 0)
    return fmt::format("{}: nothing recognized: {} ({:.0f} ms)\n", scene.string(), recognition.reason,
                       recognition.total_ms());
  const auto& all = recognition.detections;
  const Detection* first = all.empty() ? nullptr : &all[0];
  std::string text = fmt::format("{}: {}{} ({:.0f} ms)\n{}", scene.string(), recognition.result.model_name,
                                 certainty_text(recognition.candidates[recognition.accepted].score, first),
                                 recognition.total_ms(), text_of(recognition.result.T_final));
  if (first) text += alternatives_text(*first, catalogue);
  for (std::size_t i = 1; i < all.size(); ++i)
    text += fmt::format("{}: also {}{}\n{}{}", scene.string(), catalogue.parts[all[i].part].name,
                        certainty_text(all[i].score, &all[i]), text_of(all[i].camera_from_model),
                        alternatives_text(all[i], catalogue));
  return text;
}

void print_for_people(const std::filesystem::path& scene, const Recognition& recognition, const Catalogue& catalogue) {
  fmt::print("{}", text_for_people(scene, recognition, catalogue));
}

void note_stages(const Common& common, const Recognition& recognition) {
  for (const auto& stage : recognition.stages)
    note(common, fmt::format("{:9.1f} ms  {}{}", stage.measure_ms, stage.tag,
                             stage.points_in && stage.points_out
                                 ? fmt::format(": {} points -> {}", *stage.points_in, *stage.points_out)
                                 : ""));
}

ColourImage picture_of(const Scene& scene, const Recognition& recognition, const Catalogue& catalogue) {
  std::vector<PlacedMesh> parts;
  for (const auto& detection : recognition.detections)
    parts.push_back({catalogue.parts[detection.part].mesh, detection.camera_from_model});
  if (parts.empty() && recognition.accepted >= 0) {
    const auto& candidate = recognition.candidates[recognition.accepted];
    parts.push_back({catalogue.parts[catalogue.views[candidate.view_row].part].mesh, candidate.camera_from_model});
  }
  if (scene.depth) return draw_overlay(*scene.depth, *scene.intrinsics, parts);
  const PointCloud seen = before_camera(scene.cloud);
  const auto camera = intrinsics_of(seen, 10);
  if (!camera) return draw_overlay(DepthImage(64, 48), Intrinsics::from_field_of_view(64, 48, 50, 40), parts);
  return draw_overlay(to_depth_image(seen, *camera), *camera, parts);
}

}  // namespace partpose::apps
