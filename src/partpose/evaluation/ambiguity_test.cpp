// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/ambiguity.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/geometry/symmetry_search.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using shapes::error_of;
using shapes::mentions;

constexpr double distance_mm = 650;
const Intrinsics vga = Intrinsics::from_field_of_view(640, 480, 50, 40);

/// A shaft along z with a window cut into it about the +x direction, as wide and as high as given; 0: none.
TriangleMesh shaft(double half_width_deg, double half_height_mm) {
  constexpr int segments = 72, rings = 30;
  constexpr double radius = 20, length = 120;
  TriangleMesh mesh;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const double a = 2 * std::numbers::pi * s / segments;
      mesh.vertices.push_back(
          Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), length * (static_cast<double>(r) / rings - 0.5))
              .cast<float>());
    }
  for (const double z : {-length / 2, length / 2 + 0.0}) mesh.vertices.emplace_back(0.0f, 0.0f, static_cast<float>(z));
  const int bottom = segments * (rings + 1), top = bottom + 1;
  for (int s = 0; s < segments; ++s) {
    const int next = (s + 1) % segments;
    for (int r = 0; r < rings; ++r) {
      const double azimuth = std::abs(std::remainder(360.0 * (s + 0.5) / segments, 360.0));
      const double z = length * ((r + 0.5) / rings - 0.5);
      if (azimuth < half_width_deg && std::abs(z - 20) < half_height_mm) continue;
      shapes::add_quad(mesh, r * segments + s, r * segments + next, (r + 1) * segments + next, (r + 1) * segments + s);
    }
    shapes::add_triangle(mesh, bottom, next, s);
    shapes::add_triangle(mesh, top, rings * segments + s, rings * segments + next);
  }
  return mesh;
}
TriangleMesh shaft_with_window() { return shaft(12, 6); }

/// The camera looks at the origin from a direction of the model frame.
Eigen::Isometry3d seen_from(const Eigen::Vector3d& direction) {
  return look_at(distance_mm * direction.normalized(), Eigen::Vector3d::Zero()).inverse();
}
Eigen::Isometry3d about_z(double angle_deg) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(radians(angle_deg), Eigen::Vector3d::UnitZ()));
}

TEST(AmbiguityOptions, NoiseFollowsTheDepth) {
  AmbiguityOptions options;
  options.floor_mm = 1e-9;
  // facts: VGA at 0.7 m, 0.08 px: 1.04 mm; HD at 1 m: 1.45 mm.
  EXPECT_NEAR(options.sigma_mm(700, 686), 1.04, 0.005);
  EXPECT_NEAR(options.sigma_mm(1000, 1005), 1.45, 0.005);
  options.floor_mm = 0.3;
  EXPECT_NEAR(options.sigma_mm(1, 686), 0.3, 1e-6);
  EXPECT_PRED2(mentions, error_of([&] {
                 options.baseline_mm = 0;
                 options.check();
               }),
               "baseline_mm");
}

TEST(DepthDifference, CountsWhatNoiseDoesNotExplain) {
  AmbiguityOptions options;
  options.disparity_sigma_px = 0;
  options.floor_mm = 1;
  DepthImage a(40, 30), b(40, 30);
  for (int v = 5; v < 25; ++v)
    for (int u = 5; u < 35; ++u) a.at(u, v) = b.at(u, v) = 600;
  EXPECT_EQ(depth_difference(a, b, 600, options).union_px, 600);
  EXPECT_EQ(depth_difference(a, b, 600, options).differing_px, 0);
  // A block of 6 x 6 px, 10 mm deep: the outer ring has neighbours of the right depth, but only seen from one image.
  for (int v = 10; v < 16; ++v)
    for (int u = 10; u < 16; ++u) b.at(u, v) = 610;
  EXPECT_EQ(depth_difference(a, b, 600, options).differing_px, 36);
  EXPECT_EQ(depth_difference(b, a, 600, options).differing_px, 36);
  EXPECT_FALSE(depth_difference(a, b, 600, options).indistinguishable(options));
  // The same within the noise: seen in the mean square only.
  for (float& z : b.z_mm)
    if (z > 0) z = 600.5f;
  const auto half = depth_difference(a, b, 600, options);
  EXPECT_EQ(half.differing_px, 0);
  EXPECT_NEAR(half.rms_sigmas, 0.5, 1e-3);
  EXPECT_TRUE(half.indistinguishable(options));
  for (float& z : b.z_mm)
    if (z > 0) z = 601.5f;
  EXPECT_FALSE(depth_difference(a, b, 600, options).indistinguishable(options));
  EXPECT_PRED2(mentions, error_of([&] { depth_difference(a, DepthImage(3, 3), 600, options); }), "3 x 3");
}

TEST(DepthDifference, EdgesMayGrowByAPixel) {
  AmbiguityOptions options;
  DepthImage a(60, 60), b(60, 60), c(60, 60);
  for (int v = 10; v < 50; ++v)
    for (int u = 10; u < 50; ++u) a.at(u, v) = 600;
  for (int v = 9; v < 51; ++v)
    for (int u = 9; u < 51; ++u) b.at(u, v) = 600;
  for (int v = 8; v < 52; ++v)
    for (int u = 8; u < 52; ++u) c.at(u, v) = 600;
  EXPECT_EQ(depth_difference(a, b, 600, options).differing_px, 0);
  EXPECT_EQ(depth_difference(a, c, 600, options).differing_px, 44 * 44 - 42 * 42);
  EXPECT_FALSE(depth_difference(a, c, 600, options).indistinguishable(options));
  EXPECT_FALSE(depth_difference(a, DepthImage(60, 60), 600, options).indistinguishable(options));
}

TEST(Indistinguishable, AShaftWhoseWindowIsHidden) {
  const TriangleMesh part = shaft_with_window();
  const auto from_behind = seen_from({-1, 0.1, 0.2}), from_front = seen_from({1, 0.1, 0.2});
  for (const double turn : {25.0, -40.0, 60.0})
    EXPECT_TRUE(indistinguishable(part, from_behind, part, from_behind * about_z(turn), vga)) << turn;
  EXPECT_FALSE(indistinguishable(part, from_behind, part, from_behind * about_z(180), vga));
  for (const double turn : {25.0, -40.0, 60.0, 180.0})
    EXPECT_FALSE(indistinguishable(part, from_front, part, from_front * about_z(turn), vga)) << turn;
  // The plain shaft is another part, and looks the same from behind.
  const TriangleMesh plain = shaft(0, 0);
  EXPECT_TRUE(indistinguishable(part, from_behind, plain, from_behind, vga));
  EXPECT_FALSE(indistinguishable(part, from_front, plain, from_front, vga));
}

TEST(Indistinguishable, ShiftsBelowTheNoiseOnly) {
  const TriangleMesh block = shapes::box({80, 60, 40});
  const auto pose = seen_from({0.4, 0.3, 1});
  const auto shifted = [&](double z_mm) { return Eigen::Translation3d(0, 0, z_mm) * pose; };
  const AmbiguityOptions options;
  const double sigma = options.sigma_mm(distance_mm, vga.fx);  // 0.95 mm
  EXPECT_TRUE(indistinguishable(block, pose, block, shifted(0.5 * sigma), vga));
  EXPECT_FALSE(indistinguishable(block, pose, block, shifted(4 * sigma), vga));
  // A noisier camera cannot tell.
  AmbiguityOptions noisy;
  noisy.disparity_sigma_px = 0.5;
  EXPECT_TRUE(indistinguishable(block, pose, block, shifted(3 * sigma), vga, noisy));
}

TEST(Indistinguishable, ASlowErrorIsTheCamerasOwn) {
  const TriangleMesh part = shaft_with_window();
  const AmbiguityOptions options = AmbiguityOptions::of(NoiseOptions{.model = "stereo"});
  const auto nearer = [&](const Eigen::Isometry3d& pose, double share) {
    return Eigen::Isometry3d(Eigen::Translation3d(0, 0, -share * distance_mm) * pose);
  };
  const auto from_behind = seen_from({-1, 0.1, 0.2}), from_front = seen_from({1, 0.1, 0.2});
  EXPECT_FALSE(indistinguishable(part, from_behind, part, nearer(from_behind, 0.004), vga));
  EXPECT_TRUE(indistinguishable(part, from_behind, part, nearer(from_behind * about_z(40), 0.004), vga, options));
  EXPECT_FALSE(indistinguishable(part, from_behind, part, nearer(from_behind, 0.012), vga, options));
  // It is no excuse for what can be seen all the same.
  EXPECT_FALSE(indistinguishable(part, from_front, part, nearer(from_front * about_z(40), 0.004), vga, options));
}

/// What a camera without noise measures of a part, and of a plane across the view with the pixels [u0, u1).
DepthImage measured_behind(const TriangleMesh& part, const Eigen::Isometry3d& pose, float plane_mm, int u0, int u1) {
  DepthImage measured = render(part, pose, vga).depth;
  for (int v = 0; v < measured.height; ++v)
    for (int u = u0; u < u1; ++u)
      if (!(measured.at(u, v) > 0) || measured.at(u, v) > plane_mm) measured.at(u, v) = plane_mm;
  return measured;
}

TEST(Indistinguishable, WhatIsNearerHidesTheDifference) {
  const TriangleMesh part = shaft_with_window();
  const auto from_front = seen_from({1, 0.1, 0.2}), turned = from_front * about_z(180);
  const double window_u = vga.project(from_front * Eigen::Vector3d(20, 0, 20)).x();
  const int u0 = static_cast<int>(window_u) - 20, u1 = u0 + 40;
  const AmbiguityOptions options;
  const auto same_with_plate_at = [&](float plane_mm, int from, int to) {
    return indistinguishable(part, turned, part, from_front, vga, options,
                             measured_behind(part, from_front, plane_mm, from, to));
  };
  EXPECT_TRUE(same_with_plate_at(500, u0, u1));
  EXPECT_FALSE(same_with_plate_at(500, u1, u1 + 40));   // before something else
  EXPECT_FALSE(same_with_plate_at(800, 0, vga.width));  // behind the part
  EXPECT_FALSE(same_with_plate_at(500, 0, 0));
}

TEST(Indistinguishable, APoseBeneathTheTableIsNotHidden) {
  const TriangleMesh block = shapes::box({80, 60, 40});
  const auto pose = seen_from({0, 0, 1});
  // Twice as long and behind the table, but for where the true one is seen.
  const TriangleMesh longer = shapes::box({160, 60, 40});
  const auto table_mm = static_cast<float>(distance_mm - 20 + 5);
  const DepthImage measured = measured_behind(block, pose, table_mm, 0, vga.width);
  const auto deeper = Eigen::Isometry3d(Eigen::Translation3d(0, 0, 30)) * pose;
  EXPECT_FALSE(indistinguishable(longer, deeper, block, pose, vga, {}, measured));
  // The block as it is on a table that reaches farther up than its lower half.
  EXPECT_TRUE(indistinguishable(block, pose, block, pose, vga, {}, measured));
}

TEST(Indistinguishable, TheFrameIsTheCameras) {
  const TriangleMesh block = shapes::box({80, 60, 40});
  const auto pose = seen_from({0, 0, 1});
  EXPECT_PRED2(mentions, error_of([&] { indistinguishable(block, pose, block, pose, vga, {}, DepthImage(320, 240)); }),
               "320 x 240");
}

TEST(Indistinguishable, OutOfView) {
  const TriangleMesh block = shapes::box({80, 60, 40});
  const auto pose = seen_from({0, 0, 1});
  const auto away = Eigen::Isometry3d(Eigen::Translation3d(5000, 0, 0)) * pose;
  const auto behind = Eigen::Isometry3d(Eigen::Translation3d(0, 0, -2000)) * pose;
  EXPECT_FALSE(indistinguishable(block, pose, block, away, vga));
  EXPECT_FALSE(indistinguishable(block, pose, block, behind, vga));
  EXPECT_TRUE(indistinguishable(block, away, block, away, vga));
}

class SearchOfShafts : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::vector<AmbiguityPart> parts;
    parts.push_back({"window", shaft_with_window(), {}});
    parts.push_back({"plain", shaft(0, 0), find_symmetries(shaft(0, 0), 0.5)});
    parts.push_back({"block", shapes::box({120, 70, 20}), find_symmetries(shapes::box({120, 70, 20}), 0.5)});
    search_ = new AmbiguitySearch(std::move(parts), vga);
  }
  static void TearDownTestSuite() { delete search_; }
  static AmbiguitySearch* search_;
};
AmbiguitySearch* SearchOfShafts::search_ = nullptr;

TEST_F(SearchOfShafts, TurnsThatKeepTheWindowHidden) {
  const auto pose = seen_from({-1, 0.1, 0.2});
  const auto found = search_->at(0, pose);
  int own = 0, plain = 0;
  double largest_turn = 0;
  for (const auto& other : found) {
    EXPECT_NE(other.part, 2);
    EXPECT_TRUE(indistinguishable(search_->parts()[0].mesh, pose, search_->parts()[other.part].mesh,
                                  other.camera_from_model, vga));
    if (other.part == 1) ++plain;
    if (other.part != 0) continue;
    ++own;
    EXPECT_GE(other.displacement_mm, 0.05 * 120);
    largest_turn = std::max(largest_turn, rotation_error_deg(other.camera_from_model, pose));
  }
  EXPECT_GE(own, 5);
  EXPECT_GT(largest_turn, 50);
  EXPECT_EQ(plain, 1);  // its turns are symmetries: one pose stands for all
}

TEST_F(SearchOfShafts, NoneWhenTheWindowIsSeen) { EXPECT_TRUE(search_->at(0, seen_from({1, 0.1, 0.2})).empty()); }

TEST_F(SearchOfShafts, SymmetriesAreNoAmbiguity) { EXPECT_TRUE(search_->at(2, seen_from({0.5, 0.4, 1})).empty()); }

TEST_F(SearchOfShafts, BadInput) {
  EXPECT_PRED2(mentions, error_of([] { AmbiguitySearch({}, vga); }), "no parts");
  EXPECT_PRED2(mentions, error_of([] { search_->at(3, seen_from({1, 0, 0})); }), "part 3 of 3");
}

}  // namespace
}  // namespace partpose
