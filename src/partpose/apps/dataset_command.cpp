// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "parts.hpp"
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
};

void make_dataset(const DatasetArguments& arguments, const Common& common) {
  std::vector<fs::path> paths = arguments.models;
  if (!arguments.model_list.empty()) {
    const auto listed = read_model_list(arguments.model_list);
    paths.insert(paths.end(), listed.begin(), listed.end());
  }
  if (paths.empty()) throw Error("dataset: give the parts with --models or --model-list");
  const auto config = arguments.config.empty() ? DatasetPreparationConfig{}
                                               : read_dataset_config(arguments.config);
  const Stopwatch watch;
  const auto parts = read_parts(paths, arguments.reading, common);
  const Dataset dataset = create_dataset(config, parts, arguments.output, terminal_progress(common.quiet));
  if (!common.quiet)
    fmt::print("{}: {} parts x {} views in {:.2f} s\n", arguments.output.string(), dataset.out.models.size(),
               dataset.out.views.size(), watch.elapsed_ms() / 1000);
}

}  // namespace

void add_dataset_commands(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<DatasetArguments>();
  auto* dataset = app.add_subcommand("dataset", "Render the views of all parts into a dataset folder");
  dataset->add_option("-m,--models", arguments->models, part_files_help);
  add_reading_options(*dataset, arguments->reading);
  dataset->add_option("--model-list", arguments->model_list, "JSON with \"model_paths\", relative to its own folder");
  dataset->add_option("-c,--config", arguments->config, "Dataset preparation JSON (default: 42 views from 650 mm)");
  dataset->add_option("-o,--output", arguments->output, "Folder to write; an older dataset there is replaced")->required();
  dataset->footer("Example:\n  partpose dataset --models parts/ --config configs/dataset_ground_truth.json --output dataset/");
  dataset->callback([arguments, &common] { make_dataset(*arguments, common); });

  struct IndexArguments {
    fs::path dataset, config;
  };
  auto index_arguments = std::make_shared<IndexArguments>();
  auto* index = app.add_subcommand("index", "Compute the descriptors of a dataset's views (the offline stage)");
  index->add_option("-d,--dataset", index_arguments->dataset, "Dataset folder")->required();
  index->add_option("-c,--config", index_arguments->config, "Pipeline JSON (default: configs/pipeline_virtual.json's values)");
  index->footer("Example:\n  partpose index --dataset dataset/ --config configs/pipeline_virtual.json\n"
                "Descriptors are kept in the dataset and used again until something that they depend on changes.");
  index->callback([index_arguments, &common] {
    const auto config = index_arguments->config.empty() ? GlobalPipelineConfig{}
                                                        : read_pipeline_config(index_arguments->config);
    const Stopwatch watch;
    const Catalogue catalogue =
        load_catalogue(open_dataset(index_arguments->dataset), config, terminal_progress(common.quiet));
    if (!common.quiet)
      fmt::print("{}: {} {} descriptors of {} parts ready in {:.2f} s\n", index_arguments->dataset.string(),
                 catalogue.index.size(), config.global_descriptor, catalogue.parts.size(), watch.elapsed_ms() / 1000);
  });
}

}  // namespace partpose::apps
