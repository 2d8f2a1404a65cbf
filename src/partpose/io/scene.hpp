// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/point_cloud.hpp"

#include <filesystem>
#include <optional>

namespace partpose {

/// What a camera measured: a depth image with its camera, or a cloud (camera frame, the camera at the origin).
struct Scene {
  std::filesystem::path path;
  PointCloud cloud;                      ///< mm; of a depth image: its points
  std::optional<DepthImage> depth;       ///< of a depth image
  std::optional<Intrinsics> intrinsics;  ///< of a depth image
};

/// Reads a 16-bit depth PNG with its camera JSON (`camera_file_of`, or `camera_file` if not empty), or a PCD or PLY cloud
/// whose coordinates are multiplied by `unit_mm` (1000 for metres).
Scene read_scene(const std::filesystem::path& path, double unit_mm = 1, const std::filesystem::path& camera_file = {});

}  // namespace partpose
