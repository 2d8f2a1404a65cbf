// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "config_keys.hpp"
#include "interruption.hpp"
#include "output.hpp"
#include "parts.hpp"
#include "recognizer_choice.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/dataset/dataset.hpp"
#include "partpose/pipeline/catalogue.hpp"
#include "partpose/pipeline/config_file.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct DatasetArguments {
  std::vector<fs::path> models;
  MeshReadOptions reading;
  fs::path model_list;
  fs::path config;
  fs::path output;
  std::vector<std::string> overrides;
  bool json = false;
};

void make_dataset(const DatasetArguments& arguments, const Common& common) {
  std::vector<fs::path> paths = arguments.models;
  if (!arguments.model_list.empty()) {
    const auto listed = read_model_list(arguments.model_list);
    paths.insert(paths.end(), listed.begin(), listed.end());
  }
  if (paths.empty()) throw Error("dataset: give the parts with --models or --model-list");
  auto config = arguments.config.empty() ? DatasetPreparationConfig{} : read_dataset_config(arguments.config);
  apply_overrides(config, arguments.overrides);
  const Stopwatch watch;
  const auto parts = read_parts(paths, arguments.reading, common);
  const Unfinished half_written;
  const Dataset dataset = create_dataset(config, parts, arguments.output, terminal_progress(common));
  if (arguments.json) {
    Json names = Json::array();
    for (const auto& model : dataset.out.models) names.push_back(model.name);
    print_json({{"dataset", arguments.output.string()},
                {"parts", names},
                {"views", dataset.out.views.size()},
                {"time_s", watch.elapsed_ms() / 1000}});
  } else if (!common.quiet) {
    fmt::print("{}: {} x {} in {:.2f} s\n", arguments.output.string(), counted(dataset.out.models.size(), "part"),
               counted(dataset.out.views.size(), "view"), watch.elapsed_ms() / 1000);
  }
}

}  // namespace

void add_dataset_commands(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<DatasetArguments>();
  auto* dataset = app.add_subcommand("dataset", "Render the views of all parts into a dataset folder");
  dataset->add_option("-m,--models", arguments->models, part_files_help);
  add_reading_options(*dataset, arguments->reading);
  dataset->add_option("--model-list", arguments->model_list, "JSON with \"model_paths\", relative to its own folder");
  dataset->add_option("-c,--config", arguments->config, "Dataset preparation JSON (default: 42 views from 650 mm)");
  add_set_option(*dataset, arguments->overrides);
  dataset->add_flag("--json", arguments->json, "Print what was made as JSON");
  dataset->add_option("-o,--output", arguments->output, "Folder to write; an older dataset there is replaced")
      ->required();
  dataset->footer(
      "Examples:\n"
      "  partpose dataset --models parts/ --config configs/dataset_ground_truth.json --output dataset/\n"
      "  partpose dataset --models parts/ --set virtual_views_icosahedron.subdivide=2 --output dataset/\n"
      "Interrupted, it leaves nothing: the dataset appears when it is whole.");
  dataset->callback([arguments, &common] { make_dataset(*arguments, common); });

  struct IndexArguments {
    fs::path dataset, config;
    std::vector<std::string> overrides;
    bool json = false;
  };
  auto index_arguments = std::make_shared<IndexArguments>();
  auto* index = app.add_subcommand("index", "Compute the descriptors of a dataset's views (the offline stage)");
  index->add_option("-d,--dataset", index_arguments->dataset, "Dataset folder")->required();
  index->add_option("-c,--config", index_arguments->config,
                    "Pipeline JSON (default: configs/pipeline_virtual.json's values)");
  add_set_option(*index, index_arguments->overrides);
  index->add_flag("--json", index_arguments->json, "Print what was made as JSON");
  index->footer(
      "Example:\n  partpose index --dataset dataset/ --config configs/pipeline_virtual.json\n"
      "Descriptors are kept in the dataset and used again until something that they depend on changes.");
  index->callback([index_arguments, &common] {
    const auto config = pipeline_config(index_arguments->config, index_arguments->overrides);
    const Stopwatch watch;
    const Unfinished half_written;
    const Catalogue catalogue =
        load_catalogue(open_dataset(index_arguments->dataset), config, terminal_progress(common));
    if (index_arguments->json)
      print_json({{"dataset", index_arguments->dataset.string()},
                  {"global_descriptor", config.global_descriptor},
                  {"descriptors", catalogue.index.size()},
                  {"parts", catalogue.parts.size()},
                  {"time_s", watch.elapsed_ms() / 1000}});
    else if (!common.quiet)
      fmt::print("{}: {} {} descriptors of {} ready in {:.2f} s\n", index_arguments->dataset.string(),
                 catalogue.index.size(), config.global_descriptor, counted(catalogue.parts.size(), "part"),
                 watch.elapsed_ms() / 1000);
  });
}

}  // namespace partpose::apps
