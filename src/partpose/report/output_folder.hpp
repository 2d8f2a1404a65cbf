// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/progress.hpp"

#include <Eigen/Geometry>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace partpose {

/// How a frame came out.
enum class Verdict {
  correct,  ///< the part that was shown, or rightly none
  wrong,    ///< another part than shown, or a part where there is none
  none,     ///< nothing recognized, but a part was shown
  found,    ///< a part recognized; what was shown is not known
  nothing   ///< nothing recognized; what was shown is not known
};
const char* name_of(Verdict verdict);

struct SavedCandidate {
  int id = -1;
  std::string model_name;
  int view_id = -1;
  Eigen::Isometry3d coarse = Eigen::Isometry3d::Identity();             ///< camera_from_model before T4
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();  ///< final
  std::optional<Eigen::Isometry3d> centred_from_model;                  ///< T1
  std::optional<double> score, icp_fitness, match_distance;
  std::optional<bool> icp_converged;
  std::optional<int> points, points_refinement;
  std::optional<int> visible_model_points, unexplained_model_points, scene_points, explained_scene_points;
  std::string verdict;
  std::filesystem::path mesh;   ///< existing file; empty: not saved
  std::filesystem::path cloud;  ///< candidate_N.ply; empty: not saved
};

/// An object that was recognized.
struct SavedDetection {
  std::string model_name;
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  std::optional<double> score, confidence;
  std::filesystem::path mesh;  ///< existing file; empty: not saved
};

struct SavedStep {
  std::string tag;
  double ms = 0;
  std::optional<int> points_in, points_out;
};

struct SavedTruth {
  std::string model_name;  ///< empty: none of the parts
  bool left_out = false;   ///< the part was taken out of the catalogue: nothing should be recognized
  std::optional<Eigen::Isometry3d> camera_from_model;
};

/// What an output folder has saved of one frame. What was not saved is not set, or empty.
struct SavedFrame {
  std::string name, run, protocol, descriptor;
  std::string scene;             ///< the file that was recognized
  std::filesystem::path folder;  ///< the iteration folder; empty: none was kept
  std::optional<SavedTruth> truth;
  std::string model_name;  ///< the result's; empty: nothing recognized
  std::optional<int> candidate_id;
  std::optional<Eigen::Isometry3d> camera_from_model;  ///< the result's
  std::map<std::string, double> figures;               ///< every number of the evaluation, by its key
  std::map<std::string, bool> flags;                   ///< what it answers with yes or no
  Verdict verdict = Verdict::nothing;
  std::string reason;                      ///< why nothing was recognized
  std::vector<SavedCandidate> candidates;  ///< in the order of the decision
  std::vector<SavedDetection> detections;  ///< the result first; empty: not saved, or the recognizer knows none
  bool has_extras = false;
  std::vector<SavedStep> steps;
  std::optional<double> time_ms;
  std::optional<double> best_score;   ///< of the best candidate, accepted or not
  std::optional<bool> best_is_right;  ///< whether that candidate names the part shown
  double input_unit_mm = 1;           ///< of scene_original.ply
  std::filesystem::path input, preprocessed, with_normals, depth, depth_camera, result_cloud,
      config;  ///< existing, or empty
};

struct OutputFolder {
  std::filesystem::path folder;
  std::vector<SavedFrame> frames;
  bool experiment = false;            ///< it holds a frames.jsonl
  std::vector<std::string> problems;  ///< files that could not be read, one line each
};

/// Reads whatever partpose wrote below `folder`: iteration folders (they hold a result.json) wherever they are, and
/// frames.jsonl of experiments, whose lines may name an iteration folder. A broken file is noted in `problems` and does
/// not hide the rest. Throws Error when there is no such folder, or no frame in it.
OutputFolder read_output_folder(const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace partpose
