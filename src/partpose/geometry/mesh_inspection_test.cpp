// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/mesh_inspection.hpp"

#include "partpose/core/error.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace partpose {
namespace {

using namespace shapes;

TriangleMesh turned(TriangleMesh mesh, std::size_t first = 0, std::size_t count = SIZE_MAX) {
  for (std::size_t t = first; t < mesh.triangles.size() && t - first < count; ++t)
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return mesh;
}

TriangleMesh at(const TriangleMesh& mesh, double x) {
  return moved(mesh, Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)));
}

const TriangleMesh cube = box({20, 30, 40});

TEST(MeshInspection, OfABox) {
  const auto found = inspect_mesh(cube);
  EXPECT_EQ(found.triangles, 12);
  EXPECT_EQ(found.vertices, 8);
  EXPECT_EQ(found.size_mm, (std::array<double, 3>{20, 30, 40}));
  EXPECT_NEAR(found.diagonal_mm, std::sqrt(400 + 900 + 1600), 1e-9);
  EXPECT_NEAR(found.area_mm2, 2 * (600 + 800 + 1200), 1e-6);
  ASSERT_TRUE(found.volume_mm3);
  EXPECT_NEAR(*found.volume_mm3, 24000, 1e-6);
  EXPECT_TRUE(found.sound());
  EXPECT_EQ(found.shells, 1);
  EXPECT_EQ(found.open_edges + found.non_manifold_edges, 0);
  EXPECT_EQ(found.unit_guess, "");
}

TEST(MeshInspection, AFlippedBoxAndOneTriangle) {
  const auto inside_out = inspect_mesh(turned(cube));
  EXPECT_EQ(inside_out.flipped_triangles, 12);
  EXPECT_TRUE(inside_out.watertight);
  EXPECT_FALSE(inside_out.volume_mm3);
  EXPECT_FALSE(inside_out.sound());
  for (const std::size_t t : {0, 5, 11}) {
    const auto one = turned(cube, t, 1);
    EXPECT_EQ(inspect_mesh(one).flipped_triangles, 1);
    const auto repair = repair_mesh(one);
    EXPECT_EQ(repair.turned_triangles, 1);
    EXPECT_EQ(repair.mesh.triangles.size(), 12u);
    EXPECT_NEAR(volume(repair.mesh), 24000, 1e-6);
  }
  EXPECT_NEAR(volume(repair_mesh(turned(cube)).mesh), 24000, 1e-6);
  EXPECT_NEAR(volume(repair_mesh(turned(l_bracket(), 3, 7)).mesh), volume(l_bracket()), 1e-6);
}

TEST(MeshInspection, AnOpenBox) {
  TriangleMesh open = cube;
  open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 2);  // a face
  const auto found = inspect_mesh(open);
  EXPECT_FALSE(found.watertight);
  EXPECT_EQ(found.open_edges, 4);
  EXPECT_FALSE(found.volume_mm3);
  EXPECT_EQ(found.flipped_triangles, 0);
  EXPECT_EQ(inspect_mesh(turned(open)).flipped_triangles, 10) << "what is open has an outside, too";
  EXPECT_EQ(repair_mesh(turned(open)).turned_triangles, 10);
}

TEST(MeshInspection, AFlatSheetHasNoOutside) {
  const auto sheet = plane_patch(50, 50, 4);
  EXPECT_EQ(inspect_mesh(sheet).flipped_triangles, 0);
  EXPECT_EQ(inspect_mesh(turned(sheet)).flipped_triangles, 0);
  EXPECT_EQ(inspect_mesh(turned(sheet, 3, 2)).flipped_triangles, 2) << "but its triangles face alike";
  EXPECT_EQ(inspect_mesh(sheet).open_edges, 16);
}

TEST(MeshInspection, TwoShellsAndACavity) {
  const auto two = inspect_mesh(joined(cube, at(sphere(10, 20, 12), 100)));
  EXPECT_EQ(two.shells, 2);
  EXPECT_TRUE(two.sound());
  EXPECT_EQ(inspect_mesh(joined(cube, at(turned(cube), 100))).flipped_triangles, 12);

  const auto hole = sphere(8, 20, 12);
  const auto hollow = joined(cube, turned(hole));
  const auto found = inspect_mesh(hollow);
  EXPECT_TRUE(found.sound()) << "a cavity's wall faces into it";
  EXPECT_NEAR(found.volume_mm3.value_or(0), 24000 - volume(hole), 1);
  EXPECT_EQ(repair_mesh(hollow).turned_triangles, 0);
  // A ball in the cavity faces outwards again.
  const auto ball = sphere(4, 20, 12);
  EXPECT_TRUE(inspect_mesh(joined(hollow, ball)).sound());
  EXPECT_EQ(inspect_mesh(joined(hollow, turned(ball))).flipped_triangles, ball.triangles.size());
}

TEST(MeshInspection, SheetsThatMeetInAnEdge) {
  // Two boxes that share an edge: four triangles meet there.
  const auto other = moved(cube, Eigen::Isometry3d(Eigen::Translation3d(20, 30, 0)));
  const auto found = inspect_mesh(joined(cube, other));
  EXPECT_EQ(found.non_manifold_edges, 1);
  EXPECT_TRUE(found.watertight);
  EXPECT_EQ(found.flipped_triangles, 0);
  // A fin on a box: its foot is an edge of three triangles.
  TriangleMesh fin = cube;
  fin.vertices.emplace_back(0.0f, 0.0f, 100.0f);
  const auto& foot = cube.triangles[0];
  add_triangle(fin, foot[0], foot[1], 8);
  const auto finned = inspect_mesh(fin);
  EXPECT_EQ(finned.non_manifold_edges, 1);
  EXPECT_EQ(finned.open_edges, 3);
  EXPECT_FALSE(finned.watertight);
}

TEST(MeshInspection, DegenerateAndDuplicateTriangles) {
  TriangleMesh mesh = cube;
  add_triangle(mesh, 0, 0, 1);
  const auto [a, b, c] = cube.triangles[4];
  add_triangle(mesh, b, c, a);
  add_triangle(mesh, c, b, a);  // wound the other way: still the same
  const auto found = inspect_mesh(mesh);
  EXPECT_EQ(found.triangles, 15);
  EXPECT_EQ(found.degenerate_triangles, 1);
  EXPECT_EQ(found.duplicate_triangles, 2);
  EXPECT_TRUE(found.watertight) << "for they are left out";
  EXPECT_FALSE(found.sound());
  const auto repair = repair_mesh(mesh);
  EXPECT_EQ(repair.removed_degenerate, 1);
  EXPECT_EQ(repair.removed_duplicates, 2);
  EXPECT_EQ(repair.mesh.triangles, cube.triangles);
  EXPECT_TRUE(inspect_mesh(repair.mesh).sound());
  EXPECT_FALSE(repair_mesh(repair.mesh).changed_anything());
}

TEST(MeshInspection, ATriangleWithoutAreaThatClosesTheSurfaceStays) {
  // A square's side split by a vertex in its middle that the other side does not have: a triangle of no height fills
  // it.
  TriangleMesh mesh = cube;
  const auto [a, b, c] = cube.triangles[0];
  const int middle = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back((cube.vertices[a] + cube.vertices[b]) / 2);
  mesh.triangles[0] = {a, middle, c};
  add_triangle(mesh, middle, b, c);
  EXPECT_EQ(inspect_mesh(mesh).open_edges, 3);
  add_triangle(mesh, b, middle, a);
  const auto found = inspect_mesh(mesh);
  EXPECT_TRUE(found.watertight);
  EXPECT_EQ(found.degenerate_triangles, 1);
  EXPECT_EQ(repair_mesh(mesh).removed_degenerate, 0);
  EXPECT_TRUE(inspect_mesh(repair_mesh(mesh).mesh).watertight);
}

TEST(MeshInspection, WeldingClosesCracks) {
  TriangleMesh soup;
  for (const auto& t : cube.triangles) {
    const int first = static_cast<int>(soup.vertices.size());
    for (const int v : t) soup.vertices.push_back(cube.vertices[v] * (1 + 1e-7f * static_cast<float>(first % 5)));
    add_triangle(soup, first, first + 1, first + 2);
  }
  EXPECT_GT(inspect_mesh(soup).open_edges, 0);
  const auto repair = repair_mesh(soup);
  EXPECT_TRUE(inspect_mesh(repair.mesh).sound());
  EXPECT_EQ(inspect_mesh(repair.mesh).vertices, 8);
  EXPECT_GT(repair.welded_vertices, 0);
  EXPECT_NEAR(volume(repair.mesh), 24000, 0.1);
  // A gap that is one stays one, and nothing is welded in vain.
  const auto apart = joined(cube, at(cube, 20.01));
  EXPECT_EQ(repair_mesh(apart).welded_vertices, 0);
  EXPECT_EQ(inspect_mesh(repair_mesh(soup, 1e-9).mesh).open_edges, inspect_mesh(soup).open_edges);
}

TEST(MeshInspection, GuessesTheUnit) {
  const auto scaled = [](double factor) {
    TriangleMesh mesh = l_bracket();  // 99 mm
    for (auto& v : mesh.vertices) v *= static_cast<float>(factor);
    return inspect_mesh(mesh).unit_guess;
  };
  EXPECT_EQ(scaled(1), "");
  EXPECT_EQ(scaled(1e-3), "metre");
  EXPECT_EQ(scaled(1 / 25.4), "inch");
  EXPECT_EQ(scaled(1e3), "micrometre");
  EXPECT_EQ(mm_per_unit("inch"), 25.4);
  EXPECT_EQ(mm_per_unit("metre"), 1000);
  EXPECT_EQ(mm_per_unit(""), 1);
}

TEST(MeshInspection, RefusesWhatIsNoMesh) {
  EXPECT_THROW(inspect_mesh({}), Error);
  EXPECT_THROW(repair_mesh({}), Error);
  TriangleMesh mesh = cube;
  mesh.triangles[3][1] = 8;
  EXPECT_THROW(inspect_mesh(mesh), Error);
  mesh.triangles[3][1] = -1;
  EXPECT_THROW(inspect_mesh(mesh), Error);
  mesh = cube;
  mesh.vertices[0].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(inspect_mesh(mesh), Error);
  EXPECT_THROW(repair_mesh(cube, -1), Error);
  const TriangleMesh point{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {{0, 1, 2}}};
  EXPECT_EQ(inspect_mesh(point).degenerate_triangles, 1);
  EXPECT_FALSE(inspect_mesh(point).watertight);
  EXPECT_THROW(repair_mesh(point), Error);
}

}  // namespace
}  // namespace partpose
