// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/stereo_sensor.hpp"
#include "partpose/core/progress.hpp"
#include "partpose/io/bop.hpp"
#include "partpose/synthesis/synthetic_scene.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace partpose {

/// The sensor that takes the frames.
struct SceneSensorOptions {
  std::string model = "stereo";
  double standard_deviation_mm = 1;
  StereoSensorOptions stereo;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("model", self.model,
          "\"none\", \"gaussianray\" (independent noise along the line of sight) or \"stereo\" (like a D415)");
    visit("standard_deviation_mm", self.standard_deviation_mm, "of \"gaussianray\" [mm], >= 0");
    visit("stereo", self.stereo, "the disturbances of \"stereo\"");
  }
  void check() const;
};

/// The sensor of that model. Throws Error for an unknown one.
SceneSensor make_scene_sensor(const SceneSensorOptions& options);

/// All that the frames of a dataset depend on, beside the parts.
struct SceneDatasetOptions {
  SceneOptions scene;
  SceneSensorOptions sensor;
  double depth_scale_mm = 0.1;
  int frames_per_scene = 1000;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("scene", self.scene, "what is on the table, and where the camera stands");
    visit("sensor", self.sensor, "what the sensor does to the depth");
    visit("depth_scale_mm", self.depth_scale_mm, "length of one unit of the depth images [mm], > 0");
    visit("frames_per_scene", self.frames_per_scene, "so many frames go into one scene folder, 1 to 1000000");
  }
  void check() const;
};

/// A BOP dataset with what BOP has no place for.
struct SceneDataset {
  BopDataset bop;
  SceneDatasetOptions options;               ///< as it was made
  std::map<int, std::string> part_names;     ///< by obj_id
  std::map<int, std::string> unknown_names;  ///< by the obj_id of `unknown`
  std::map<int, BopScene> unknown;           ///< by scene_id: where parts are that are not in the catalogue
};

/// The symmetries of a part for models_info.json.
using SymmetriesOf = std::function<Symmetries(const TriangleMesh& mesh)>;

/// Draws frames 0 to `frames` - 1 and writes them as a BOP dataset, split "test":
///
///     camera.json, models/, test/000001/..., test_targets_bop19.json   as BOP has them; obj_id 1 is the first part
///     scenes.json                          the options, and the parts' names by obj_id
///     models_unknown/obj_000001.ply, ...   parts that are not in the catalogue
///     unknown/000001/scene_gt.json, ...    where they are in the frames of test/000001, in the same form
///
/// World is the table (z = 0 its top, z up). A visibility is that of the frame without noise. The folder is written
/// beside `folder` and renamed. An older scene dataset there is replaced; anything else there is an Error. The same
/// input gives the same bytes, for any number of threads. Throws Error for no frames, and for options that cannot be
/// met.
void write_scene_dataset(std::vector<ScenePart> catalogue, std::vector<ScenePart> unknown,
                         const SceneDatasetOptions& options, std::size_t frames, const std::filesystem::path& folder,
                         const SymmetriesOf& symmetries_of = {}, const Progress& progress = {});

/// Throws Error when the folder is no dataset that write_scene_dataset wrote, or is damaged.
SceneDataset read_scene_dataset(const std::filesystem::path& folder);

}  // namespace partpose
