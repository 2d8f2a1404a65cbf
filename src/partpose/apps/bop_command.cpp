// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"
#include "output.hpp"
#include "recognizer_choice.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/evaluation/bop_recognition.hpp"
#include "partpose/evaluation/bop_score.hpp"
#include "partpose/io/json.hpp"
#include "partpose/pipeline/catalogue_cache.hpp"

#include <CLI/CLI.hpp>

#include <memory>
#include <optional>
#include <set>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct BopRecognizeArguments {
  fs::path dataset, output, cache;
  std::string split = "test";
  std::string recognizer = default_recognizer;
  std::optional<float> min_score;
  bool json = false;
};

struct BopScoreArguments {
  fs::path dataset, results, json;
  std::string split = "test";
  BopScoreOptions options;
  bool no_vsd = false;
};

std::size_t images_of(const BopDataset& dataset) {
  std::set<std::pair<int, int>> images;
  for (const auto& t : dataset.targets) images.insert({t.scene_id, t.im_id});
  return images.size();
}

void recognize(const BopRecognizeArguments& arguments, const Common& common) {
  check_file_can_be_written(arguments.output);
  const BopDataset dataset = read_bop_dataset(arguments.dataset, arguments.split);
  const float min_score = arguments.min_score.value_or(default_min_score(arguments.recognizer));
  const auto progress = terminal_progress(common);
  const Unfinished half_written;
  Catalogue catalogue =
      bop_catalogue(dataset, arguments.cache.empty() ? default_cache_folder() : arguments.cache, progress);
  const auto recognizer = make_recognizer(arguments.recognizer, std::move(catalogue), min_score);
  const auto estimates = recognize_bop(dataset, *recognizer, min_score, progress);
  write_bop_results(arguments.output, estimates);
  int wanted = 0;
  for (const auto& t : dataset.targets) wanted += t.inst_count;
  if (arguments.json)
    print_json({{"output", arguments.output.string()},
                {"instances", wanted},
                {"recognized", estimates.size()},
                {"images", images_of(dataset)},
                {"average_time_s", std::max(bop_average_time_s(estimates), 0.0)}});
  if (common.quiet || arguments.json) return;
  fmt::print("{} of {} recognized in {}, {:.2f} s for each that shows one; written to {}\n", estimates.size(),
             counted(wanted, "instance"), counted(images_of(dataset), "image"),
             std::max(bop_average_time_s(estimates), 0.0), arguments.output.string());
}

/// The keys of the toolkit's scores_bop19.json, and more beside.
Json json_of(const BopScores& scores, const std::vector<int>& obj_ids) {
  const auto null_or = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  const auto average = [](const BopScore& score) { return score.average_recall; };
  Json json;
  json["bop19_average_recall"] = null_or(scores.average_recall);
  json["bop19_average_recall_vsd"] = null_or(scores.vsd ? std::optional(average(*scores.vsd)) : std::nullopt);
  json["bop19_average_recall_mssd"] = scores.mssd.average_recall;
  json["bop19_average_recall_mspd"] = scores.mspd.average_recall;
  json["bop19_average_time_per_image"] = scores.average_time_per_image_s;
  json["targets_count"] = scores.targets_count;
  json["estimates_kept"] = scores.estimates_kept;
  for (const int id : obj_ids) {
    Json object;
    if (scores.vsd) object["average_recall_vsd"] = scores.vsd->obj_recall.at(id);
    object["average_recall_mssd"] = scores.mssd.obj_recall.at(id);
    object["average_recall_mspd"] = scores.mspd.obj_recall.at(id);
    json["objects"][std::to_string(id)] = object;
  }
  for (const auto& [name, score] : {std::pair("mssd", &scores.mssd), std::pair("mspd", &scores.mspd)})
    for (const auto& recall : score->recalls)
      json["recalls"][name].push_back(
          {{"threshold", recall.threshold}, {"recall", recall.recall}, {"tp_count", recall.tp_count}});
  return json;
}

void print_row(const std::string& name, const std::optional<double>& vsd, double mssd, double mspd) {
  const auto percent = [](double share) { return fmt::format("{:.1f}", 100 * share); };
  const std::string none = "-";
  fmt::print("{:<12} {:>8} {:>8} {:>8} {:>8}\n", name, vsd ? percent((*vsd + mssd + mspd) / 3) : none,
             vsd ? percent(*vsd) : none, percent(mssd), percent(mspd));
}

void score(BopScoreArguments arguments, const Common& common) {
  const BopDataset dataset = read_bop_dataset(arguments.dataset, arguments.split);
  const auto estimates = read_bop_results(arguments.results);
  arguments.options.vsd = !arguments.no_vsd;
  const BopScores scores = score_bop(dataset, estimates, arguments.options, terminal_progress(common));
  std::vector<int> obj_ids;
  for (const auto& [id, recall] : scores.mssd.obj_recall) obj_ids.push_back(id);
  if (!arguments.json.empty()) {
    auto file = open_for_writing(arguments.json);
    file << json_of(scores, obj_ids).dump(2) << std::endl;
    if (!file) throw Error("{}: could not be written completely: is the disk full?", arguments.json.string());
    if (arguments.json == "-") return;
  }
  fmt::print("{} in {}, {} of them\n", counted(scores.targets_count, "instance"), counted(images_of(dataset), "image"),
             counted(scores.estimates_kept, "estimate"));
  fmt::print("{:<12} {:>8} {:>8} {:>8} {:>8}\n", "recall in %", "AR", "AR_VSD", "AR_MSSD", "AR_MSPD");
  print_row("all", scores.vsd ? std::optional(scores.vsd->average_recall) : std::nullopt, scores.mssd.average_recall,
            scores.mspd.average_recall);
  for (const int id : obj_ids)
    print_row(fmt::format("object {}", id), scores.vsd ? std::optional(scores.vsd->obj_recall.at(id)) : std::nullopt,
              scores.mssd.obj_recall.at(id), scores.mspd.obj_recall.at(id));
  if (scores.average_time_per_image_s >= 0)
    fmt::print("{:.3f} s per image\n", scores.average_time_per_image_s);
  else
    fmt::print("time per image not known\n");
  if (!scores.vsd)
    fmt::print("AR_VSD and AR need depth images{}\n",
               arguments.no_vsd ? ", which --no-vsd left out" : "; there are none");
}

}  // namespace

void add_bop_commands(CLI::App& app, const Common& common) {
  auto* bop = app.add_subcommand("bop", "Recognize, or score, a dataset in the format of the BOP benchmark");
  bop->require_subcommand(1);
  bop->footer(
      "Examples:\n  partpose bop recognize toy/ --output partpose_toy-test.csv\n  partpose bop score toy/ "
      "partpose_toy-test.csv");

  auto recognize_arguments = std::make_shared<BopRecognizeArguments>();
  auto* recognize_command =
      bop->add_subcommand("recognize", "Recognize the targets of a BOP dataset and write the results file");
  recognize_command
      ->add_option("dataset", recognize_arguments->dataset, "Folder with models/, the split and the targets")
      ->required();
  recognize_command
      ->add_option("--split", recognize_arguments->split, "Folder of the scenes (the targets' file counts for test*)")
      ->capture_default_str();
  recognize_command
      ->add_option("-o,--output", recognize_arguments->output,
                   "Results file; the toolkit wants METHOD_DATASET-SPLIT.csv, without _ in METHOD")
      ->required();
  add_min_score_option(*recognize_command, recognize_arguments->min_score);
  add_recognizer_option(*recognize_command, recognize_arguments->recognizer);
  recognize_command->add_flag("--json", recognize_arguments->json, "Print the counts as JSON");
  recognize_command->add_option("--cache", recognize_arguments->cache,
                                "Where catalogues for --recognizer recognizer are kept (default: ~/.cache/partpose)");
  recognize_command->footer("Example:\n  partpose bop recognize toy/ --split test --output partpose_toy-test.csv");
  recognize_command->callback([recognize_arguments, &common] { recognize(*recognize_arguments, common); });

  auto score_arguments = std::make_shared<BopScoreArguments>();
  auto* score_command =
      bop->add_subcommand("score", "Score a results file as the BOP benchmark does: AR of VSD, MSSD and MSPD");
  score_command->add_option("dataset", score_arguments->dataset, "Folder with the models, the split and the targets")
      ->required();
  score_command->add_option("results", score_arguments->results, "Results file, of whatever program")->required();
  score_command->add_option("--split", score_arguments->split, "Folder of the scenes")->capture_default_str();
  score_command->add_option("--json", score_arguments->json, "Write the scores here (-, or no FILE: standard output)")
      ->type_name("[FILE]")
      ->expected(0, 1)
      ->default_str("-");
  score_command
      ->add_option("--vsd-delta", score_arguments->options.vsd_delta_mm,
                   "mm behind the measured surface where a pose still counts as visible (ITODD: 5)")
      ->capture_default_str();
  score_command->add_flag("--no-vsd", score_arguments->no_vsd, "Leave VSD out; it takes longest");
  score_command->add_option("--image-width", score_arguments->options.image_width,
                            "px, when there is neither camera.json nor a depth image");
  score_command->footer(
      "Examples:\n"
      "  partpose bop score toy/ partpose_toy-test.csv\n"
      "  partpose bop score toy/ other_toy-test.csv --json scores.json");
  score_command->callback([score_arguments, &common] { score(*score_arguments, common); });
}

}  // namespace partpose::apps
