// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/cramer_rao.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/random.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>

namespace partpose {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

const Intrinsics camera{320, 240, 400, 400, 159.5, 119.5};

Eigen::Isometry3d ahead(double z_mm) { return Eigen::Isometry3d(Eigen::Translation3d(0, 0, z_mm)); }

/// A corner of a box towards the camera.
Eigen::Isometry3d tilted(double z_mm) {
  Eigen::Isometry3d pose = ahead(z_mm);
  pose.linear() = (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  return pose;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Eigen::Vector3d& centre, const Vector6& by) {
  const Eigen::Vector3d w = by.head<3>();
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  if (w.norm() > 0) turn.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  return Eigen::Translation3d(Eigen::Vector3d(by.tail<3>())) * Eigen::Translation3d(centre) * turn *
         Eigen::Translation3d(-centre) * pose;
}

TEST(PoseBound, OfAPlaneSeenFromTheFront) {
  // Far away and seen narrowly, so that all lines of sight are along z: three directions are known, three are not.
  const Intrinsics narrow{200, 200, 20000, 20000, 99.5, 99.5};
  const auto bound = pose_bound(shapes::box(Eigen::Vector3f{60, 60, 2}), ahead(10001), narrow, 2.0);
  const int across = 60 * 2;  // pixels of half a millimetre
  ASSERT_EQ(bound.pixels, across * across);
  const double count = bound.pixels, sigma2 = 4;
  EXPECT_NEAR(bound.information(5, 5), count / sigma2, 1e-3 * count / sigma2);
  // Turns about x and y: the sum of the squared distances from the axis, 60^2 / 12 each.
  EXPECT_NEAR(bound.information(0, 0), count * 300 / sigma2, 2e-3 * count * 300 / sigma2);
  EXPECT_NEAR(bound.information(1, 1), count * 300 / sigma2, 2e-3 * count * 300 / sigma2);
  EXPECT_LT(std::abs(bound.information(3, 3)) + std::abs(bound.information(4, 4)), 1e-9 * count);
  EXPECT_LT(std::abs(bound.information(2, 2)), 1e-6 * count);
  EXPECT_FALSE(bound.determined);
  EXPECT_TRUE(std::isinf(bound.weakest_mm));
}

TEST(PoseBound, OfASphereKnowsItsPlaceAndNotItsTurn) {
  const Intrinsics narrow{160, 160, 80000, 80000, 79.5, 79.5};  // all lines of sight are along z
  const auto bound = pose_bound(shapes::sphere(40, 96, 48), ahead(60000), narrow, 1.0);
  // Of a true sphere the turns' block is zero; the facets leave little of it (lengths at the radius).
  const double turns = bound.information.topLeftCorner<3, 3>().trace() / (40 * 40);
  const double shifts = bound.information.bottomRightCorner<3, 3>().trace();
  EXPECT_LT(turns, 2e-3 * shifts);
  // Along z each pixel says (n.z / n.d)^2 = 1; across it says less in the middle, and without limit at the limb.
  EXPECT_NEAR(bound.information(5, 5), bound.pixels, 0.01 * bound.pixels);
  EXPECT_NEAR(bound.information(3, 3), bound.information(4, 4), 0.05 * bound.information(3, 3));
}

/// The information by finite differences of what the renderer draws.
Matrix6 information_by_rendering(const TriangleMesh& mesh, const Eigen::Isometry3d& pose, double sigma_mm) {
  const Eigen::Vector3d centre = pose * bounding_box(mesh).center();
  const auto base = render(mesh, pose, camera);
  const auto range = [](const Rendering& r, int u, int v) {
    return camera.unproject(u, v, r.depth.at(u, v)).cast<double>().norm();
  };
  std::vector<std::pair<Rendering, Rendering>> sides;
  std::vector<double> steps;
  for (int k = 0; k < 6; ++k) {
    steps.push_back(k < 3 ? 2e-3 : 0.1);
    Vector6 by = Vector6::Zero();
    by[k] = steps.back();
    sides.emplace_back(render(mesh, moved(pose, centre, by), camera), render(mesh, moved(pose, centre, -by), camera));
  }
  Matrix6 information = Matrix6::Zero();
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * camera.width + u;
      if (base.triangle[p] < 0) continue;
      Vector6 J = Vector6::Zero();
      bool inside = true;
      for (int k = 0; k < 6; ++k) {
        inside =
            inside && sides[k].first.triangle[p] == base.triangle[p] && sides[k].second.triangle[p] == base.triangle[p];
        J[k] = (range(sides[k].first, u, v) - range(sides[k].second, u, v)) / (2 * steps[k]);
      }
      if (inside) information += J * J.transpose() / (sigma_mm * sigma_mm);
    }
  return information;
}

TEST(PoseBound, OfABoxIsThatOfRenderedDifferences) {
  const TriangleMesh box = shapes::box(Eigen::Vector3f{80, 60, 40});
  const auto bound = pose_bound(box, tilted(500), camera, 3.0);
  const Matrix6 rendered = information_by_rendering(box, tilted(500), 3.0);
  // Pixels at edges that change their triangle are missing in the second.
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(rendered(k, k) / bound.information(k, k), 1, 0.08) << k;
  const Matrix6 difference = rendered - bound.information;
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k)
      EXPECT_LT(std::abs(difference(i, k)), 0.08 * std::sqrt(bound.information(i, i) * bound.information(k, k)));
  EXPECT_TRUE(bound.determined);
}

TEST(PoseBound, GrowsWithTheNoiseAndIsAboutTheCentre) {
  const TriangleMesh box = shapes::box(Eigen::Vector3f{80, 60, 40});
  const auto one = pose_bound(box, tilted(500), camera, 1.0), three = pose_bound(box, tilted(500), camera, 3.0);
  EXPECT_NEAR(three.rotation_deg() / one.rotation_deg(), 3, 1e-6);
  EXPECT_NEAR(three.translation_mm() / one.translation_mm(), 3, 1e-6);
  // The model's origin elsewhere: the same part at the same place has the same bound.
  TriangleMesh shifted = box;
  for (auto& vertex : shifted.vertices) vertex += Eigen::Vector3f(300, -200, 100);
  const auto other = pose_bound(shifted, tilted(500) * Eigen::Translation3d(-300, 200, -100), camera, 1.0);
  EXPECT_NEAR(other.translation_mm(), one.translation_mm(), 0.01 * one.translation_mm());
  EXPECT_NEAR(other.rotation_deg(), one.rotation_deg(), 0.01 * one.rotation_deg());
  EXPECT_THROW(pose_bound(box, tilted(500), camera, 0), Error);
}

/// Least squares on noisy ranges; each pixel stays on its plane.
Vector6 estimate(const std::vector<Eigen::Vector3d>& directions, const std::vector<Eigen::Vector3d>& points,
                 const std::vector<Eigen::Vector3d>& normals, const std::vector<double>& ranges,
                 const Eigen::Vector3d& centre) {
  const auto range = [&](std::size_t i, const Vector6& by) {
    const Eigen::Isometry3d motion = moved(Eigen::Isometry3d::Identity(), centre, by);
    const Eigen::Vector3d n = motion.linear() * normals[i];
    return n.dot(motion * points[i]) / n.dot(directions[i]);
  };
  Vector6 by = Vector6::Zero();
  for (int iteration = 0; iteration < 4; ++iteration) {
    Matrix6 A = Matrix6::Zero();
    Vector6 b = Vector6::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vector6 J;
      for (int k = 0; k < 6; ++k) {
        Vector6 step = by;
        step[k] += k < 3 ? 1e-5 : 1e-3;
        J[k] = (range(i, step) - range(i, by)) / (k < 3 ? 1e-5 : 1e-3);
      }
      A += J * J.transpose();
      b += J * (ranges[i] - range(i, by));
    }
    by += A.ldlt().solve(b);
  }
  return by;
}

TEST(PoseBound, IsReachedByLeastSquaresOnSimulatedRanges) {
  const Intrinsics small{48, 36, 60, 60, 23.5, 17.5};
  const TriangleMesh box = shapes::box(Eigen::Vector3f{80, 60, 40});
  const Eigen::Isometry3d pose = tilted(300);
  constexpr double sigma_mm = 0.5;
  const auto bound = pose_bound(box, pose, small, sigma_mm);
  ASSERT_TRUE(bound.determined);
  const auto seen = render(box, pose, small);
  std::vector<Eigen::Vector3d> directions, points, normals;
  for (int v = 0; v < small.height; ++v)
    for (int u = 0; u < small.width; ++u) {
      const int t = seen.triangle[static_cast<std::size_t>(v) * small.width + u];
      if (t < 0) continue;
      points.push_back(small.unproject(u, v, seen.depth.at(u, v)).cast<double>());
      directions.push_back(points.back().normalized());
      const auto& triangle = box.triangles[t];
      const Eigen::Vector3f a = box.vertices[triangle[0]];
      normals.emplace_back(
          pose.linear() *
          (box.vertices[triangle[1]] - a).cross(box.vertices[triangle[2]] - a).cast<double>().normalized());
    }
  Matrix6 covariance = Matrix6::Zero();
  constexpr int trials = 300;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(11, static_cast<std::uint64_t>(trial));
    std::vector<double> ranges;
    for (const auto& p : points) ranges.push_back(p.norm() + sigma_mm * random.normal_pair().first);
    const Vector6 error = estimate(directions, points, normals, ranges, pose.translation());
    covariance += error * error.transpose() / trials;
  }
  // The relative deviation of a variance from 300 trials is sqrt(2 / 300) = 8 %.
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(covariance(k, k) / bound.covariance(k, k), 1, 0.3) << k;
  const double turns = covariance.topLeftCorner<3, 3>().trace(), shifts = covariance.bottomRightCorner<3, 3>().trace();
  EXPECT_NEAR(std::sqrt(turns) / radians(bound.rotation_deg()), 1, 0.1);
  EXPECT_NEAR(std::sqrt(shifts) / bound.translation_mm(), 1, 0.1);
}

}  // namespace
}  // namespace partpose
