// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "config_keys.hpp"
#include "interruption.hpp"
#include "output.hpp"
#include "parts.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/geometry/symmetry_search.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/png.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/synthesis/bop_scenes.hpp"
#include "partpose/synthesis/scene_picture.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <set>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct ScenesArguments {
  std::vector<fs::path> models, unknown;
  fs::path config, output, pictures;
  std::int64_t frames = 100;
  std::optional<std::uint64_t> seed;
  std::optional<std::string> sensor, poses;
  std::optional<int> parts, clutter;
  std::vector<double> hidden;
  std::vector<std::string> overrides;
  bool list_poses = false, print_config = false, json = false;
};

std::vector<ScenePart> scene_parts(const std::vector<fs::path>& files_and_folders, const Common& common) {
  std::vector<ScenePart> parts;
  if (files_and_folders.empty()) return parts;
  for (auto& part : read_parts(files_and_folders, {}, common)) parts.push_back({part.name, std::move(part.mesh)});
  return parts;
}

SceneDatasetOptions options_of(const ScenesArguments& arguments) {
  SceneDatasetOptions options;
  if (!arguments.config.empty()) options = read_json<SceneDatasetOptions>(arguments.config);
  apply_overrides(options, arguments.overrides);
  if (arguments.seed) options.scene.seed = *arguments.seed;
  if (arguments.sensor) options.sensor.model = *arguments.sensor;
  if (arguments.poses) options.scene.poses = *arguments.poses;
  if (arguments.parts) options.scene.parts = {std::min(1, *arguments.parts), *arguments.parts};
  if (arguments.clutter) options.scene.clutter = {0, *arguments.clutter};
  if (!arguments.hidden.empty()) options.scene.hidden_fraction = {arguments.hidden[0], arguments.hidden[1]};
  if (!arguments.unknown.empty() && options.scene.unknown_parts[1] == 0) options.scene.unknown_parts = {1, 1};
  options.check();
  return options;
}

Json json_of(const RestingPoses& resting) {
  Json poses = Json::array();
  for (const auto& pose : resting.poses)
    poses.push_back({{"group", pose.group},
                     {"probability", pose.probability},
                     {"centre_height_mm", pose.centre_height_mm},
                     {"stability_deg", pose.stability_deg},
                     {"down", {pose.down.x(), pose.down.y(), pose.down.z()}},
                     {"table_from_model", to_json(pose.table_from_model)}});
  return {{"poses", poses}, {"centre_of_mass_from_mesh", resting.centre_of_mass_from_mesh}};
}

void list_poses(const std::vector<ScenePart>& parts, const RestingPoseOptions& options, bool json) {
  if (json) {
    Json all = Json::object();
    for (const auto& part : parts) all[part.name] = json_of(resting_poses(part.mesh, options));
    print_json(all);
    return;
  }
  fmt::print("{:<20} {:>5} {:>12} {:>12} {:>14} {:>26}\n", "part", "group", "probability", "height [mm]",
             "stability [deg]", "down (model axes)");
  for (const auto& part : parts) {
    const RestingPoses resting = resting_poses(part.mesh, options);
    for (const auto& pose : resting.poses)
      fmt::print("{:<20} {:>5} {:>12.4f} {:>12.2f} {:>14.1f}   ({:>6.3f}, {:>6.3f}, {:>6.3f})\n", part.name, pose.group,
                 pose.probability, pose.centre_height_mm, pose.stability_deg, pose.down.x(), pose.down.y(),
                 pose.down.z());
    if (!resting.centre_of_mass_from_mesh)
      fmt::print("{:<20} (the mesh is not closed: centre of mass of its convex hull)\n", part.name);
  }
}

void make_scenes(const ScenesArguments& arguments, const Common& common) {
  const SceneDatasetOptions options = options_of(arguments);
  if (arguments.print_config) {
    fmt::print("{}\n", to_json(options).dump(2));
    return;
  }
  if (arguments.models.empty()) throw Error("scenes: give the parts with --models");
  std::vector<ScenePart> parts = scene_parts(arguments.models, common),
                         unknown = scene_parts(arguments.unknown, common);
  if (arguments.list_poses) {
    list_poses(parts, options.scene.resting_poses, arguments.json);
    return;
  }
  if (arguments.output.empty()) throw Error("scenes: give the folder to write with --output");
  if (arguments.frames < 1) throw Error("scenes: --frames {}: must be 1 or more", arguments.frames);
  check_folder_can_be_written(arguments.pictures);
  const Stopwatch watch;
  const auto frames = static_cast<std::size_t>(arguments.frames);
  const auto symmetries_of = [](const TriangleMesh& mesh) {
    return find_symmetries(mesh, default_symmetry_tolerance_mm(diameter(mesh)));
  };
  const Unfinished half_written;
  write_scene_dataset(parts, unknown, options, frames, arguments.output, symmetries_of, terminal_progress(common));
  if (arguments.json)
    print_json({{"output", arguments.output.string()},
                {"frames", frames},
                {"parts", parts.size()},
                {"time_s", watch.elapsed_ms() / 1000}});
  else if (!common.quiet)
    fmt::print("{}: {} of {} in {:.2f} s\n", arguments.output.string(), counted(frames, "frame"),
               counted(parts.size(), "part"), watch.elapsed_ms() / 1000);
  if (arguments.pictures.empty()) return;
  fs::create_directories(arguments.pictures);
  const SceneGenerator generator(std::move(parts), std::move(unknown), options.scene);
  for (std::size_t i = 0; i < frames; ++i) {
    check_not_interrupted();
    write_png(arguments.pictures / fmt::format("{:06}.png", i), picture_of(generator.generate(i)));
  }
}

}  // namespace

void add_scenes_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<ScenesArguments>();
  auto* scenes = app.add_subcommand("scenes", "Draw depth frames of parts that lie on a table, with their exact poses");
  scenes->add_option("-m,--models", arguments->models, "Model files of the catalogue, or folders of them")
      ->allow_extra_args(false);
  scenes->add_option("-n,--frames", arguments->frames, "How many frames")->capture_default_str();
  scenes->add_option("-o,--output", arguments->output,
                     "Folder to write, a BOP dataset; older scenes there are replaced");
  scenes->add_option("-c,--config", arguments->config, "Scenes JSON; the options below change what it says");
  add_set_option(*scenes, arguments->overrides);
  scenes->add_option("--seed", arguments->seed, "The same seed gives the same frames (default: 1)");
  scenes->add_option("--sensor", arguments->sensor, "stereo (like a D415, the default), gaussianray or none")
      ->check(CLI::IsMember({"stereo", "gaussianray", "none"}));
  scenes->add_option("--parts", arguments->parts, "At most so many catalogue parts in a frame (default: 1)")
      ->check(CLI::Range(0, 100));
  scenes
      ->add_option("--unknown", arguments->unknown,
                   "Model files or folders of parts that are not in the catalogue: one in each frame")
      ->allow_extra_args(false);
  scenes->add_option("--clutter", arguments->clutter, "At most so many boxes and cylinders in a frame (default: 0)")
      ->check(CLI::Range(0, 100));
  scenes->add_option("--hidden", arguments->hidden, "Hide a share of the first part, drawn between these two, 0 to 1")
      ->expected(2);
  scenes
      ->add_option("--poses", arguments->poses,
                   "natural (as often as a dropped part rests so, the default) or uniform (rare ones as often)")
      ->check(CLI::IsMember({"natural", "uniform"}));
  scenes->add_option("--pictures", arguments->pictures, "Also write a shaded picture of each frame here");
  scenes->add_flag("--json", arguments->json, "Print what was made, or the resting poses, as JSON");
  scenes->add_flag("--list-poses", arguments->list_poses, "Only list the resting poses of the parts");
  scenes->add_flag("--print-config", arguments->print_config, "Only print the scenes JSON that would be used");
  scenes->footer(
      "Examples:\n"
      "  partpose scenes --models parts/ --frames 200 --output scenes/\n"
      "  partpose scenes --models parts/ --parts 5 --clutter 4 --pictures pictures/ --output scenes/\n"
      "  partpose scenes --models parts/ --hidden 0.3 0.5 --sensor none --output occluded/\n"
      "  partpose scenes --models known/ --unknown others/ --seed 7 --output scenes/\n"
      "  partpose scenes --models parts/ --set sensor.stereo.baseline_mm=95 --output wide_baseline/\n"
      "  partpose scenes --models parts/flange.stl --list-poses\n"
      "  partpose scenes --print-config >scenes.json           # all options, to be changed and given with --config");
  scenes->callback([arguments, &common] { make_scenes(*arguments, common); });
}

}  // namespace partpose::apps
