// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/icp.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>
#include <Eigen/QR>

namespace partpose {
namespace {

using namespace shapes;

/// Stops only when the last digits are there.
PoseRefinementOptions exact_options(bool symmetric) {
  PoseRefinementOptions options;
  options.use_symmetric_objective = symmetric;
  options.transformation_epsilon = 1e-4f;  // floats end at 3e-5 mm where the parts lie
  options.euclidean_fitness_epsilon = 1e-6f;
  return options;
}

struct Case {
  PointCloud source, target;
  Eigen::Isometry3d target_from_source = Eigen::Isometry3d::Identity();  ///< the truth, where there is one
};

/// The surface of a part somewhere in space, and some of its points moved away by at most so much.
Case moved_surface(Random& random, const TriangleMesh& mesh, const Eigen::Vector3d& position_mm, double angle_deg,
                   double distance_mm, int target_points = 4000, int source_points = 1500) {
  Case out;
  const auto pose = random_pose(random, position_mm);
  out.target = transformed(surface_points(mesh, target_points, random), pose);
  std::vector<int> some;
  for (int i = 0; i < source_points; ++i) some.push_back(i * target_points / source_points);
  const Eigen::Vector3d centre = pose * bounding_box(mesh).center();
  out.target_from_source =
      random_motion(random, between(random, 0, angle_deg), between(random, 0, distance_mm), centre);
  out.source = transformed(select(out.target, some), out.target_from_source.inverse());
  return out;
}

IcpResult run(const Case& c, const PoseRefinementOptions& options) {
  return icp(c.source, c.target, KdTree(c.target.points), options);
}

/// How far two motions take the points of a cloud apart, at most.
double largest_distance_mm(const PointCloud& cloud, const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  double largest = 0;
  for (const auto& p : cloud.points) largest = std::max(largest, (a * p.cast<double>() - b * p.cast<double>()).norm());
  return largest;
}

void expect_recovers(const TriangleMesh& mesh, const Eigen::Vector3d& position_mm, bool symmetric, std::uint64_t seed) {
  Random random(seed);
  for (int round = 0; round < 10; ++round) {
    const auto c = moved_surface(random, mesh, position_mm, 8, 5);
    const auto result = run(c, exact_options(symmetric));
    EXPECT_TRUE(result.converged) << "round " << round;
    EXPECT_GE(result.pairs, c.source.size() / 2);
    EXPECT_LE(result.iterations, 150);
    EXPECT_LT(rotation_error_deg(result.target_from_source, c.target_from_source), 1e-3) << "round " << round;
    EXPECT_LT(largest_distance_mm(c.source, result.target_from_source, c.target_from_source), 1e-3)
        << "round " << round;
    EXPECT_TRUE(is_rigid(result.target_from_source.matrix(), 1e-9));
  }
}

TEST(Icp, RecoversTheBracketsPose) {
  expect_recovers(l_bracket(), Eigen::Vector3d::Zero(), true, 1);
  expect_recovers(l_bracket(), Eigen::Vector3d::Zero(), false, 2);
}

TEST(Icp, RecoversTheBracketsPoseFarFromTheCamera) {
  expect_recovers(l_bracket(), {100, -60, 650}, true, 3);
  expect_recovers(l_bracket(), {100, -60, 650}, false, 4);
}

TEST(Icp, RecoversTheBoxsPose) {
  expect_recovers(box({70, 50, 30}), {-40, 80, 650}, true, 5);
  expect_recovers(box({70, 50, 30}), {-40, 80, 650}, false, 6);
}

TEST(Icp, OtherPointsOfTheSameSurfaceMeetItsPlanes) {
  // The two clouds share no point: where only faces meet, the pose is still exact but for the pairs across edges.
  Random random(7);
  for (const bool symmetric : {true, false}) {
    for (int round = 0; round < 5; ++round) {
      auto c = moved_surface(random, l_bracket(), {20, 30, 650}, 5, 3);
      const auto others = surface_points(l_bracket(), 1500, random);
      const auto base = random_pose(random, {20, 30, 650});
      c.target = transformed(surface_points(l_bracket(), 6000, random), base);
      c.source = transformed(others, c.target_from_source.inverse() * base);
      const auto result = run(c, exact_options(symmetric));
      EXPECT_LT(rotation_error_deg(result.target_from_source, c.target_from_source), 0.3);
      EXPECT_LT(largest_distance_mm(c.source, result.target_from_source, c.target_from_source), 0.3);
    }
  }
}

TEST(Icp, DefaultsStopWithinATenthOfAMillimetre) {
  Random random(8);
  for (int round = 0; round < 10; ++round) {
    const auto c = moved_surface(random, l_bracket(), {0, 0, 650}, 8, 5);
    const auto result = run(c, {});
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.iterations, 60);
    EXPECT_LT(largest_distance_mm(c.source, result.target_from_source, c.target_from_source), 0.1);
  }
}

TEST(Icp, NothingToDoIsNothingDone) {
  Random random(9);
  for (const bool symmetric : {true, false}) {
    const auto c = moved_surface(random, l_bracket(), {0, 0, 650}, 0, 0);
    const auto result = run(c, exact_options(symmetric));
    EXPECT_TRUE(result.converged);
    EXPECT_LE(result.iterations, 4);
    EXPECT_LT(largest_distance_mm(c.source, result.target_from_source, Eigen::Isometry3d::Identity()), 1e-4);
  }
}

TEST(Icp, DoesNotDependOnTheFrame) {
  // The same two clouds turned and moved together: the result must turn and move with them.
  Random random(10);
  for (const bool symmetric : {true, false}) {
    const auto c = moved_surface(random, l_bracket(), {0, 0, 0}, 6, 4, 1500, 400);
    const auto frame = random_pose(random, {150, -100, 650});
    const Case there = {transformed(c.source, frame), transformed(c.target, frame), frame * c.target_from_source};
    auto options = exact_options(symmetric);
    options.max_iterations = 3;
    const auto here = run(c, options).target_from_source;
    const auto expected = frame * here * frame.inverse();
    EXPECT_LT(largest_distance_mm(there.source, run(there, options).target_from_source, expected), 2e-3);
  }
}

// --- Shapes that leave directions free -----------------------------------------------------------------------------

constexpr double cylinder_radius = 20;

/// Points of a cylinder's side about z, in rings 2.5 mm apart, with normals.
PointCloud cylinder_rings(int rings) {
  PointCloud cloud;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < 48; ++s) {
      const double azimuth = 2 * std::numbers::pi * s / 48;
      const Eigen::Vector3d normal(std::cos(azimuth), std::sin(azimuth), 0);
      cloud.points.push_back(
          (cylinder_radius * normal + Eigen::Vector3d(0, 0, 2.5 * (r - 0.5 * (rings - 1)))).cast<float>());
      cloud.normals.push_back(normal.cast<float>());
    }
  }
  return cloud;
}

/// The same at random places of a length.
PointCloud cylinder_side(Random& random, int count, double length) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double azimuth = between(random, 0, 2 * std::numbers::pi);
    const Eigen::Vector3d normal(std::cos(azimuth), std::sin(azimuth), 0);
    const double z = between(random, -length / 2, length / 2);
    cloud.points.push_back((cylinder_radius * normal + Eigen::Vector3d(0, 0, z)).cast<float>());
    cloud.normals.push_back(normal.cast<float>());
  }
  return cloud;
}

PointCloud ball(Random& random, int count, double radius) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d normal = random_direction(random);
    cloud.points.push_back((radius * normal).cast<float>());
    cloud.normals.push_back(normal.cast<float>());
  }
  return cloud;
}

double turn_about_z_deg(const Eigen::Isometry3d& motion) {
  return degrees(std::atan2(motion.linear()(1, 0), motion.linear()(0, 0)));
}

TEST(Icp, DoesNotPushACylinderAlongItsAxis) {
  // Pushed by less than the points' spacing, so that each point's partner is the one it was made from.
  for (const bool symmetric : {true, false}) {
    const auto result = run({transformed(cylinder_rings(11), Eigen::Isometry3d(Eigen::Translation3d(0.3, -0.2, 0.5))),
                             cylinder_rings(41), Eigen::Isometry3d::Identity()},
                            exact_options(symmetric));
    EXPECT_TRUE(result.converged);
    EXPECT_LT(rotation_error_deg(result.target_from_source, Eigen::Isometry3d::Identity()), 1e-3);
    EXPECT_LT((result.target_from_source.translation() - Eigen::Vector3d(-0.3, 0.2, 0)).head<2>().norm(), 1e-3)
        << "across the axis the pairs say where it belongs";
    EXPECT_NEAR(result.target_from_source.translation().z(), 0, 1e-3) << "along the axis nothing does";
  }
}

TEST(Icp, DoesNotTurnACylinderAboutItsAxis) {
  // The symmetric objective alone: the planes of point-to-plane pairs resist a turn to second order.
  const Eigen::Isometry3d turned(Eigen::Translation3d(0.3, -0.2, 0) *
                                 Eigen::AngleAxisd(radians(1), Eigen::Vector3d::UnitZ()));
  const auto result = run({transformed(cylinder_rings(11), turned), cylinder_rings(41), Eigen::Isometry3d::Identity()},
                          exact_options(true));
  EXPECT_TRUE(result.converged);
  const Eigen::Isometry3d left = result.target_from_source * turned;
  EXPECT_NEAR(turn_about_z_deg(left), 1, 1e-2);
  EXPECT_LT(left.translation().head<2>().norm(), 1e-3);
}

TEST(Icp, CylindersAxesMeet) {
  // Points at random: partners are not exact, and the free directions may drift a little, but not run away.
  Random random(11);
  for (const bool symmetric : {true, false}) {
    for (int round = 0; round < 5; ++round) {
      const auto pose = random_pose(random, {50, 20, 600});
      const Eigen::Isometry3d tilt(Eigen::Translation3d(1, -0.7, 0) *
                                   Eigen::AngleAxisd(radians(2), Eigen::Vector3d(1, 2, 0).normalized()));
      const auto result = run({transformed(cylinder_side(random, 400, 60), pose * tilt),
                               transformed(cylinder_side(random, 6000, 100), pose), Eigen::Isometry3d::Identity()},
                              exact_options(symmetric));
      const Eigen::Isometry3d motion = pose.inverse() * result.target_from_source * pose * tilt;
      EXPECT_LT(angle_deg(motion.linear().col(2), Eigen::Vector3d::UnitZ()), 0.1);
      EXPECT_LT(motion.translation().head<2>().norm(), 0.05);
      EXPECT_LT(std::abs(motion.translation().z()), 3);
      EXPECT_LT(std::abs(turn_about_z_deg(motion)), 5);
    }
  }
}

TEST(Icp, DoesNotTurnABallWhosePartnersAreKnown) {
  PointCloud target;
  for (const auto& vertex : sphere(30, 24, 12).vertices) {
    target.points.push_back(vertex);
    target.normals.push_back(vertex.normalized());
  }
  const Eigen::Isometry3d turned(Eigen::Translation3d(0.2, -0.1, 0.3) *
                                 Eigen::AngleAxisd(radians(0.5), Eigen::Vector3d(1, 2, 3).normalized()));
  const auto result = run({transformed(target, turned), target, Eigen::Isometry3d::Identity()}, exact_options(true));
  EXPECT_TRUE(result.converged);
  const Eigen::Isometry3d left = result.target_from_source * turned;
  EXPECT_LT(left.translation().norm(), 2e-3);
  EXPECT_LT(rotation_error_deg(left, Eigen::Isometry3d(turned.linear())), 2e-2);
}

TEST(Icp, CentresOfBallsMeet) {
  Random random(12);
  for (const bool symmetric : {true, false}) {
    for (int round = 0; round < 5; ++round) {
      const Eigen::Isometry3d pose(Eigen::Translation3d(50, 20, 600)), pushed(Eigen::Translation3d(51.5, 19, 602));
      const auto result = run({transformed(ball(random, 400, 30), pushed), transformed(ball(random, 6000, 30), pose),
                               Eigen::Isometry3d::Identity()},
                              exact_options(symmetric));
      EXPECT_LT((result.target_from_source * pushed.translation() - pose.translation()).norm(), 0.05);
      EXPECT_LT(rotation_error_deg(result.target_from_source, Eigen::Isometry3d::Identity()), 5);
    }
  }
}

TEST(Icp, APlaneLeavesThreeDirectionsAlone) {
  // Neither a turn about the normal nor a shift within the plane.
  Random random(13);
  for (const bool symmetric : {true, false}) {
    const auto target = transformed(surface_points(plane_patch(200, 200), 6000, random),
                                    Eigen::Isometry3d(Eigen::Translation3d(0, 0, 600)));
    const auto source =
        transformed(surface_points(plane_patch(80, 80), 400, random),
                    Eigen::Isometry3d(Eigen::Translation3d(0, 0, 602) *
                                      Eigen::AngleAxisd(radians(2), Eigen::Vector3d(1, 2, 0).normalized())));
    const auto result = run({source, target, Eigen::Isometry3d::Identity()}, exact_options(symmetric));
    EXPECT_TRUE(result.converged);
    for (const auto& p : source.points) EXPECT_NEAR((result.target_from_source * p.cast<double>()).z(), 600, 1e-3);
    EXPECT_LT(std::abs(turn_about_z_deg(result.target_from_source)), 0.2);
    const Eigen::Vector3d middle(0, 0, 602);
    EXPECT_LT((result.target_from_source * middle - middle).head<2>().norm(), 0.2);
  }
}

// --- What is not enough ---------------------------------------------------------------------------------------------

TEST(Icp, FewerThanSixPairsDoNotConverge) {
  Random random(14);
  for (const bool symmetric : {true, false}) {
    auto c = moved_surface(random, l_bracket(), {0, 0, 650}, 3, 2);
    auto options = exact_options(symmetric);

    Case few = c;
    few.source = select(c.source, std::vector{0, 1, 2, 3, 4});
    auto result = run(few, options);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.pairs, 5);
    EXPECT_EQ(result.iterations, 0);
    EXPECT_EQ(result.target_from_source.matrix(), Eigen::Matrix4d::Identity());

    options.max_correspondence_distance = 1;
    Case far = c;
    far.source = transformed(c.source, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 500)));
    result = run(far, options);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.pairs, 0);
    EXPECT_EQ(result.target_from_source.matrix(), Eigen::Matrix4d::Identity());

    options = exact_options(symmetric);
    Case turned_inside_out = c;
    turned_inside_out.target_from_source.setIdentity();
    turned_inside_out.source = c.target;
    for (auto& normal : turned_inside_out.source.normals) normal = -normal;
    EXPECT_EQ(run(turned_inside_out, options).pairs, 0) << "normals must point the same way";
    options.enforce_same_direction_normals = false;
    EXPECT_EQ(run(turned_inside_out, options).pairs, c.target.size());
  }
}

TEST(Icp, DegenerateCloudsDoNoHarm) {
  PointCloud one_place, line;
  for (int i = 0; i < 20; ++i) {
    one_place.points.emplace_back(1.0f, 2.0f, 600.0f);
    line.points.emplace_back(static_cast<float>(i), 2.0f, 600.0f);
  }
  one_place.normals = line.normals = std::vector<Eigen::Vector3f>(20, {0, 0, -1});
  for (const bool symmetric : {true, false}) {
    for (const auto* source : {&one_place, &line}) {
      for (const auto* target : {&one_place, &line}) {
        const auto result = run({*source, *target, Eigen::Isometry3d::Identity()}, exact_options(symmetric));
        EXPECT_TRUE(is_rigid(result.target_from_source.matrix(), 1e-9));
      }
    }
  }
}

TEST(Icp, NeedsNormals) {
  Random random(15);
  const auto cloud = surface_points(l_bracket(), 100, random);
  auto bare = cloud;
  bare.normals.clear();
  const KdTree tree(cloud.points);
  EXPECT_PRED2(mentions, error_of([&] { icp(bare, cloud, tree, {}); }), "normals");
  EXPECT_PRED2(mentions, error_of([&] { icp(cloud, bare, tree, {}); }), "normals");
  EXPECT_PRED2(mentions, error_of([&] { icp(PointCloud{}, cloud, tree, {}); }), "normals");
}

TEST(Icp, FarPairsDoNotCount) {
  // A third of the source has nothing to do with the target; the gate leaves it out.
  Random random(16);
  for (const bool symmetric : {true, false}) {
    for (int round = 0; round < 5; ++round) {
      auto c = moved_surface(random, l_bracket(), {0, 0, 650}, 4, 3);
      append(c.source, transformed(surface_points(box({60, 60, 60}), 500, random),
                                   Eigen::Isometry3d(Eigen::Translation3d(70, 80, 650))));
      const auto gated = run(c, exact_options(symmetric));
      EXPECT_LT(rotation_error_deg(gated.target_from_source, c.target_from_source), 1e-2);
      auto options = exact_options(symmetric);
      options.correspondence_gate_factor = 0;
      EXPECT_GT(rotation_error_deg(run(c, options).target_from_source, c.target_from_source),
                rotation_error_deg(gated.target_from_source, c.target_from_source));
    }
  }
}

// --- One step against the minimum of its objective, with residuals differentiated numerically -----------------------

/// Pairs of a source at its present place with the target as the library's rules say: nearest, normals at most 90
/// degrees apart; no gate.
struct Pairing {
  std::vector<Eigen::Vector3d> p, q, n;  ///< about the centre of all, n the (mean) normal of unit length
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();

  Pairing(const PointCloud& source, const PointCloud& target, bool symmetric) {
    for (std::size_t i = 0; i < source.size(); ++i) {
      std::size_t nearest = 0;
      for (std::size_t k = 1; k < target.size(); ++k)
        if ((target.points[k] - source.points[i]).squaredNorm() <
            (target.points[nearest] - source.points[i]).squaredNorm())
          nearest = k;
      if (source.normals[i].dot(target.normals[nearest]) < 0) continue;
      p.push_back(source.points[i].cast<double>());
      q.push_back(target.points[nearest].cast<double>());
      n.push_back(target.normals[nearest].cast<double>());
      if (symmetric) n.back() = (n.back() + source.normals[i].cast<double>()).normalized();
    }
    for (const auto* points : {&p, &q})
      for (const auto& v : *points) centre += v / (2.0 * static_cast<double>(p.size()));
    for (auto* points : {&p, &q})
      for (auto& v : *points) v -= centre;
  }
};

using Vector6 = Eigen::Matrix<double, 6, 1>;

Eigen::VectorXd residuals(const Pairing& pairs, const Vector6& x, bool symmetric) {
  const Eigen::Matrix3d turn = rotation_from_vector(x.head<3>());
  Eigen::VectorXd r(static_cast<Eigen::Index>(pairs.p.size()));
  for (std::size_t i = 0; i < pairs.p.size(); ++i) {
    // Rusinkiewicz 2019, eq. 9: both sides turn half of the way. Chen and Medioni 1992: the source alone turns.
    const Eigen::Vector3d other = symmetric ? Eigen::Vector3d(turn.transpose() * pairs.q[i]) : pairs.q[i];
    r[static_cast<Eigen::Index>(i)] = (turn * pairs.p[i] - other + x.tail<3>()).dot(pairs.n[i]);
  }
  return r;
}

Eigen::MatrixXd jacobian(const Pairing& pairs, const Vector6& x, bool symmetric) {
  Eigen::MatrixXd j(static_cast<Eigen::Index>(pairs.p.size()), 6);
  for (int k = 0; k < 6; ++k) {
    const double h = k < 3 ? 1e-5 : 1e-3;
    Vector6 forward = x, backward = x;
    forward[k] += h;
    backward[k] -= h;
    j.col(k) = (residuals(pairs, forward, symmetric) - residuals(pairs, backward, symmetric)) / (2 * h);
  }
  return j;
}

/// The motion of the source that the parameters stand for.
Eigen::Isometry3d motion_of(const Pairing& pairs, const Vector6& x, bool symmetric) {
  const Eigen::Matrix3d turn = rotation_from_vector(x.head<3>());
  Eigen::Isometry3d motion(turn);
  motion.translation() = x.tail<3>();
  if (symmetric) motion = Eigen::Isometry3d(turn) * Eigen::Translation3d(x.tail<3>()) * Eigen::Isometry3d(turn);
  return Eigen::Translation3d(pairs.centre) * motion * Eigen::Translation3d(-pairs.centre);
}

TEST(IcpStep, IsTheMinimumOfItsObjective) {
  Random random(17);
  for (const bool symmetric : {true, false}) {
    for (int round = 0; round < 10; ++round) {
      // So few points that all of them make the first step.
      const auto c = moved_surface(random, l_bracket(), {0, 0, 650}, 5, 3, 1500, 400);
      auto options = exact_options(symmetric);
      options.max_iterations = 1;
      options.correspondence_gate_factor = 0;
      const auto result = run(c, options);
      const Pairing pairs(c.source, c.target, symmetric);
      ASSERT_EQ(result.pairs, pairs.p.size());
      ASSERT_EQ(result.iterations, 1);

      // The linear problem, its Jacobian by finite differences. Its turn is the axis times the tangent (eq. 11).
      const Vector6 zero = Vector6::Zero();
      Vector6 linear = jacobian(pairs, zero, symmetric).colPivHouseholderQr().solve(-residuals(pairs, zero, symmetric));
      if (symmetric) {
        const double tangent = linear.head<3>().norm(), angle = std::atan(tangent);
        linear.head<3>() *= angle / tangent;
        linear.tail<3>() *= std::cos(angle);
      }
      EXPECT_LT(largest_distance_mm(c.source, result.target_from_source, motion_of(pairs, linear, symmetric)), 1e-5);

      // The problem itself, by Gauss and Newton to the end: one linear step is near to it, the symmetric one very near.
      Vector6 minimum = Vector6::Zero();
      for (int i = 0; i < 20; ++i)
        minimum +=
            jacobian(pairs, minimum, symmetric).colPivHouseholderQr().solve(-residuals(pairs, minimum, symmetric));
      const Vector6 gradient = jacobian(pairs, minimum, symmetric).transpose() * residuals(pairs, minimum, symmetric);
      EXPECT_LT(gradient.norm(), 1e-3) << "no minimum was found";
      const double start =
          largest_distance_mm(c.source, Eigen::Isometry3d::Identity(), motion_of(pairs, minimum, symmetric));
      EXPECT_LT(largest_distance_mm(c.source, result.target_from_source, motion_of(pairs, minimum, symmetric)),
                (symmetric ? 0.01 : 0.1) * start);
    }
  }
}

TEST(MeanNearestDistance, ByBruteForce) {
  Random random(18);
  const auto cloud = random_cube(random, 100, 30), target = random_cube(random, 200, 30);
  const auto pose = random_motion(random, 20, 10);
  double sum = 0;
  for (const auto& p : cloud.points) {
    double nearest = 1e9;
    for (const auto& q : target.points)
      nearest = std::min(nearest, (pose * p.cast<double>() - q.cast<double>()).norm());
    sum += nearest;
  }
  EXPECT_NEAR(mean_nearest_distance_mm(cloud, pose, KdTree(target.points)), sum / 100, 1e-4);
  EXPECT_EQ(mean_nearest_distance_mm(PointCloud{}, pose, KdTree(target.points)), 0);
}

TEST(PoseRefinementOptions, CheckNamesTheKey) {
  const auto with = [](auto change) {
    PoseRefinementOptions options;
    change(options);
    return error_of([&] { options.check(); });
  };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(with([](auto&) {}), "no error");
  for (const float bad : {-1.0f, nan}) {
    EXPECT_PRED2(mentions, with([&](auto& o) { o.voxel_size = bad; }), "voxel_size");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.max_correspondence_distance = bad; }), "max_correspondence_distance");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.transformation_epsilon = bad; }), "transformation_epsilon");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.euclidean_fitness_epsilon = bad; }), "euclidean_fitness_epsilon");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.correspondence_gate_factor = bad; }), "correspondence_gate_factor");
  }
  EXPECT_PRED2(mentions, with([](auto& o) { o.voxel_size = 0; }), "voxel_size 0");
  EXPECT_PRED2(mentions, with([](auto& o) { o.max_iterations = 0; }), "max_iterations 0");
  EXPECT_EQ(with([](auto& o) { o.correspondence_gate_factor = 0; }), "no error");
}

}  // namespace
}  // namespace partpose
