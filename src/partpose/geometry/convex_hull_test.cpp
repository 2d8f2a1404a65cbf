// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/convex_hull.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numbers>
#include <set>

namespace partpose {
namespace {

using shapes::between;

/// Closed, every neighbour the right one, no point more than `tolerance_mm` outside, each original index right.
void expect_is_hull(const ConvexHull& hull, std::span<const Eigen::Vector3f> points, double tolerance_mm) {
  ASSERT_EQ(hull.triangles.size(), hull.neighbours.size());
  std::set<std::pair<int, int>> edges;
  for (const auto& t : hull.triangles)
    for (int k = 0; k < 3; ++k) {
      const bool first = edges.insert({t[k], t[(k + 1) % 3]}).second;
      EXPECT_TRUE(first || hull.flat);  // both sides of a flat one are cut into triangles alike
    }
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({b, a}));
  std::set<int> used;
  for (std::size_t t = 0; t < hull.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      used.insert(hull.triangles[t][k]);
      const auto& other = hull.triangles[hull.neighbours[t][k]];
      int shared = 0;
      for (int j = 0; j < 3; ++j)
        shared += other[j] == hull.triangles[t][(k + 1) % 3] && other[(j + 1) % 3] == hull.triangles[t][k];
      EXPECT_EQ(shared, 1);
    }
    const auto& [a, b, c] = hull.triangles[t];
    const Eigen::Vector3d normal = (hull.vertices[b] - hull.vertices[a]).cross(hull.vertices[c] - hull.vertices[a]);
    if (normal.norm() < tolerance_mm * tolerance_mm) continue;
    // The plane through three rounded points is exact on the grid alone: away from them its error grows.
    const Eigen::Vector3d n = normal.normalized();
    const double longest =
        std::max({(hull.vertices[b] - hull.vertices[a]).norm(), (hull.vertices[c] - hull.vertices[b]).norm(),
                  (hull.vertices[a] - hull.vertices[c]).norm()});
    const double thickness = normal.norm() / longest;
    if (thickness < 1e3 * tolerance_mm) continue;
    for (const auto& p : points) EXPECT_LT(n.dot(p.cast<double>() - hull.vertices[a]), 1e3 * tolerance_mm);
  }
  EXPECT_EQ(used.size(), hull.vertices.size());
  EXPECT_EQ(static_cast<int>(hull.vertices.size() * 2) - 4, static_cast<int>(hull.triangles.size()));  // Euler
  for (std::size_t v = 0; v < hull.vertices.size(); ++v)
    EXPECT_EQ(hull.vertices[v], points[hull.original[v]].cast<double>());
}

TEST(ConvexHull, OfABoxWithPointsOnItsFacesInsideAndTwice) {
  auto points = shapes::box({-30, -20, -10}, {30, 20, 10}).vertices;
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3f p(
        Eigen::Vector3d(between(random, -30, 30), between(random, -20, 20), between(random, -10, 10)).cast<float>());
    if (i % 2) p[i % 3] = (i % 4 < 2 ? -1.0f : 1.0f) * std::array{30.0f, 20.0f, 10.0f}[i % 3];
    points.push_back(p);
    points.push_back(p);
  }
  const ConvexHull hull = convex_hull(points);
  expect_is_hull(hull, points, 1e-4);
  EXPECT_NEAR(hull.volume_mm3(), 60 * 40 * 20, 1);
  EXPECT_LT(hull.centroid().norm(), 1e-3);
  EXPECT_FALSE(hull.flat);
}

TEST(ConvexHull, KeepsEveryPointOfASphereAndNoneInside) {
  Random random(2);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 400; ++i) points.push_back((50 * shapes::random_direction(random)).cast<float>());
  for (int i = 0; i < 400; ++i) points.push_back((40 * shapes::random_direction(random)).cast<float>());
  const ConvexHull hull = convex_hull(points);
  EXPECT_EQ(hull.vertices.size(), 400u);
  for (const int i : hull.original) EXPECT_LT(i, 400);
  expect_is_hull(hull, points, 1e-4);
}

TEST(ConvexHull, VolumeDoesNotDependOnWhereThePartLies) {
  Random random(3);
  for (const auto& mesh : {shapes::l_bracket(), shapes::cylinder(20, 60, 64), shapes::sphere(30, 32, 16)}) {
    const double expected = convex_hull(mesh.vertices).volume_mm3();
    for (int i = 0; i < 5; ++i) {
      const auto pose = shapes::random_pose(random, {400, -300, 100});
      const auto moved = shapes::moved(mesh, pose);
      const ConvexHull hull = convex_hull(moved.vertices);
      EXPECT_NEAR(hull.volume_mm3() / expected, 1, 1e-5);
      expect_is_hull(hull, moved.vertices, 2e-4);
    }
  }
  // An L's hull has the pentagon of its outline: the rectangle less the triangle between the legs' ends.
  EXPECT_NEAR(convex_hull(shapes::l_bracket().vertices).volume_mm3(), 30 * (80 * 50 - 0.5 * 68 * 38), 1);
}

TEST(ConvexHull, OfPointsInAPlaneHasTwoSides) {
  Random random(4);
  auto mesh = shapes::plane_patch(40, 20, 6);
  for (const bool tilted : {false, true}) {
    if (tilted) {  // rounded to floats: not exactly a plane any more, or still one; right either way
      mesh = shapes::moved(mesh, shapes::random_pose(random));
    }
    const ConvexHull hull = convex_hull(mesh.vertices);
    expect_is_hull(hull, mesh.vertices, 1e-4);
    double area = 0;
    for (const auto& [a, b, c] : hull.triangles)
      area += 0.5 * (hull.vertices[b] - hull.vertices[a]).cross(hull.vertices[c] - hull.vertices[a]).norm();
    EXPECT_NEAR(area, 2 * 40 * 20, 0.1);
    if (!tilted) {
      EXPECT_TRUE(hull.flat);
      EXPECT_EQ(hull.vertices.size(), 4u);
      EXPECT_LT(hull.centroid().norm(), 1e-4);
      EXPECT_EQ(hull.volume_mm3(), 0);
    }
  }
}

TEST(ConvexHull, OfAPlaneThatIsOffByLessThanTheRounding) {
  // A grid whose heights differ in the last bits of a float: what an exporter makes of a flat face.
  Random random(5);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) points.emplace_back(float(i), float(j), 5.0f + float(between(random, -1, 1)) * 1e-6f);
  for (int i = 0; i < 10; ++i) points.emplace_back(20.0f + float(i), 20.0f, 15.0f);
  const ConvexHull hull = convex_hull(points);
  expect_is_hull(hull, points, 1e-4);
}

TEST(ConvexHull, RefusesWhatHasNoSurface) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto error = [](std::vector<Eigen::Vector3f> points) { return shapes::error_of([&] { convex_hull(points); }); };
  EXPECT_PRED2(shapes::mentions, error({}), "no points");
  EXPECT_PRED2(shapes::mentions, error({{1, 2, 3}}), "one line");
  EXPECT_PRED2(shapes::mentions, error({{1, 2, 3}, {1, 2, 3}, {4, 5, 6}}), "one line");
  EXPECT_PRED2(shapes::mentions, error({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}), "one line");
  EXPECT_PRED2(shapes::mentions, error({{0, 0, 0}, {1, nan, 1}, {2, 0, 2}}), "point 1");
}

}  // namespace
}  // namespace partpose
