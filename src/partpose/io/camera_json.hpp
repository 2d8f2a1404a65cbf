// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace partpose {

/// What a camera JSON says: {"width", "height", "fx", "fy", "cx", "cy", "depth_scale_mm"}, all in px but the last; and,
/// for a stereo camera, perhaps "baseline_mm".
struct CameraFile {
  Intrinsics intrinsics;
  double depth_scale_mm = 1;          ///< mm for each unit of the depth image
  std::optional<double> baseline_mm;  ///< between a stereo camera's imagers

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("width", self.intrinsics.width, "image width [px]");
    visit("height", self.intrinsics.height, "image height [px]");
    visit("fx", self.intrinsics.fx, "focal length in x [px]");
    visit("fy", self.intrinsics.fy, "focal length in y [px]");
    visit("cx", self.intrinsics.cx, "principal point in x [px], pixel centres at integers");
    visit("cy", self.intrinsics.cy, "principal point in y [px], pixel centres at integers");
    visit("depth_scale_mm", self.depth_scale_mm, "length of one unit of the depth image [mm]");
    visit("baseline_mm", self.baseline_mm, "distance between a stereo camera's imagers [mm]");
  }
  void check() const;
};

CameraFile read_camera(const std::filesystem::path& path);
void write_camera(const std::filesystem::path& path, const CameraFile& camera);

/// For people: what of a camera is hardly ever so (swapped or rescaled principal point, focal lengths in another unit),
/// a window cut out of an image being ordinary. Empty: nothing.
std::string doubt_about(const Intrinsics& camera);

/// The camera of `NAME.png`: `NAME.camera.json` beside it, or else `camera.json` in its folder.
/// Throws Error naming both when neither exists.
std::filesystem::path camera_file_of(const std::filesystem::path& depth_image);

}  // namespace partpose
