// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/resting_poses.hpp"

#include "partpose/geometry/convex_hull.hpp"
#include "partpose/geometry/icosphere.hpp"
#include "partpose/io/stl.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <numeric>

namespace partpose {
namespace {

using std::numbers::pi;

/// Solid angle of a rectangle seen from above its middle.
double rectangle_share(double a, double b, double height) {
  return 4 * std::atan(a * b / (2 * height * std::sqrt(4 * height * height + a * a + b * b))) / (4 * pi);
}

double triangle_share(Eigen::Vector3d a, Eigen::Vector3d b, Eigen::Vector3d c) {
  // Girard: the excess of the angles between the planes through the eye and the sides.
  const auto angle = [](const Eigen::Vector3d& at, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return radians(shapes::angle_deg(at.cross(p), at.cross(q)));
  };
  return (angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - pi) / (4 * pi);
}

const RestingPose* pose_with_down(const RestingPoses& poses, const Eigen::Vector3d& down, double within_deg = 0.5) {
  for (const auto& pose : poses.poses)
    if (shapes::angle_deg(pose.down, down) < within_deg) return &pose;
  return nullptr;
}

double height_above_table(const TriangleMesh& mesh, const Eigen::Vector3d& centre, const Eigen::Vector3d& down) {
  double height = 0;
  for (const auto& v : mesh.vertices) height = std::max(height, down.dot(v.cast<double>() - centre));
  return height;
}

/// What holds of any part: a chance of 1 in all, on the table, z up, and no small tilt lowers the centre of mass.
void expect_physical(const TriangleMesh& mesh, const RestingPoses& poses, double slack_mm = 1e-3) {
  ASSERT_FALSE(poses.poses.empty());
  double sum = 0;
  Random random(11);
  for (const auto& pose : poses.poses) {
    sum += pose.probability;
    EXPECT_GT(pose.probability, 0);
    EXPECT_TRUE(is_rigid(pose.table_from_model.matrix(), 1e-9));
    EXPECT_NEAR((pose.table_from_model.linear() * pose.down + Eigen::Vector3d::UnitZ()).norm(), 0, 1e-9);
    double lowest = 1e300;
    for (const auto& v : mesh.vertices) lowest = std::min(lowest, (pose.table_from_model * v.cast<double>()).z());
    EXPECT_NEAR(lowest, 0, 1e-4);
    const Eigen::Vector3d centre = pose.table_from_model * poses.centre_of_mass_mm;
    EXPECT_LT(centre.head<2>().norm(), 1e-9);
    EXPECT_NEAR(centre.z(), pose.centre_height_mm, slack_mm);
    EXPECT_LT(pose.group, poses.groups);
    for (int i = 0; i < 50; ++i) {
      const double tilt_deg = pose.stability_deg * random.uniform();
      const Eigen::Vector3d axis = pose.down.cross(shapes::random_direction(random)).normalized();
      const Eigen::Vector3d tilted = Eigen::AngleAxisd(radians(tilt_deg), axis) * pose.down;
      EXPECT_GT(height_above_table(mesh, poses.centre_of_mass_mm, tilted), pose.centre_height_mm - slack_mm);
    }
  }
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_TRUE(std::is_sorted(poses.poses.begin(), poses.poses.end(),
                             [](const auto& a, const auto& b) { return a.probability > b.probability; }));
}

/// Lowers the centre of mass by smaller and smaller random tilts: where any orientation ends, knowing nothing of faces.
Eigen::Vector3d settled(const TriangleMesh& mesh, const Eigen::Vector3d& centre, Eigen::Vector3d down, Random& random) {
  double height = height_above_table(mesh, centre, down);
  for (double step_deg = 2; step_deg > 1e-3;) {
    bool lower = false;
    for (int i = 0; i < 60 && !lower; ++i) {
      const Eigen::Vector3d next =
          (down + std::tan(radians(step_deg)) * down.cross(shapes::random_direction(random)).normalized()).normalized();
      const double h = height_above_table(mesh, centre, next);
      if (h < height) {
        lower = true;
        height = h;
        down = next;
      }
    }
    if (!lower) step_deg /= 2;
  }
  return down;
}

TriangleMesh cone(double radius, double height, int segments) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, static_cast<float>(height)}};
  for (int s = 0; s < segments; ++s)
    mesh.vertices.push_back(
        Eigen::Vector3d(radius * std::cos(2 * pi * s / segments), radius * std::sin(2 * pi * s / segments), 0)
            .cast<float>());
  for (int s = 0; s < segments; ++s) {
    const int a = 2 + s, b = 2 + (s + 1) % segments;
    shapes::add_triangle(mesh, 0, b, a);
    shapes::add_triangle(mesh, 1, a, b);
  }
  return mesh;
}

TriangleMesh hull_mesh(const std::vector<Eigen::Vector3f>& points) {
  const ConvexHull hull = convex_hull(points);
  TriangleMesh mesh;
  for (const auto& v : hull.vertices) mesh.vertices.push_back(v.cast<float>());
  mesh.triangles = hull.triangles;
  return mesh;
}

TEST(RestingPoses, OfABoxAreItsSixFacesByTheirSolidAngles) {
  const auto mesh = shapes::box(Eigen::Vector3f(60, 40, 20));
  const auto poses = resting_poses(mesh);
  expect_physical(mesh, poses);
  ASSERT_EQ(poses.poses.size(), 6u);
  EXPECT_EQ(poses.groups, 6);
  EXPECT_TRUE(poses.centre_of_mass_from_mesh);
  const std::array<double, 3> size = {60, 40, 20};
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const double a = size[(axis + 1) % 3], b = size[(axis + 2) % 3], half = size[axis] / 2;
      const auto* pose = pose_with_down(poses, sign * Eigen::Vector3d::Unit(axis), 1e-3);
      ASSERT_NE(pose, nullptr);
      EXPECT_NEAR(pose->probability, rectangle_share(a, b, half), 1e-6);
      EXPECT_NEAR(pose->centre_height_mm, half, 1e-4);
      EXPECT_NEAR(pose->stability_deg, degrees(std::atan2(std::min(a, b) / 2, half)), 1e-3);
    }
}

TEST(RestingPoses, OfACubeAreEquallyLikely) {
  for (const auto& pose : resting_poses(shapes::box(Eigen::Vector3f(30, 30, 30))).poses) {
    EXPECT_NEAR(pose.probability, 1 / 6.0, 1e-6);
    EXPECT_NEAR(pose.stability_deg, 45, 1e-3);
  }
}

TEST(RestingPoses, DoNotDependOnTheModelFrameOrOnTheDirectionOfTheTriangles) {
  Random random(3);
  const auto mesh = shapes::l_bracket();
  const auto expected = resting_poses(mesh);
  for (int i = 0; i < 10; ++i) {
    const auto target_from_mesh = shapes::random_pose(random, {100, -50, 30});
    auto moved = shapes::moved(mesh, target_from_mesh);
    if (i % 2)
      for (auto& t : moved.triangles) std::swap(t[0], t[1]);
    const auto poses = resting_poses(moved);
    expect_physical(moved, poses);
    EXPECT_TRUE(poses.centre_of_mass_from_mesh);
    ASSERT_EQ(poses.poses.size(), expected.poses.size());
    for (const auto& pose : expected.poses) {
      const auto* found = pose_with_down(poses, target_from_mesh.linear() * pose.down, 0.01);
      ASSERT_NE(found, nullptr);
      EXPECT_NEAR(found->probability, pose.probability, 1e-4);
      EXPECT_NEAR(found->stability_deg, pose.stability_deg, 0.01);
    }
  }
}

TEST(RestingPoses, OfAnLBracketTopplesFromTheEndsOfItsLegs) {
  const auto mesh = shapes::l_bracket();
  const auto poses = resting_poses(mesh);
  expect_physical(mesh, poses);
  // Both legs by hand: 80 x 12 about (40, 6) and 12 x 38 about (6, 31).
  const double area = 80 * 12 + 12 * 38;
  const Eigen::Vector3d centre((960.0 * 40 + 456 * 6) / area, (960.0 * 6 + 456 * 31) / area, 15);
  EXPECT_LT((poses.centre_of_mass_mm - centre).norm(), 1e-4);
  ASSERT_EQ(poses.poses.size(), 5u);
  // Standing on an end the centre of mass is beyond the inner side of the leg: it falls on the slanted face of the
  // hull, the one between the ends.
  const Eigen::Vector3d a(80, 12, 0), b(12, 50, 0), up(0, 0, 30);
  const auto share = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {  // of the face from p to q, 30 mm wide
    return triangle_share(p - centre, q - centre, q + up - centre) +
           triangle_share(p - centre, q + up - centre, p + up - centre);
  };
  const auto* slanted = pose_with_down(poses, Eigen::Vector3d(38, 68, 0).normalized(), 0.01);
  ASSERT_NE(slanted, nullptr);
  EXPECT_NEAR(slanted->probability, share(a, b) + share({80, 0, 0}, a) + share(b, {0, 50, 0}), 1e-6);
  const auto* left = pose_with_down(poses, {-1, 0, 0}, 0.01);
  ASSERT_NE(left, nullptr);
  EXPECT_NEAR(left->probability, share({0, 50, 0}, {0, 0, 0}), 1e-6);
  EXPECT_NEAR(left->stability_deg, degrees(std::atan2(centre.y(), centre.x())), 1e-3);
  EXPECT_EQ(pose_with_down(poses, {1, 0, 0}, 0.01), nullptr);
}

TEST(RestingPoses, AreWhereTheCentreOfMassCannotSink) {
  Random random(5);
  for (const auto& mesh : {shapes::l_bracket(), shapes::box(Eigen::Vector3f(60, 40, 20)), cone(25, 40, 12),
                           read_stl(std::filesystem::path(PARTPOSE_SOURCE_DIR) / "parts/bracket.stl")}) {
    const auto poses = resting_poses(mesh);
    expect_physical(mesh, poses, 0.02);
    const auto hull = hull_mesh(mesh.vertices);
    int missed = 0;
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector3d down = settled(hull, poses.centre_of_mass_mm, shapes::random_direction(random), random);
      missed += pose_with_down(poses, down, 6) == nullptr;
    }
    EXPECT_LE(missed, 1);  // descent by random tilts may get stuck in a narrow valley
  }
}

TEST(RestingPoses, OfACylinderAreTwoEndsAndAnyTurnOnItsSide) {
  for (const int segments : {24, 64, 128}) {
    const auto mesh = shapes::cylinder(20, 60, segments);
    const auto poses = resting_poses(mesh);
    expect_physical(mesh, poses);
    EXPECT_EQ(poses.groups, 3);
    std::vector<double> of_group(3, 0.0);
    for (const auto& pose : poses.poses) {
      of_group[pose.group] += pose.probability;
      for (const auto& other : poses.poses) {
        if (&other != &pose) {
          EXPECT_GT(shapes::angle_deg(pose.down, other.down), 4.0);
        }
      }
    }
    const double disc = (1 - 30 / std::hypot(30, 20)) / 2;
    std::sort(of_group.begin(), of_group.end());
    EXPECT_NEAR(of_group[0], disc, 2e-3);
    EXPECT_NEAR(of_group[1], disc, 2e-3);
    EXPECT_NEAR(of_group[2], 1 - 2 * disc, 4e-3);
    EXPECT_GE(poses.poses.size(), 22u);  // still as many turns as 4 degrees leave, for keyways and the like
  }
}

TEST(RestingPoses, ALongPinDoesNotStandOnItsEnd) {
  // atan(3 / 100) = 1.7 degrees: stable in theory.
  const auto poses = resting_poses(shapes::cylinder(3, 200, 32));
  expect_physical(shapes::cylinder(3, 200, 32), poses);
  EXPECT_EQ(pose_with_down(poses, {0, 0, 1}), nullptr);
  EXPECT_EQ(pose_with_down(poses, {0, 0, -1}), nullptr);
  EXPECT_EQ(poses.groups, 1);
  RestingPoseOptions theory;
  theory.least_stability_deg = 0;
  EXPECT_NE(pose_with_down(resting_poses(shapes::cylinder(3, 200, 32), theory), {0, 0, 1}), nullptr);
}

TEST(RestingPoses, OfAConeAreItsBaseAndItsSide) {
  const auto mesh = cone(20, 50, 48);
  const auto poses = resting_poses(mesh);
  expect_physical(mesh, poses);
  EXPECT_LT((poses.centre_of_mass_mm - Eigen::Vector3d(0, 0, 12.5)).norm(), 1e-4);
  EXPECT_EQ(poses.groups, 2);
  const auto* base = pose_with_down(poses, {0, 0, -1});
  ASSERT_NE(base, nullptr);
  EXPECT_NEAR(base->probability, (1 - 12.5 / std::hypot(12.5, 20)) / 2, 2e-3);
  EXPECT_NEAR(base->centre_height_mm, 12.5, 1e-4);
}

TEST(RestingPoses, ASphereRestsAnyhow) {
  std::vector<Eigen::Vector3f> points;
  for (const auto& direction : icosphere_directions(3, true)) points.push_back((30 * direction).cast<float>());
  const auto mesh = hull_mesh(points);
  const auto poses = resting_poses(mesh);
  expect_physical(mesh, poses);
  EXPECT_EQ(poses.groups, 1);
  EXPECT_GT(poses.poses.size(), 100u);
  for (const auto& pose : poses.poses) EXPECT_LT(pose.probability, 0.02);
}

TEST(RestingPoses, AHalfSphereStandsUpAgain) {
  std::vector<Eigen::Vector3f> points;
  for (int ring = 0; ring <= 15; ++ring)
    for (int s = 0; s < 60; ++s) {
      const double polar = pi / 2 * ring / 15, azimuth = 2 * pi * s / 60;
      points.push_back((30 * Eigen::Vector3d(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                             std::cos(polar)))
                           .cast<float>());
    }
  const auto mesh = hull_mesh(points);
  const auto poses = resting_poses(mesh);
  expect_physical(mesh, poses);
  EXPECT_NEAR(poses.centre_of_mass_mm.z(), 3 * 30 / 8.0, 0.05);
  const auto* flat = pose_with_down(poses, {0, 0, -1});
  ASSERT_NE(flat, nullptr);
  EXPECT_NEAR(flat->probability, (1 - 11.25 / std::hypot(11.25, 30)) / 2, 3e-3);
  for (const auto& pose : poses.poses) {
    if (&pose != flat) {
      EXPECT_LT(shapes::angle_deg(pose.down, {0, 0, 1}), 12);
    }
  }
}

TEST(RestingPoses, OfAnOpenMeshComeFromItsHull) {
  auto mesh = shapes::box(Eigen::Vector3f(60, 40, 20));
  const auto closed = resting_poses(mesh);
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);  // the lid; its corners remain
  const auto open = resting_poses(mesh);
  expect_physical(mesh, open);
  EXPECT_FALSE(open.centre_of_mass_from_mesh);
  ASSERT_EQ(open.poses.size(), 6u);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(open.poses[i].probability, closed.poses[i].probability, 1e-9);

  auto mixed = shapes::l_bracket();
  std::swap(mixed.triangles[3][0], mixed.triangles[3][1]);
  EXPECT_FALSE(resting_poses(mixed).centre_of_mass_from_mesh);
}

TEST(RestingPoses, OfAFlatPlateAreItsSides) {
  const auto sheet = shapes::plane_patch(60, 40, 3);  // no thickness at all
  const auto poses = resting_poses(sheet);
  expect_physical(sheet, poses);
  ASSERT_EQ(poses.poses.size(), 2u);
  for (const auto& pose : poses.poses) {
    EXPECT_NEAR(pose.probability, 0.5, 1e-9);
    EXPECT_NEAR(pose.stability_deg, 90, 1e-6);
  }
  const auto plate = shapes::box(Eigen::Vector3f(100, 80, 1));  // 0.6 degrees on its edges
  const auto thin = resting_poses(plate);
  expect_physical(plate, thin);
  ASSERT_EQ(thin.poses.size(), 2u);
  EXPECT_NEAR(thin.poses[0].probability, 0.5, 1e-6);
}

TEST(RestingPoses, OfTheShippedPartsAreFew) {
  for (const char* name : {"bracket", "elbow_100", "flange", "housing", "keyed_shaft", "link", "mount_left",
                           "pocket_plate", "pump_body", "t_plate"}) {
    const auto mesh = read_stl(std::filesystem::path(PARTPOSE_SOURCE_DIR) / "parts" / (std::string(name) + ".stl"));
    const auto poses = resting_poses(mesh);
    SCOPED_TRACE(name);
    expect_physical(mesh, poses, 0.05);
    EXPECT_TRUE(poses.centre_of_mass_from_mesh);
    EXPECT_LE(poses.groups, 14);
    std::string text;
    for (const auto& pose : poses.poses)
      text += fmt::format(" {}:{:.3f}/{:.0f}", pose.group, pose.probability, pose.stability_deg);
    RecordProperty(name, text);
  }
}

TEST(RestingPoses, RefuseWhatIsNoPart) {
  EXPECT_PRED2(shapes::mentions, shapes::error_of([] { resting_poses(TriangleMesh{}); }), "no points");
  auto mesh = shapes::box(Eigen::Vector3f(1, 2, 3));
  mesh.vertices[3].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_PRED2(shapes::mentions, shapes::error_of([&] { resting_poses(mesh); }), "not finite");
  TriangleMesh needle;
  needle.vertices = {{0, 0, 0}, {1, 0, 0}, {5, 0, 0}};
  needle.triangles = {{0, 1, 2}};
  EXPECT_PRED2(shapes::mentions, shapes::error_of([&] { resting_poses(needle); }), "one line");
  RestingPoseOptions options;
  options.merge_deg = -1;
  EXPECT_PRED2(shapes::mentions, shapes::error_of([&] { resting_poses(shapes::l_bracket(), options); }),
               "merge_deg -1");
}

}  // namespace
}  // namespace partpose
