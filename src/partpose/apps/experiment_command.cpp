// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "config_keys.hpp"
#include "interruption.hpp"
#include "output.hpp"
#include "terminal.hpp"

#include "partpose/evaluation/experiment_tables.hpp"
#include "partpose/evaluation/plot.hpp"
#include "partpose/io/json.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>

namespace partpose::apps {

namespace {

struct ExperimentArguments {
  std::filesystem::path spec, output;
  std::vector<std::string> overrides;
  int most_frames = 0;
  bool json = false;
};

void run(const ExperimentArguments& arguments, const Common& common) {
  const Unfinished frame;  // each is finished before a signal counts
  const auto adjust = [&](ExperimentSpec& spec) {
    apply_overrides(spec, arguments.overrides);
    if (arguments.most_frames > 0) spec.most_frames = arguments.most_frames;
  };
  const auto records = run_experiment(arguments.spec, arguments.output, terminal_progress(common), adjust);
  const auto spec = read_json<ExperimentSpec>(arguments.output / "experiment.json");
  for (const auto& group : spec.groups)
    for (const auto& protocol : spec.protocols)
      if (protocol.left_out && protocol.captured.empty() &&
          std::none_of(records.begin(), records.end(), [&](const FrameRecord& record) {
            return record.group == group.name && record.protocol == protocol.name;
          }))
        complain(
            fmt::format("{} / {}: no frames, since without the part shown no part would be left to find; give "
                        "the group another part",
                        group.name, protocol.name));
  if (arguments.json) {
    Json runs = Json::array();
    for (const auto& s : summarize_runs(records, spec))
      runs.push_back({{"run", s.run},
                      {"frames", s.frames},
                      {"correct", s.correct},
                      {"incorrect", s.wrong},
                      {"no_result", s.none},
                      {"pose_right", s.pose_right},
                      {"seen_right", s.seen_right},
                      {"median_ms", quantile(s.times_ms, 0.5)}});
    print_json({{"runs", runs}, {"tables", (arguments.output / "tables.json").string()}});
    return;
  }
  fmt::print("{:<60} {:>6} {:>9} {:>11} {:>11} {:>12} {:>12} {:>10}\n", "run", "frames", "correct %", "incorrect %",
             "no result %", "limits %", "pose right %", "median ms");
  for (const auto& s : summarize_runs(records, spec)) {
    // Of a part that is not in the catalogue there is no pose.
    const auto of_poses = [&](int count) { return s.left_out ? "-" : fmt::format("{:.1f}", s.percent(count)); };
    fmt::print("{:<60} {:>6} {:>9.1f} {:>11.1f} {:>11.1f} {:>12} {:>12} {:>10.1f}\n", title_of_run(s.run), s.frames,
               s.percent(s.correct), s.percent(s.wrong), s.percent(s.none), of_poses(s.pose_right),
               of_poses(s.seen_right), quantile(s.times_ms, 0.5));
  }
  fmt::print(
      "pose right: MSSD below 10 % of the diameter up to symmetry, or part and pose that the camera cannot tell from "
      "the truth; limits: within {:g} deg and {:g} mm, symmetry ignored; of all frames\n",
      spec.limit_deg, spec.limit_mm);
  fmt::print("Tables and plots: {}\n", (arguments.output / "tables.md").string());
}

}  // namespace

void add_experiment_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<ExperimentArguments>();
  auto* experiment = app.add_subcommand(
      "experiment", "Run a grid of parts, protocols, descriptors and configurations, and write its tables");
  experiment->add_option("spec", arguments->spec, "Experiment JSON (see experiments/ and docs/evaluation.md)")
      ->required();
  experiment
      ->add_option("-o,--output", arguments->output,
                   "Folder for frames and tables; when the experiment was stopped in it, it goes on")
      ->required();
  add_set_option(*experiment, arguments->overrides);
  experiment->add_flag("--json", arguments->json, "Print the table as JSON");
  experiment
      ->add_option("--frames", arguments->most_frames,
                   "At most so many frames of each protocol, spread evenly over it (the file's \"most_frames\")")
      ->check(CLI::Range(1, 1000000));
  experiment->footer(
      "Examples:\n"
      "  partpose experiment experiments/ground_truth.json --output results/\n"
      "  partpose experiment experiments/ground_truth.json --set descriptors=vfh,esf --output two_descriptors/\n"
      "Interrupted, it goes on where it stopped when the command is given again.");
  experiment->callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace partpose::apps
