// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/camera_json.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/foreign_camera.hpp"
#include "partpose/io/json.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace partpose {

namespace {

/// How many times as large an image would be whose middle the principal point is.
Eigen::Array2d size_about_principal_point(const Intrinsics& camera) {
  return (2 * Eigen::Array2d(camera.cx, camera.cy) + 1) / Eigen::Array2d(camera.width, camera.height);
}

/// Real principal points are some hundredths of the image off its middle: these are by far nearer to another one's.
bool is_swapped(const Intrinsics& camera) {
  if (std::abs(camera.width - camera.height) < 0.12 * std::max(camera.width, camera.height)) return false;
  Intrinsics turned = camera;
  std::swap(turned.width, turned.height);
  const Eigen::Array2d off = (size_about_principal_point(camera) - 1).abs();
  const Eigen::Array2d off_turned = (size_about_principal_point(turned) - 1).abs();
  return (off_turned < 0.06).all() && (off_turned < 0.25 * off).all();
}

/// A window cut out of an image has its principal point anywhere, but hardly ever on the diagonal.
bool is_of_another_resolution(const Intrinsics& camera) {
  const Eigen::Array2d size = size_about_principal_point(camera);
  return std::abs(size.x() - size.y()) < 0.03 * size.maxCoeff() && (size.minCoeff() > 1.4 || size.maxCoeff() < 0.7);
}

}  // namespace

std::string doubt_about(const Intrinsics& camera) {
  const auto middle_of = [&](double width, double height, const char* question) {
    return fmt::format("cx {:g} and cy {:g} are the middle of {:.0f} x {:.0f} px, the image is {} x {} px: {}",
                       camera.cx, camera.cy, width, height, camera.width, camera.height, question);
  };
  if (is_swapped(camera)) return middle_of(camera.height, camera.width, "are they swapped?");
  if (is_of_another_resolution(camera))
    return middle_of(2 * camera.cx + 1, 2 * camera.cy + 1, "are the intrinsics of another resolution?");
  const double ratio = camera.fx / camera.fy;
  if (ratio > 2.5 || ratio < 1 / 2.5)
    return fmt::format("fx {:g} and fy {:g} differ more than pixels' sides do", camera.fx, camera.fy);
  const double field_of_view_deg = 2 * std::atan(camera.width / (2 * camera.fx)) * 180 / std::numbers::pi;
  if (field_of_view_deg > 145 || field_of_view_deg < 0.5)
    return fmt::format("fx {:g} px makes a field of view of {:.3g} deg: is it in another unit?", camera.fx,
                       field_of_view_deg);
  return {};
}

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
    std::string hint = foreign_camera_hint(json);
    if (hint.empty() && std::string_view(error.what()).find("\"depth_scale_mm\" is missing") != std::string_view::npos)
      hint = "write \"depth_scale_mm\": 1 where one unit of the depth image is 1 mm, 0.1 where it is 0.1 mm";
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
