// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/field_refinement.hpp"

#include "partpose/core/pose.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(FieldRefinement, FindsThePoseThatThePointsWereTakenAt) {
  const TriangleMesh mesh = shapes::l_bracket();
  const SurfaceField field(mesh);
  Random random(7);
  for (int round = 0; round < 10; ++round) {
    const Eigen::Isometry3d truth = shapes::random_pose(random, {20, -30, 600});
    const PointCloud points = transformed(shapes::surface_points(mesh, 300, random), truth);
    const Eigen::Vector3d centre = centroid(points);
    Eigen::Isometry3d start = truth;
    start.linear() = shapes::random_turn(random, radians(6)) * truth.linear();
    start.translation() = centre + start.linear() * truth.linear().transpose() * (truth.translation() - centre);
    start.translation() += 3 * shapes::random_direction(random);
    const auto refined = refine_on_field(field, start, ProbePoints(points.points),
                                         {.start_scale_mm = 6, .end_scale_mm = 0.5, .max_iterations = 40});
    EXPECT_LT(rotation_error_deg(refined.camera_from_model, truth), 0.5);
    EXPECT_LT((refined.camera_from_model.inverse() * truth).translation().norm(), 0.5);
  }
}

TEST(FieldRefinement, LeavesWhatIsNotDetermined) {
  const SurfaceField field(shapes::box(Eigen::Vector3f(80, 80, 10)));
  std::vector<Eigen::Vector3f> face;  // the inner part of the face towards the camera
  for (float y = -20; y <= 20; y += 4)
    for (float x = -20; x <= 20; x += 4) face.emplace_back(x, y, 500);
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.translation() = Eigen::Vector3d(4, -3, 507);
  const auto refined = refine_on_field(field, start, ProbePoints(face), {});
  EXPECT_NEAR(refined.camera_from_model.translation().z(), 505, 0.05);
  EXPECT_NEAR(refined.camera_from_model.translation().x(), 4, 0.05);
  EXPECT_NEAR(refined.camera_from_model.translation().y(), -3, 0.05);
  EXPECT_LT(refined.mean_capped, 0.05);  // at a scale of 1 mm
}

TEST(FieldRefinement, OnATableItOnlyTurnsAndMovesThere) {
  const TriangleMesh mesh = shapes::l_bracket();
  const SurfaceField field(mesh);
  Random random(8);
  const Eigen::Vector3d upright = Eigen::Vector3d(0.1, 0.5, 0.8).normalized();
  const Eigen::Isometry3d truth = shapes::random_pose(random, {10, 20, 550});
  const Eigen::Vector3d across = upright.unitOrthogonal();
  Eigen::Isometry3d start = truth;
  start.linear() = Eigen::AngleAxisd(radians(7), upright).toRotationMatrix() * truth.linear();
  start.translation() += 4 * across;
  // Points that lie 2 mm higher than the part can: it must not follow them.
  PointCloud points = transformed(shapes::surface_points(mesh, 300, random), truth);
  for (auto& p : points.points) p += (2 * upright).cast<float>();
  const auto refined =
      refine_on_field(field, start, ProbePoints(points.points),
                      {.start_scale_mm = 6, .end_scale_mm = 1, .max_iterations = 40, .upright = upright});
  EXPECT_LT(rotation_error_deg(refined.camera_from_model, truth), 0.7);
  EXPECT_LT((refined.camera_from_model.translation() - truth.translation()).norm(), 2);
  const Eigen::Isometry3d moved = refined.camera_from_model * start.inverse();
  EXPECT_LT((moved.linear() * upright - upright).norm(), 1e-5);
  const Eigen::Vector3d origin = truth.translation();  // a place that moves as the table does
  EXPECT_NEAR(upright.dot(moved * origin - origin), 0, 1e-3);
}

TEST(MeanDistance, IsCapped) {
  const SurfaceField field(shapes::box(Eigen::Vector3f(80, 80, 10)));
  const Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, 505));
  std::vector<Eigen::Vector3f> points;
  for (float x = -20; x <= 20; x += 10) points.emplace_back(x, 0, 498);  // the face is at 500
  EXPECT_NEAR(mean_distance_mm(field, pose, ProbePoints(points), 10), 2, 0.02);
  points.emplace_back(0, 0, 492);
  EXPECT_NEAR(mean_distance_mm(field, pose, ProbePoints(points), 4), (5 * 2 + 4) / 6.0, 0.02);
  EXPECT_EQ(mean_distance_mm(field, pose, ProbePoints(), 4), 0);
}

TEST(FieldRefinement, NoPointsMoveNothing) {
  const SurfaceField field(shapes::box(Eigen::Vector3f(80, 80, 10)));
  const auto refined = refine_on_field(field, Eigen::Isometry3d::Identity(), ProbePoints(), {});
  EXPECT_TRUE(refined.camera_from_model.isApprox(Eigen::Isometry3d::Identity()));
}

}  // namespace
}  // namespace partpose
