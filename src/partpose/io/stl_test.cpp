// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/stl.hpp"

#include "partpose/io/testing.hpp"
#include "tests/shapes.hpp"

#include <cstdint>

namespace partpose {
namespace {

using namespace testing;
using namespace std::string_literals;

/// A tetrahedron with awkward numbers and no vertex twice, its vertices in order of first use.
TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0.1f, 0, 0}, {10.3f, 0, 1e-20f}, {0, 1.0f / 3, 0}, {0, -999999.9f, 7}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

std::string binary_stl(std::uint32_t claimed, const std::vector<std::array<float, 9>>& triangles,
                       std::string header = "made by a test") {
  header.resize(80, '\0');
  header += as_bytes(claimed);
  for (const auto& corners : triangles) header += std::string(12, '\xff') + as_bytes(corners) + "\0\0"s;
  return header;
}

const std::array<float, 9> unit_triangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

const std::string ascii_triangle =
    "solid two words\n"
    "  facet normal 0 0 1\n"
    "    outer loop\n"
    "      vertex 0 0 0\n"
    "      vertex 1 0 0\n"
    "      vertex 0 1 0\n"
    "    endloop\n"
    "  endfacet\n"
    "endsolid two words\n";

std::string error_in(const std::string& bytes) {
  return error_of([&] { parse_stl(bytes, "part.stl"); });
}

TEST(Stl, BinaryRoundTripKeepsBitsAndOrder) {
  const TempFolder folder;
  const auto mesh = tetrahedron();
  write_stl(folder / "a.stl", mesh);
  EXPECT_EQ(std::filesystem::file_size(folder / "a.stl"), 84 + 50 * 4);
  const auto again = read_stl(folder / "a.stl");
  EXPECT_TRUE(same_bits(again.vertices, mesh.vertices));
  EXPECT_EQ(again.triangles, mesh.triangles);
}

TEST(Stl, WritesNormalsByTheWinding) {
  const TempFolder folder;
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 5}, {2, 0, 5}, {0, 3, 5}};
  mesh.triangles = {{0, 2, 1}};
  write_stl(folder / "a.stl", mesh);
  EXPECT_EQ(content(folder / "a.stl").substr(84, 12), as_bytes(std::array<float, 3>{0, 0, -1}));
}

TEST(Stl, ReadsAscii) {
  const auto mesh = parse_stl(ascii_triangle, "part.stl");
  const std::vector<Eigen::Vector3f> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_TRUE(same_bits(mesh.vertices, vertices));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}}));
}

TEST(Stl, ReadsAsciiOfManyHands) {
  std::string odd = ascii_triangle;
  for (char& c : odd) c = static_cast<char>(std::toupper(c));
  odd = replaced(odd, "SOLID", "Solid");
  odd = replaced(odd, "NORMAL 0 0 1", "normal nan -1.#IND 0");
  odd = replaced(odd, "VERTEX 1 0 0", "\tVERTEX\t+1.50E+01 -2e-3 1e-60 ");
  for (std::size_t at = 0; (at = odd.find('\n', at)) != std::string::npos; at += 2) odd.insert(at, 1, '\r');
  const auto mesh = parse_stl(odd, "part.stl");
  ASSERT_EQ(mesh.vertices.size(), 3);
  EXPECT_EQ(mesh.vertices[1], Eigen::Vector3f(15, -0.002f, 0));
}

TEST(Stl, ReadsSeveralSolidsAsOneMesh) {
  const auto moved = replaced(ascii_triangle, "vertex 0 0 0", "vertex 0 0 9");
  const auto mesh = parse_stl(ascii_triangle + "\n\n" + moved + "solid nothing\nendsolid", "part.stl");
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {3, 1, 2}}));
}

TEST(Stl, ReadsBinaryWhoseHeaderBeginsWithSolid) {
  EXPECT_EQ(parse_stl(binary_stl(1, {unit_triangle}, "solid part"), "p").triangles.size(), 1);
  EXPECT_EQ(parse_stl(binary_stl(1, {unit_triangle}, "solid" + std::string(75, ' ')), "p").triangles.size(), 1);
}

TEST(Stl, ABinarySolidOfTheWrongSizeIsNotTakenForText) {
  const auto bytes = binary_stl(2, {unit_triangle}, "solid" + std::string(75, ' '));
  EXPECT_EQ(error_in(bytes),
            "part.stl: byte 80: header says 2 triangles (184 bytes), the file has 134 bytes: truncated or not an STL");
}

TEST(Stl, KeepsDegenerateTrianglesAndIgnoresStoredNormals) {
  const auto mesh = parse_stl(binary_stl(2, {{5, 5, 5, 5, 5, 5, 6, 6, 6}, unit_triangle}), "p");
  ASSERT_EQ(mesh.triangles.size(), 2);
  EXPECT_EQ(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_TRUE(mesh.face_normal(0).isZero());
  EXPECT_EQ(mesh.face_normal(1), Eigen::Vector3f::UnitZ());
}

TEST(Stl, MergesEqualVerticesOnly) {
  auto other = unit_triangle;
  other[0] = std::nextafter(0.0f, 1.0f);
  EXPECT_EQ(parse_stl(binary_stl(2, {unit_triangle, unit_triangle}), "p").vertices.size(), 3);
  EXPECT_EQ(parse_stl(binary_stl(2, {unit_triangle, other}), "p").vertices.size(), 4);
}

TEST(Stl, RefusesALyingTriangleCount) {
  EXPECT_EQ(
      error_in(binary_stl(1000, std::vector(13, unit_triangle))),
      "part.stl: byte 80: header says 1000 triangles (50084 bytes), the file has 734 bytes: truncated or not an STL");
  EXPECT_EQ(
      error_in(binary_stl(0xffffffff, {unit_triangle})),
      "part.stl: byte 80: header says 4294967295 triangles (214748364834 bytes), the file has 134 bytes: truncated "
      "or not an STL");
  EXPECT_CONTAINS(error_in(binary_stl(1, {unit_triangle, unit_triangle})),
                  "byte 80: header says 1 triangles (134 bytes), the file has 184 bytes: too long");
  EXPECT_CONTAINS(error_in(binary_stl(1, {unit_triangle}) + "x"), "the file has 135 bytes: too long");
}

TEST(Stl, RefusesFilesWithoutTriangles) {
  EXPECT_EQ(error_in(binary_stl(0, {})), "part.stl: byte 80: empty, header says 0 triangles");
  EXPECT_CONTAINS(error_in("solid a\nendsolid a\n"), "part.stl: line 2, byte 8: empty");
  EXPECT_CONTAINS(error_in(""), "part.stl: byte 0: the file ends here");
  EXPECT_CONTAINS(error_in("PK\x03\x04"), "part.stl: byte 4: the file ends here, a binary STL has at least 84 bytes");
}

TEST(Stl, RefusesAMeshWithoutArea) {
  EXPECT_EQ(error_in(binary_stl(2, {{0, 0, 0, 1, 1, 1, 2, 2, 2}, {}})),
            "part.stl: none of the 2 triangles has an area");
}

TEST(Stl, RefusesUnusableCoordinates) {
  auto corners = unit_triangle;
  corners[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_in(binary_stl(2, {unit_triangle, corners})),
            "part.stl: byte 162: triangle 1: coordinate nan is not finite");
  corners[4] = -std::numeric_limits<float>::infinity();
  EXPECT_CONTAINS(error_in(binary_stl(1, {corners})), "byte 112: triangle 0: coordinate -inf is not finite");
  corners[4] = 1e6f;
  EXPECT_EQ(error_in(binary_stl(1, {corners})), "no error");
  corners[4] = -1000000.1f;
  EXPECT_CONTAINS(error_in(binary_stl(1, {corners})), "mm is beyond 1000000 mm: wrong units?");

  const auto ascii = [](const char* number) {
    return error_in(replaced(ascii_triangle, "vertex 1 0 0", fmt::format("vertex 1 {} 0", number)));
  };
  EXPECT_EQ(ascii("nan"), "part.stl: line 5, byte 86: coordinate nan is not finite");
  EXPECT_CONTAINS(ascii("-Infinity"), "line 5, byte 86: coordinate -inf is not finite");
  EXPECT_CONTAINS(ascii("2e6"), "line 5, byte 86: coordinate 2000000 mm is beyond");
  EXPECT_CONTAINS(ascii("1e99"), "line 5, byte 86: '1e99' where a coordinate is expected");
  EXPECT_CONTAINS(ascii("1,5"), "line 5, byte 86: '1,5' where a coordinate is expected");
}

TEST(Stl, RefusesBadGrammar) {
  const auto with = [](const char* from, const char* to) { return error_in(replaced(ascii_triangle, from, to)); };
  EXPECT_CONTAINS(with("facet normal", "facet norm"), "line 2, byte 24: 'norm' where 'normal' is expected");
  EXPECT_CONTAINS(with("outer loop", "outer lop"), "line 3, byte 47: 'lop' where 'loop' is expected");
  EXPECT_CONTAINS(with("      vertex 0 1 0\n", ""), "line 6, byte 94: 'endloop' where 'vertex' is expected");
  EXPECT_CONTAINS(with("    endloop", "    vertex 1 1 0\n    endloop"), "line 7, byte 113: 'vertex' where 'endloop'");
  EXPECT_CONTAINS(with("vertex 1 0 0", "vertex 1 0"), "'vertex' where a coordinate is expected");
  EXPECT_CONTAINS(with("endsolid", "endsolit"), "line 9, byte 132: 'endsolit' where 'facet' or 'endsolid' is expected");
  EXPECT_CONTAINS(error_in(ascii_triangle + "rubbish"), "line 10, byte 151: 'rubbish' where 'solid' is expected");
}

TEST(Stl, RefusesEveryTruncationOfAscii) {
  const auto complete = ascii_triangle.find("endsolid") + std::string("endsolid").size();
  for (std::size_t length = 0; length < complete; ++length)
    EXPECT_CONTAINS(error_in(ascii_triangle.substr(0, length)), "part.stl: ");
  EXPECT_CONTAINS(error_in(ascii_triangle.substr(0, complete - 8)),
                  "line 9, byte 132: the file ends here, 'facet' or 'endsolid' expected: truncated");
}

TEST(Stl, NamesTheFile) {
  const TempFolder folder;
  const auto path = folder.file("lying.stl", binary_stl(7, {unit_triangle}));
  EXPECT_TRUE(error_of([&] { read_stl(path); }).starts_with(path.string() + ": byte 80: header says 7 triangles"));
}

TEST(Stl, RefusesToWriteWhatCouldNotBeRead) {
  const TempFolder folder;
  const auto writing = [&](const TriangleMesh& mesh) { return error_of([&] { write_stl(folder / "a.stl", mesh); }); };
  EXPECT_CONTAINS(writing({}), "a.stl: a mesh without triangles");
  auto mesh = tetrahedron();
  mesh.triangles[2][1] = 4;
  EXPECT_CONTAINS(writing(mesh), "a.stl: triangle 2 has vertex 4, the mesh has 4 vertices");
  mesh.triangles[2][1] = -1;
  EXPECT_CONTAINS(writing(mesh), "triangle 2 has vertex -1");
  mesh = tetrahedron();
  mesh.vertices[3].z() = std::numeric_limits<float>::infinity();
  EXPECT_CONTAINS(writing(mesh), "a.stl: triangle 1: coordinate inf is not finite");
  EXPECT_EQ(folder.files(), 0);
}

TEST(Stl, SurvivesDamage) {
  const TempFolder folder;
  write_stl(folder / "a.stl", tetrahedron());
  EXPECT_EQ(survive_damage(content(folder / "a.stl"), read_stl), 0);
  survive_damage(ascii_triangle + ascii_triangle, read_stl);
}

TEST(Stl, StoredNormalsAreCompared) {
  const TempFolder folder;
  write_stl(folder / "a.stl", shapes::box({10, 20, 30}));
  EXPECT_EQ(stl_normals(folder / "a.stl").missing + stl_normals(folder / "a.stl").against, 0);
  std::string bytes = content(folder / "a.stl");
  bytes.replace(84 + 50 * 3, 12, std::string(12, '\0'));
  for (const int t : {5, 7})
    for (int axis = 0; axis < 3; ++axis) bytes[84 + 50 * t + 4 * axis + 3] ^= '\x80';  // the signs
  const auto found = stl_normals(folder.file("b.stl", bytes));
  EXPECT_EQ(found.missing, 1);
  EXPECT_EQ(found.against, 2);
  const std::string facet =
      "facet normal {}\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const auto ascii =
      stl_normals(folder.file("c.stl", "solid x\n" + replaced(facet, "{}", "0 0 -1") + replaced(facet, "{}", "a b c") +
                                           replaced(facet, "{}", "0 0 1") + "endsolid\n"));
  EXPECT_EQ(ascii.missing, 1);
  EXPECT_EQ(ascii.against, 1);
}

}  // namespace
}  // namespace partpose
