// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/evaluation/pose_judge.hpp"
#include "partpose/pipeline/recognition.hpp"

#include <string>
#include <vector>

/// Frames with several objects, each to be found.
namespace partpose {

/// An object of a frame, as it truly is.
struct ObjectTruth {
  std::string part;
  std::vector<Eigen::Isometry3d> camera_from_model;  ///< any of them is right
  double visible_fraction = 1;                       ///< of its silhouette, 0 to 1
};

/// What became of an object.
struct ObjectRecord {
  std::string part;
  double visible_fraction = 1;
  int detection = -1;
  bool pose_right = false;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("part", self.part, "the part");
    visit("visible_fraction", self.visible_fraction, "of its silhouette, 0 to 1");
    visit("detection", self.detection, "index of the detection that names its part where it is; -1: not found");
    visit("pose_right", self.pose_right,
          "whether a detection has MSSD below 10 % of the diameter, or cannot be told from the truth by this camera");
  }
};

/// What a detection is worth.
struct DetectionRecord {
  std::string part;
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  float score = -1;
  double confidence = 0;
  int object = -1;
  bool part_right = false;
  bool right = false;
  std::optional<Explanation> explanation = {};  ///< of the Engine; absent in the records of older versions

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("part", self.part, "the part");
    visit("camera_from_model", self.camera_from_model, "4x4 [mm]");
    visit("score", self.score, "0 to 1");
    visit("confidence", self.confidence, "stated probability that part and pose are right, 0 to 1");
    visit("object", self.object, "index of the object that it stands for; -1: none");
    visit("part_right", self.part_right, "whether it names that object's part");
    visit("right", self.right, "whether part and pose are right, or cannot be told from the truth by this camera");
    visit("explanation", self.explanation, "what the engine's score is made of");
  }
};

struct FrameObjects {
  std::vector<ObjectRecord> objects;
  std::vector<DetectionRecord> detections;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("objects", self.objects, "parts of the catalogue that are in the frame");
    visit("detections", self.detections, "what was recognized, likeliest first");
  }
};

/// All that the recognizer found; of one that knows no detections its result, with its score as the confidence.
std::vector<DetectionRecord> detections_of(const Recognition& recognition, const Catalogue& catalogue);

/// Matches detections and objects one to one, and judges each pair. A detection may stand for an object of its part
/// when their boxes' middles are less than half the diameter apart; of all such pairs those of least MSSD are matched
/// first. What is left on both sides is matched where the camera cannot tell one from the other although the parts
/// differ: such a detection is right as far as can be seen (`right`), but does not name the part (`part_right`).
FrameObjects judge_objects(std::vector<DetectionRecord> detections, const std::vector<ObjectTruth>& truths,
                           const PoseJudge& judge, const JudgedFrame& frame);

}  // namespace partpose
