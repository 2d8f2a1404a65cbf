// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "config_keys.hpp"
#include "interruption.hpp"
#include "output.hpp"
#include "recognizer_choice.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/evaluation/accuracy.hpp"
#include "partpose/io/json.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/pipeline/iteration_output.hpp"
#include "partpose/report/report.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct EvaluateArguments {
  fs::path dataset;
  fs::path test;
  fs::path config;
  fs::path jsonl;
  fs::path output;
  std::vector<std::string> overrides;
  bool json = false;
  double limit_deg = 15;
  double limit_mm = 15;
};

void print_row(std::FILE* out, const std::string& name, const ProtocolSummary& s) {
  fmt::print(out, "{:<24} {:>6} {:>9.1f} {:>9.1f} {:>9.1f} {:>12.1f} {:>9.1f} {:>9.1f}\n", name, s.frames,
             s.correct_percent(), s.wrong_percent(), s.none_percent(), s.pose_right_percent(), s.median_ms, s.p95_ms);
}

Json json_of(const ProtocolSummary& s) {
  return {{"frames", s.frames},         {"correct", s.correct},     {"wrong", s.wrong},  {"none", s.none},
          {"pose_right", s.pose_right}, {"median_ms", s.median_ms}, {"p95_ms", s.p95_ms}};
}

Json frame_line(const ProtocolFrame& frame, const Recognition& recognition, const Catalogue& catalogue) {
  Json line = to_json(frame.evaluation);
  line["result"] = to_json(frame.result);
  line["reason"] = recognition.reason;
  line["candidates"] = Json::array();
  for (const auto& candidate : extras_of(recognition, catalogue).candidate_extras) {
    Json entry;
    entry["model_name"] = candidate.model_name;
    entry["view_id"] = candidate.view_id;
    entry["match_distance"] = candidate.match_distance;
    entry["icp_fitness"] = candidate.icp_fitness;
    entry["icp_converged"] = candidate.icp_converged;
    entry["rotation_error_deg"] = rotation_error_deg(candidate.T_final, frame.truth.camera_from_model);
    entry["translation_error_mm"] = translation_error_mm(candidate.T_final, frame.truth.camera_from_model);
    entry["verdict"] = candidate.verdict;
    line["candidates"].push_back(entry);
  }
  line["time_ms"] = times_of(recognition.stages);
  return line;
}

void evaluate_dataset(const EvaluateArguments& arguments, const Common& common) {
  check_file_can_be_written(arguments.jsonl);
  check_folder_can_be_written(arguments.output);
  const auto config = pipeline_config(arguments.config, arguments.overrides);
  const auto progress = terminal_progress(common);
  const Unfinished frame;  // each is finished before a signal counts
  const GlobalPipeline pipeline(load_catalogue(open_dataset(arguments.dataset), config, progress), config);
  const Dataset test = open_dataset(arguments.test);
  std::optional<std::ofstream> jsonl;
  if (!arguments.jsonl.empty()) jsonl.emplace(open_for_writing(arguments.jsonl));
  const auto on_frame = [&](const ProtocolFrame& frame, const Recognition& recognition, const PointCloud& scene) {
    if (jsonl) *jsonl << json_line(frame_line(frame, recognition, pipeline.catalogue())) << std::endl;
    if (arguments.output.empty()) return;
    const Scene view{test.view_path(frame.truth.model_id, frame.truth.view_id), scene, {}, {}};
    const fs::path iteration = write_iteration(arguments.output, recognition, view, pipeline.catalogue(), config);
    write_json(iteration / "evaluation.json", frame.evaluation);
    write_json(iteration / "evaluation_dataset.json", test.out);
  };
  const auto frames = run_protocol(pipeline, test, progress, on_frame);
  if (config.debug.visualize_flag && !arguments.output.empty() && !frames.empty())
    write_report(arguments.output, arguments.output / "report.html",
                 {.stages = stages_of(config.debug.visualize),
                  .limit_deg = arguments.limit_deg,
                  .limit_mm = arguments.limit_mm});

  std::map<std::string, ProtocolSummary> of_part;
  for (const auto& model : test.out.models) {
    std::vector<ProtocolFrame> of_model;
    for (const auto& frame : frames)
      if (frame.truth.model_id == model.id) of_model.push_back(frame);
    of_part[model.name] = summarize(of_model, arguments.limit_deg, arguments.limit_mm);
  }
  const ProtocolSummary all = summarize(frames, arguments.limit_deg, arguments.limit_mm);
  if (arguments.json) {
    Json parts = Json::object();
    for (const auto& [name, summary] : of_part) parts[name] = json_of(summary);
    print_json({{"all", json_of(all)},
                {"parts", parts},
                {"limit_deg", arguments.limit_deg},
                {"limit_mm", arguments.limit_mm}});
    return;
  }
  std::FILE* out = is_standard_output(arguments.jsonl) ? stderr : stdout;
  fmt::print(out, "{:<24} {:>6} {:>9} {:>9} {:>9} {:>12} {:>9} {:>9}\n", "part shown", "frames", "correct %", "wrong %",
             "none %", "pose right %", "median ms", "p95 ms");
  for (const auto& model : test.out.models) print_row(out, model.name, of_part[model.name]);
  print_row(out, "all", all);
  fmt::print(out, "pose right: within {} deg and {} mm of the truth, of all frames, symmetry ignored\n",
             arguments.limit_deg, arguments.limit_mm);
}

}  // namespace

void add_evaluate_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<EvaluateArguments>();
  auto* evaluate =
      app.add_subcommand("evaluate", "Recognize every view of a test dataset and count how often it is right");
  evaluate->add_option("-d,--dataset", arguments->dataset, "Dataset folder of the catalogue")->required();
  evaluate->add_option("-t,--test", arguments->test, "Dataset folder whose views are the scenes")->required();
  evaluate->add_option("-c,--config", arguments->config, "Pipeline JSON");
  add_set_option(*evaluate, arguments->overrides);
  evaluate->add_flag("--json", arguments->json, "Print the table as JSON");
  evaluate->add_option("--jsonl", arguments->jsonl, "Write one JSON line for each frame here (-: standard output)");
  evaluate->add_option("-o,--output", arguments->output,
                       "Write an iteration output folder for each frame here, with evaluation.json in it");
  evaluate->add_option("--limit-deg", arguments->limit_deg, "A pose is right below this rotation error")
      ->capture_default_str();
  evaluate->add_option("--limit-mm", arguments->limit_mm, "A pose is right below this translation error")
      ->capture_default_str();
  evaluate->footer(
      "Example (ground-truth protocol):\n"
      "  partpose evaluate --dataset dataset/ --test dataset/ --config configs/pipeline_virtual.json");
  evaluate->callback([arguments, &common] { evaluate_dataset(*arguments, common); });
}

}  // namespace partpose::apps
