// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/object_judge.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace partpose {

namespace {

constexpr double near_share = 0.5;   // of the diameter
constexpr double right_share = 0.1;  // of the diameter

struct Pair {
  double deviation = 0;  ///< MSSD, share of the diameter
  std::size_t detection = 0, object = 0;
};

double middles_apart_mm(const TriangleMesh& a, const Eigen::Isometry3d& camera_from_a, const TriangleMesh& b,
                        const Eigen::Isometry3d& camera_from_b) {
  return (camera_from_a * bounding_box(a).center() - camera_from_b * bounding_box(b).center()).norm();
}

}  // namespace

std::vector<DetectionRecord> detections_of(const Recognition& recognition, const Catalogue& catalogue) {
  std::vector<DetectionRecord> out;
  for (const auto& detection : recognition.detections) {
    out.push_back(
        {catalogue.parts[detection.part].name, detection.camera_from_model, detection.score, detection.confidence});
    out.back().explanation = detection.explanation;
  }
  if (out.empty() && recognition.accepted >= 0) {
    const Candidate& best = recognition.candidates[recognition.accepted];
    out.push_back({catalogue.parts[catalogue.views[best.view_row].part].name, best.camera_from_model, best.score,
                   std::clamp<double>(best.score, 0, 1)});
  }
  return out;
}

FrameObjects judge_objects(std::vector<DetectionRecord> detections, const std::vector<ObjectTruth>& truths,
                           const PoseJudge& judge, const JudgedFrame& frame) {
  FrameObjects out;
  out.detections = std::move(detections);
  for (const auto& truth : truths) out.objects.push_back({truth.part, truth.visible_fraction});

  std::vector<Pair> pairs;
  for (std::size_t d = 0; d < out.detections.size(); ++d) {
    const DetectionRecord& detection = out.detections[d];
    for (std::size_t t = 0; t < truths.size(); ++t) {
      if (truths[t].part != detection.part) continue;
      const TriangleMesh& mesh = judge.mesh(detection.part);
      const double diameter_mm = judge.diameter_mm(detection.part);
      double least = std::numeric_limits<double>::infinity();
      for (const auto& pose : truths[t].camera_from_model)
        if (middles_apart_mm(mesh, detection.camera_from_model, mesh, pose) < near_share * diameter_mm)
          least = std::min(least, judge.deviation_mm(detection.part, detection.camera_from_model, pose) / diameter_mm);
      if (least < std::numeric_limits<double>::infinity()) pairs.push_back({least, d, t});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.deviation, a.detection, a.object) < std::tie(b.deviation, b.detection, b.object);
  });
  for (const auto& pair : pairs) {
    DetectionRecord& detection = out.detections[pair.detection];
    ObjectRecord& object = out.objects[pair.object];
    if (detection.object >= 0 || object.detection >= 0) continue;
    detection.object = static_cast<int>(pair.object);
    object.detection = static_cast<int>(pair.detection);
    detection.part_right = true;
    const auto same = [&](const Eigen::Isometry3d& pose) {
      return judge.same_to_camera(detection.part, detection.camera_from_model, object.part, pose, frame);
    };
    const auto& poses = truths[pair.object].camera_from_model;
    detection.right = object.pose_right = pair.deviation < right_share || std::any_of(poses.begin(), poses.end(), same);
  }
  for (auto& detection : out.detections) {
    for (std::size_t t = 0; detection.object < 0 && t < truths.size(); ++t) {
      ObjectRecord& object = out.objects[t];
      if (object.detection >= 0 || object.pose_right || object.part == detection.part) continue;
      for (const auto& pose : truths[t].camera_from_model) {
        const double apart_mm =
            middles_apart_mm(judge.mesh(detection.part), detection.camera_from_model, judge.mesh(object.part), pose);
        if (apart_mm < near_share * judge.diameter_mm(object.part) &&
            judge.same_to_camera(detection.part, detection.camera_from_model, object.part, pose, frame)) {
          detection.object = static_cast<int>(t);
          detection.right = object.pose_right = true;
          break;
        }
      }
    }
  }
  return out;
}

}  // namespace partpose
