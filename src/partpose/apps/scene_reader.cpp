// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.hpp"

#include "terminal.hpp"

#include "partpose/io/camera_json.hpp"

#include <fmt/format.h>

namespace partpose::apps {

Scene SceneReader::read(const std::filesystem::path& path) {
  Scene scene = read_scene(path, reading_.units == "m" ? 1000 : 1, reading_.camera);
  if (scene.intrinsics) warn(path, doubt_about(*scene.intrinsics));
  return scene;
}

void SceneReader::warn(const std::filesystem::path& path, const std::string& doubt) {
  if (doubt.empty() || !said_.insert(doubt).second) return;
  complain(fmt::format("{}: its camera looks wrong: {}", path.string(), doubt));
}

}  // namespace partpose::apps
