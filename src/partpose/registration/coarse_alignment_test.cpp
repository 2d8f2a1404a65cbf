// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/coarse_alignment.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

/// The points of a bracket whose normals face the camera.
PointCloud bracket_view(Random& random, const Eigen::Vector3d& position_mm) {
  const auto cloud = transformed(surface_points(l_bracket(), 3000, random), random_pose(random, position_mm));
  std::vector<int> facing;
  for (int i = 0; i < 3000; ++i)
    if (cloud.normals[i].dot(cloud.points[i]) < 0) facing.push_back(i);
  return select(cloud, facing);
}

std::vector<Eigen::Isometry3d> align(const PointCloud& view, const PointCloud& scene,
                                     const CoarseAlignmentOptions& options = {}) {
  return coarse_alignments(alignment_features(view), alignment_features(scene), {}, options);
}

TEST(AlignmentFeatures, AreCentroidAndRollHistogram) {
  Random random(1);
  const auto view = bracket_view(random, {30, 40, 600});
  const auto features = alignment_features(view);
  EXPECT_LT((features.centroid_mm - centroid(view)).norm(), 1e-12);
  EXPECT_EQ(features.roll_histogram, camera_roll_histogram(view, centroid(view)));
}

TEST(CoarseAlignment, UndoesARollAboutTheLineOfSight) {
  Random random(2);
  for (int round = 0; round < 5; ++round) {
    const auto view = bracket_view(random, {0, 0, 650});
    for (const double roll_deg : {0.0, 10.0, 73.0, 150.0, 245.0, 359.0}) {
      const Eigen::Isometry3d truth(Eigen::AngleAxisd(radians(roll_deg), centroid(view).normalized()));
      const auto scene = transformed(view, truth);
      const auto alignments = align(view, scene);
      ASSERT_FALSE(alignments.empty());
      EXPECT_LE(alignments.size(), 4);
      EXPECT_LT(rotation_error_deg(alignments[0], truth), 3) << roll_deg;
      EXPECT_LT((alignments[0] * centroid(view) - centroid(scene)).norm(), 1e-3);
      for (const auto& alignment : alignments) {
        EXPECT_TRUE(is_rigid(alignment.matrix(), 1e-9));
        EXPECT_LT((alignment * centroid(view) - centroid(scene)).norm(), 1e-3)
            << "all of them bring the centroids together";
      }
    }
  }
}

TEST(CoarseAlignment, FollowsThePartOffTheOpticalAxis) {
  // Rolled, then carried about the camera to where it is seen far off the axis, at another distance: as the camera sees
  // it, nothing but the roll has changed.
  Random random(3);
  for (int round = 0; round < 10; ++round) {
    const auto view = bracket_view(random, {0, 0, 650});
    const double roll_deg = between(random, 0, 360);
    const Eigen::Vector3d direction =
        Eigen::Vector3d(between(random, -0.4, 0.4), between(random, -0.3, 0.3), 1).normalized();
    const Eigen::Isometry3d roll(Eigen::AngleAxisd(radians(roll_deg), centroid(view).normalized()));
    const Eigen::Isometry3d carried(Eigen::Quaterniond::FromTwoVectors(centroid(view), direction));
    const Eigen::Isometry3d truth = Eigen::Translation3d(between(random, -80, 80) * direction) * carried * roll;
    const auto scene = transformed(view, truth);
    const auto best = align(view, scene).at(0);
    EXPECT_LT(rotation_error_deg(best, truth), 3) << "round " << round;
    EXPECT_LT((best * centroid(view) - centroid(scene)).norm(), 1e-3);
    for (const auto& p : view.points)
      EXPECT_LT((best * p.cast<double>() - truth * p.cast<double>()).norm(), 80 * radians(3));
  }
}

TEST(CoarseAlignment, WithoutTheHistogramItOnlyMoves) {
  Random random(4);
  const auto view = bracket_view(random, {0, 0, 650});
  const auto scene = bracket_view(random, {60, -30, 600});
  const auto alignments = align(view, scene, {.use_crh = false});
  ASSERT_EQ(alignments.size(), 1);
  EXPECT_EQ(alignments[0].linear(), Eigen::Matrix3d::Identity());
  EXPECT_LT((alignments[0].translation() - (centroid(scene) - centroid(view))).norm(), 1e-9);
}

TEST(CoarseAlignment, WithoutTheCentroidsItOnlyTurns) {
  Random random(5);
  const auto view = bracket_view(random, {0, 0, 650});
  const auto scene = bracket_view(random, {60, -30, 600});
  for (const bool use_crh : {true, false})
    for (const auto& alignment : align(view, scene, {.use_crh = use_crh, .use_correction_by_centroids = false}))
      EXPECT_LT((alignment * centroid(view) - centroid(view)).norm(), 1e-9);
}

TEST(CoarseAlignment, FollowsTheDescriptorsReferenceFrames) {
  Random random(7);
  const auto view = bracket_view(random, {0, 0, 650});
  const Eigen::Isometry3d truth = random_pose(random, {20, -10, 30});
  const auto scene = transformed(view, truth);
  const Eigen::Isometry3d in_view = random_pose(random, {0, 5, 640});
  const std::vector<ReferenceFrames> frames = {{in_view, truth * in_view}, {in_view, in_view}};
  const auto align_by = [&](const CoarseAlignmentOptions& options) {
    return coarse_alignments(alignment_features(view), alignment_features(scene), frames, options);
  };
  const auto by_frames = align_by({.use_crh = false});
  ASSERT_EQ(by_frames.size(), 2);
  EXPECT_TRUE(by_frames[0].isApprox(truth, 1e-6));
  EXPECT_LT((by_frames[1] * centroid(view) - centroid(scene)).norm(), 1e-9) << "corrected by the centroids";
  const auto without_centroids = align_by({.use_crh = false, .use_correction_by_centroids = false});
  EXPECT_TRUE(without_centroids[1].isApprox(Eigen::Isometry3d::Identity(), 1e-9));
  const auto with_turns = align_by({});
  EXPECT_GT(with_turns.size(), 2) << "the turns of the roll histogram as well";
  EXPECT_TRUE(with_turns[0].isApprox(truth, 1e-6));
  for (const auto& alignment : align_by({.use_descriptor_if_possible = false}))
    EXPECT_FALSE(alignment.isApprox(by_frames[1], 1e-6)) << "switched off";
}

TEST(CoarseAlignment, TriesAsManyTurnsAsAskedFor) {
  Random random(6);
  const auto view = bracket_view(random, {0, 0, 650}), scene = bracket_view(random, {0, 0, 650});
  const auto four = align(view, scene, {.crh_peaks = 4});
  for (const int peaks : {1, 2, 4}) {
    const auto alignments = align(view, scene, {.crh_peaks = peaks});
    EXPECT_LE(alignments.size(), peaks);
    EXPECT_TRUE(alignments.at(0).isApprox(four[0], 1e-12));
  }
}

TEST(CoarseAlignment, OfAViewWithoutStructureThereIsOne) {
  PointCloud facing;
  for (int i = 0; i < 10; ++i) facing.points.emplace_back(static_cast<float>(i) - 4.5f, 0.0f, 600.0f);
  facing.normals.assign(10, {0, 0, -1});
  const auto alignments = align(facing, facing);
  ASSERT_EQ(alignments.size(), 1);
  EXPECT_TRUE(alignments[0].isApprox(Eigen::Isometry3d::Identity(), 1e-9));
}

TEST(CoarseAlignmentOptions, CheckNamesTheKey) {
  EXPECT_EQ(error_of([] { CoarseAlignmentOptions{}.check(); }), "no error");
  EXPECT_PRED2(mentions, error_of([] { CoarseAlignmentOptions{.crh_peaks = 0}.check(); }), "crh_peaks 0");
}

}  // namespace
}  // namespace partpose
