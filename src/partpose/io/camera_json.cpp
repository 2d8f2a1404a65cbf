// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/camera_json.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/foreign_camera.hpp"
#include "partpose/io/json.hpp"

#include <cmath>

namespace partpose {

void CameraFile::check() const {
  intrinsics.check();
  if (!(depth_scale_mm > 0) || !std::isfinite(depth_scale_mm))
    throw Error("depth_scale_mm {}: must be positive", depth_scale_mm);
  if (baseline_mm && (!(*baseline_mm > 0) || !std::isfinite(*baseline_mm)))
    throw Error("baseline_mm {}: must be positive", *baseline_mm);
}

CameraFile read_camera(const std::filesystem::path& path) {
  const Json json = read_json_file(path);
  try {
    return from_json<CameraFile>(json);
  } catch (const Error& error) {
    const std::string hint = foreign_camera_hint(json);
    throw Error("{}: {}{}{}", path.string(), error.what(), hint.empty() ? "" : "; ", hint);
  }
}

void write_camera(const std::filesystem::path& path, const CameraFile& camera) { write_json(path, camera); }

std::filesystem::path camera_file_of(const std::filesystem::path& depth_image) {
  auto own = depth_image;
  own.replace_extension(".camera.json");
  const auto shared = depth_image.parent_path() / "camera.json";
  if (std::filesystem::exists(own)) return own;
  if (std::filesystem::exists(shared)) return shared;
  throw Error("{}: no camera found; give it as {} or {}, or name it (--camera)", depth_image.string(), own.string(),
              shared.string());
}

}  // namespace partpose
