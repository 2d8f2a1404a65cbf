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
  EXPECT_LT(refined.rms_mm, 0.05);
}

TEST(FieldRefinement, NoPointsMoveNothing) {
  const SurfaceField field(shapes::box(Eigen::Vector3f(80, 80, 10)));
  const auto refined = refine_on_field(field, Eigen::Isometry3d::Identity(), ProbePoints(), {});
  EXPECT_TRUE(refined.camera_from_model.isApprox(Eigen::Isometry3d::Identity()));
}

}  // namespace
}  // namespace partpose
