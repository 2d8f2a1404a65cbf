// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/normals.hpp"

#include "partpose/core/parallel.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

namespace partpose {
namespace {

using namespace shapes;

/// Points every 2 mm of a square with 60 mm sides, at a pose.
PointCloud plane_points(const Eigen::Isometry3d& pose) {
  PointCloud cloud;
  for (int r = -15; r <= 15; ++r)
    for (int c = -15; c <= 15; ++c) cloud.points.push_back((pose * Eigen::Vector3d(2.0 * c, 2.0 * r, 0)).cast<float>());
  return cloud;
}

TEST(Normals, OfAPlane) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const auto pose = random_pose(random, {40, -30, 650});
    auto cloud = plane_points(pose);
    estimate_normals(cloud, 9);
    ASSERT_TRUE(cloud.has_normals());
    ASSERT_TRUE(cloud.has_curvatures());
    Eigen::Vector3d truth = pose.linear().col(2);
    if (truth.dot(pose.translation()) > 0) truth = -truth;
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      EXPECT_NEAR(cloud.normals[k].norm(), 1, 1e-5);
      EXPECT_LT(angle_deg(cloud.normals[k].cast<double>(), truth), 0.01);
      EXPECT_LT(cloud.curvatures[k], 1e-6);
      EXPECT_GE(cloud.curvatures[k], 0);
    }
  }
}

TEST(Normals, OfASphereSeenFromOutsideAndFromInside) {
  Random random(2);
  const Eigen::Vector3d centre(20, 10, 600);
  PointCloud cloud;
  for (int i = 0; i < 20000; ++i) cloud.points.push_back((centre + 50 * random_direction(random)).cast<float>());

  estimate_normals(cloud, 6);
  double sum_deg = 0;
  int judged = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p = cloud.points[i].cast<double>(), radial = (p - centre).normalized();
    EXPECT_LE(cloud.normals[i].cast<double>().dot(p), 0) << "must face the camera at the origin";
    if (std::abs(radial.dot(p.normalized())) < 0.1) continue;  // near the rim either sense is right
    const double error = angle_deg(cloud.normals[i].cast<double>(), radial.dot(p) < 0 ? radial : -radial);
    EXPECT_LT(error, 5);
    sum_deg += error;
    ++judged;
    // A cap of a sphere: about (radius of the patch / radius of the sphere)^2 / 24 of the variance is along the normal.
    EXPECT_LT(cloud.curvatures[i], 0.002);
  }
  EXPECT_GT(judged, 15000);
  EXPECT_LT(sum_deg / judged, 0.8);

  estimate_normals(cloud, 6, centre.cast<float>());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_LT(angle_deg(cloud.normals[i].cast<double>(), centre - cloud.points[i].cast<double>()), 5);
}

/// Principal components in double precision of all points within the radius, found one by one.
struct Pca {
  int neighbours = 0;
  bool border_case = false;  ///< a point lies so near to the radius that rounding decides
  Eigen::Vector3d values = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();

  Pca(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& query, double radius) {
    std::vector<Eigen::Vector3d> inside;
    for (const auto& p : points) {
      const Eigen::Vector3d offset = p.cast<double>() - query.cast<double>();
      border_case = border_case || std::abs(offset.norm() - radius) < 1e-5 * radius;
      if (offset.norm() <= radius) inside.push_back(offset);
    }
    neighbours = static_cast<int>(inside.size());
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& offset : inside) mean += offset / neighbours;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const auto& offset : inside) covariance += (offset - mean) * (offset - mean).transpose() / neighbours;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    values = solver.eigenvalues();
    normal = solver.eigenvectors().col(0);
  }
};

TEST(Normals, OfARandomCloudByDirectPrincipalComponents) {
  Random random(3);
  for (const Eigen::Vector3d& centre : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-80, 60, 650)}) {
    auto cloud = random_cube(random, 1200, 20, centre);
    for (auto& p : cloud.points) p.z() = static_cast<float>(centre.z() + 0.2 * (p.z() - centre.z()));
    for (const float radius : {2.0f, 5.0f}) {
      estimate_normals(cloud, radius);
      int compared = 0, undefined = 0;
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Pca truth(cloud.points, cloud.points[i], radius);
        if (truth.border_case) continue;
        if (truth.neighbours < 3) {
          EXPECT_TRUE(cloud.normals[i].array().isNaN().all());
          EXPECT_TRUE(std::isnan(cloud.curvatures[i]));
          ++undefined;
          continue;
        }
        EXPECT_NEAR(cloud.curvatures[i], std::max(truth.values[0], 0.0) / truth.values.sum(), 1e-4);
        if (truth.values[1] - truth.values[0] < 0.02 * truth.values[2])
          continue;  // hardly a direction of least variance
        EXPECT_GT(std::abs(cloud.normals[i].cast<double>().dot(truth.normal)), 1 - 1e-6);
        EXPECT_LE(cloud.normals[i].dot(cloud.points[i]), 0);
        ++compared;
      }
      EXPECT_GT(compared, 600);
      EXPECT_GT(undefined, radius == 2.0f ? 3 : -1);
    }
  }
}

TEST(Normals, OfThreePointsIsTheirTriangles) {
  PointCloud cloud;
  cloud.points = {{0, 0, 100}, {5, 0, 100}, {0, 5, 103}};
  estimate_normals(cloud, 8);
  const Eigen::Vector3d truth = -Eigen::Vector3d(5, 0, 0).cross(Eigen::Vector3d(0, 5, 3)).normalized();
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(angle_deg(cloud.normals[i].cast<double>(), truth), 0.01);
    EXPECT_NEAR(cloud.curvatures[i], 0, 1e-6);
  }
}

void expect_undefined(PointCloud cloud, float radius) {
  estimate_normals(cloud, radius);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_TRUE(cloud.normals[i].array().isNaN().all())
        << "normal " << cloud.normals[i].transpose() << " of point " << i;
    EXPECT_TRUE(std::isnan(cloud.curvatures[i]));
  }
}

TEST(Normals, AreUndefinedForTooFewPoints) {
  PointCloud cloud;
  estimate_normals(cloud, 5);
  EXPECT_TRUE(cloud.normals.empty());
  cloud.points = {{1, 2, 600}};
  expect_undefined(cloud, 5);
  cloud.points = {{1, 2, 600}, {2, 2, 600}};
  expect_undefined(cloud, 5);
  cloud.points = {{1, 2, 600}, {2, 2, 600}, {50, 2, 600}, {1, 90, 600}};
  expect_undefined(cloud, 5);
  cloud.points.assign(10, {1, 2, 600});
  expect_undefined(cloud, 5);
}

TEST(Normals, AreUndefinedOnALineAlongAnAxis) {
  PointCloud cloud;
  for (int i = 0; i < 40; ++i) cloud.points.emplace_back(static_cast<float>(i), -7.0f, 600.0f);
  expect_undefined(cloud, 9);
}

TEST(Normals, AreUndefinedOnAnySlantedLine) {
  Random random(4);
  int defined = 0, points = 0;
  for (int line = 0; line < 20; ++line) {
    const Eigen::Vector3d direction = random_direction(random);
    PointCloud cloud;
    for (int i = 0; i < 40; ++i) cloud.points.push_back((Eigen::Vector3d(30, -20, 600) + i * direction).cast<float>());
    estimate_normals(cloud, 9);
    for (const auto& normal : cloud.normals) defined += normal.allFinite(), ++points;
  }
  EXPECT_EQ(defined, 0) << "of " << points << " points on lines";
}

TEST(Normals, ReplaceOlderOnes) {
  auto cloud = plane_points(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 500)));
  cloud.normals.assign(3, Eigen::Vector3f::UnitX());
  cloud.curvatures.assign(7, 0.2f);
  estimate_normals(cloud, 9);
  ASSERT_EQ(cloud.normals.size(), cloud.size());
  ASSERT_EQ(cloud.curvatures.size(), cloud.size());
  EXPECT_LT((cloud.normals[0] - Eigen::Vector3f(0, 0, -1)).norm(), 1e-5);
}

TEST(Normals, SameBitsForAnyNumberOfThreads) {
  Random random(5);
  const auto input = random_cube(random, 5000, 30, {0, 0, 600});
  const auto with_threads = [&input](int threads) {
    const ThreadLimit limit(threads);
    auto cloud = input;
    estimate_normals(cloud, 4);
    return cloud;
  };
  const auto one = with_threads(1);
  EXPECT_TRUE(same_bits(one, with_threads(2)));
  EXPECT_TRUE(same_bits(one, with_threads(0)));
}

TEST(Normals, RefuseAnImpossibleRadius) {
  PointCloud cloud;
  for (const float bad : {0.0f, -2.0f, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_PRED2(mentions, error_of([&] { estimate_normals(cloud, bad); }), "radius");
}

}  // namespace
}  // namespace partpose
