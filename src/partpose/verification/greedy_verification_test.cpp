// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/verification/greedy_verification.hpp"

#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/geometry/icosphere.hpp"
#include "partpose/geometry/voxel_grid.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

/// A part as a catalogue knows it: its mesh, and its surface as seen from all around.
struct Part {
  TriangleMesh mesh;
  PointCloud surface;

  explicit Part(TriangleMesh m) : mesh(std::move(m)) {
    const Eigen::Vector3d centre = bounding_box(mesh).center();
    for (const auto& direction : icosphere_directions(1, true)) {
      const Eigen::Isometry3d camera_from_model = look_at(centre + 650 * direction, centre).inverse();
      append(surface, transformed(capture(mesh, camera_from_model, {}, false), camera_from_model.inverse()));
    }
    surface = voxel_grid(surface, 5);
  }
  PlacedPart at(const Eigen::Isometry3d& camera_from_model) const { return {mesh, surface, camera_from_model}; }
};

const Part& bracket() {
  static const Part part(l_bracket());
  return part;
}

PointCloud seen(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, float noise_mm = 0) {
  VirtualDepthCameraOptions camera;
  camera.noise = {"gaussianray", noise_mm};
  return capture(mesh, camera_from_model, camera, false);
}

Verification verify(const PlacedPart& part, const PointCloud& scene,
                    const HypothesisVerificationOptions& options = {}) {
  return verify_greedy(part, scene, voxel_grid(scene, options.voxel_mm()), options);
}

TEST(VerifyGreedy, AcceptsTheTruePose) {
  Random random(1);
  for (const Part& part : {bracket(), Part(box({70, 50, 30})), Part(cylinder(20, 80, 48))}) {
    for (int round = 0; round < 10; ++round) {
      const auto pose =
          random_pose(random, {between(random, -80, 80), between(random, -60, 60), between(random, 450, 850)});
      const auto result = verify(part.at(pose), seen(part.mesh, pose, round % 2 == 0 ? 0 : 1));
      EXPECT_TRUE(result.accepted) << "round " << round << ": " << result.reason;
      EXPECT_TRUE(result.reason.empty());
      EXPECT_EQ(result.unexplained_model_points, 0);
      EXPECT_GE(result.explained_scene_points, 0.97 * result.scene_points) << "but for faces seen at a grazing angle";
      EXPECT_GT(result.visible_model_points, 20);
      EXPECT_LT(result.visible_model_points, part.surface.size()) << "the far side cannot be seen";
    }
  }
}

TEST(VerifyGreedy, RejectsAPoseThirtyMillimetresAway) {
  Random random(2);
  for (int round = 0; round < 10; ++round) {
    const auto pose = random_pose(random, {0, 0, 650});
    const auto scene = seen(bracket().mesh, pose);
    for (const Eigen::Vector3d& shift :
         {Eigen::Vector3d(30, 0, 0), Eigen::Vector3d(-30, 0, 0), Eigen::Vector3d(0, 30, 0), Eigen::Vector3d(0, -30, 0),
          Eigen::Vector3d(0, 0, 30), Eigen::Vector3d(0, 0, -30), Eigen::Vector3d(30 * random_direction(random))}) {
      const auto result = verify(bracket().at(Eigen::Translation3d(shift) * pose), scene);
      EXPECT_FALSE(result.accepted) << "round " << round << ", shifted by " << shift.transpose();
      EXPECT_FALSE(result.reason.empty());
    }
  }
}

TEST(VerifyGreedy, RejectsASmallPartThatFitsIntoALargeOne) {
  // A face of the small box lies in a face of the large one: all that is seen of it is explained.
  const Part small(box({30, 30, 30}));
  Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, 650));
  const auto scene = seen(box({120, 120, 30}), pose);
  auto result = verify(small.at(pose), scene);
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(result.unexplained_model_points, 0);
  EXPECT_PRED2(mentions, result.reason, "explains only");
  HypothesisVerificationOptions options;
  options.min_scene_coverage = 0;
  EXPECT_TRUE(verify(small.at(pose), scene, options).accepted) << "as the original would have it";
}

TEST(VerifyGreedy, RejectsALargePartInTheSceneOfASmallOne) {
  const Part large(box({120, 120, 30}));
  const Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, 650));
  const auto result = verify(large.at(pose), seen(box({30, 30, 30}), pose));
  EXPECT_FALSE(result.accepted);
  EXPECT_PRED2(mentions, result.reason, "unexplained");
  EXPECT_GT(result.unexplained_model_points, 100);
}

TEST(VerifyGreedy, WhatAnotherObjectHidesDoesNotCount) {
  // A bar before the middle of a plate.
  const Part plate(box({140, 80, 10}));
  const Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, 650));
  const auto scene = seen(joined(plate.mesh, box({-18, -60, -60}, {18, 60, -50})), pose);
  HypothesisVerificationOptions options;
  options.min_scene_coverage = 0.5f;
  const auto with_bar = verify(plate.at(pose), scene, options);
  EXPECT_TRUE(with_bar.accepted) << with_bar.reason;
  EXPECT_EQ(with_bar.unexplained_model_points, 0);

  std::vector<int> of_plate;
  for (int i = 0; i < static_cast<int>(scene.size()); ++i)
    if (scene.points[i].z() > 620) of_plate.push_back(i);
  const auto with_a_hole = verify(plate.at(pose), select(scene, of_plate), options);
  EXPECT_GT(with_a_hole.unexplained_model_points, 10) << "nothing explains why the middle is not seen";
  EXPECT_GT(with_a_hole.visible_model_points, with_bar.visible_model_points);

  options.occlusion_reasoning = false;
  const auto without_reasoning = verify(plate.at(pose), scene, options);
  EXPECT_EQ(without_reasoning.visible_model_points, plate.surface.size());
  EXPECT_GT(without_reasoning.unexplained_model_points, 10);
  EXPECT_FALSE(without_reasoning.accepted);
}

TEST(VerifyGreedy, CountsAsBruteForceDoes) {
  Random random(3);
  HypothesisVerificationOptions options;
  options.occlusion_reasoning = false;
  for (int round = 0; round < 5; ++round) {
    const auto pose = random_pose(random, {0, 0, 650});
    const auto scene = seen(bracket().mesh, random_motion(random, 10, 15, {0, 0, 650}) * pose);
    const auto thinned = voxel_grid(scene, options.voxel_mm());
    const auto model = transformed(bracket().surface, pose);
    const auto far_from = [](const PointCloud& cloud, const PointCloud& other) {
      int count = 0;
      for (const auto& p : cloud.points) {
        float nearest = std::numeric_limits<float>::infinity();
        for (const auto& q : other.points) nearest = std::min(nearest, (p - q).norm());
        count += nearest > 10;
      }
      return count;
    };
    for (const float regularizer : {0.0f, 0.5f, 5.0f, 45.0f}) {
      options.regularizer = regularizer;
      const auto result = verify(bracket().at(pose), scene, options);
      EXPECT_EQ(result.scene_points, thinned.size());
      EXPECT_EQ(result.visible_model_points, model.size());
      EXPECT_EQ(result.unexplained_model_points, far_from(model, thinned));
      EXPECT_EQ(result.explained_scene_points, thinned.size() - far_from(thinned, model));
      const bool outweighs = static_cast<float>(result.explained_scene_points) >
                             regularizer * static_cast<float>(result.unexplained_model_points);
      const bool covers = result.explained_scene_points >= 0.8 * result.scene_points;
      EXPECT_EQ(result.accepted, outweighs && covers);
    }
  }
}

TEST(VerifyGreedy, AnEmptySceneIsAReason) {
  const auto result = verify(bracket().at(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 650))), PointCloud{});
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(result.reason, "the scene has no points");
}

TEST(VerifyGreedy, APartBehindTheCameraIsAReason) {
  Random random(4);
  const auto pose = random_pose(random, {0, 0, 650});
  const auto result = verify(bracket().at(Eigen::Translation3d(0, 0, -1300) * pose), seen(bracket().mesh, pose));
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(result.visible_model_points, 0);
  EXPECT_PRED2(mentions, result.reason, "no point of the model would be visible");
}

TEST(VerifyGreedy, APartAtTheCameraIsNoException) {
  // A hypothesis may put a part around the camera, with points beside its centre at next to no depth.
  const Part slab(box({120, 120, 30}));
  const auto scene = seen(slab.mesh, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 650)));
  for (const double z : {1e-4, 1e-2, 1.0, 5.0, 14.999, 15.0001}) {
    const Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, z));
    bool accepted = false;
    EXPECT_NO_THROW(accepted = verify(slab.at(pose), scene).accepted) << "at " << z << " mm";
    EXPECT_FALSE(accepted);
  }
}

TEST(HypothesisVerificationOptions, CheckNamesTheKey) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const auto with = [](auto change) {
    HypothesisVerificationOptions options;
    change(options);
    return error_of([&] { options.check(); });
  };
  EXPECT_EQ(with([](auto&) {}), "no error");
  for (const float bad : {-1.0f, nan}) {
    EXPECT_PRED2(mentions, with([&](auto& o) { o.model_representation_voxel_size = bad; }),
                 "model_representation_voxel_size");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.inlier_threshold = bad; }), "inlier_threshold");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.occlusion_threshold = bad; }), "occlusion_threshold");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.regularizer = bad; }), "regularizer");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.verification_voxel_size = bad; }), "verification_voxel_size");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.min_scene_coverage = bad; }), "min_scene_coverage");
  }
  EXPECT_PRED2(mentions, with([](auto& o) { o.resolution = 0.0f; }), " 0: must be positive");
  EXPECT_PRED2(mentions, with([](auto& o) { o.min_scene_coverage = 1.5f; }), "min_scene_coverage 1.5");
  EXPECT_EQ(with([](auto& o) { o.resolution = 4.0f; }), "no error");
  HypothesisVerificationOptions options;
  EXPECT_EQ(options.voxel_mm(), 5);
  options.resolution = 4.0f;
  EXPECT_EQ(options.voxel_mm(), 4);
}

}  // namespace
}  // namespace partpose
