// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"
#include "output.hpp"
#include "recognition_output.hpp"
#include "recognizer_choice.hpp"
#include "scene_reader.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/png.hpp"
#include "partpose/pipeline/iteration_output.hpp"
#include "partpose/report/report.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct RecognizeArguments : RecognizerArguments {
  std::vector<fs::path> scenes;
  fs::path camera, jsonl, output, pictures;
  std::string units = "mm";
  bool json = false;
};

/// Throws Error when an output would replace a scene.
void check_keeps_scenes(const fs::path& output, const std::vector<fs::path>& scenes) {
  std::error_code ignored;
  for (const auto& scene : scenes)
    if (fs::equivalent(output, scene, ignored))
      throw Error("{}: is a scene; give another place for the output, which would replace it", output.string());
}

void recognize_all(RecognizeArguments arguments, const Common& common) {
  if (arguments.json && !arguments.jsonl.empty())
    throw Error("recognize: --json and --jsonl write the same lines; give one of them");
  if (arguments.json) arguments.jsonl = "-";
  arguments.json = is_standard_output(arguments.jsonl);
  check_file_can_be_written(arguments.jsonl);
  check_folder_can_be_written(arguments.output);
  check_folder_can_be_written(arguments.pictures);
  const SceneReading reading = {arguments.camera, arguments.units};
  check_scenes(reading, arguments.scenes);
  const ChosenRecognizer chosen = choose_recognizer("recognize", arguments, common);
  const Catalogue& catalogue = chosen.recognizer->catalogue();
  if (arguments.units == "m" && chosen.config.preprocessing.scale_flag)
    throw Error("recognize: --units m and the configuration's preprocessing.scale_flag would both scale the scenes");
  const Unfinished frame;  // each is finished before a signal counts
  std::optional<std::ofstream> jsonl;
  if (!arguments.jsonl.empty()) {
    check_keeps_scenes(arguments.jsonl, arguments.scenes);
    jsonl.emplace(open_for_writing(arguments.jsonl));
  }
  PictureNames picture_names(arguments.pictures);
  if (!arguments.pictures.empty()) fs::create_directories(arguments.pictures);
  SceneReader reader(reading);
  for (const auto& path : arguments.scenes) {
    check_not_interrupted();
    try {
      const Scene scene = reader.read(path);
      const Recognition recognition = named_after(path, [&] { return chosen.recognizer->recognize(scene); });
      if (jsonl) *jsonl << json_line(line_of(path, recognition, catalogue)) << std::endl;
      if ((!common.quiet && !arguments.json) || chosen.config.debug.result_to_cout)
        print_for_people(path, recognition, catalogue);
      note_stages(common, recognition);
      if (!arguments.output.empty()) {
        const DebugOptions& debug = chosen.config.debug;
        const fs::path iteration = write_iteration(arguments.output, recognition, scene, catalogue, chosen.config);
        if (debug.visualize_flag)
          write_report(iteration, iteration / "report.html", {.stages = stages_of(debug.visualize)});
      }
      if (!arguments.pictures.empty()) {
        const fs::path picture = picture_names.next(path);
        check_keeps_scenes(picture, arguments.scenes);
        write_png(picture, picture_of(chosen.in_mm(scene), recognition, catalogue));
      }
    } catch (const Error& error) {
      // One bad scene does not lose the others.
      complain(error.what());
      if (jsonl) *jsonl << json_line(Json{{"scene", path.string()}, {"error", error.what()}}) << std::endl;
      ++common.failures;
    }
  }
  if (jsonl && !*jsonl) throw Error("{}: could not be written completely: is the disk full?", arguments.jsonl.string());
}

}  // namespace

void add_recognize_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<RecognizeArguments>();
  auto* recognize = app.add_subcommand("recognize", "Say which part each scene shows, and where it is");
  recognize
      ->add_option("scenes", arguments->scenes,
                   "16-bit depth PNG (with NAME.camera.json or camera.json beside it), PCD or PLY")
      ->required();
  add_recognizer_arguments(*recognize, *arguments);
  recognize->add_option("--camera", arguments->camera, "Camera JSON for all depth images");
  recognize->add_option("--units", arguments->units, "Unit of clouds' coordinates: mm or m")
      ->check(CLI::IsMember({"mm", "m"}))
      ->capture_default_str();
  recognize->add_flag("--json", arguments->json, "Print one JSON line for each scene, and nothing else");
  recognize->add_option("--jsonl", arguments->jsonl,
                        "Write one JSON line for each scene here (-: standard output, as --json)");
  recognize->add_option("--pictures", arguments->pictures,
                        "Write a picture of each scene with all that was recognized drawn over it here");
  recognize->add_option("-o,--output", arguments->output,
                        "Write an iteration output folder for each scene here (see the configuration's \"debug\")");
  recognize->footer(
      "Examples:\n"
      "  partpose recognize --models parts/ frame.png\n"
      "  partpose recognize --models parts/ --jsonl results.jsonl --pictures pictures/ *.png *.ply\n"
      "  partpose recognize --models parts/ --json frame.png | jq .model_name\n"
      "  partpose recognize --dataset dataset/ --config configs/pipeline_virtual.json --set vfh.k_nn=9 scene.pcd\n"
      "A pose is camera_from_model, 4x4, in mm; camera frame: x right, y down, z forward.");
  recognize->callback([arguments, &common] { recognize_all(*arguments, common); });
}

}  // namespace partpose::apps
