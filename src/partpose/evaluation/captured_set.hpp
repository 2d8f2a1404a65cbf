// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"

#include <Eigen/Geometry>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace partpose {

/// One object in a scene of a set, or none (`model_name` empty: the scene shows none of the set's models).
struct CapturedScene {
  std::filesystem::path path;
  std::string kind;        ///< "object_only", "with_table", "full_frame" or "instance"
  std::string model_name;
  std::vector<Eigen::Isometry3d> camera_from_model;  ///< all equivalent poses, mm
};

/// Scenes with ground truth: a folder with models/*.stl, gt.json and, if it likes, symmetries.json. gt.json lists
/// {"scenes": [{"scene", "kind", "model", "T", "T_refined"}]}, T_refined before T where both are there; symmetries.json has
/// for each model the keys of a BOP models_info.json.
struct CapturedSet {
  std::filesystem::path folder;
  std::vector<CapturedScene> scenes;
  std::map<std::string, std::vector<Eigen::Isometry3d>> symmetries;  ///< model_from_model, the identity first
};

/// Throws Error naming file and key.
CapturedSet read_captured_set(const std::filesystem::path& folder);

/// How far a pose is from the nearest of the equivalent ones.
struct SymmetricPoseError {
  double rotation_deg = 0;
  double translation_mm = 0;
  double largest_displacement_mm = 0;  ///< of a corner of the model's bounding box; the nearest pose is that of the least
};

/// `symmetries` holds the identity at least.
SymmetricPoseError symmetric_pose_error(const Eigen::Isometry3d& camera_from_model,
                                        const std::vector<Eigen::Isometry3d>& truth,
                                        const std::vector<Eigen::Isometry3d>& symmetries,
                                        const Eigen::AlignedBox3d& model_box);

}  // namespace partpose
