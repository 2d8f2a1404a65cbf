// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/virtual_depth_camera.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

VirtualDepthCameraOptions camera_with(const std::string& noise_model, float standard_deviation_mm) {
  VirtualDepthCameraOptions options;
  options.resolution_px = {320, 240};
  options.noise = {noise_model, standard_deviation_mm};
  return options;
}

/// A wall that fills the image.
const TriangleMesh wall = plane_patch(4000, 4000);
const Eigen::Isometry3d before_wall =
    Eigen::Isometry3d(Eigen::Translation3d(0, 0, 700)) * Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 0).normalized());

Eigen::Isometry3d bracket_pose() {
  Random random(5);
  return random_pose(random, {10, -20, 400});
}

TEST(LookAt, StandsAtThePositionAndLooksAtTheTarget) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d position = 700 * random_direction(random), target = 100 * random_direction(random);
    const auto pose = look_at(position, target);
    EXPECT_TRUE(is_rigid(pose.matrix(), 1e-12));
    EXPECT_EQ(pose.translation(), position);
    const Eigen::Vector3d x = pose.linear().col(0), y = pose.linear().col(1), z = pose.linear().col(2);
    EXPECT_NEAR((target - position).normalized().dot(z), 1, 1e-12);
    EXPECT_NEAR(x.z(), 0, 1e-12) << "the image's rows are level";
    EXPECT_LE(y.z(), 0) << "down in the image is down in the world";
    const Eigen::Vector3d seen = pose.inverse() * target;
    EXPECT_NEAR(seen.head<2>().norm(), 0, 1e-9);
    EXPECT_NEAR(seen.z(), (target - position).norm(), 1e-9);
  }
}

TEST(LookAt, StraightDownAndStraightUp) {
  for (const double side : {1.0, -1.0}) {
    const auto pose = look_at({20, 30, side * 500}, {20, 30, 0});
    EXPECT_TRUE(is_rigid(pose.matrix(), 1e-12));
    EXPECT_EQ(pose.linear().col(0), Eigen::Vector3d::UnitX());
    EXPECT_EQ(pose.linear().col(2), Eigen::Vector3d(0, 0, -side));
  }
  // As good as straight down.
  for (const double offset : {1e-12, 1e-8, 1e-6, 1e-4})
    EXPECT_TRUE(is_rigid(look_at({offset, -offset, 600}, {0, 0, 0}).matrix(), 1e-8)) << offset;
}

TEST(VirtualDepthCamera, CheckNamesTheKeyAndTheValue) {
  const auto with = [](auto change) {
    VirtualDepthCameraOptions options;
    change(options);
    return error_of([&] { options.check(); });
  };
  EXPECT_EQ(with([](auto&) {}), "no error");
  EXPECT_EQ(with([](auto& o) { o.noise = {"gaussian", 3}; }), "no error");
  EXPECT_EQ(with([](auto& o) { o.noise = {"gaussianray", 0}; }), "no error");
  EXPECT_EQ(with([](auto& o) { o.normals = "estimated"; }), "no error");
  EXPECT_PRED2(mentions, with([](auto& o) { o.noise.model = "Gaussian"; }), "model \"Gaussian\": must be \"none\"");
  for (const auto& model : {"none", "gaussian"}) {
    EXPECT_PRED2(mentions, with([&](auto& o) { o.noise = {model, -1}; }), "standard_deviation_mm -1");
    EXPECT_PRED2(mentions, with([&](auto& o) {
                   o.noise = {model, static_cast<float>(nan)};
                 }),
                 "standard_deviation_mm nan");
  }
  EXPECT_PRED2(mentions, with([](auto& o) { o.normals = "none"; }), "normals \"none\"");
  EXPECT_PRED2(mentions, with([](auto& o) { o.normal_estimation_radius_mm = 0; }), "normal_estimation_radius_mm 0");
  EXPECT_PRED2(mentions, with([](auto& o) { o.resolution_px = {0, 480}; }), "resolution_px 0");
  EXPECT_PRED2(mentions, with([](auto& o) { o.resolution_px = {640, 9000}; }), "resolution_px 9000");
  EXPECT_PRED2(mentions, with([](auto& o) { o.field_of_view_deg = {50, 180}; }), "field of view 180");
  EXPECT_PRED2(mentions, with([](auto& o) { o.field_of_view_deg = {nan, 40}; }), "field of view nan");
}

TEST(VirtualDepthCamera, IntrinsicsFollowTheOptions) {
  VirtualDepthCameraOptions options;
  options.field_of_view_deg = {90, 60};
  options.resolution_px = {200, 100};
  const auto camera = options.intrinsics();
  EXPECT_EQ(camera.width, 200);
  EXPECT_EQ(camera.height, 100);
  EXPECT_NEAR(camera.fx, 100, 1e-9);
  EXPECT_NEAR(camera.fy, 50 * std::sqrt(3), 1e-9);
}

TEST(Capture, IsTheRenderingAsPoints) {
  const auto options = camera_with("none", 5);
  const auto mesh = l_bracket();
  const auto depth = render(mesh, bracket_pose(), options.intrinsics()).depth;
  for (const bool organized : {false, true}) {
    const auto cloud = capture(mesh, bracket_pose(), options, organized);
    EXPECT_TRUE(same_bits(cloud.points, to_point_cloud(depth, options.intrinsics(), organized).points));
    EXPECT_EQ(cloud.is_organized(), organized);
    EXPECT_EQ(cloud.normals.size(), cloud.size());
    EXPECT_EQ(cloud.curvatures.size(), cloud.size());
  }
}

TEST(Capture, PointsLieOnTheMesh) {
  const auto mesh = l_bracket();
  const auto cloud = capture(mesh, bracket_pose(), camera_with("none", 0), false);
  ASSERT_GT(cloud.size(), 1000);
  double worst = 0;
  for (std::size_t i = 0; i < cloud.size(); i += 7)
    worst = std::max(worst, distance_to_mesh(bracket_pose().inverse() * cloud.points[i].cast<double>(), mesh));
  EXPECT_LT(worst, 1e-3);
}

TEST(Capture, MeshNormalsAreUnitAndFaceTheCamera) {
  auto inside_out = l_bracket();
  for (auto& [a, b, c] : inside_out.triangles) std::swap(b, c);
  const auto cloud = capture(l_bracket(), bracket_pose(), camera_with("none", 0), false);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_NEAR(cloud.normals[i].norm(), 1, 1e-5);
    EXPECT_LE(cloud.normals[i].dot(cloud.points[i]), 0);
    // The bracket's faces lie along its axes.
    EXPECT_NEAR((bracket_pose().linear().transpose() * cloud.normals[i].cast<double>()).cwiseAbs().maxCoeff(), 1, 1e-6);
    EXPECT_EQ(cloud.curvatures[i], 0);
  }
  EXPECT_TRUE(same_bits(capture(inside_out, bracket_pose(), camera_with("none", 0), false).normals, cloud.normals))
      << "what is seen faces the camera, whatever the winding";
}

TEST(Capture, FarOffTheAxisAFaceMayFaceTheCameraAndLookAwayFromItsImagePlane) {
  auto options = camera_with("none", 0);
  options.field_of_view_deg = {120, 100};
  int looking_away = 0;
  for (const double x : {-500.0, 500.0}) {
    const Eigen::Isometry3d pose = Eigen::Translation3d(x, 100, 400) *
                                   Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(x < 0 ? -0.6 : 0.6, Eigen::Vector3d::UnitY());
    const auto cloud = capture(box({150, 150, 150}), pose, options, false);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      EXPECT_LE(cloud.normals[i].dot(cloud.points[i]), 0);
      looking_away += cloud.normals[i].z() > 0.1f;
    }
  }
  EXPECT_GT(looking_away, 100);
}

TEST(Capture, EstimatedNormalsOfAWallAreTheMeshs) {
  auto options = camera_with("none", 0);
  const auto truth = capture(wall, before_wall, options, false);
  options.normals = "estimated";
  const auto cloud = capture(wall, before_wall, options, false);
  ASSERT_EQ(cloud.size(), truth.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_LT(angle_deg(cloud.normals[i].cast<double>(), truth.normals[i].cast<double>()), 0.02);
}

TEST(Capture, EstimatedNormalsAreOfTheNoisyPoints) {
  auto options = camera_with("gaussianray", 1);
  options.normals = "estimated";
  const Eigen::Vector3d mesh_normal =
      capture(wall, before_wall, camera_with("none", 0), false).normals[0].cast<double>();
  double squares = 0;
  const auto cloud = capture(wall, before_wall, options, false);
  for (const auto& normal : cloud.normals) squares += std::pow(angle_deg(normal.cast<double>(), mesh_normal), 2);
  const double rms_deg = std::sqrt(squares / static_cast<double>(cloud.size()));
  EXPECT_GT(rms_deg, 1);
  EXPECT_LT(rms_deg, 15);
}

TEST(Capture, SameSeedSameBitsOtherFrameOtherNoise) {
  for (const std::string model : {"gaussian", "gaussianray"}) {
    auto options = camera_with(model, 2);
    const auto first = capture(wall, before_wall, options, false, 3);
    EXPECT_TRUE(same_bits(first, capture(wall, before_wall, options, false, 3)));
    EXPECT_FALSE(same_bits(first, capture(wall, before_wall, options, false, 4)));
    options.noise_seed = 2;
    EXPECT_FALSE(same_bits(first, capture(wall, before_wall, options, false, 3)));
  }
}

TEST(Capture, OrganizedIsTheSameWithGaps) {
  for (const std::string model : {"none", "gaussian", "gaussianray"}) {
    for (const std::string normals : {"mesh", "estimated"}) {
      auto options = camera_with(model, 1.5f);
      options.normals = normals;
      const auto cloud = capture(l_bracket(), bracket_pose(), options, false, 8);
      const auto organized = capture(l_bracket(), bracket_pose(), options, true, 8);
      ASSERT_TRUE(organized.is_organized());
      EXPECT_EQ(organized.width, 320);
      EXPECT_EQ(organized.height, 240);
      EXPECT_TRUE(same_bits(without_missing(organized), without_missing(cloud)));
      for (std::size_t i = 0; i < organized.size(); ++i) {
        const bool missing = organized.points[i].array().isNaN().all();
        EXPECT_TRUE(missing || organized.points[i].allFinite());
        EXPECT_TRUE(!missing || organized.normals[i].array().isNaN().all());
      }
    }
  }
}

struct NoiseStatistics {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double between_neighbours = 0;  ///< covariance of the x offsets of neighbouring pixels
};

NoiseStatistics statistics_of(const PointCloud& noisy, const PointCloud& clean) {
  NoiseStatistics out;
  const auto count = static_cast<double>(clean.size());
  Eigen::Vector3d previous = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < clean.size(); ++i) {
    const Eigen::Vector3d offset = (noisy.points[i] - clean.points[i]).cast<double>();
    out.mean += offset / count;
    out.covariance += offset * offset.transpose() / count;
    out.between_neighbours += offset.x() * previous.x() / count;
    previous = offset;
  }
  return out;
}

TEST(Capture, GaussianNoiseIsTheSameInAllDirections) {
  for (const float deviation : {0.5f, 3.0f}) {
    const auto clean = capture(wall, before_wall, camera_with("none", 0), false);
    const auto noisy = capture(wall, before_wall, camera_with("gaussian", deviation), false);
    ASSERT_EQ(noisy.size(), 320 * 240);
    const auto statistics = statistics_of(noisy, clean);
    const double variance = deviation * deviation;
    EXPECT_LT(statistics.mean.norm(), 0.02 * deviation);
    EXPECT_LT((statistics.covariance - variance * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.025 * variance);
    EXPECT_LT(std::abs(statistics.between_neighbours), 0.02 * variance);
    EXPECT_EQ(noisy.normals, clean.normals);
  }
}

TEST(Capture, GaussianRayNoiseIsAlongTheLineOfSight) {
  for (const float deviation : {0.5f, 3.0f}) {
    const auto clean = capture(wall, before_wall, camera_with("none", 0), false);
    const auto noisy = capture(wall, before_wall, camera_with("gaussianray", deviation), false);
    ASSERT_EQ(noisy.size(), clean.size());
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      const Eigen::Vector3d before = clean.points[i].cast<double>(), after = noisy.points[i].cast<double>();
      EXPECT_LT(angle_deg(before, after), 2e-5);
      const double along = after.norm() - before.norm();
      sum += along;
      squares += along * along;
    }
    const auto count = static_cast<double>(clean.size());
    EXPECT_NEAR(std::sqrt(squares / count), deviation, 0.015 * deviation);
    EXPECT_NEAR(sum / count, 0, 0.02 * deviation);
  }
}

TEST(Capture, NoiseOfAPixelDoesNotDependOnWhatElseIsSeen) {
  // A plate alone, and with another above it: the same points.
  const auto options = camera_with("gaussian", 2);
  const Eigen::Isometry3d here(Eigen::Translation3d(0, 0, 600));
  const auto plate = plane_patch(100, 100);
  const auto above = moved(plate, Eigen::Isometry3d(Eigen::Translation3d(30, -150, 20)));
  const auto alone = capture(plate, here, options, true), together = capture(joined(plate, above), here, options, true);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < alone.size(); ++i) {
    if (!alone.points[i].allFinite()) continue;
    EXPECT_EQ(alone.points[i], together.points[i]);
    ++seen;
  }
  EXPECT_GT(seen, 1000);
  EXPECT_GT(without_missing(together).size(), seen + 1000);
}

TEST(Capture, NothingSeenIsAnEmptyCloud) {
  const Eigen::Isometry3d behind(Eigen::Translation3d(0, 0, -500));
  const auto nothing = capture(l_bracket(), behind, camera_with("gaussian", 1), false);
  EXPECT_TRUE(nothing.empty());
  const auto organized = capture(l_bracket(), behind, camera_with("gaussian", 1), true);
  EXPECT_EQ(organized.size(), 320 * 240);
  EXPECT_TRUE(without_missing(organized).empty());
}

}  // namespace
}  // namespace partpose
