// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/mesh.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

TriangleMesh one_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  return {{a, b, c}, {{0, 1, 2}}};
}

/// As STL stores it: each triangle with three vertices of its own.
TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh out;
  for (const auto& triangle : mesh.triangles) {
    const int first = static_cast<int>(out.vertices.size());
    for (const int v : triangle) out.vertices.push_back(mesh.vertices[v]);
    add_triangle(out, first, first + 1, first + 2);
  }
  return out;
}

TEST(Mesh, FaceNormalsFollowTheWinding) {
  EXPECT_EQ(one_triangle({0, 0, 5}, {2, 0, 5}, {0, 3, 5}).face_normal(0), Eigen::Vector3f::UnitZ());
  EXPECT_EQ(one_triangle({0, 0, 5}, {0, 3, 5}, {2, 0, 5}).face_normal(0), -Eigen::Vector3f::UnitZ());
  const auto ball = sphere(20, 24, 12);
  for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
    const auto& [a, b, c] = ball.triangles[t];
    const Eigen::Vector3f middle = ball.vertices[a] + ball.vertices[b] + ball.vertices[c];
    EXPECT_NEAR(ball.face_normal(t).norm(), 1, 1e-6);
    EXPECT_GT(ball.face_normal(t).dot(middle.normalized()), 0.9);
  }
}

TEST(Mesh, DegenerateTrianglesHaveNoNormal) {
  EXPECT_TRUE(one_triangle({1, 2, 3}, {1, 2, 3}, {4, 5, 6}).face_normal(0).isZero());
  EXPECT_TRUE(one_triangle({0, 0, 0}, {1, 2, 3}, {2, 4, 6}).face_normal(0).isZero());
  // Tiny is not degenerate.
  EXPECT_NEAR(one_triangle({0, 0, 0}, {1e-15f, 0, 0}, {0, 1e-15f, 0}).face_normal(0).z(), 1, 1e-6);
}

TEST(Mesh, BoundingBox) {
  const auto mesh = box({-1, 2, -3}, {4, 5, 6});
  EXPECT_EQ(bounding_box(mesh).min(), Eigen::Vector3d(-1, 2, -3));
  EXPECT_EQ(bounding_box(mesh).max(), Eigen::Vector3d(4, 5, 6));
  EXPECT_DOUBLE_EQ(bounding_box_diagonal(mesh), std::sqrt(25 + 9 + 81));
  EXPECT_TRUE(bounding_box(TriangleMesh{}).isEmpty());
  EXPECT_EQ(bounding_box_diagonal(TriangleMesh{}), 0);
}

TEST(Mesh, MergingUndoesTheTriangleSoup) {
  for (const auto& mesh : {box({10, 20, 30}), l_bracket(), sphere(30, 20, 10), cylinder(5, 20, 16)}) {
    const auto merged = with_merged_vertices(soup(mesh));
    EXPECT_EQ(merged.vertices.size(), mesh.vertices.size());
    ASSERT_EQ(merged.triangles.size(), mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(merged.vertices[merged.triangles[t][k]], mesh.vertices[mesh.triangles[t][k]]);
  }
}

TEST(Mesh, MergingKeepsTheOrderOfFirstUse) {
  TriangleMesh mesh;
  mesh.vertices = {{3, 0, 0}, {1, 0, 0}, {3, 0, 0}, {2, 0, 0}, {1, 0, 0}};
  mesh.triangles = {{4, 2, 3}, {0, 2, 1}};
  const auto merged = with_merged_vertices(mesh);
  const std::vector<Eigen::Vector3f> vertices = {{3, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_EQ(merged.vertices, vertices);
  EXPECT_EQ(merged.triangles, (std::vector<std::array<int, 3>>{{1, 0, 2}, {0, 0, 1}}));
}

TEST(Mesh, MergingTakesBothZerosForOneAndNothingElse) {
  TriangleMesh mesh;
  mesh.vertices = {{0.0f, 1, 2}, {-0.0f, 1, 2}, {std::nextafter(0.0f, 1.0f), 1, 2}};
  mesh.triangles = {{0, 1, 2}};
  const auto merged = with_merged_vertices(mesh);
  EXPECT_EQ(merged.vertices.size(), 2);
  EXPECT_EQ(merged.triangles[0], (std::array{0, 0, 1}));
}

TEST(Shapes, AreClosedAndFaceOutwards) {
  EXPECT_NEAR(volume(box({10, 20, 30})), 6000, 1e-6);
  EXPECT_NEAR(volume(l_bracket()), 30 * (80 * 12 + 38 * 12), 1e-6);
  EXPECT_NEAR(volume(sphere(30, 120, 60)), 4.0 / 3 * std::numbers::pi * 27000, 150);
  EXPECT_NEAR(volume(cylinder(10, 40, 200)), std::numbers::pi * 100 * 40, 5);
  for (const auto& mesh : {box({10, 20, 30}), l_bracket(), sphere(30, 20, 10), cylinder(5, 20, 16)}) {
    // Closed: each edge is used once in each direction. Then the volume does not depend on where the origin is.
    std::vector<std::pair<int, int>> edges;
    for (const auto& [a, b, c] : mesh.triangles) edges.insert(edges.end(), {{a, b}, {b, c}, {c, a}});
    std::sort(edges.begin(), edges.end());
    EXPECT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end());
    for (const auto& [from, to] : edges)
      EXPECT_TRUE(std::binary_search(edges.begin(), edges.end(), std::pair(to, from)));
  }
}

TEST(Diameter, IsThatOfAnalyticShapes) {
  EXPECT_DOUBLE_EQ(diameter(box({30, 40, 120})), 130);
  EXPECT_EQ(diameter({}), 0);
  EXPECT_EQ(diameter({{{1, 2, 3}}, {}}), 0);
}

TEST(Diameter, IsThatOfAllPairsOfVertices) {
  Random random(7);
  for (int k = 0; k < 20; ++k) {
    TriangleMesh mesh;
    for (int i = 0; i < 60; ++i)
      mesh.vertices.push_back(
          Eigen::Vector3d(49 * random.uniform(), 10 * random.uniform(), 31 * random.uniform()).cast<float>());
    double largest = 0;
    for (const auto& a : mesh.vertices)
      for (const auto& b : mesh.vertices) largest = std::max(largest, (a.cast<double>() - b.cast<double>()).norm());
    EXPECT_DOUBLE_EQ(diameter(mesh), largest);
  }
}

TEST(Shapes, SurfacePointsLieOnTheSurface) {
  Random random(1);
  const auto mesh = l_bracket();
  const auto cloud = surface_points(mesh, 500, random);
  int lower_half = 0;
  for (const auto& p : cloud.points) {
    EXPECT_LT(distance_to_mesh(p.cast<double>(), mesh), 1e-5);
    lower_half += p.z() < 15;
  }
  EXPECT_NEAR(lower_half, 250, 50);
  EXPECT_DOUBLE_EQ(distance_to_mesh({-3, -4, 10}, mesh), 5);
  EXPECT_DOUBLE_EQ(distance_to_mesh({40, 20, 15}, mesh), 8);
}

}  // namespace
}  // namespace partpose
