// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "recognizer_choice.hpp"

#include "config_keys.hpp"
#include "interruption.hpp"
#include "output.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/engine/engine.hpp"
#include "partpose/pipeline/catalogue_cache.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/pipeline/global_pipeline.hpp"
#include "partpose/pipeline/recognizer.hpp"

#include <CLI/CLI.hpp>

namespace partpose::apps {

CLI::Option* add_recognizer_option(CLI::App& command, std::string& name) {
  return command.add_option("--recognizer", name, "What recognizes the parts where nothing is configured")
      ->check(CLI::IsMember({"engine", "recognizer"}))
      ->capture_default_str();
}

CLI::Option* add_min_score_option(CLI::App& command, std::optional<float>& min_score) {
  return command.add_option("--min-score", min_score,
                            "A candidate below is not believed, 0 to 1 (default: the recognizer's own)");
}

std::unique_ptr<PartRecognizer> make_recognizer(const std::string& name, Catalogue catalogue,
                                                std::optional<float> min_score) {
  if (name == "engine") {
    EngineOptions options;
    options.min_score = min_score.value_or(options.min_score);
    return std::make_unique<Engine>(std::move(catalogue), options);
  }
  RecognizerOptions options;
  options.min_score = min_score.value_or(options.min_score);
  return std::make_unique<Recognizer>(std::move(catalogue), options);
}

float default_min_score(const std::string& name) {
  return name == "engine" ? EngineOptions{}.min_score : RecognizerOptions{}.min_score;
}

void add_recognizer_arguments(CLI::App& command, RecognizerArguments& arguments) {
  command.add_option("-m,--models", arguments.models, "Model file or folder of them, may be given more than once")
      ->allow_extra_args(false);
  command.add_option("-d,--dataset", arguments.dataset, "Dataset folder of the parts, instead of --models");
  auto* config =
      command.add_option("-c,--config", arguments.config,
                         "Pipeline JSON: run exactly that pipeline on the dataset (default: nothing to configure)");
  add_set_option(command, arguments.overrides);
  add_recognizer_option(command, arguments.recognizer)->excludes(config);
  add_min_score_option(command, arguments.min_score)->excludes(config);
  add_reading_options(command, arguments.reading);
  command.add_option("--cache", arguments.cache,
                     "Where catalogues of --models for --recognizer recognizer are kept (default: ~/.cache/partpose)");
}

Scene ChosenRecognizer::in_mm(const Scene& scene) const {
  Scene out = scene;
  if (config.preprocessing.scale_flag) out.cloud = scaled(scene.cloud, config.preprocessing.scale_factor);
  return out;
}

ChosenRecognizer choose_recognizer(const std::string& command, const RecognizerArguments& arguments,
                                   const Common& common) {
  if (arguments.models.empty() == arguments.dataset.empty())
    throw Error("{}: give the parts with --models (model files) or with --dataset (a dataset folder)", command);
  if (!arguments.config.empty() && arguments.dataset.empty())
    throw Error("{}: --config goes with --dataset; --models needs no configuration", command);
  if (!arguments.overrides.empty() && arguments.config.empty())
    throw Error("{}: --set changes a configuration; give one with --config (partpose config writes the default one)",
                command);
  ChosenRecognizer chosen;
  if (!arguments.config.empty()) {
    chosen.config = pipeline_config(arguments.config, arguments.overrides);
    const auto notion = [](std::string_view step) { fmt::print(stderr, "{}\n", step); };
    const Unfinished descriptors;
    chosen.recognizer = std::make_unique<GlobalPipeline>(
        load_catalogue(open_dataset(arguments.dataset), chosen.config, terminal_progress(common)), chosen.config,
        chosen.config.debug.step_notion_to_cout ? notion : std::function<void(std::string_view)>{});
    return chosen;
  }
  chosen.config = Recognizer::catalogue_config();
  const auto catalogue = [&] {
    if (arguments.dataset.empty())
      return catalogue_for(arguments.recognizer, read_parts(arguments.models, arguments.reading, common),
                           arguments.cache, common);
    Dataset dataset = open_dataset(arguments.dataset);
    if (arguments.recognizer == "engine") return mesh_catalogue(std::move(dataset));
    const Unfinished descriptors;
    return load_catalogue(std::move(dataset), chosen.config, terminal_progress(common));
  };
  chosen.recognizer = make_recognizer(arguments.recognizer, catalogue(), arguments.min_score);
  return chosen;
}

GlobalPipelineConfig pipeline_config(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  GlobalPipelineConfig config = path.empty() ? GlobalPipelineConfig{} : read_pipeline_config(path);
  apply_overrides(config, overrides);
  return config;
}

Catalogue catalogue_for(const std::string& recognizer, const std::vector<NamedMesh>& parts,
                        const std::filesystem::path& cache, const Common& common) {
  if (recognizer == "engine") return mesh_catalogue(parts);
  const auto folder = cache.empty() ? default_cache_folder() : cache;
  const Unfinished dataset;
  Catalogue catalogue = cached_catalogue(parts, DatasetPreparationConfig{}, Recognizer::catalogue_config(), folder,
                                         terminal_progress(common));
  note(common, fmt::format("catalogue of {}, {}: {}", counted(catalogue.parts.size(), "part"),
                           counted(catalogue.views.size(), "view"), catalogue.dataset.folder.string()));
  return catalogue;
}

}  // namespace partpose::apps
