// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/report/output_folder.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/json.hpp"

#include <algorithm>
#include <fstream>
#include <set>

namespace partpose {

namespace {

namespace fs = std::filesystem;

/// The value of a key, or nothing when it is absent or of another type: a report shows what is there.
template <typename T>
std::optional<T> find(const Json& object, const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto it = object.find(key);
  if (it == object.end()) return std::nullopt;
  try {
    return from_json<T>(*it);
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::string text(const Json& object, const char* key) {
  const auto it = object.is_object() ? object.find(key) : object.end();
  if (!object.is_object() || it == object.end()) return {};
  if (it->is_string()) return it->get<std::string>();
  return it->is_number() ? it->dump() : std::string();
}

const Json& member(const Json& object, const char* key) {
  static const Json none;
  if (!object.is_object() || !object.contains(key)) return none;
  return object[key];
}

/// The elements of an array; none when it is absent or no array.
const Json& elements(const Json& object, const char* key) {
  static const Json none = Json::array();
  const Json& value = member(object, key);
  return value.is_array() ? value : none;
}

/// -1 is "no value" in the reference's records.
std::optional<double> not_negative(const Json& object, const char* key) {
  const auto value = find<double>(object, key);
  return value && *value >= 0 ? value : std::nullopt;
}

fs::path if_there(const fs::path& path) { return fs::is_regular_file(path) ? path : fs::path(); }

/// `relative` under the iteration's folder or one of those above it, not above `top`.
fs::path find_upwards(fs::path folder, const fs::path& top, const std::string& relative) {
  if (relative.empty() || fs::path(relative).is_absolute()) return {};
  while (true) {
    if (const auto found = if_there(folder / relative); !found.empty()) return found;
    if (folder == top || !folder.has_relative_path()) break;
    folder = folder.parent_path();
  }
  return if_there(top.parent_path() / relative);
}

SavedCandidate candidate_of(const Json& json, const fs::path& folder, const fs::path& top) {
  SavedCandidate c;
  c.id = find<int>(json, "id").value_or(-1);
  c.model_name = text(json, "model_name");
  c.view_id = find<int>(json, "view_id").value_or(-1);
  c.camera_from_model = find<Eigen::Isometry3d>(json, "T_final").value_or(Eigen::Isometry3d::Identity());
  c.coarse =
      find<Eigen::Isometry3d>(json, "T_4").value_or(Eigen::Isometry3d::Identity()).inverse() * c.camera_from_model;
  c.centred_from_model = find<Eigen::Isometry3d>(json, "T_1");
  c.score = not_negative(json, "score");
  c.icp_fitness = not_negative(json, "icp_fitness");
  c.match_distance = not_negative(json, "match_distance");
  c.icp_converged = find<bool>(json, "icp_converged");
  c.points = find<int>(json, "num_of_points");
  c.points_refinement = find<int>(json, "num_of_points_refinement");
  c.visible_model_points = find<int>(json, "visible_model_points");
  c.unexplained_model_points = find<int>(json, "unexplained_model_points");
  c.scene_points = find<int>(json, "scene_points");
  c.explained_scene_points = find<int>(json, "explained_scene_points");
  c.verdict = text(json, "verdict");
  c.mesh = find_upwards(folder, top, text(json, "mesh"));
  c.cloud = if_there(folder / fmt::format("candidate_{}.ply", c.id));
  return c;
}

SavedDetection detection_of(const Json& json, const fs::path& folder, const fs::path& top) {
  return {text(json, "model_name"), find<Eigen::Isometry3d>(json, "T").value_or(Eigen::Isometry3d::Identity()),
          not_negative(json, "score"), not_negative(json, "confidence"), find_upwards(folder, top, text(json, "mesh"))};
}

std::vector<SavedStep> steps_of(const Json& steps) {
  std::vector<SavedStep> out;
  for (const auto& step : steps)
    out.push_back({text(step, "tag"), find<double>(step, "measure_ms").value_or(0), find<int>(step, "points_in"),
                   find<int>(step, "points_out")});
  return out;
}

void take_result(const Json& result, SavedFrame& frame) {
  if (!result.is_object()) return;
  frame.model_name = text(result, "model_name");
  frame.candidate_id = find<int>(result, "candidate_id");
  if (frame.candidate_id && *frame.candidate_id < 0) frame.model_name.clear();
  if (!frame.model_name.empty()) frame.camera_from_model = find<Eigen::Isometry3d>(result, "T_final");
}

void take_evaluation(const Json& evaluation, SavedFrame& frame) {
  if (!evaluation.is_object()) return;
  if (!frame.truth && evaluation.contains("ground_truth_model_name"))
    frame.truth = SavedTruth{text(evaluation, "ground_truth_model_name"), false, {}};
  if (frame.truth && !frame.truth->model_name.empty() && !frame.truth->camera_from_model)
    frame.truth->camera_from_model = find<Eigen::Isometry3d>(evaluation, "ground_truth_transformation_matrix");
  for (const auto& [key, value] : evaluation.items()) {
    if (key == "ground_truth_model_id" || key == "ground_truth_view_id") continue;
    if (value.is_boolean()) frame.flags[key] = value.get<bool>();
    if (value.is_number() && value.get<double>() >= 0) frame.figures[key] = value.get<double>();
  }
}

void take_times(const Json& times, SavedFrame& frame) {
  if (times.is_number()) frame.time_ms = times.get<double>();
  if (!times.is_object()) return;
  const bool known = !frame.steps.empty();
  for (const auto& [tag, ms] : times.items()) {
    if (!ms.is_number()) continue;
    if (tag == "total")
      frame.time_ms = ms.get<double>();
    else if (!known)
      frame.steps.push_back({tag, ms.get<double>(), {}, {}});
  }
}

/// An experiment's line says it; otherwise the candidates do.
void take_best_score(SavedFrame& frame) {
  if (frame.best_score) return;
  for (const auto& candidate : frame.candidates) {
    if (!candidate.score || (frame.best_score && *candidate.score <= *frame.best_score)) continue;
    frame.best_score = candidate.score;
    frame.best_is_right = frame.truth && candidate.model_name == frame.truth->model_name;
  }
}

void judge(SavedFrame& frame) {
  const bool found = !frame.model_name.empty();
  if (!frame.truth)
    frame.verdict = found ? Verdict::found : Verdict::nothing;
  else if (frame.truth->left_out)
    frame.verdict = found ? Verdict::wrong : Verdict::correct;
  else if (frame.model_name == frame.truth->model_name)
    frame.verdict = Verdict::correct;
  else
    frame.verdict = found ? Verdict::wrong : Verdict::none;
}

class Reader {
 public:
  Reader(const fs::path& folder, const Progress& progress) : top_(fs::weakly_canonical(folder)), progress_(progress) {
    out_.folder = folder;
  }

  OutputFolder read() {
    std::vector<fs::path> iterations, experiments;
    std::error_code error;
    for (fs::recursive_directory_iterator it(top_, fs::directory_options::skip_permission_denied, error), end;
         !error && it != end; it.increment(error)) {
      if (it->path().filename() == "result.json") iterations.push_back(it->path().parent_path());
      if (it->path().filename() == "frames.jsonl") experiments.push_back(it->path());
    }
    if (error) throw Error("{}: cannot be read: {}", out_.folder.string(), error.message());
    std::sort(iterations.begin(), iterations.end());
    std::sort(experiments.begin(), experiments.end());
    total_ = iterations.size();
    out_.experiment = !experiments.empty();
    for (const auto& path : experiments) read_lines(path);
    for (const auto& folder : iterations)
      if (!taken_.contains(folder)) add_iteration(folder);
    if (out_.frames.empty())
      throw Error(
          "{}: holds no iteration folder (with result.json) and no frames.jsonl; give a folder that partpose "
          "wrote with --output",
          out_.folder.string());
    return std::move(out_);
  }

 private:
  void problem(const std::string& words) { out_.problems.push_back(words); }

  Json read_if_there(const fs::path& path) {
    if (!fs::is_regular_file(path)) return {};
    try {
      return read_json_file(path);
    } catch (const Error& error) {
      problem(error.what());
      return {};
    }
  }

  /// All that an iteration folder has, into `frame`; what `frame` knows already stays.
  void take_folder(const fs::path& folder, SavedFrame& frame) {
    frame.folder = folder;
    const Json extras = read_if_there(folder / "extras.json");
    frame.has_extras = extras.is_object();
    if (frame.scene.empty()) frame.scene = text(extras, "scene");
    frame.reason = text(extras, "reason");
    for (const auto& candidate : elements(extras, "candidate_extras"))
      frame.candidates.push_back(candidate_of(candidate, folder, top_));
    const Json detections = read_if_there(folder / "detections.json");
    if (detections.is_array())
      for (const auto& detection : detections) frame.detections.push_back(detection_of(detection, folder, top_));
    frame.steps = steps_of(elements(extras, "time_profiling"));
    frame.input_unit_mm = find<double>(member(extras, "scene_extras"), "input_unit_mm").value_or(1);
    take_result(read_if_there(folder / "result.json"), frame);
    take_evaluation(read_if_there(folder / "evaluation.json"), frame);
    frame.input = if_there(folder / "scene_original.ply");
    frame.preprocessed = if_there(folder / "scene_preprocessed.ply");
    frame.with_normals = if_there(folder / "scene_cloud_w_normals.ply");
    frame.depth = if_there(folder / "scene_depth.png");
    frame.depth_camera = if_there(folder / "scene_depth.camera.json");
    frame.result_cloud = if_there(folder / "result_full.ply");
    frame.config = if_there(folder / "used_pipeline_config.json");
    if (progress_ && done_ < total_) progress_("reading frames", ++done_, total_);
  }

  void finish(SavedFrame frame) {
    if (!frame.time_ms && !frame.steps.empty()) {
      frame.time_ms = 0;
      for (const auto& step : frame.steps) *frame.time_ms += step.ms;
    }
    take_best_score(frame);
    judge(frame);
    out_.frames.push_back(std::move(frame));
  }

  void add_iteration(const fs::path& folder) {
    SavedFrame frame;
    if (const auto above = fs::relative(folder.parent_path(), top_); folder != top_ && above != ".")
      frame.run = above.string();
    take_folder(folder, frame);
    const std::string folder_name = folder.filename().string();
    frame.name = frame.scene.empty() ? folder_name : fs::path(frame.scene).filename().string();
    // A dataset's view is called by its number alone.
    if (const int view = find<int>(read_if_there(folder / "evaluation.json"), "ground_truth_view_id").value_or(-1);
        view >= 0 && frame.truth)
      frame.name = fmt::format("{} view {}", frame.truth->model_name, view);
    finish(std::move(frame));
  }

  void read_lines(const fs::path& path) {
    std::ifstream file(path);
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      const Json json = Json::parse(line, nullptr, false);
      if (!json.is_object()) {
        problem(fmt::format("{}: line {}: not a JSON object (cut off?)", path.string(), number));
        continue;
      }
      SavedFrame frame;
      frame.run = text(json, "run");
      frame.protocol = text(json, "protocol");
      frame.descriptor = text(json, "descriptor");
      frame.name = text(json, "frame");
      frame.scene = text(json, "scene");
      const Json& truth = member(json, "truth");
      if (truth.is_object())
        frame.truth = SavedTruth{text(truth, "model_name"), false, find<Eigen::Isometry3d>(truth, "T")};
      const std::string folder = text(json, "folder");
      if (!folder.empty()) {
        const fs::path iteration = fs::weakly_canonical(path.parent_path() / folder);
        if (fs::is_regular_file(iteration / "result.json")) {
          taken_.insert(iteration);
          take_folder(iteration, frame);
        } else {
          problem(fmt::format("{}: line {}: folder {} holds no result.json", path.string(), number, folder));
        }
      }
      take_result(member(json, "result"), frame);
      take_evaluation(member(json, "evaluation"), frame);
      if (frame.truth) frame.truth->left_out = find<bool>(json, "left_out").value_or(false);
      frame.best_score = not_negative(json, "score");
      frame.best_is_right = find<bool>(json, "best_is_right");
      if (frame.steps.empty()) frame.steps = steps_of(elements(json, "stages"));
      take_times(member(json, "time_ms"), frame);
      if (frame.reason.empty()) frame.reason = text(json, "reason");
      if (frame.name.empty()) frame.name = fmt::format("line {}", number);
      finish(std::move(frame));
    }
  }

  fs::path top_;
  const Progress& progress_;
  std::size_t done_ = 0, total_ = 0;
  OutputFolder out_;
  std::set<fs::path> taken_;
};

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::correct:
      return "correct";
    case Verdict::wrong:
      return "wrong";
    case Verdict::none:
      return "none";
    case Verdict::found:
      return "found";
    case Verdict::nothing:
      return "nothing";
  }
  return "";
}

OutputFolder read_output_folder(const fs::path& folder, const Progress& progress) {
  if (!fs::is_directory(folder)) throw Error("{}: no such folder", folder.string());
  return Reader(folder, progress).read();
}

}  // namespace partpose
