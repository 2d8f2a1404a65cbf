// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.hpp"

#include "terminal.hpp"

#include "partpose/io/camera_json.hpp"

#include <fmt/format.h>

namespace partpose::apps {

Scene SceneReader::read(const std::filesystem::path& path) {
  Scene scene = read_scene(path, reading_.units == "m" ? 1000 : 1, reading_.camera);
  if (!scene.depth) return scene;
  if (const std::string doubt = doubt_about(*scene.intrinsics); !doubt.empty())
    warn_once(path, "its camera looks wrong: " + doubt);
  if (reading_.units == "m")
    warn_once(path, "--units m is of clouds; a depth image's unit is the depth_scale_mm of its camera");
  return scene;
}

void SceneReader::warn_once(const std::filesystem::path& path, const std::string& doubt) {
  if (said_.insert(doubt).second) complain(fmt::format("{}: {}", path.string(), doubt));
}

}  // namespace partpose::apps
