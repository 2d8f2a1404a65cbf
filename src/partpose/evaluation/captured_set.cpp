// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/captured_set.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/io/json.hpp"

#include <limits>
#include <numbers>

namespace partpose {

namespace {

namespace fs = std::filesystem;

const Json& member(const Json& object, const char* key, const fs::path& file) {
  if (!object.is_object() || !object.contains(key)) throw Error("{}: key \"{}\" is missing", file.string(), key);
  return object[key];
}

std::string text(const Json& object, const char* key, const fs::path& file) {
  const Json& value = member(object, key, file);
  if (value.is_null()) return {};
  if (!value.is_string()) throw Error("{}: key \"{}\": expected a string or null", file.string(), key);
  return value.get<std::string>();
}

std::vector<Eigen::Isometry3d> poses(const Json& json, const fs::path& file) {
  try {
    // Written with few digits: made exactly rigid.
    std::vector<Eigen::Isometry3d> out = from_json<std::vector<Eigen::Isometry3d>>(json);
    for (auto& pose : out) pose = nearest_rigid(pose.matrix());
    return out;
  } catch (const Error& error) {
    throw Error("{}: poses: {}", file.string(), error.what());
  }
}

/// The discrete symmetries, and each turned about each continuous axis in steps of two degrees.
std::vector<Eigen::Isometry3d> read_symmetries(const Json& info, const fs::path& file) {
  std::vector<Eigen::Isometry3d> discrete = {Eigen::Isometry3d::Identity()};
  try {
    if (info.contains("symmetries_discrete")) {
      for (const auto& values : from_json<std::vector<std::array<double, 16>>>(info["symmetries_discrete"])) {
        Eigen::Matrix4d matrix;
        for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = values[i];
        discrete.push_back(nearest_rigid(matrix));
      }
    }
    std::vector<Eigen::Isometry3d> all = discrete;
    if (info.contains("symmetries_continuous")) {
      for (const auto& axis : info["symmetries_continuous"]) {
        const auto direction = from_json<std::array<double, 3>>(member(axis, "axis", file));
        const auto offset = from_json<std::array<double, 3>>(member(axis, "offset", file));
        const Eigen::Vector3d unit = Eigen::Vector3d(direction.data()).normalized();
        const Eigen::Translation3d to_axis{Eigen::Vector3d(offset.data())};
        constexpr int steps = 180;
        for (int k = 1; k < steps; ++k) {
          const Eigen::Isometry3d turn = to_axis * Eigen::AngleAxisd(2 * std::numbers::pi * k / steps, unit) * to_axis.inverse();
          for (const auto& symmetry : discrete) all.push_back(turn * symmetry);
        }
      }
    }
    return all;
  } catch (const Error& error) {
    throw Error("{}: {}", file.string(), error.what());
  }
}

}  // namespace

CapturedSet read_captured_set(const fs::path& folder) {
  CapturedSet set{folder, {}, {}};
  const fs::path truth_file = folder / "gt.json";
  const Json truth = read_json_file(truth_file);
  for (const auto& entry : member(truth, "scenes", truth_file)) {
    const bool refined = entry.contains("T_refined") && !entry["T_refined"].empty();
    set.scenes.push_back({folder / text(entry, "scene", truth_file), text(entry, "kind", truth_file),
                          text(entry, "model", truth_file),
                          poses(member(entry, refined ? "T_refined" : "T", truth_file), truth_file)});
    if (!set.scenes.back().model_name.empty() && set.scenes.back().camera_from_model.empty())
      throw Error("{}: scene {} names a model but no pose", truth_file.string(), set.scenes.back().path.filename().string());
  }
  const fs::path symmetry_file = folder / "symmetries.json";
  if (fs::exists(symmetry_file)) {
    const Json symmetries = read_json_file(symmetry_file);
    for (const auto& [name, info] : symmetries.items()) set.symmetries[name] = read_symmetries(info, symmetry_file);
  }
  return set;
}

SymmetricPoseError symmetric_pose_error(const Eigen::Isometry3d& camera_from_model,
                                        const std::vector<Eigen::Isometry3d>& truth,
                                        const std::vector<Eigen::Isometry3d>& symmetries,
                                        const Eigen::AlignedBox3d& model_box) {
  SymmetricPoseError best;
  best.largest_displacement_mm = std::numeric_limits<double>::infinity();
  for (const auto& pose : truth) {
    for (const auto& symmetry : symmetries) {
      const Eigen::Isometry3d equivalent = pose * symmetry;
      double largest = 0;
      for (int c = 0; c < 8; ++c) {
        const Eigen::Vector3d corner = model_box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c));
        largest = std::max(largest, (camera_from_model * corner - equivalent * corner).norm());
      }
      if (largest < best.largest_displacement_mm)
        best = {rotation_error_deg(camera_from_model, equivalent), translation_error_mm(camera_from_model, equivalent), largest};
    }
  }
  return best;
}

}  // namespace partpose
