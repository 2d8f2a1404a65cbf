// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/foreign_camera.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace partpose {

namespace {

struct ForeignKey {
  const char* name;
  const char* program;
};

/// What tells a program's files from ours, the surest first.
constexpr std::array foreign_keys = {
    ForeignKey{"ppx", "RealSense"},
    ForeignKey{"ppy", "RealSense"},
    ForeignKey{"intrinsic_matrix", "Open3D"},
    ForeignKey{"camera_matrix", "OpenCV"},
    ForeignKey{"cameraMatrix", "OpenCV"},
    ForeignKey{"cam_K", "BOP"},
    ForeignKey{"K", "ROS"},
    ForeignKey{"k", "ROS"},
    ForeignKey{"coeffs", "RealSense"},
    ForeignKey{"depth_scale", "BOP or RealSense"},
};

/// The key's number, if it is one.
std::optional<double> number(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_number() ? std::optional(it->get<double>()) : std::nullopt;
}

std::optional<double> first_number(const Json& json, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (const auto value = number(json, key)) return value;
  return {};
}

/// All numbers of nested arrays, in their order; of {"data": [...]} those of its data.
void append_numbers(const Json& json, std::vector<double>& out) {
  if (json.is_number()) out.push_back(json.get<double>());
  if (json.is_array())
    for (const auto& item : json) append_numbers(item, out);
  if (json.is_object() && json.contains("data")) append_numbers(json["data"], out);
}

std::vector<double> numbers(const Json& json, const char* key) {
  std::vector<double> out;
  if (const auto it = json.find(key); it != json.end()) append_numbers(*it, out);
  return out;
}

struct Pinhole {
  std::optional<double> fx, fy, cx, cy;
};

/// Of a 3x3 matrix: the principal point is in its last column, where a matrix that is stored by columns ends.
Pinhole pinhole_of_matrix(const std::vector<double>& m) {
  const bool by_columns = m[2] == 0 && m[5] == 0;
  return {m[0], m[4], by_columns ? m[6] : m[2], by_columns ? m[7] : m[5]};
}

Pinhole pinhole_of(const Json& json) {
  for (const char* key : {"intrinsic_matrix", "camera_matrix", "cameraMatrix", "cam_K", "K", "k"})
    if (const auto matrix = numbers(json, key); matrix.size() == 9) return pinhole_of_matrix(matrix);
  return {number(json, "fx"), number(json, "fy"), first_number(json, {"cx", "ppx"}), first_number(json, {"cy", "ppy"})};
}

/// In metres a unit is a thousandth or less, in mm a hundredth or more.
std::optional<double> depth_scale_mm(const Json& json) {
  if (const auto own = number(json, "depth_scale_mm")) return own;
  const auto scale = number(json, "depth_scale");
  if (scale && *scale > 0 && *scale < 0.01) return *scale * 1000;
  return scale && *scale >= 0.01 && *scale <= 10 ? scale : std::nullopt;
}

bool has_distortion(const Json& json) {
  for (const char* key : {"coeffs", "D", "d", "dist_coeffs", "distCoeffs", "distortion_coefficients"}) {
    const auto values = numbers(json, key);
    if (std::any_of(values.begin(), values.end(), [](double value) { return value != 0; })) return true;
  }
  return false;
}

/// The camera itself, or what a program puts around it.
const Json& camera_in(const Json& json) {
  for (const char* key : {"intrinsic", "intrinsics", "depth"})
    if (const auto it = json.find(key); it != json.end() && it->is_object()) return *it;
  return json;
}

}  // namespace

std::string foreign_camera_hint(const Json& json) {
  if (!json.is_object()) return {};
  const Json& camera = camera_in(json);
  const auto key = std::find_if(foreign_keys.begin(), foreign_keys.end(),
                                [&](const ForeignKey& foreign) { return camera.contains(foreign.name); });
  if (key == foreign_keys.end()) return {};
  const auto text = [](const std::optional<double>& value) { return value ? fmt::format("{}", *value) : "..."; };
  const Pinhole pinhole = pinhole_of(camera);
  std::string hint = fmt::format(
      "it looks like a file of {}; write {{\"width\": {}, \"height\": {}, \"fx\": {}, \"fy\": {}, \"cx\": {}, \"cy\": "
      "{}, "
      "\"depth_scale_mm\": {}}}, the last being the length of one unit of the depth image",
      key->program, text(first_number(camera, {"width", "image_width"})),
      text(first_number(camera, {"height", "image_height"})), text(pinhole.fx), text(pinhole.fy), text(pinhole.cx),
      text(pinhole.cy), text(depth_scale_mm(camera)));
  if (has_distortion(camera)) hint += "; its distortion is not taken into account: depth images must be undistorted";
  return hint;
}

}  // namespace partpose
