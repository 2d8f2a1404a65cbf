// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/descriptors.hpp"
#include "partpose/preprocess/preprocess.hpp"
#include "partpose/registration/coarse_alignment.hpp"
#include "partpose/registration/icp.hpp"
#include "partpose/verification/greedy_verification.hpp"

#include <string>
#include <vector>

namespace partpose {

struct VisualizeOptions {
  bool preprocess = false;
  bool normal_estimation = false;
  bool coarse_alignment = false;
  bool pose_refinement = false;
  bool result = false;
  bool result_with_candidates = false;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("preprocess", self.preprocess, "picture of the preprocessed scene");
    visit("normal_estimation", self.normal_estimation, "picture of the normals");
    visit("coarse_alignment", self.coarse_alignment, "picture of the candidates after the coarse alignment");
    visit("pose_refinement", self.pose_refinement, "picture of the candidates after the refinement");
    visit("result", self.result, "picture of the result");
    visit("result_with_candidates", self.result_with_candidates, "picture of the result and all candidates");
  }
};

struct DebugOptions {
  bool result_to_cout = false;
  bool step_notion_to_cout = false;
  bool save_extras_json = false;
  bool save_point_clouds = false;
  bool save_used_dataset_json = false;
  bool save_used_pipeline_config_json = false;
  bool visualize_flag = false;
  VisualizeOptions visualize;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("result_to_cout", self.result_to_cout, "report the result as it is found");
    visit("step_notion_to_cout", self.step_notion_to_cout, "report each step as it begins");
    visit("save_extras_json", self.save_extras_json, "write extras.json to the iteration's folder");
    visit("save_point_clouds", self.save_point_clouds, "write the point clouds to the iteration's folder");
    visit("save_used_dataset_json", self.save_used_dataset_json, "write used_dataset.json to the iteration's folder");
    visit("save_used_pipeline_config_json", self.save_used_pipeline_config_json,
          "write used_pipeline_config.json to the iteration's folder");
    visit("visualize_flag", self.visualize_flag, "write pictures of the steps chosen in visualize");
    visit("visualize", self.visualize, "which steps");
  }
};

/// How the dataset's views are made comparable with a scene.
struct DatabaseOptions {
  std::string normals = "estimated";
  std::vector<float> noise_levels_mm = {0, 1.5f, 3};

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("normals", self.normals,
          "\"estimated\": the views go through the scene's voxel grid and normal estimation; "
          "\"mesh\": as they are in the dataset, as the reference does");
    visit("noise_levels_mm", self.noise_levels_mm,
          "each view is described once with noise of each of these standard deviations along its rays [mm], >= 0");
  }
  void check() const;
};

/// Appendix C.2.1 of the reference with the keys that its appendix D adds, and our own: `database`,
/// `vfh.use_normalized_distances`, `coarse_alignment.crh_peaks`, `pose_refinement.correspondence_gate_factor`,
/// `pose_refinement.two_sided_fitness`, `hypothesis_verification.min_scene_coverage`.
struct GlobalPipelineConfig {
  PreprocessOptions preprocessing;
  NormalEstimationOptions normal_estimation;
  std::string global_descriptor = "vfh";
  CoarseAlignmentOptions coarse_alignment;
  PoseRefinementOptions pose_refinement;
  HypothesisVerificationOptions hypothesis_verification;
  DescriptorOptions descriptors;
  DatabaseOptions database;
  DebugOptions debug;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("preprocessing", self.preprocessing, "what is done to the scene first");
    visit("normal_estimation", self.normal_estimation, "normals of the scene");
    visit("global_descriptor", self.global_descriptor, "\"vfh\", \"cvfh\", \"ourcvfh\", \"good\" or \"esf\"");
    DescriptorOptions::describe(self.descriptors, visit);
    visit("database", self.database, "how the dataset's views are made comparable with a scene");
    visit("coarse_alignment", self.coarse_alignment, "first guess of a candidate's pose");
    visit("pose_refinement", self.pose_refinement, "iterative closest points");
    visit("hypothesis_verification", self.hypothesis_verification, "which candidates are believed");
    visit("debug", self.debug, "what is reported and saved");
  }
  void check() const;
};

}  // namespace partpose
