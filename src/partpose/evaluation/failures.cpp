// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/failures.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/evaluation/experiment_tables.hpp"
#include "partpose/pipeline/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace partpose {

namespace {

constexpr int width_px = 320, height_px = 240;

struct Placed {
  const TriangleMesh* mesh;
  Eigen::Isometry3d camera_from_model;
  std::array<std::uint8_t, 3> colour;
};

/// The part of the image that shows all of them, with a margin, in the picture's proportions; the whole image when
/// nothing is before the camera.
Intrinsics cut_around(const std::vector<Placed>& things, const Intrinsics& camera) {
  Eigen::AlignedBox2d seen;
  for (const auto& thing : things) {
    const Eigen::AlignedBox3d box = bounding_box(*thing.mesh);
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner =
          thing.camera_from_model * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
      if (corner.z() > 1) seen.extend(camera.project(corner));
    }
  }
  const Eigen::AlignedBox2d image(Eigen::Vector2d(0, 0), Eigen::Vector2d(camera.width - 1, camera.height - 1));
  seen = seen.isEmpty() ? image : seen.intersection(image);
  if (seen.isEmpty()) seen = image;
  const Eigen::Vector2d middle = seen.center();
  const double pixels_per_px = 1.3 * std::max(seen.sizes().x() / width_px, std::max(seen.sizes().y(), 8.0) / height_px);
  Intrinsics cut{width_px, height_px, camera.fx / pixels_per_px, camera.fy / pixels_per_px, 0, 0};
  cut.cx = (camera.cx - middle.x()) / pixels_per_px + 0.5 * (width_px - 1);
  cut.cy = (camera.cy - middle.y()) / pixels_per_px + 0.5 * (height_px - 1);
  return cut;
}

DepthImage resampled(const DepthImage& depth, const Intrinsics& from, const Intrinsics& to) {
  DepthImage out(to.width, to.height);
  for (int v = 0; v < to.height; ++v)
    for (int u = 0; u < to.width; ++u) {
      const auto x = std::lround((u - to.cx) / to.fx * from.fx + from.cx);
      const auto y = std::lround((v - to.cy) / to.fy * from.fy + from.cy);
      if (x >= 0 && y >= 0 && x < depth.width && y < depth.height)
        out.at(u, v) = depth.at(static_cast<int>(x), static_cast<int>(y));
    }
  return out;
}

void draw_outline(ColourImage& image, const Placed& thing, const Intrinsics& camera) {
  const DepthImage depth = render(*thing.mesh, thing.camera_from_model, camera).depth;
  for (int v = 1; v + 1 < camera.height; ++v)
    for (int u = 1; u + 1 < camera.width; ++u)
      if (depth.at(u, v) > 0 &&
          !(depth.at(u - 1, v) > 0 && depth.at(u + 1, v) > 0 && depth.at(u, v - 1) > 0 && depth.at(u, v + 1) > 0))
        image.pixels[static_cast<std::size_t>(v) * camera.width + u] = thing.colour;
}

}  // namespace

const char* name_of(Failure failure) {
  switch (failure) {
    case Failure::wrong_part:
      return "names another part";
    case Failure::not_refused:
      return "accepts what is not in the catalogue";
    case Failure::nothing_recognized:
      return "recognizes nothing";
    case Failure::wrong_pose:
      return "right part, wrong pose";
    case Failure::object_missed:
      return "an object is missed, or its pose is wrong";
    case Failure::extra_detection:
      return "a detection of a part that is not there";
  }
  return "";
}

std::optional<Failure> failure_of(const FrameRecord& record) {
  const Evaluation& evaluation = record.evaluation;
  const bool recognized_something = record.result.candidate_id >= 0;
  if (record.left_out || evaluation.ground_truth_model_name.empty())
    return recognized_something ? std::optional(Failure::not_refused) : std::nullopt;
  const bool right =
      evaluation.indistinguishable.value_or(false) || (evaluation.recognized_correctly && mssd_below(evaluation, 0.10));
  if (!recognized_something) return Failure::nothing_recognized;
  if (!evaluation.recognized_correctly && !right) return Failure::wrong_part;
  if (!right) return Failure::wrong_pose;
  if (!record.objects) return std::nullopt;
  for (const auto& object : record.objects->objects)
    if (object.visible_fraction >= counted_visibility && !object.pose_right) return Failure::object_missed;
  for (const auto& detection : record.objects->detections)
    if (detection.object < 0) return Failure::extra_detection;
  return std::nullopt;
}

ColourImage picture_of_failure(const FrameRecord& record, const std::vector<ObjectTruth>& truths,
                               const PoseJudge& judge, const JudgedFrame& frame) {
  constexpr std::array<std::uint8_t, 3> green = {70, 230, 90}, orange = {255, 150, 30};
  std::vector<Placed> things;
  for (const auto& truth : truths) things.push_back({&judge.mesh(truth.part), truth.camera_from_model.at(0), green});
  if (record.objects)
    for (const auto& detection : record.objects->detections)
      things.push_back({&judge.mesh(detection.part), detection.camera_from_model, orange});
  else if (record.result.candidate_id >= 0)
    things.push_back({&judge.mesh(record.result.model_name), record.result.T_final, orange});
  const Intrinsics camera = cut_around(things, frame.camera);
  ColourImage picture = draw_overlay(resampled(frame.depth, frame.camera, camera), camera);
  for (const auto& thing : things) draw_outline(picture, thing, camera);
  return picture;
}

}  // namespace partpose
