// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "parts.hpp"
#include "output.hpp"
#include "recognition_output.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/png.hpp"
#include "partpose/io/scene.hpp"
#include "partpose/pipeline/catalogue_cache.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/pipeline/global_pipeline.hpp"
#include "partpose/pipeline/iteration_output.hpp"
#include "partpose/pipeline/recognizer.hpp"
#include "partpose/report/report.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct RecognizeArguments {
  std::vector<fs::path> scenes;
  std::vector<fs::path> models;
  MeshReadOptions reading;
  fs::path dataset, config, camera, cache, jsonl, output, pictures;
  std::string units = "mm";
};

/// Either way to recognize a scene, behind one face.
class AnyPipeline {
 public:
  AnyPipeline(const RecognizeArguments& arguments, const Common& common, const Progress& progress) {
    if (arguments.models.empty() == arguments.dataset.empty())
      throw Error("recognize: give the parts with --models (model files) or with --dataset (a dataset folder)");
    if (!arguments.config.empty() && arguments.dataset.empty())
      throw Error("recognize: --config goes with --dataset; --models needs no configuration");
    if (!arguments.config.empty()) {
      config_ = read_pipeline_config(arguments.config);
      const auto notion = [](std::string_view step) { fmt::print(stderr, "{}\n", step); };
      recognizer_ = std::make_unique<GlobalPipeline>(
          load_catalogue(open_dataset(arguments.dataset), config_, progress), config_,
          config_.debug.step_notion_to_cout ? notion : std::function<void(std::string_view)>{});
      return;
    }
    config_ = Recognizer::catalogue_config();
    if (!arguments.dataset.empty()) {
      recognizer_ = std::make_unique<Recognizer>(load_catalogue(open_dataset(arguments.dataset), config_, progress));
      return;
    }
    recognizer_ = std::make_unique<Recognizer>(
        cached_catalogue(read_parts(arguments.models, arguments.reading, common), DatasetPreparationConfig{}, config_,
                         arguments.cache.empty() ? default_cache_folder() : arguments.cache, progress));
  }

  Recognition recognize(const Scene& scene) const { return recognizer_->recognize(scene); }

  /// The scene as the pipeline sees it: the configuration may scale it.
  Scene in_mm(const Scene& scene) const {
    Scene out = scene;
    if (config_.preprocessing.scale_flag) out.cloud = scaled(scene.cloud, config_.preprocessing.scale_factor);
    return out;
  }

  const Catalogue& catalogue() const { return recognizer_->catalogue(); }
  const GlobalPipelineConfig& config() const { return config_; }

 private:
  GlobalPipelineConfig config_;
  std::unique_ptr<PartRecognizer> recognizer_;
};

/// Throws Error when an output would replace a scene.
void check_keeps_scenes(const fs::path& output, const std::vector<fs::path>& scenes) {
  std::error_code ignored;
  for (const auto& scene : scenes)
    if (fs::equivalent(output, scene, ignored))
      throw Error("{}: is a scene; give another place for the output, which would replace it", output.string());
}

int recognize_all(const RecognizeArguments& arguments, const Common& common) {
  const AnyPipeline pipeline(arguments, common, terminal_progress(common.quiet));
  if (arguments.units == "m" && pipeline.config().preprocessing.scale_flag)
    throw Error("recognize: --units m and the configuration's preprocessing.scale_flag would both scale the scenes");
  std::optional<std::ofstream> jsonl;
  if (!arguments.jsonl.empty()) {
    check_keeps_scenes(arguments.jsonl, arguments.scenes);
    jsonl.emplace(open_for_writing(arguments.jsonl));
  }
  PictureNames picture_names(arguments.pictures);
  if (!arguments.pictures.empty()) fs::create_directories(arguments.pictures);
  int failed = 0;
  for (const auto& path : arguments.scenes) {
    try {
      const Scene scene = read_scene(path, arguments.units == "m" ? 1000 : 1, arguments.camera);
      const Recognition recognition = named_after(path, [&] { return pipeline.recognize(scene); });
      if (jsonl) *jsonl << json_line(line_of(path, recognition)) << std::endl;
      if (!common.quiet || pipeline.config().debug.result_to_cout) print_for_people(path, recognition);
      if (!arguments.output.empty()) {
        const DebugOptions& debug = pipeline.config().debug;
        const fs::path iteration =
            write_iteration(arguments.output, recognition, scene, pipeline.catalogue(), pipeline.config());
        if (debug.visualize_flag)
          write_report(iteration, iteration / "report.html", {.stages = stages_of(debug.visualize)});
      }
      if (!arguments.pictures.empty()) {
        const fs::path picture = picture_names.next(path);
        check_keeps_scenes(picture, arguments.scenes);
        write_png(picture, picture_of(pipeline.in_mm(scene), recognition, pipeline.catalogue()));
      }
    } catch (const Error& error) {
      // One bad scene does not lose the others.
      fmt::print(stderr, "partpose: {}\n", error.what());
      if (jsonl) *jsonl << json_line(Json{{"scene", path.string()}, {"error", error.what()}}) << std::endl;
      ++failed;
    }
  }
  if (jsonl && !*jsonl) throw Error("{}: could not be written completely: is the disk full?", arguments.jsonl.string());
  return failed;
}

}  // namespace

void add_recognize_command(CLI::App& app, const Common& common, int& failures) {
  auto arguments = std::make_shared<RecognizeArguments>();
  auto* recognize = app.add_subcommand("recognize", "Say which part each scene shows, and where it is");
  recognize
      ->add_option("scenes", arguments->scenes,
                   "16-bit depth PNG (with NAME.camera.json or camera.json beside it), PCD or PLY")
      ->required();
  recognize
      ->add_option(
          "-m,--models", arguments->models,
          "Model file or folder of them, may be given more than once; the catalogue is made on first use and kept")
      ->allow_extra_args(false);
  recognize->add_option("-d,--dataset", arguments->dataset, "Dataset folder of the parts, instead of --models");
  recognize->add_option("-c,--config", arguments->config,
                        "Pipeline JSON: run exactly that pipeline on the dataset (default: nothing to configure)");
  recognize->add_option("--camera", arguments->camera, "Camera JSON for all depth images");
  add_reading_options(*recognize, arguments->reading);
  recognize->add_option("--units", arguments->units, "Unit of clouds' coordinates: mm or m")
      ->check(CLI::IsMember({"mm", "m"}))
      ->capture_default_str();
  recognize->add_option("--jsonl", arguments->jsonl, "Write one JSON line for each scene here (-: standard output)");
  recognize->add_option("--pictures", arguments->pictures,
                        "Write a picture of each scene with the part drawn over it here");
  recognize->add_option("-o,--output", arguments->output,
                        "Write an iteration output folder for each scene here (see the configuration's \"debug\")");
  recognize->add_option("--cache", arguments->cache,
                        "Where catalogues of --models are kept (default: ~/.cache/partpose)");
  recognize->footer(
      "Examples:\n"
      "  partpose recognize --models parts/ frame.png\n"
      "  partpose recognize --models parts/ --jsonl results.jsonl --pictures pictures/ *.png *.ply\n"
      "  partpose recognize --dataset dataset/ --config configs/pipeline_virtual.json --jsonl results.jsonl scene.pcd\n"
      "A pose is camera_from_model, 4x4, in mm; camera frame: x right, y down, z forward.");
  recognize->callback([arguments, &common, &failures] { failures += recognize_all(*arguments, common); });
}

}  // namespace partpose::apps
