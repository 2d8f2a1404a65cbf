// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/scene.hpp"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace partpose::apps {

/// How the scenes are told.
struct SceneReading {
  std::filesystem::path camera;  ///< of all depth images; empty: each has its own beside it
  std::string units = "mm";      ///< of clouds: "mm" or "m"
};

/// Throws Error when a model stands among the scenes, as where a shell makes several words of --models *.stl: what was
/// meant for the catalogue would be missing there. Also when clouds' units are given, but no cloud.
void check_scenes(const SceneReading& reading, const std::vector<std::filesystem::path>& scenes);

/// Reads scenes. What looks wrong with them is said on standard error, of a camera once for each thing.
class SceneReader {
 public:
  explicit SceneReader(SceneReading reading = {}) : reading_(std::move(reading)) {}
  /// Throws Error as of read_scene.
  Scene read(const std::filesystem::path& path);

 private:
  void warn_once(const std::filesystem::path& path, const std::string& doubt);

  SceneReading reading_;
  std::set<std::string> said_;
};

}  // namespace partpose::apps
