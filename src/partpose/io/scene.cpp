// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/scene.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/camera_json.hpp"
#include "partpose/io/cloud.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/png.hpp"

#include <algorithm>
#include <cctype>

namespace partpose {

Scene read_scene(const std::filesystem::path& path, double unit_mm, const std::filesystem::path& camera_file) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
  Scene scene;
  scene.path = path;
  if (extension != ".png") {
    scene.cloud = read_cloud(path);
    for (auto& p : scene.cloud.points) p *= static_cast<float>(unit_mm);
    return scene;
  }
  check_is_file(path);
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
