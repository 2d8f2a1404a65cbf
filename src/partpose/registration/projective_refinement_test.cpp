// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/projective_refinement.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

const Intrinsics camera = Intrinsics::from_field_of_view(200, 150, 16, 12);

/// The bracket so that faces in three directions are seen.
Eigen::Isometry3d good_pose() {
  return Eigen::Translation3d(-20, 10, 600) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -1, 0.3).normalized()) *
         Eigen::Translation3d(-40, -25, -15);
}

Eigen::Vector3d middle() { return good_pose() * Eigen::Vector3d(40, 25, 15); }

double largest_distance_mm(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  double largest = 0;
  for (const auto& v : l_bracket().vertices)
    largest = std::max(largest, (a * v.cast<double>() - b * v.cast<double>()).norm());
  return largest;
}

TEST(ProjectiveRefinement, RecoversThePose) {
  Random random(1);
  const auto mesh = l_bracket();
  const auto depth = render(mesh, good_pose(), camera).depth;
  for (int round = 0; round < 10; ++round) {
    const auto start = random_motion(random, between(random, 0, 3), between(random, 0, 3), middle()) * good_pose();
    const auto result = refine_projectively(mesh, start, depth, camera, {.max_iterations = 40, .converged_mm = 1e-4f});
    EXPECT_LT(largest_distance_mm(result.camera_from_model, good_pose()), 0.02) << "round " << round;
    EXPECT_LT(result.rms_mm, 0.02);
    EXPECT_GT(result.pixels, 3000);
    EXPECT_TRUE(is_rigid(result.camera_from_model.matrix(), 1e-9));
  }
}

TEST(ProjectiveRefinement, DefaultsComeNear) {
  Random random(2);
  const auto mesh = l_bracket();
  const auto depth = render(mesh, good_pose(), camera).depth;
  for (int round = 0; round < 10; ++round) {
    const auto start = random_motion(random, between(random, 0, 3), between(random, 0, 3), middle()) * good_pose();
    EXPECT_LT(largest_distance_mm(refine_projectively(mesh, start, depth, camera, {}).camera_from_model, good_pose()),
              1.5);
  }
}

TEST(ProjectiveRefinement, HolesNoiseAndOutliersDoLittleHarm) {
  Random random(3);
  const auto mesh = l_bracket();
  for (int round = 0; round < 5; ++round) {
    auto depth = render(mesh, good_pose(), camera).depth;
    for (float& z : depth.z_mm) {
      if (z == 0) continue;
      z += static_cast<float>(0.5 * random.normal_pair().first);
      const auto fate = random.below(10);
      if (fate == 0) z = 0;
      if (fate == 1) z += static_cast<float>(between(random, 3, 9));
    }
    const auto start = random_motion(random, 2, 2, middle()) * good_pose();
    const auto result = refine_projectively(mesh, start, depth, camera, {.max_iterations = 40, .converged_mm = 1e-3f});
    EXPECT_LT(largest_distance_mm(result.camera_from_model, good_pose()), 0.25) << "round " << round;
    EXPECT_NEAR(result.rms_mm, 0.5, 0.25);
  }
}

TEST(ProjectiveRefinement, PixelsBeyondTheGateDoNotCount) {
  const auto mesh = l_bracket();
  const auto depth = render(mesh, Eigen::Translation3d(0, 0, 11) * good_pose(), camera).depth;
  const auto result = refine_projectively(mesh, good_pose(), depth, camera, {.gate_mm = 5});
  EXPECT_GT(largest_distance_mm(result.camera_from_model, Eigen::Translation3d(0, 0, 11) * good_pose()), 1);
  const auto wider = refine_projectively(mesh, good_pose(), depth, camera, {.gate_mm = 15, .max_iterations = 40});
  EXPECT_LT(largest_distance_mm(wider.camera_from_model, Eigen::Translation3d(0, 0, 11) * good_pose()), 0.5);
}

TEST(ProjectiveRefinement, DampingHoldsAgainstFewPixels) {
  const auto mesh = l_bracket();
  auto depth = render(mesh, good_pose(), camera).depth;
  int kept = 0;
  for (float& z : depth.z_mm) z = z > 0 && kept++ < 300 ? z + 2 : 0;
  const auto moved_mm = [&](double damping) {
    const auto result = refine_projectively(mesh, good_pose(), depth, camera, {.damping = damping});
    return largest_distance_mm(result.camera_from_model, good_pose());
  };
  EXPECT_GT(moved_mm(0), 1);
  EXPECT_LT(moved_mm(3000), 0.8 * moved_mm(0));
  EXPECT_LT(moved_mm(1e6), 0.05);
}

TEST(ProjectiveRefinement, WithoutPixelsInCommonNothingMoves) {
  const auto mesh = l_bracket();
  const DepthImage empty(camera.width, camera.height);
  const auto result = refine_projectively(mesh, good_pose(), empty, camera, {});
  EXPECT_EQ(result.pixels, 0);
  EXPECT_EQ(result.camera_from_model.matrix(), good_pose().matrix());
  const Eigen::Isometry3d beside = Eigen::Translation3d(500, 0, 0) * good_pose();
  const auto depth = render(mesh, good_pose(), camera).depth;
  EXPECT_EQ(refine_projectively(mesh, beside, depth, camera, {}).camera_from_model.matrix(), beside.matrix());
}

TEST(ProjectiveRefinement, APlateAloneIsNotTurnedInItsPlane) {
  const auto plate = plane_patch(300, 300);
  const Eigen::Isometry3d truth(Eigen::Translation3d(0, 0, 600) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()));
  const auto depth = render(plate, truth, camera).depth;  // fills the image
  const Eigen::Isometry3d start = Eigen::Translation3d(0, 0, 2) * truth;
  const auto result = refine_projectively(plate, start, depth, camera, {.max_iterations = 40});
  const Eigen::Vector3d normal = truth.linear().col(2);
  EXPECT_NEAR(normal.dot(result.camera_from_model.translation() - truth.translation()), 0, 0.02);
  EXPECT_LT(rotation_error_deg(result.camera_from_model, truth), 0.05);
  const Eigen::Vector3d moved = result.camera_from_model.translation() - start.translation();
  EXPECT_LT((moved - moved.dot(normal) * normal).norm(), 0.05) << "pushed within its plane";
}

}  // namespace
}  // namespace partpose
