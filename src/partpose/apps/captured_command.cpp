// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"
#include "output.hpp"
#include "recognition_output.hpp"
#include "recognizer_choice.hpp"
#include "scene_reader.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/text.hpp"
#include "partpose/evaluation/accuracy.hpp"
#include "partpose/evaluation/captured_set.hpp"
#include "partpose/io/png.hpp"
#include "partpose/pipeline/iteration_output.hpp"
#include "partpose/pipeline/recognizer.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct CapturedArguments {
  fs::path set, models, cache, jsonl, output, pictures;
  std::vector<std::string> kinds;
  std::optional<float> min_score;
  std::string recognizer = default_recognizer;
  bool json = false;
  double limit_deg = 15;
  double limit_mm = 15;
};

struct Count {
  int frames = 0, right = 0, wrong = 0, none = 0, pose_right = 0;
  std::vector<double> ms;

  double median_ms() const {
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// What one frame gave, in a few words, and into the count.
std::string judge(const Recognition& recognition, const CapturedScene& truth, const CapturedSet& set,
                  const Catalogue& catalogue, const CapturedArguments& arguments, Count& count, Json& line) {
  ++count.frames;
  count.ms.push_back(recognition.total_ms());
  line["ground_truth_model_name"] = truth.model_name.empty() ? Json(nullptr) : Json(truth.model_name);
  const bool found = recognition.accepted >= 0;
  if (truth.model_name.empty()) {
    ++(found ? count.wrong : count.right);
    if (!found) ++count.pose_right;
    return found ? "WRONG: " + recognition.result.model_name + ", but it is none of them" : "right: none of them";
  }
  if (!found) {
    ++count.none;
    return fmt::format("NOT FOUND: it is {}; {}", truth.model_name, recognition.reason);
  }
  if (recognition.result.model_name != truth.model_name) {
    ++count.wrong;
    return fmt::format("WRONG: {}, but it is {}", recognition.result.model_name, truth.model_name);
  }
  ++count.right;
  const auto& mesh = catalogue.parts[catalogue.views[recognition.candidates[recognition.accepted].view_row].part].mesh;
  const auto symmetry = set.symmetries.find(truth.model_name);
  const auto error = symmetric_pose_error(
      recognition.result.T_final, truth.camera_from_model,
      symmetry == set.symmetries.end() ? std::vector{Eigen::Isometry3d::Identity()} : symmetry->second,
      bounding_box(mesh));
  line["rotation_error_deg"] = error.rotation_deg;
  line["translation_error_mm"] = error.translation_mm;
  const bool pose_right = error.rotation_deg < arguments.limit_deg && error.translation_mm < arguments.limit_mm;
  count.pose_right += pose_right;
  return fmt::format("{}: {}, off by {:.1f} deg, {:.1f} mm", pose_right ? "right" : "POSE WRONG", truth.model_name,
                     error.rotation_deg, error.translation_mm);
}

/// The iteration folder with evaluation.json: the plain errors to the first of the equivalent poses, and beside them
/// those to the nearest one, as `line` has them.
void write_frame(const fs::path& folder, const Recognition& recognition, const Scene& scene, const CapturedScene& truth,
                 const Json& line, const Catalogue& catalogue) {
  const fs::path iteration = write_iteration(folder, recognition, scene, catalogue, Recognizer::catalogue_config());
  GroundTruth shown{truth.model_name, {}, -1, -1};
  shown.camera_from_model =
      truth.camera_from_model.empty() ? Eigen::Isometry3d::Identity() : truth.camera_from_model[0];
  Json evaluation = to_json(evaluate(recognition.result, shown));
  if (line.contains("rotation_error_deg")) {
    evaluation["rotation_error_symmetric_deg"] = line["rotation_error_deg"];
    evaluation["translation_error_symmetric_mm"] = line["translation_error_mm"];
  }
  write_json_file(iteration / "evaluation.json", evaluation);
}

/// A truth that names none of the parts is more likely a slip than a test.
void check_models_are_known(const CapturedSet& set, const Catalogue& catalogue) {
  std::vector<std::string> names;
  for (const auto& part : catalogue.parts) names.push_back(part.name);
  for (const auto& scene : set.scenes)
    if (!scene.model_name.empty() && std::find(names.begin(), names.end(), scene.model_name) == names.end())
      throw Error("{}: model \"{}\" of {} is none of the parts; did you mean \"{}\", or null?",
                  (set.folder / "gt.json").string(), scene.model_name, scene.path.filename().string(),
                  nearest_word(scene.model_name, names));
}

/// A kind that no scene has is more likely a slip.
void check_kinds_are_known(const CapturedSet& set, const std::vector<std::string>& wanted) {
  std::set<std::string> kinds;
  for (const auto& scene : set.scenes) kinds.insert(scene.kind);
  for (const auto& kind : wanted)
    if (!kinds.count(kind))
      throw Error("--kind {}: {} has no scene of it; its kinds are {}", kind, (set.folder / "gt.json").string(),
                  fmt::join(kinds, ", "));
}

/// {"frames": [...], "kinds": {KIND: {"frames": n, "right": n, ...}}}
Json json_of(Json lines, const std::map<std::string, Count>& count_of_kind) {
  Json all = {{"frames", std::move(lines)}, {"kinds", Json::object()}};
  for (const auto& [kind, count] : count_of_kind)
    all["kinds"][kind] = {{"frames", count.frames}, {"right", count.right},           {"wrong", count.wrong},
                          {"none", count.none},     {"pose_right", count.pose_right}, {"median_ms", count.median_ms()}};
  return all;
}

void evaluate_captured(const CapturedArguments& arguments, const Common& common) {
  check_file_can_be_written(arguments.jsonl);
  check_folder_can_be_written(arguments.output);
  check_folder_can_be_written(arguments.pictures);
  const CapturedSet set = read_captured_set(arguments.set);
  const auto parts = read_parts({arguments.models.empty() ? arguments.set / "models" : arguments.models}, {}, common);
  const auto chosen = make_recognizer(
      arguments.recognizer, catalogue_for(arguments.recognizer, parts, arguments.cache, common), arguments.min_score);
  const PartRecognizer& recognizer = *chosen;
  const Unfinished frame;  // each is finished before a signal counts
  std::optional<std::ofstream> jsonl;
  if (!arguments.jsonl.empty()) jsonl.emplace(open_for_writing(arguments.jsonl));
  if (!arguments.pictures.empty()) fs::create_directories(arguments.pictures);

  PictureNames picture_names(arguments.pictures);
  check_kinds_are_known(set, arguments.kinds);
  check_models_are_known(set, recognizer.catalogue());
  std::map<std::string, Count> count_of_kind;
  Json lines = Json::array();
  std::FILE* out = is_standard_output(arguments.jsonl) ? stderr : stdout;
  SceneReader reader;
  for (const auto& truth : set.scenes) {
    if (!arguments.kinds.empty() &&
        std::find(arguments.kinds.begin(), arguments.kinds.end(), truth.kind) == arguments.kinds.end())
      continue;
    check_not_interrupted();
    const Scene scene = reader.read(truth.path);
    const Recognition recognition = named_after(truth.path, [&] { return recognizer.recognize(scene); });
    Json line = line_of(truth.path, recognition, recognizer.catalogue());
    const std::string verdict =
        judge(recognition, truth, set, recognizer.catalogue(), arguments, count_of_kind[truth.kind], line);
    if (!arguments.json) {
      fmt::print(out, "{:<32} {:5.0f} ms  {}\n", truth.path.filename().string(), recognition.total_ms(),
                 coloured(out, verdict.starts_with("right") ? Colour::green : Colour::red, verdict));
      if (!common.quiet && recognition.accepted >= 0) fmt::print(out, "{}", text_of(recognition.result.T_final));
    }
    if (jsonl) *jsonl << json_line(line) << std::endl;
    if (!arguments.output.empty())
      write_frame(arguments.output, recognition, scene, truth, line, recognizer.catalogue());
    if (!arguments.pictures.empty())
      write_png(picture_names.next(truth.path), picture_of(scene, recognition, recognizer.catalogue()));
    if (arguments.json) lines.push_back(std::move(line));
  }
  if (arguments.json) {
    print_json(json_of(std::move(lines), count_of_kind));
    return;
  }
  fmt::print(out, "{:<14} {:>6} {:>8} {:>8} {:>8} {:>12} {:>10}\n", "kind", "frames", "right", "wrong", "none",
             "pose right", "median ms");
  for (auto& [kind, count] : count_of_kind) {
    fmt::print(out, "{:<14} {:>6} {:>8} {:>8} {:>8} {:>12} {:>10.0f}\n", kind, count.frames, count.right, count.wrong,
               count.none, count.pose_right, count.median_ms());
  }
  fmt::print(out, "pose right: within {} deg and {} mm of the truth or of a pose that is equivalent by symmetry\n",
             arguments.limit_deg, arguments.limit_mm);
}

}  // namespace

void add_captured_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<CapturedArguments>();
  auto* captured =
      app.add_subcommand("captured", "Recognize a folder of captured scenes with ground truth and compare");
  captured->add_option("set", arguments->set, "Folder with gt.json, symmetries.json and models/")->required();
  captured->add_option("-m,--models", arguments->models, "Folder of model files, when it is not models/ in the set");
  captured
      ->add_option("--kind", arguments->kinds,
                   "Only scenes of this kind (object_only, with_table, full_frame, instance)")
      ->allow_extra_args(false);
  captured->add_flag("--json", arguments->json, "Print it all as JSON");
  captured->add_option("--jsonl", arguments->jsonl, "Write one JSON line for each scene here (-: standard output)");
  captured->add_option(
      "-o,--output", arguments->output,
      "Write an iteration output folder for each scene here, with evaluation.json in it (partpose report)");
  captured->add_option("--pictures", arguments->pictures,
                       "Write a picture of each scene with all that was recognized drawn over it here");
  add_recognizer_option(*captured, arguments->recognizer);
  add_min_score_option(*captured, arguments->min_score);
  captured->add_option("--cache", arguments->cache,
                       "Where catalogues for --recognizer recognizer are kept (default: ~/.cache/partpose)");
  captured->add_option("--limit-deg", arguments->limit_deg, "A pose is right below this rotation error")
      ->capture_default_str();
  captured->add_option("--limit-mm", arguments->limit_mm, "A pose is right below this translation error")
      ->capture_default_str();
  captured->footer("Example:\n  partpose captured scenes/ --models parts/ --pictures pictures/");
  captured->callback([arguments, &common] { evaluate_captured(*arguments, common); });
}

}  // namespace partpose::apps
