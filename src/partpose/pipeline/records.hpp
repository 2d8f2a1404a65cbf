// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <vector>

/// The output files of appendix C.2 of the reference, key by key.
namespace partpose {

/// C.2.2. Nothing recognized is candidate_id -1, with an empty model_name and the identity.
struct Result {
  Eigen::Isometry3d T_final = Eigen::Isometry3d::Identity();
  int candidate_id = -1;
  bool icp_converged = false;
  float icp_fitness = -1;
  float match_distance = -1;
  int model_id = -1;
  std::string model_name;
  std::string timestamp;
  int view_id = -1;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("T_final", self.T_final, "camera_from_model, 4x4 [mm]");
    visit("candidate_id", self.candidate_id, "-1: nothing recognized");
    visit("icp_converged", self.icp_converged, "whether the refinement converged");
    visit("icp_fitness", self.icp_fitness,
          "mean distance of scene and candidate [mm]; of the Recognizer: root mean square, point to plane");
    visit("match_distance", self.match_distance, "L1 distance of the descriptors");
    visit("model_id", self.model_id, "the part");
    visit("model_name", self.model_name, "the part");
    visit("timestamp", self.timestamp, "names the iteration's folder");
    visit("view_id", self.view_id, "the view that matched");
  }
};

struct CandidateExtras {
  Eigen::Isometry3d T_1 = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_2 = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_3 = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_4 = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_final = Eigen::Isometry3d::Identity();
  bool icp_converged = false;
  float icp_fitness = -1;
  int id = -1;
  float match_distance = -1;
  int model_id = -1;
  std::string model_name;
  int num_of_points = 0;
  int num_of_points_refinement = 0;
  int view_id = -1;
  float score = -1;
  std::string verdict;
  std::string mesh;
  std::optional<int> visible_model_points, unexplained_model_points, scene_points, explained_scene_points;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("T_1", self.T_1, "centred_from_model, 4x4 [mm]");
    visit("T_2", self.T_2, "camera_from_centred, 4x4 [mm]");
    visit("T_3", self.T_3, "coarse alignment, 4x4 [mm]");
    visit("T_4", self.T_4, "refinement, 4x4 [mm]");
    visit("T_final", self.T_final, "T_4 T_3 T_2 T_1 = camera_from_model, 4x4 [mm]");
    visit("icp_converged", self.icp_converged, "whether the refinement converged");
    visit("icp_fitness", self.icp_fitness,
          "mean distance of scene and candidate [mm]; of the Recognizer: root mean square, point to plane");
    visit("id", self.id, "rank before the last sorting");
    visit("match_distance", self.match_distance, "L1 distance of the descriptors");
    visit("model_id", self.model_id, "the part");
    visit("model_name", self.model_name, "the part");
    visit("num_of_points", self.num_of_points, "of the view in the dataset");
    visit("num_of_points_refinement", self.num_of_points_refinement, "of the view in the refinement");
    visit("view_id", self.view_id, "the view");
    visit("score", self.score, "how well model and scene explain each other, 0 to 1; -1: not looked at");
    visit("verdict", self.verdict, "\"accepted\", or why not");
    visit("mesh", self.mesh, "the part's mesh, relative to the output folder; empty: not saved");
    visit("visible_model_points", self.visible_model_points, "of the part's surface in the greedy verification");
    visit("unexplained_model_points", self.unexplained_model_points, "of them: no scene point is near");
    visit("scene_points", self.scene_points, "of the thinned scene in the greedy verification");
    visit("explained_scene_points", self.explained_scene_points, "of them: near the part's visible surface");
  }
};

struct SceneExtras {
  int num_of_points_input = 0;
  int num_of_points_normal_estimation = 0;
  int num_of_points_refinement = 0;
  int num_of_points_normals = 0;
  float input_unit_mm = 1;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("num_of_points_input", self.num_of_points_input, "as it came");
    visit("num_of_points_normal_estimation", self.num_of_points_normal_estimation, "after the preprocessing");
    visit("num_of_points_refinement", self.num_of_points_refinement, "in the refinement");
    visit("num_of_points_normals", self.num_of_points_normals, "that have a normal");
    visit("input_unit_mm", self.input_unit_mm, "length of one unit of scene_original.ply [mm]");
  }
};

struct MeasuredOperation {
  double measure_ms = 0;
  std::string tag;
  std::optional<int> points_in = {}, points_out = {};

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("measure_ms", self.measure_ms, "wall-clock time [ms]");
    visit("tag", self.tag, "the step");
    visit("points_in", self.points_in, "of the scene, that the step was given");
    visit("points_out", self.points_out, "of the scene, that it left");
  }
};

/// C.2.3, and beside it what a report of the frame says.
struct Extras {
  std::vector<CandidateExtras> candidate_extras;  ///< in the order of the decision
  SceneExtras scene_extras;
  std::vector<MeasuredOperation> time_profiling;
  std::string timestamp;
  std::string scene;
  std::string reason;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("candidate_extras", self.candidate_extras, "in the order of the verification");
    visit("scene_extras", self.scene_extras, "the scene");
    visit("time_profiling", self.time_profiling, "each step");
    visit("timestamp", self.timestamp, "names the iteration's folder");
    visit("scene", self.scene, "the file that the scene was read from; empty: none");
    visit("reason", self.reason, "why nothing was recognized; empty when something was");
  }
};

/// C.2.4, and beside it figures that know the part's symmetries; they are absent where they were not taken.
struct Evaluation {
  int ground_truth_model_id = -1;
  std::string ground_truth_model_name;
  Eigen::Isometry3d ground_truth_transformation_matrix = Eigen::Isometry3d::Identity();
  int ground_truth_view_id = -1;
  std::string timestamp;
  bool recognized_correctly = false;
  float rotation_error_deg = -1;
  float translation_error_mm = -1;
  std::optional<float> diameter_mm, add_mm, adi_mm, mssd_mm, mspd_px, vsd;
  std::optional<bool> indistinguishable;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("ground_truth_model_id", self.ground_truth_model_id, "-1 when the scene is not of a dataset");
    visit("ground_truth_model_name", self.ground_truth_model_name, "the part that was shown; empty: none of them");
    visit("ground_truth_transformation_matrix", self.ground_truth_transformation_matrix, "camera_from_model, 4x4 [mm]");
    visit("ground_truth_view_id", self.ground_truth_view_id, "-1 when the scene is not of a dataset");
    visit("timestamp", self.timestamp, "names the iteration's folder");
    visit("recognized_correctly", self.recognized_correctly, "whether the result names the part shown");
    visit("rotation_error_deg", self.rotation_error_deg, "eq. 2.2 [deg], -1 when the part is not the one shown");
    visit("translation_error_mm", self.translation_error_mm, "eq. 2.3 [mm], -1 when the part is not the one shown");
    visit("diameter_mm", self.diameter_mm, "of the part shown: largest distance of two vertices [mm]");
    visit("add_mm", self.add_mm, "ADD [mm], symmetry ignored");
    visit("adi_mm", self.adi_mm, "ADI [mm]");
    visit("mssd_mm", self.mssd_mm, "MSSD [mm], up to the part's symmetries");
    visit("mspd_px", self.mspd_px, "MSPD [px of an image 640 px wide], up to the part's symmetries");
    visit("vsd", self.vsd, "VSD, 0 to 1, mean over the ten taus of BOP");
    visit("indistinguishable", self.indistinguishable,
          "whether this camera cannot tell the result, part and pose, from the truth");
  }
};

}  // namespace partpose
