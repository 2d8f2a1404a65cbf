// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/symmetry_search.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/geometry/surface_distance.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using shapes::error_of;
using shapes::mentions;

/// About z, apex up, closed by a disc.
TriangleMesh cone(double radius, double height, int segments) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0.0f, 0.0f, static_cast<float>(height));
  mesh.vertices.emplace_back(0.0f, 0.0f, 0.0f);
  for (int s = 0; s < segments; ++s) {
    const double a = 2 * std::numbers::pi * s / segments;
    mesh.vertices.push_back(Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), 0).cast<float>());
  }
  for (int s = 0; s < segments; ++s) {
    const int a = 2 + s, b = 2 + (s + 1) % segments;
    shapes::add_triangle(mesh, 0, a, b);
    shapes::add_triangle(mesh, 1, b, a);
  }
  return mesh;
}

/// A rectangular bar beside the z axis, wound around it; thinner towards the top by `taper` (0: the same all along).
TriangleMesh helix(double taper) {
  constexpr int steps = 120;
  TriangleMesh mesh;
  for (int step = 0; step <= steps; ++step) {
    const double along = static_cast<double>(step) / steps;
    const Eigen::AngleAxisd turn(2.5 * 2 * std::numbers::pi * (along - 0.5), Eigen::Vector3d::UnitZ());
    const double half = 4 * (1 - taper * along);
    for (const auto& [x, z] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      mesh.vertices.push_back((turn * Eigen::Vector3d(20 + half * x, 0, 60 * along + half * z)).cast<float>());
  }
  for (int step = 0; step < steps; ++step)
    for (int side = 0; side < 4; ++side) {
      const int a = 4 * step + side, b = 4 * step + (side + 1) % 4;
      shapes::add_quad(mesh, a, b, b + 4, a + 4);
    }
  shapes::add_quad(mesh, 3, 2, 1, 0);
  shapes::add_quad(mesh, 4 * steps, 4 * steps + 1, 4 * steps + 2, 4 * steps + 3);
  return mesh;
}

TriangleMesh tetrahedron(float size) {
  TriangleMesh mesh;
  for (const auto& corner : {Eigen::Vector3f(1, 1, 1), {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}})
    mesh.vertices.push_back(size * corner);
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return mesh;
}

/// The same surface with triangles of all sizes: random ones cut at random places, again and again.
TriangleMesh unevenly_cut(TriangleMesh mesh, int cuts, Random& random) {
  for (int i = 0; i < cuts; ++i) {
    const std::size_t t = random.below(i % 3 ? mesh.triangles.size() : std::min<std::size_t>(mesh.triangles.size(), 4));
    const auto [a, b, c] = mesh.triangles[t];
    const double u = shapes::between(random, 0.2, 0.4), v = shapes::between(random, 0.2, 0.4);
    const int inside = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back((u * mesh.vertices[a].cast<double>() + v * mesh.vertices[b].cast<double>() +
                             (1 - u - v) * mesh.vertices[c].cast<double>())
                                .cast<float>());
    mesh.triangles[t] = {a, b, inside};
    mesh.triangles.push_back({b, c, inside});
    mesh.triangles.push_back({c, a, inside});
  }
  return mesh;
}

/// Points of the surface moved by each symmetry still lie on it: checked by trying every triangle.
void expect_true(const TriangleMesh& mesh, const Symmetries& symmetries, double tolerance_mm) {
  Random random(11);
  const auto points = shapes::surface_points(mesh, 60, random).points;
  for (const auto& motion : symmetry_transformations(symmetries, 0.5)) {
    EXPECT_NEAR(motion.linear().determinant(), 1, 1e-9);
    for (const auto& p : points) EXPECT_LE(shapes::distance_to_mesh(motion * p.cast<double>(), mesh), tolerance_mm);
  }
}

/// With the identity: products stay within.
void expect_group(const std::vector<Eigen::Isometry3d>& discrete, double reach_mm) {
  auto all = discrete;
  all.push_back(Eigen::Isometry3d::Identity());
  for (const auto& a : all)
    for (const auto& b : all) {
      const Eigen::Isometry3d product = a * b;
      EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Eigen::Isometry3d& c) {
        return (c.matrix() - product.matrix()).norm() < 0.01 * reach_mm;
      }));
    }
}

struct Expected {
  const char* name;
  TriangleMesh mesh;
  std::size_t discrete, continuous;
};

class Shapes : public ::testing::TestWithParam<Expected> {};

TEST_P(Shapes, AllSymmetriesAndNoOthers) {
  const auto& [name, mesh, discrete, continuous] = GetParam();
  const auto search = search_symmetries(mesh);
  EXPECT_EQ(search.found.symmetries.discrete.size(), discrete);
  EXPECT_EQ(search.found.symmetries.continuous.size(), continuous);
  EXPECT_EQ(search.found.discrete_deviation_mm.size(), discrete);
  EXPECT_EQ(search.found.continuous_deviation_mm.size(), continuous);
  EXPECT_LE(search.found.largest_deviation_mm(), search.tolerance_mm);
  expect_true(mesh, search.found.symmetries, search.tolerance_mm);
  expect_group(search.found.symmetries.discrete, 1);
}

/// A symmetry of the part is one of the moved part, wherever it lies.
TEST_P(Shapes, TurnWithThePart) {
  const auto& [name, mesh, discrete, continuous] = GetParam();
  Random random(5);
  const TriangleMesh moved = shapes::moved(mesh, shapes::random_pose(random, {400, -250, 900}));
  const auto search = search_symmetries(moved);
  EXPECT_EQ(search.found.symmetries.discrete.size(), discrete);
  EXPECT_EQ(search.found.symmetries.continuous.size(), continuous);
  expect_true(moved, search.found.symmetries, search.tolerance_mm);
}

TEST_P(Shapes, DoNotDependOnTheTriangles) {
  const auto& [name, mesh, discrete, continuous] = GetParam();
  Random random(6);
  const auto search = search_symmetries(unevenly_cut(mesh, 800, random));
  EXPECT_EQ(search.found.symmetries.discrete.size(), discrete);
  EXPECT_EQ(search.found.symmetries.continuous.size(), continuous);
}

INSTANTIATE_TEST_SUITE_P(
    SymmetrySearch, Shapes,
    ::testing::Values(
        Expected{"sphere", shapes::sphere(30, 64, 32), 0, 3}, Expected{"cylinder", shapes::cylinder(20, 70, 64), 1, 1},
        Expected{"cylinder_of_24_facets", shapes::cylinder(20, 70, 24), 1, 1},
        // As high as its second moments are alike in all directions: no axis stands out by them.
        Expected{"cylinder_like_a_ball", shapes::cylinder(20, 41.23, 90), 1, 1},
        Expected{"cone", cone(25, 60, 90), 0, 1}, Expected{"box", shapes::box({60, 40, 20}), 3, 0},
        Expected{"cube", shapes::box({50, 50, 50}), 23, 0}, Expected{"square_prism", shapes::box({50, 50, 20}), 7, 0},
        Expected{"nearly_square_prism", shapes::box({50, 46, 20}), 3, 0},
        Expected{"triangle_prism", shapes::cylinder(30, 25, 3), 5, 0},
        Expected{"prism_of_5", shapes::cylinder(30, 25, 5), 9, 0},
        Expected{"prism_of_6", shapes::cylinder(30, 25, 6), 11, 0},
        Expected{"prism_of_8", shapes::cylinder(30, 25, 8), 15, 0}, Expected{"pyramid_of_7", cone(30, 40, 7), 6, 0},
        Expected{"tetrahedron", tetrahedron(25), 11, 0}, Expected{"l_bracket", shapes::l_bracket(), 0, 0},
        Expected{"l_bracket_of_equal_legs", shapes::l_bracket(60, 60, 12, 30), 1, 0}, Expected{"helix", helix(0), 1, 0},
        Expected{"tapering_helix", helix(0.5), 0, 0}, Expected{"thin_plate", shapes::box({120, 80, 2}), 3, 0},
        Expected{"open_patch", shapes::plane_patch(60, 40), 3, 0}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(SymmetrySearch, GearOfManyTeeth) {
  // 40 teeth, 3 mm high: 9 degrees apart.
  TriangleMesh gear;
  constexpr int teeth = 40, corners = 4 * teeth;
  for (const float z : {0.0f, 15.0f})
    for (int c = 0; c < corners; ++c) {
      const double a = 2 * std::numbers::pi * c / corners, r = c % 4 < 2 ? 40 : 37;
      gear.vertices.push_back(Eigen::Vector3d(r * std::cos(a), r * std::sin(a), z).cast<float>());
    }
  for (const float z : {0.0f, 15.0f}) gear.vertices.emplace_back(0.0f, 0.0f, z);
  for (int c = 0; c < corners; ++c) {
    const int next = (c + 1) % corners;
    shapes::add_quad(gear, c, next, corners + next, corners + c);
    shapes::add_triangle(gear, 2 * corners, next, c);
    shapes::add_triangle(gear, 2 * corners + 1, corners + c, corners + next);
  }
  const auto search = search_symmetries(gear, 0.3);
  EXPECT_EQ(search.found.symmetries.discrete.size(), 2u * teeth - 1);
  EXPECT_TRUE(search.found.symmetries.continuous.empty());
  expect_true(gear, search.found.symmetries, 0.3);
}

TEST(SymmetrySearch, MirrorImagesAreNoSymmetry) {
  const TriangleMesh part = shapes::joined(
      shapes::l_bracket(), shapes::moved(shapes::box({8, 8, 20}), Eigen::Isometry3d(Eigen::Translation3d(50, 12, 8))));
  EXPECT_TRUE(find_symmetries(part, 0.5).empty());
  TriangleMesh mirrored = part;
  for (auto& v : mirrored.vertices) v.x() = -20 - v.x();
  for (auto& t : mirrored.triangles) std::swap(t[0], t[1]);
  const auto search = search_symmetries(shapes::joined(part, mirrored), 0.5);
  EXPECT_TRUE(search.found.symmetries.empty());
}

TEST(SymmetrySearch, ABumpBreaksItAboveTheTolerance) {
  const auto with_bump = [](float height) {
    return shapes::joined(shapes::box({60, 40, 20}),
                          shapes::box(Eigen::Vector3f(15, 5, 10), Eigen::Vector3f(20, 10, 10 + height)));
  };
  const auto below = search_symmetries(with_bump(0.9f), 1.0);
  ASSERT_EQ(below.found.symmetries.discrete.size(), 3u);
  for (const double deviation : below.found.discrete_deviation_mm) EXPECT_NEAR(deviation, 0.9, 0.05);
  const auto above = search_symmetries(with_bump(1.2f), 1.0);
  EXPECT_TRUE(above.found.symmetries.empty());
  // It remains near: the bump is a detail.
  ASSERT_EQ(above.near.symmetries.discrete.size(), 3u);
  for (const double deviation : above.near.discrete_deviation_mm) EXPECT_NEAR(deviation, 1.2, 0.05);
}

TEST(SymmetrySearch, FacetsAreRoundWithinTheToleranceOnly) {
  const TriangleMesh shaft = shapes::cylinder(20, 70, 24);  // facets 0.17 mm deep
  const double depth = 20 * (1 - std::cos(std::numbers::pi / 24));
  const auto coarse = search_symmetries(shaft, 0.3);
  ASSERT_EQ(coarse.found.symmetries.continuous.size(), 1u);
  EXPECT_NEAR(coarse.found.continuous_deviation_mm[0], depth, 0.1 * depth);
  const auto fine = search_symmetries(shaft, 0.05);
  EXPECT_TRUE(fine.found.symmetries.continuous.empty());
  EXPECT_EQ(fine.found.symmetries.discrete.size(), 47u);
}

TEST(SymmetrySearch, RoundButForAKey) {
  const TriangleMesh keyed = shapes::joined(shapes::cylinder(20, 100, 64),
                                            shapes::box(Eigen::Vector3f(19.5, -3, 20), Eigen::Vector3f(24, 3, 40)));
  const auto search = search_symmetries(keyed, 0.5);
  EXPECT_TRUE(search.found.symmetries.empty());
  ASSERT_EQ(search.near.symmetries.continuous.size(), 1u);
  const auto& [axis, offset_mm] = search.near.symmetries.continuous[0];
  EXPECT_LT(axis.normalized().cross(Eigen::Vector3d::UnitZ()).norm(), 1e-3);
  EXPECT_LT(offset_mm.head<2>().norm(), 0.05);
  EXPECT_NEAR(search.near.continuous_deviation_mm[0], 4, 0.3);
}

TEST(SymmetrySearch, SameBitsForAnyNumberOfThreads) {
  const TriangleMesh prism = shapes::cylinder(30, 25, 6);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return search_symmetries(prism);
  };
  const auto one = run(1), many = run(4);
  ASSERT_EQ(one.found.symmetries.discrete.size(), many.found.symmetries.discrete.size());
  for (std::size_t i = 0; i < one.found.symmetries.discrete.size(); ++i) {
    EXPECT_EQ(one.found.symmetries.discrete[i].matrix(), many.found.symmetries.discrete[i].matrix());
    EXPECT_EQ(one.found.discrete_deviation_mm[i], many.found.discrete_deviation_mm[i]);
  }
}

TEST(SymmetrySearch, BadInput) {
  EXPECT_PRED2(mentions, error_of([] { search_symmetries({}); }), "no triangles");
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_PRED2(mentions, error_of([&] { search_symmetries(flat); }), "no area");
  flat.vertices[0].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_PRED2(mentions, error_of([&] { search_symmetries(flat); }), "not finite");
  for (const double tolerance : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_PRED2(mentions, error_of([&] { search_symmetries(shapes::box({1, 2, 3}), tolerance); }), "must be positive");
}

}  // namespace
}  // namespace partpose
