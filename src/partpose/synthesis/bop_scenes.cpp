// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/synthesis/bop_scenes.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/new_folder.hpp"

#include <cmath>
#include <mutex>
#include <set>
#include <utility>

namespace partpose {

namespace fs = std::filesystem;

namespace {

const char* const record_file = "scenes.json";
const char* const split = "test";
const char* const unknown_split = "unknown";
const char* const models_folder = "models";
const char* const unknown_models_folder = "models_unknown";

struct NamedObject {
  int obj_id = 0;
  std::string name;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("obj_id", self.obj_id, "its number in the dataset");
    visit("name", self.name, "the part's name");
  }
};

/// scenes.json
struct Record {
  std::vector<NamedObject> parts, unknown_parts;
  SceneDatasetOptions options;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("parts", self.parts, "the parts in models/");
    visit("unknown_parts", self.unknown_parts, "the parts in models_unknown/");
    visit("options", self.options, "as the frames were made");
  }
};

/// Those of the silhouette's pixels in the image that have a depth.
int count_valid(const ScenePiece& piece, const Intrinsics& intrinsics, const DepthImage& measured) {
  const Rendering alone = render(*piece.mesh, piece.camera_from_model, intrinsics);
  int count = 0;
  for (std::size_t p = 0; p < measured.z_mm.size(); ++p) count += alone.depth.z_mm[p] > 0 && measured.z_mm[p] > 0;
  return count;
}

BopGroundTruth ground_truth_of(const ScenePiece& piece, const Intrinsics& intrinsics, const DepthImage& measured) {
  BopVisibility visibility;
  visibility.bbox_obj = piece.silhouette_box;
  visibility.bbox_visib = piece.visible_box;
  visibility.px_count_all = piece.silhouette_px;
  visibility.px_count_valid = count_valid(piece, intrinsics, measured);
  visibility.px_count_visib = piece.visible_px;
  visibility.visib_fract = piece.visible_fraction();
  return {piece.index + 1, piece.camera_from_model, visibility};
}

std::vector<NamedObject> write_models(const fs::path& folder, const std::vector<ScenePart>& parts,
                                      const SymmetriesOf& symmetries_of) {
  std::vector<BopModelInfo> infos(parts.size());
  parallel_for(parts.size(), [&](std::size_t i) {
    infos[i] = bop_model_info(parts[i].mesh, symmetries_of ? symmetries_of(parts[i].mesh) : Symmetries{});
    write_bop_model(folder, static_cast<int>(i) + 1, parts[i].mesh);
  });
  std::map<int, BopModelInfo> by_id;
  std::vector<NamedObject> names;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    names.push_back({static_cast<int>(i) + 1, parts[i].name});
    by_id[names.back().obj_id] = infos[i];
  }
  write_bop_models_info(folder, by_id);
  return names;
}

std::map<int, std::string> names_by_id(const std::vector<NamedObject>& objects, const fs::path& file) {
  std::map<int, std::string> out;
  for (const auto& object : objects)
    if (!out.emplace(object.obj_id, object.name).second)
      throw Error("{}: obj_id {} is given twice", file.string(), object.obj_id);
  return out;
}

}  // namespace

void SceneSensorOptions::check() const {
  if (model != "none" && model != "gaussianray" && model != "stereo")
    throw Error("model \"{}\": must be \"none\", \"gaussianray\" or \"stereo\"", model);
  if (!(standard_deviation_mm >= 0 && standard_deviation_mm <= 1000))
    throw Error("standard_deviation_mm {}: must be 0 to 1000", standard_deviation_mm);
  stereo.check();
}

SceneSensor make_scene_sensor(const SceneSensorOptions& options) {
  options.check();
  if (options.model == "none") return ideal_sensor();
  if (options.model == "gaussianray") return gaussian_ray_sensor(options.standard_deviation_mm);
  return stereo_scene_sensor(options.stereo);
}

void SceneDatasetOptions::check() const {
  scene.check();
  sensor.check();
  if (!(depth_scale_mm > 0) || scene.camera.farthest_mm / depth_scale_mm > 65535)
    throw Error(
        "depth_scale_mm {}: must be positive, and large enough that scene.camera.farthest_mm ({}) is 65535 "
        "units at most",
        depth_scale_mm, scene.camera.farthest_mm);
  if (frames_per_scene < 1 || frames_per_scene > 1000000)
    throw Error("frames_per_scene {}: must be 1 to 1000000", frames_per_scene);
}

void write_scene_dataset(std::vector<ScenePart> catalogue, std::vector<ScenePart> unknown,
                         const SceneDatasetOptions& options, std::size_t frames, const fs::path& folder,
                         const SymmetriesOf& symmetries_of, const Progress& progress) {
  options.check();
  if (frames < 1 || frames > 100'000'000) throw Error("scenes: {} frames: must be 1 to 100000000", frames);
  if (catalogue.empty()) throw Error("scenes: give the catalogue's parts");
  NewFolder output(
      folder, record_file,
      {"camera.json", "test_targets_bop19.json", models_folder, unknown_models_folder, split, unknown_split});
  Record record;
  record.options = options;
  record.parts = write_models(output.path() / models_folder, catalogue, symmetries_of);
  if (!unknown.empty())
    record.unknown_parts = write_models(output.path() / unknown_models_folder, unknown, symmetries_of);
  const bool has_unknown = !unknown.empty();

  const SceneGenerator generator(std::move(catalogue), std::move(unknown), options.scene);
  const SceneSensor sensor = make_scene_sensor(options.sensor);
  const BopCamera camera = BopCamera::of(options.scene.camera.intrinsics, options.depth_scale_mm);
  const auto per_scene = static_cast<std::size_t>(options.frames_per_scene);
  std::vector<BopImage> images(frames), unknown_images(frames);
  std::size_t done = 0;
  std::mutex progress_mutex;
  const auto scene_id = [&](std::size_t frame) { return static_cast<int>(frame / per_scene) + 1; };
  parallel_for(frames, [&](std::size_t frame) {
    const SyntheticScene scene = generator.generate(frame);
    const DepthImage measured = sensor(scene, options.scene.seed);
    const int im_id = static_cast<int>(frame % per_scene);
    write_bop_depth(bop_scene_folder(output.path(), split, scene_id(frame)), im_id, measured, options.depth_scale_mm);
    for (BopImage* image : {&images[frame], &unknown_images[frame]}) {
      image->id = im_id;
      image->camera = camera;
      image->camera.camera_from_world = scene.camera_from_table;
    }
    for (const auto& piece : scene.pieces) {
      if (piece.kind == ScenePiece::Kind::part)
        images[frame].ground_truths.push_back(ground_truth_of(piece, scene.intrinsics, measured));
      if (piece.kind == ScenePiece::Kind::unknown_part)
        unknown_images[frame].ground_truths.push_back(ground_truth_of(piece, scene.intrinsics, measured));
    }
    const std::lock_guard lock(progress_mutex);
    ++done;
    if (progress) progress("drawing frames", done, frames);
  });

  std::vector<BopScene> scenes;
  for (std::size_t begin = 0; begin < frames; begin += per_scene) {
    const auto end = static_cast<std::ptrdiff_t>(std::min(frames, begin + per_scene));
    const auto write = [&](const char* name, std::vector<BopImage>& all) {
      BopScene scene;
      scene.id = scene_id(begin);
      scene.folder = bop_scene_folder(output.path(), name, scene.id);
      scene.images.assign(std::make_move_iterator(all.begin() + static_cast<std::ptrdiff_t>(begin)),
                          std::make_move_iterator(all.begin() + end));
      write_bop_scene(scene);
      return scene;
    };
    scenes.push_back(write(split, images));
    if (has_unknown) write(unknown_split, unknown_images);
  }
  write_bop_targets(output.path(), bop_targets_of(scenes));
  write_bop_camera(output.path(), {options.scene.camera.intrinsics, options.depth_scale_mm});
  write_json(output.path() / record_file, record);
  output.finish();
}

SceneDataset read_scene_dataset(const fs::path& folder) {
  if (!fs::exists(folder / record_file))
    throw Error("{}: has no {}; make scenes with 'partpose scenes'", folder.string(), record_file);
  const Record record = read_json<Record>(folder / record_file);
  SceneDataset out;
  out.options = record.options;
  out.part_names = names_by_id(record.parts, folder / record_file);
  out.unknown_names = names_by_id(record.unknown_parts, folder / record_file);
  out.bop = read_bop_dataset(folder, split);
  for (const auto& [id, info] : out.bop.models)
    if (!out.part_names.contains(id)) throw Error("{}: names no part {}", (folder / record_file).string(), id);
  if (out.unknown_names.empty()) return out;
  for (const auto& [id, scene] : out.bop.scenes) {
    const auto& unknown = out.unknown[id] = read_bop_scene(bop_scene_folder(folder, unknown_split, id), id);
    for (const auto& image : unknown.images)
      for (const auto& truth : image.ground_truths)
        if (!out.unknown_names.contains(truth.obj_id))
          throw Error("{}: image {}: obj_id {} is not among the unknown parts of {}",
                      (unknown.folder / "scene_gt.json").string(), image.id, truth.obj_id, record_file);
  }
  return out;
}

}  // namespace partpose
