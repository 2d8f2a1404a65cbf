// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/scene.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/camera_json.hpp"
#include "partpose/io/cloud.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/png.hpp"

#include <fmt/ranges.h>

#include <set>

namespace partpose {

namespace {

namespace fs = std::filesystem;

const std::set<std::string> scene_endings = {".pcd", ".ply", ".png"};

/// PLY files are scenes as well: a scanner may write them.
bool is_model_alone(const fs::path& file) {
  return !scene_endings.contains(lower_case_ending(file)) && is_model_file(file);
}

/// Of a folder that is given as a scene: what to give instead.
std::string scenes_or_models_of(const fs::path& folder) {
  std::set<std::string> patterns;
  bool has_models = false;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string ending = lower_case_ending(entry.path());
    has_models |= is_model_alone(entry.path());
    if (scene_endings.contains(ending))
      patterns.insert((folder / fmt::format("*{}", entry.path().extension().string())).string());
  }
  if (!patterns.empty()) return fmt::format("a scene is a file; give its files: {}", fmt::join(patterns, " "));
  return has_models ? "it holds models, which are given with --models" : "a file is needed";
}

/// Throws Error unless the file's kind is one of a scene's: it may be what another argument is meant for.
void check_is_scene(const fs::path& path, const std::string& ending) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw Error("{}: is a folder, {}", path.string(), scenes_or_models_of(path));
  check_is_file(path);
  if (is_model_alone(path))
    throw Error(
        "{}: is a model of a part, not a scene; models are given with --models, which takes one file or folder each "
        "time",
        path.string());
  if (!scene_endings.contains(ending))
    throw Error("{}: a scene is a .png (16-bit depth), .pcd or .ply file", path.string());
}

}  // namespace

Scene read_scene(const std::filesystem::path& path, double unit_mm, const std::filesystem::path& camera_file) {
  const std::string extension = lower_case_ending(path);
  check_is_scene(path, extension);
  Scene scene;
  scene.path = path;
  if (extension != ".png") {
    scene.cloud = read_cloud(path);
    for (auto& p : scene.cloud.points) p *= static_cast<float>(unit_mm);
    return scene;
  }
  if (is_picture_png(path))  // of which not the camera is missing
    throw Error("{}: is a picture (8-bit or in colours), not a depth image: that is a 16-bit greyscale PNG",
                path.string());
  const auto camera_path = camera_file.empty() ? camera_file_of(path) : camera_file;
  const CameraFile camera = read_camera(camera_path);
  scene.depth = read_depth_png(path, camera.depth_scale_mm);
  scene.intrinsics = camera.intrinsics;
  if (scene.depth->width != camera.intrinsics.width || scene.depth->height != camera.intrinsics.height)
    throw Error("{}: is {} x {} px, its camera {} says {} x {} px", path.string(), scene.depth->width,
                scene.depth->height, camera_path.string(), camera.intrinsics.width, camera.intrinsics.height);
  scene.cloud = to_point_cloud(*scene.depth, *scene.intrinsics);
  return scene;
}

}  // namespace partpose
