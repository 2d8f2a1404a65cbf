// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/verification/render_compare.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

const Intrinsics camera = Intrinsics::from_field_of_view(160, 120, 16, 12);

Eigen::Isometry3d at(double x, double y, double z) { return Eigen::Isometry3d(Eigen::Translation3d(x, y, z)); }

/// What a camera sees of an object alone; `background_mm` 0: nothing measured around it.
LabelledDepth frame_of(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, float background_mm = 0) {
  LabelledDepth frame{camera, render(mesh, camera_from_model, camera).depth, {}};
  for (float& z : frame.depth.z_mm) {
    frame.label.push_back(z > 0               ? PixelLabel::object
                          : background_mm > 0 ? PixelLabel::background
                                              : PixelLabel::nothing);
    if (!(z > 0)) z = background_mm;
  }
  return frame;
}

int pixels_of(const LabelledDepth& frame, PixelLabel label) {
  return static_cast<int>(std::count(frame.label.begin(), frame.label.end(), label));
}

TEST(RenderCompare, TheTruePoseExplainsAll) {
  Random random(1);
  for (int round = 0; round < 10; ++round) {
    const auto pose = random_pose(random, {0, 0, 600});
    for (const float background : {0.0f, 800.0f}) {
      const auto frame = frame_of(l_bracket(), pose, background);
      const auto result = render_and_compare(l_bracket(), pose, frame, {});
      EXPECT_EQ(result.object, pixels_of(frame, PixelLabel::object));
      EXPECT_EQ(result.model, result.object);
      EXPECT_EQ(result.unexplained, 0);
      EXPECT_EQ(result.free_space, 0);
      EXPECT_EQ(result.hidden, 0);
      EXPECT_EQ(result.nothing, 0);
      EXPECT_DOUBLE_EQ(result.cost, 0);
      EXPECT_DOUBLE_EQ(result.score(), 1);
    }
  }
}

TEST(RenderCompare, TheFartherAwayTheWorse) {
  Random random(2);
  for (int round = 0; round < 10; ++round) {
    const auto pose = random_pose(random, {0, 0, 600});
    const auto frame = frame_of(l_bracket(), pose, 800);
    const Eigen::Vector3d direction = random_direction(random);
    double before = 0.95;
    for (const double shift : {3.0, 8.0, 20.0, 40.0}) {
      const auto result = render_and_compare(l_bracket(), Eigen::Translation3d(shift * direction) * pose, frame, {});
      EXPECT_LT(result.score(), before + 0.02) << "round " << round << ", " << shift << " mm";
      EXPECT_GE(result.score(), 0);
      before = result.score();
    }
    EXPECT_LT(before, 0.2);
  }
}

TEST(RenderCompare, DepthsThatDifferByTheToleranceExplainNothing) {
  const auto plate = box({60, 60, 5});
  const auto frame = frame_of(plate, at(0, 0, 600));
  // Away from the camera: the silhouette stays within that of the object.
  const auto score_of = [&](double shift) {
    return render_and_compare(plate, at(0, 0, 600 + shift), frame, {}).score();
  };
  EXPECT_NEAR(score_of(2), 1 - 0.25, 0.02) << "half of the tolerance costs a quarter";
  EXPECT_NEAR(score_of(4.1), 0, 0.02);
  EXPECT_NEAR(score_of(50), 0, 0.02);
  const auto deeper = render_and_compare(plate, at(0, 0, 606), frame, {});
  EXPECT_EQ(deeper.unexplained, 0) << "the part is rendered there, if at another depth";
}

TEST(RenderCompare, APartBeforeTheBackgroundCannotBeThere) {
  const auto block = box({40, 40, 40});
  LabelledDepth wall{camera, DepthImage(camera.width, camera.height), {}};
  wall.depth.z_mm.assign(wall.depth.z_mm.size(), 700);
  wall.label.assign(wall.depth.z_mm.size(), PixelLabel::background);
  const auto before = render_and_compare(block, at(0, 0, 600), wall, {});
  EXPECT_GT(before.model, 1000);
  EXPECT_EQ(before.free_space, before.model);
  EXPECT_EQ(before.hidden, 0);
  EXPECT_DOUBLE_EQ(before.score(), 0);
  const auto behind = render_and_compare(block, at(0, 0, 800), wall, {.hidden_cost = 0.25f});
  EXPECT_EQ(behind.hidden, behind.model);
  EXPECT_EQ(behind.free_space, 0);
  EXPECT_DOUBLE_EQ(behind.score(), 0.75);
}

TEST(RenderCompare, WhereNothingWasMeasuredLittleCanBeSaid) {
  const LabelledDepth dark{camera, DepthImage(camera.width, camera.height),
                           std::vector<PixelLabel>(160 * 120, PixelLabel::nothing)};
  const auto result = render_and_compare(box({40, 40, 40}), at(0, 0, 600), dark, {.nothing_cost = 0.5f});
  EXPECT_GT(result.model, 1000);
  EXPECT_EQ(result.nothing, result.model);
  EXPECT_DOUBLE_EQ(result.score(), 0.5);
}

TEST(RenderCompare, BothDirectionsCount) {
  const auto small = box({30, 30, 10}), large = box({60, 60, 10});
  const auto pose = at(0, 0, 600);
  const auto small_in_large = render_and_compare(small, pose, frame_of(large, pose, 800), {});
  EXPECT_GT(small_in_large.unexplained, small_in_large.object / 2);
  EXPECT_EQ(small_in_large.free_space, 0);
  EXPECT_LT(small_in_large.score(), 0.6);
  const auto large_on_small = render_and_compare(large, pose, frame_of(small, pose, 800), {});
  EXPECT_GT(large_on_small.free_space, large_on_small.model / 2);
  EXPECT_LT(large_on_small.score(), 0.6);
}

TEST(RenderCompare, NothingInCommonScoresZero) {
  const auto block = box({40, 40, 40});
  const auto result = render_and_compare(block, at(-50, 0, 600), frame_of(block, at(50, 0, 600), 800), {});
  EXPECT_EQ(result.unexplained, result.object);
  EXPECT_EQ(result.free_space, result.model);
  EXPECT_DOUBLE_EQ(result.score(), 0);
  // No part in the image, no object in the frame.
  const LabelledDepth dark{camera, DepthImage(camera.width, camera.height),
                           std::vector<PixelLabel>(160 * 120, PixelLabel::nothing)};
  EXPECT_EQ(render_and_compare(block, at(0, 0, -600), dark, {}).score(), 0);
}

}  // namespace
}  // namespace partpose
