// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.hpp"

#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/camera_json.hpp"
#include "partpose/io/model_files.hpp"

#include <fmt/format.h>

namespace partpose::apps {

void check_scenes(const SceneReading& reading, const std::vector<std::filesystem::path>& scenes) {
  bool any_cloud = scenes.empty();
  for (const auto& scene : scenes) {
    const std::string ending = lower_case_ending(scene);
    if (ending != ".ply" && is_model_file(scene))
      throw Error(
          "{}: is a model of a part, not a scene; --models takes one file or folder: repeat it for each model, or name "
          "their folder",
          scene.string());
    any_cloud |= ending != ".png";
  }
  if (reading.units == "m" && !any_cloud)
    throw Error("--units m is of clouds; a depth image's unit is the depth_scale_mm of its camera");
}

Scene SceneReader::read(const std::filesystem::path& path) {
  Scene scene = read_scene(path, reading_.units == "m" ? 1000 : 1, reading_.camera);
  if (!scene.depth) {
    if (scene.cloud.empty())
      complain(fmt::format("{}: is empty, it has no points", path.string()));
    else if (without_missing(scene.cloud).empty())
      complain(fmt::format("{}: is empty, all of its {} points are NaN", path.string(), scene.cloud.size()));
    return scene;
  }
  if (const std::string doubt = doubt_about(*scene.intrinsics); !doubt.empty())
    warn_once(path, "its camera looks wrong: " + doubt);
  return scene;
}

void SceneReader::warn_once(const std::filesystem::path& path, const std::string& doubt) {
  if (said_.insert(doubt).second) complain(fmt::format("{}: {}", path.string(), doubt));
}

}  // namespace partpose::apps
