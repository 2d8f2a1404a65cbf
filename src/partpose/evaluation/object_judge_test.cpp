// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/object_judge.hpp"

#include "partpose/core/pose.hpp"
#include "partpose/evaluation/failures.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace partpose {
namespace {

const Intrinsics camera{320, 240, 300, 300, 159.5, 119.5};
const JudgedFrame frame{camera, {}, {}};

Catalogue catalogue() {
  Catalogue out;
  for (const auto& [name, mesh] :
       {std::pair{"bracket", shapes::l_bracket()}, std::pair{"box", shapes::box(Eigen::Vector3f(60, 40, 20))},
        std::pair{"twin", shapes::box(Eigen::Vector3f(60, 40, 20))}}) {
    CataloguePart part;
    part.id = static_cast<int>(out.parts.size()) + 1;
    part.name = name;
    part.mesh = mesh;
    out.parts.push_back(part);
  }
  return out;
}

Eigen::Isometry3d at(double x_mm, double y_mm = 0) {
  Eigen::Isometry3d pose(Eigen::Translation3d(x_mm, y_mm, 500));
  pose.linear() = (Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  return pose;
}

DetectionRecord found(const std::string& part, const Eigen::Isometry3d& pose, double confidence = 0.9) {
  DetectionRecord detection;
  detection.part = part;
  detection.camera_from_model = pose;
  detection.score = 0.9f;
  detection.confidence = confidence;
  return detection;
}

TEST(JudgeObjects, EachDetectionStandsForOneObject) {
  const PoseJudge judge(catalogue());
  // Two boxes side by side; three boxes are found there: one is too many.
  const auto r = judge_objects({found("box", at(-35)), found("box", at(35)), found("box", at(37))},
                               {{"box", {at(35)}, 0.9}, {"box", {at(-35)}, 0.7}}, judge, frame);
  ASSERT_EQ(r.objects.size(), 2u);
  EXPECT_EQ(r.objects[0].detection, 1);
  EXPECT_EQ(r.objects[1].detection, 0);
  EXPECT_TRUE(r.objects[0].pose_right && r.objects[1].pose_right);
  EXPECT_EQ(r.objects[1].visible_fraction, 0.7);
  EXPECT_EQ(r.detections[2].object, -1);
  EXPECT_FALSE(r.detections[2].part_right || r.detections[2].right);
}

TEST(JudgeObjects, TheNearestIsMatchedWhateverTheOrder) {
  const PoseJudge judge(catalogue());
  const auto r = judge_objects({found("box", at(6)), found("box", at(0))}, {{"box", {at(0)}, 1}}, judge, frame);
  EXPECT_EQ(r.objects[0].detection, 1);
  EXPECT_EQ(r.detections[0].object, -1);
}

TEST(JudgeObjects, FarAwayIsNotFoundAndAWrongPoseIs) {
  const PoseJudge judge(catalogue());
  const double half_mm = 0.5 * judge.diameter_mm("bracket");
  for (const double shift_mm : {half_mm - 1, half_mm + 1}) {
    const auto r = judge_objects({found("bracket", at(shift_mm))}, {{"bracket", {at(0)}, 1}}, judge, frame);
    EXPECT_EQ(r.objects[0].detection >= 0, shift_mm < half_mm);
    EXPECT_FALSE(r.objects[0].pose_right);
    EXPECT_EQ(r.detections[0].part_right, shift_mm < half_mm);
    EXPECT_FALSE(r.detections[0].right);
  }
}

TEST(JudgeObjects, SymmetricPosesAndSeveralTruePosesAreRight) {
  const PoseJudge judge(catalogue());
  const Eigen::Isometry3d half_turn(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(
      judge_objects({found("box", at(0) * half_turn)}, {{"box", {at(0)}, 1}}, judge, frame).detections[0].right);
  const Eigen::Isometry3d other = at(0) * half_turn;
  EXPECT_FALSE(judge_objects({found("bracket", other)}, {{"bracket", {at(0)}, 1}}, judge, frame).detections[0].right);
  EXPECT_TRUE(
      judge_objects({found("bracket", other)}, {{"bracket", {at(0), other}, 1}}, judge, frame).detections[0].right);
}

TEST(JudgeObjects, AnotherPartThatLooksTheSameIsRightAsFarAsCanBeSeen) {
  const PoseJudge judge(catalogue());
  const auto r = judge_objects({found("twin", at(0))}, {{"box", {at(0)}, 1}}, judge, frame);
  EXPECT_EQ(r.objects[0].detection, -1);
  EXPECT_TRUE(r.objects[0].pose_right);
  EXPECT_TRUE(r.detections[0].right);
  EXPECT_FALSE(r.detections[0].part_right);
  const auto different = judge_objects({found("bracket", at(0))}, {{"box", {at(0)}, 1}}, judge, frame);
  EXPECT_FALSE(different.objects[0].pose_right || different.detections[0].right);
}

TEST(JudgeObjects, NothingThereAndNothingFound) {
  const PoseJudge judge(catalogue());
  const auto r = judge_objects({found("box", at(0))}, {}, judge, frame);
  EXPECT_FALSE(r.detections[0].right || r.detections[0].part_right);
  EXPECT_EQ(judge_objects({}, {{"box", {at(0)}, 1}}, judge, frame).objects[0].detection, -1);
}

TEST(PoseJudge, TheNearestEquivalentPose) {
  const PoseJudge judge(catalogue());
  const Eigen::Isometry3d half_turn(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  const Eigen::Isometry3d estimate = at(0) * half_turn * Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX());
  const auto nearest = judge.nearest_equivalent("box", estimate, at(0));
  EXPECT_NEAR(rotation_error_deg(estimate, nearest), degrees(0.01), 1e-3);
  EXPECT_LT(judge.deviation_mm("box", estimate, at(0)), 1);
}

FrameRecord record(const std::string& shown, const std::string& named, float mssd_mm) {
  FrameRecord r;
  r.evaluation.ground_truth_model_name = shown;
  r.result.model_name = named;
  r.result.candidate_id = named.empty() ? -1 : 0;
  r.evaluation.recognized_correctly = shown == named;
  r.evaluation.diameter_mm = 100.f;
  if (r.evaluation.recognized_correctly) r.evaluation.mssd_mm = mssd_mm;
  return r;
}

TEST(Failures, WhatWentWrong) {
  EXPECT_EQ(failure_of(record("box", "box", 9)), std::nullopt);
  EXPECT_EQ(failure_of(record("box", "box", 10)), Failure::wrong_pose);
  EXPECT_EQ(failure_of(record("box", "twin", 0)), Failure::wrong_part);
  EXPECT_EQ(failure_of(record("box", "", 0)), Failure::nothing_recognized);
  FrameRecord same = record("box", "twin", 0);
  same.evaluation.indistinguishable = true;
  EXPECT_EQ(failure_of(same), std::nullopt);
  FrameRecord left_out = record("box", "twin", 0);
  left_out.left_out = true;
  EXPECT_EQ(failure_of(left_out), Failure::not_refused);
  FrameRecord several = record("box", "box", 1);
  several.objects.emplace();
  several.objects->objects = {{"box", 1, 0, true}, {"box", 0.59, -1, false}};  // too little seen to be asked for
  several.objects->detections = {found("box", at(0))};
  several.objects->detections[0].object = 0;
  EXPECT_EQ(failure_of(several), std::nullopt);
  several.objects->detections.push_back(found("box", at(90)));
  EXPECT_EQ(failure_of(several), Failure::extra_detection);
  several.objects->objects[1].visible_fraction = 0.6;
  EXPECT_EQ(failure_of(several), Failure::object_missed);
}

TEST(Failures, ThePictureShowsTruthAndResult) {
  const PoseJudge judge(catalogue());
  FrameRecord failing = record("box", "box", 50);
  failing.result.T_final = at(40);
  JudgedFrame seen = frame;
  seen.depth = DepthImage(320, 240);
  const auto picture = picture_of_failure(failing, {{"box", {at(0)}, 1}}, judge, seen);
  ASSERT_EQ(picture.width, 320);
  ASSERT_EQ(picture.height, 240);
  Eigen::AlignedBox2d green, orange;
  for (int v = 0; v < picture.height; ++v)
    for (int u = 0; u < picture.width; ++u) {
      const auto& c = picture.pixels[static_cast<std::size_t>(v) * picture.width + u];
      if (c[1] > 200) green.extend(Eigen::Vector2d(u, v));
      if (c[0] > 200) orange.extend(Eigen::Vector2d(u, v));
    }
  ASSERT_FALSE(green.isEmpty() || orange.isEmpty());
  EXPECT_GT(orange.center().x() - green.center().x(), 20);
  EXPECT_NEAR(orange.center().y(), green.center().y(), 3);
  EXPECT_TRUE(Eigen::AlignedBox2d(Eigen::Vector2d(1, 1), Eigen::Vector2d(318, 238)).contains(green));
}

}  // namespace
}  // namespace partpose
