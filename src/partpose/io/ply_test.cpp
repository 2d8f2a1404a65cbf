// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/ply.hpp"

#include "partpose/io/testing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace partpose {
namespace {

using namespace testing;
using namespace std::string_literals;

/// Faces before the vertices, lists in both, a colour, and numbers of many types.
std::string header_of(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\n"
         "comment element vertex 99\n"
         "obj_info num_cols 2\n"
         "element face 2\n"
         "property list uchar int vertex_indices\n"
         "property uchar flags\n"
         "element vertex 2\n"
         "property double x\n"
         "property uchar red\n"
         "property int16 y\n"
         "property list ushort float32 weights\n"
         "property float z\n"
         "element nothing 7\n"
         "element camera 1\n"
         "property float view\n"
         "end_header\n";
}

const std::string ascii_file = header_of("ascii") + "3 0 1 1 5\n0 5\n-1.5 255 -300 2 7 8 9.25\nnan 0 12 0 1e-3\n1\n";

/// The same with nan in z instead, in either byte order.
std::string binary_file(bool big_endian) {
  const auto number = [&](auto value) {
    std::string bytes = as_bytes(value);
    if (big_endian) std::ranges::reverse(bytes);
    return bytes;
  };
  return header_of(big_endian ? "binary_big_endian" : "binary_little_endian") +                          //
         "\3" + number(std::int32_t{0}) + number(std::int32_t{1}) + number(std::int32_t{1}) + "\5" +     //
         "\0\5"s +                                                                                       //
         number(-1.5) + "\xff" + number(std::int16_t{-300}) + number(std::uint16_t{2}) + number(7.0f) +  //
         number(8.0f) + number(9.25f) +                                                                  //
         number(0.5) + "\0"s + number(std::int16_t{12}) + number(std::uint16_t{0}) +
         number(std::numeric_limits<float>::quiet_NaN()) +  //
         number(1.0f);
}

std::string error_in(const std::string& bytes) {
  const TempFolder folder;
  const auto path = folder.file("scene.ply", bytes);
  const auto error = error_of([&] { read_ply(path); });
  EXPECT_TRUE(error == "no error" || error.starts_with(path.string() + ": ")) << error;
  return error;
}

TEST(Ply, RoundTripKeepsBits) {
  const TempFolder folder;
  for (const bool normals : {false, true})
    for (const bool curvatures : {false, true}) {
      const auto cloud = random_cloud(50, 1, normals, curvatures);
      write_ply(folder / "a.ply", cloud);
      expect_same_cloud(read_ply(folder / "a.ply"), cloud);
    }
  write_ply(folder / "a.ply", {});
  expect_same_cloud(read_ply(folder / "a.ply"), {});
  EXPECT_EQ(folder.files(), 1);
}

TEST(Ply, RoundTripOfAnOrganizedCloudLosesItsSizeOnly) {
  const TempFolder folder;
  auto cloud = random_cloud(5, 4, true, false);
  write_ply(folder / "a.ply", cloud);
  cloud.width = 20;
  cloud.height = 1;
  expect_same_cloud(read_ply(folder / "a.ply"), cloud);
}

TEST(Ply, WritesColoursBesideThePoints) {
  const TempFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {4, 5, 6}};
  const std::vector<std::array<std::uint8_t, 3>> colours = {{255, 0, 1}, {2, 3, 128}};
  write_ply(folder / "a.ply", cloud, {.colours = colours});
  EXPECT_EQ(content(folder / "a.ply"),
            "ply\nformat binary_little_endian 1.0\ncomment millimetres\nelement vertex 2\nproperty float x\n"
            "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
            "end_header\n" +
                as_bytes(std::array<float, 3>{1, 2, 3}) + "\xff\0\1"s + as_bytes(std::array<float, 3>{4, 5, 6}) +
                "\2\3\x80");
  EXPECT_TRUE(same_bits(read_ply(folder / "a.ply").points, cloud.points));
}

TEST(Ply, RefusesAWrongNumberOfColours) {
  const TempFolder folder;
  const std::vector<std::array<std::uint8_t, 3>> colours(3);
  EXPECT_CONTAINS(
      error_of([&] { write_ply(folder / "a.ply", random_cloud(2, 1, false, false), {.colours = colours}); }),
      "a.ply: 3 colours for 2 points");
  EXPECT_EQ(folder.files(), 0);
}

TEST(Ply, ReadsAsciiAmongOtherData) {
  const TempFolder folder;
  const auto cloud = read_ply(folder.file("a.ply", ascii_file));
  ASSERT_EQ(cloud.size(), 2);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(-1.5f, -300, 9.25f));
  EXPECT_TRUE(std::isnan(cloud.points[1].x()));
  EXPECT_EQ(cloud.points[1].z(), 0.001f);
  EXPECT_EQ(cloud.width, 2);
  EXPECT_EQ(cloud.height, 1);
  EXPECT_FALSE(cloud.has_normals());
}

TEST(Ply, ReadsBinaryOfBothByteOrdersAmongOtherData) {
  const TempFolder folder;
  for (const bool big_endian : {false, true}) {
    const auto cloud = read_ply(folder.file("a.ply", binary_file(big_endian)));
    ASSERT_EQ(cloud.size(), 2);
    EXPECT_EQ(cloud.points[0], Eigen::Vector3f(-1.5f, -300, 9.25f));
    EXPECT_EQ(cloud.points[1].head<2>(), Eigen::Vector2f(0.5f, 12));
    EXPECT_TRUE(std::isnan(cloud.points[1].z()));
  }
}

TEST(Ply, ReadsEveryNumericType) {
  const TempFolder folder;
  const auto read = [&](const std::string& type, const auto& value) {
    const auto bytes = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty " + type + " x\nproperty " +
                       type + " y\nproperty " + type + " z\nend_header\n" + as_bytes(std::array{value, value, value});
    return read_ply(folder.file("a.ply", bytes)).points.at(0).z();
  };
  for (const char* type : {"char", "int8"}) EXPECT_EQ(read(type, std::int8_t{-100}), -100);
  for (const char* type : {"uchar", "uint8"}) EXPECT_EQ(read(type, std::uint8_t{200}), 200);
  for (const char* type : {"short", "int16"}) EXPECT_EQ(read(type, std::int16_t{-30000}), -30000);
  for (const char* type : {"ushort", "uint16"}) EXPECT_EQ(read(type, std::uint16_t{60000}), 60000);
  for (const char* type : {"int", "int32"}) EXPECT_EQ(read(type, std::int32_t{-8388608}), -8388608);
  for (const char* type : {"uint", "uint32"}) EXPECT_EQ(read(type, std::uint32_t{4000000000u}), 4e9f);
  for (const char* type : {"float", "float32"}) EXPECT_EQ(read(type, 0.1f), 0.1f);
  for (const char* type : {"double", "float64"}) EXPECT_EQ(read(type, 0.1), 0.1f);
}

TEST(Ply, ReadsNormalsAndCurvatureInAnyOrder) {
  const TempFolder folder;
  const auto cloud = read_ply(folder.file("a.ply",
                                          "ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nproperty float curvature\r\n"
                                          "property float nz\r\nproperty float ny\r\nproperty float nx\r\n"
                                          "property float z\r\nproperty float y\r\nproperty float x\r\nend_header\r\n"
                                          "\r\n 0.5 1 0 -0 3 2 1\r\n\r\n"));
  EXPECT_EQ(cloud.points.at(0), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(cloud.normals.at(0), Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(cloud.curvatures.at(0), 0.5f);
}

TEST(Ply, RefusesBadHeaders) {
  const auto with = [](const char* from, const char* to) { return error_in(replaced(ascii_file, from, to)); };
  EXPECT_CONTAINS(error_in("solid x"), "line 1, byte 0: 'solid', 'ply' expected: not a PLY file");
  EXPECT_CONTAINS(with("ply\n", "plyy\n"), "line 1, byte 0: 'plyy', 'ply' expected");
  EXPECT_CONTAINS(with("format ascii 1.0\n", ""), "the header ends without a format line");
  EXPECT_CONTAINS(with("format ascii", "format text"), "line 2, byte 11: format 'text', one of ascii, binary_little");
  EXPECT_CONTAINS(with("ascii 1.0", "ascii 2.0"), "line 2, byte 17: format version '2.0', 1.0 expected");
  EXPECT_CONTAINS(with("ascii 1.0", "ascii 1.0 x"), "line 2, byte 21: 'x' where the line's end is expected");
  EXPECT_CONTAINS(with("comment", "remark"), "line 3, byte 21: 'remark' where one of format, element, ");
  EXPECT_CONTAINS(with("element face 2\n", ""), "line 5, byte 67: a property before the first element");
  EXPECT_CONTAINS(with("element face 2", "element face -2"), "element count '-2', a number from 0 to 2147483647");
  EXPECT_CONTAINS(with("element face 2", "element face"), "element count '', a number from 0 to 2147483647");
  EXPECT_CONTAINS(with("element face 2", "element"), "line 5, byte 74: an element needs a name");
  EXPECT_CONTAINS(with("property double x", "property flot x"), "line 9, byte 168: type 'flot', one of char, uchar, ");
  EXPECT_CONTAINS(with("property double x", "property double"), "line 9, byte 174: a property needs a name");
  EXPECT_CONTAINS(with("list uchar", "list float"), "line 6, byte 96: a list's length cannot be a float");
  EXPECT_CONTAINS(with("list uchar int vertex", "list uchar vertex"), "type 'vertex_indices', one of ");
  EXPECT_CONTAINS(with("element vertex 2", "element vertices 2"), "the header has 0 elements 'vertex', 1 expected");
  EXPECT_CONTAINS(with("element camera", "element vertex"), "the header has 2 elements 'vertex', 1 expected");
  EXPECT_CONTAINS(with("float z", "float depth"), "a point cloud needs x, y and z");
  EXPECT_CONTAINS(with("float32 weights", "float32 nx"), "no error");
  EXPECT_CONTAINS(with("uchar red", "uchar nx"), "a normal needs nx, ny and nz");
  EXPECT_CONTAINS(with("uchar red", "uchar x"), "x is there 2 times");
  EXPECT_CONTAINS(error_in(ascii_file.substr(0, ascii_file.find("end_header"))),
                  "line 17, byte 322: the file ends here, the header needs an end_header line: truncated");
}

TEST(Ply, RefusesBadAsciiData) {
  const auto with = [](const char* from, const char* to) { return error_in(replaced(ascii_file, from, to)); };
  const auto begin = header_of("ascii").size();
  const auto at = [&](int line, std::size_t byte) { return fmt::format("line {}, byte {}: ", line, begin + byte); };
  EXPECT_CONTAINS(with("-1.5 255", "-1.5x 255"), at(20, 14) + "element 'vertex', 0 of 2: '-1.5x' where a number");
  EXPECT_CONTAINS(with("-1.5 255", "1e99 255"), "'1e99' where a number is expected");
  EXPECT_CONTAINS(with("2 7 8 9.25", "2 7 8"), at(20, 33) + "element 'vertex', 0 of 2: a value is missing: truncated");
  EXPECT_CONTAINS(with("2 7 8 9.25", "2 7 8 9.25 1"), at(20, 39) + "'1' where the line's end is expected");
  EXPECT_CONTAINS(with("2 7 8 9.25", "-2 7 8 9.25"), "'-2' where a list's length is expected");
  EXPECT_CONTAINS(with("2 7 8 9.25", "4294967295 7 8 9.25"), "element 'vertex', 0 of 2: a value is missing");
  EXPECT_CONTAINS(with("vertex 2", "vertex 2000000000"), "element 'vertex', 2 of 2000000000: ");
  EXPECT_CONTAINS(error_in(ascii_file.substr(0, begin + 14)), "element 'vertex', 0 of 2: a value is missing");
  EXPECT_CONTAINS(error_in(ascii_file.substr(0, ascii_file.size() - 2)),
                  "element 'camera', 0 of 1: a value is missing");
  EXPECT_CONTAINS(error_in(ascii_file + "1\n"), "data behind the last element");
}

TEST(Ply, RefusesBadBinaryData) {
  const auto good = binary_file(false);
  const auto begin = header_of("binary_little_endian").size();
  for (std::size_t length = begin; length < good.size(); ++length)
    EXPECT_CONTAINS(error_in(good.substr(0, length)), fmt::format("byte {}: the file ends in element '", length));
  EXPECT_CONTAINS(error_in(good.substr(0, begin + 20)), "the file ends in element 'vertex', 0 of 2: truncated");
  EXPECT_CONTAINS(error_in(replaced(good, "face 2", "\xe9 9")), "the file ends in element '?', 5 of 9: truncated");
  EXPECT_CONTAINS(error_in(good + "12"), fmt::format("byte {}: 2 bytes behind the last element", good.size()));
  EXPECT_CONTAINS(error_in(replaced(good, "vertex 2", "vertex 2147483647")),
                  "element 'vertex', 2 of 2147483647: truncated");
  EXPECT_CONTAINS(error_in(replaced(replaced(good, "list uchar", "list char"), "\3"s + "\0"s, "\xff"s + "\0"s)),
                  fmt::format("byte {}: element 'face', 0 of 2: a list of -1 values", begin - 1));
  EXPECT_CONTAINS(error_in(replaced(good, as_bytes(-1.5), as_bytes(1e300))),
                  fmt::format("byte {}: element 'vertex', 0 of 2: 1e+300 is too large for a 32-bit float", begin + 16));
}

TEST(Ply, SurvivesDamage) {
  const TempFolder folder;
  write_ply(folder / "a.ply", random_cloud(5, 1, true, true));
  EXPECT_EQ(survive_damage(content(folder / "a.ply"), [](const auto& path) { return read_ply(path); }), 0);
  for (const auto& bytes : {ascii_file, binary_file(false), binary_file(true)})
    survive_damage(bytes, [](const auto& path) { return read_ply(path); });
}

/// A pyramid: a square and four triangles.
const std::string pyramid =
    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nelement face 5\nproperty list uchar int vertex_index\nproperty int flag\nend_header\n"
    "0 0 0 1\n2 0 0 1\n2 2 0 1\n0 2 0 1\n1 1 3 1\n4 3 2 1 0 9\n3 0 1 4 9\n3 1 2 4 9\n3 2 3 4 9\n3 3 0 4 9\n";

TEST(PlyMesh, PolygonsBecomeFans) {
  const TempFolder folder;
  const TriangleMesh mesh = read_ply_mesh(folder.file("a.ply", pyramid));
  ASSERT_EQ(mesh.vertices.size(), 5);
  EXPECT_EQ(mesh.vertices[4], Eigen::Vector3f(1, 1, 3));
  EXPECT_EQ(mesh.triangles,
            (std::vector<std::array<int, 3>>{{3, 2, 1}, {3, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}));
  EXPECT_EQ(read_ply(folder / "a.ply").size(), 5) << "as a cloud: the vertices";
}

TEST(PlyMesh, BinaryIsReadAlike) {
  const TempFolder folder;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  for (int i = 0; i < 3; ++i) bytes += as_bytes(1.5 * i) + as_bytes(float(i * i)) + as_bytes(2.f);
  bytes += as_bytes(std::uint8_t{3});
  for (const std::uint32_t i : {2, 0, 1}) bytes += as_bytes(i);
  const TriangleMesh mesh = read_ply_mesh(folder.file("a.ply", bytes));
  EXPECT_EQ(mesh.vertices[2], Eigen::Vector3f(3, 4, 2));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{2, 0, 1}}));
  bytes[bytes.size() - 4] = 3;
  EXPECT_CONTAINS(error_of([&] { read_ply_mesh(folder.file("b.ply", bytes)); }), "vertex 3 of 3 does not exist");
}

TEST(PlyMesh, RoundTripKeepsBitsAndWritesUnitNormals) {
  const TempFolder folder;
  TriangleMesh mesh = read_ply_mesh(folder.file("a.ply", pyramid));
  mesh.vertices[0].x() = 0.1f / 3;
  mesh.vertices[1].y() = -1.17549435e-38f;
  write_ply_mesh(folder / "b.ply", mesh);
  const TriangleMesh again = read_ply_mesh(folder / "b.ply");
  EXPECT_TRUE(same_bits(again.vertices, mesh.vertices));
  EXPECT_EQ(again.triangles, mesh.triangles);
  const PointCloud cloud = read_ply(folder / "b.ply");
  ASSERT_EQ(cloud.normals.size(), 5);
  for (const auto& n : cloud.normals) EXPECT_NEAR(n.norm(), 1, 1e-6);
  EXPECT_GT(cloud.normals[4].z(), 0.99f);
}

TEST(PlyMesh, RefusesWhatIsNoMesh) {
  const TempFolder folder;
  const auto refused = [&](const std::string& from, const std::string& to) {
    return error_of([&] { read_ply_mesh(folder.file("a.ply", replaced(pyramid, from, to))); });
  };
  EXPECT_CONTAINS(refused("element face 5", "element faces 5"), "has no triangles, is it a point cloud?");
  EXPECT_CONTAINS(refused("3 0 1 4 9", "3 0 1 5 9"), "'5' where one of 5 vertices is expected");
  EXPECT_CONTAINS(refused("3 0 1 4 9", "3 0 -1 4 9"), "'-1' where one of 5 vertices is expected");
  EXPECT_CONTAINS(refused("3 0 1 4 9", "4 0 1 4 9"), "'9' where one of 5 vertices is expected");
  EXPECT_CONTAINS(refused("1 1 3 1", "1 1 nan 1"), "a coordinate is not finite");
  TriangleMesh mesh = read_ply_mesh(folder.file("a.ply", pyramid));
  mesh.triangles[0][1] = 5;
  EXPECT_CONTAINS(error_of([&] { write_ply_mesh(folder / "b.ply", mesh); }), "triangle 0 has vertex 5 of 5");
  mesh.triangles[0][1] = 0;
  mesh.vertices[2].x() = std::numeric_limits<float>::infinity();
  EXPECT_CONTAINS(error_of([&] { write_ply_mesh(folder / "b.ply", mesh); }), "vertex 2 is not finite");
}

TEST(PlyMesh, SurvivesDamage) {
  survive_damage(pyramid, [](const auto& path) { return read_ply_mesh(path); });
}

}  // namespace
}  // namespace partpose
