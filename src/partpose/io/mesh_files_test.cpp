// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/mesh_files.hpp"

#include "partpose/geometry/mesh_inspection.hpp"
#include "partpose/io/isolated_reader.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/io/testing.hpp"
#include "partpose/io/zip.hpp"
#include "tests/shapes.hpp"
#include "tests/step_files.hpp"

#include <zlib.h>

#include <csignal>
#include <numbers>

namespace partpose {
namespace {

using namespace testing;
namespace fs = std::filesystem;

const std::string off_triangles = "OFF\n4 4 6\n0 0 0\n30 0 0\n0 40 0\n0 0 50\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string obj_of(const TriangleMesh& mesh) {
  std::string text = "# a mesh\no first\n";
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    text += fmt::format("v {} {} {}\n", mesh.vertices[v].x(), mesh.vertices[v].y(), mesh.vertices[v].z());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t == 5) text += "o second\n";
    text += fmt::format("f {} {} {}\n", mesh.triangles[t][0] + 1, mesh.triangles[t][1] + 1, mesh.triangles[t][2] + 1);
  }
  return text;
}

TEST(MeshFiles, AFolderMayMixFormats) {
  const TempFolder folder;
  write_stl(folder / "b.stl", shapes::box({1, 2, 3}));
  folder.file("A.OFF", off_triangles);
  folder.file("c.txt", "no model");
  const auto parts = read_meshes(folder / "");
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "A");
  EXPECT_EQ(parts[0].file, folder / "A.OFF");
  EXPECT_EQ(parts[0].mesh.triangles.size(), 4u);
  EXPECT_EQ(parts[1].name, "b");
  EXPECT_EQ(parts[1].unit, "");
  EXPECT_EQ(read_meshes({folder / "b.stl", folder / "A.OFF"})[0].name, "b");
  EXPECT_EQ(read_meshes(folder / "b.stl").size(), 1u);
}

TEST(MeshFiles, TwoPartsOfOneNameAreRefusedByBothFiles) {
  const TempFolder folder;
  write_stl(folder / "part.stl", shapes::box({1, 2, 3}));
  folder.file("part.off", off_triangles);
  EXPECT_EQ(error_of([&] { read_meshes(folder / ""); }),
            fmt::format("{}: another model is already named \"part\": {}; rename or leave out one of the two",
                        (folder / "part.stl").string(), (folder / "part.off").string()));
}

TEST(MeshFiles, BrokenFilesAreToldAndLeftOut) {
  const TempFolder folder;
  folder.file("a.stl", "not one");
  folder.file("b.off", off_triangles);
  folder.file("c.ply", "ply\n");
  std::vector<std::string> told;
  const auto tell = [&](const fs::path& file, const std::string& message) {
    EXPECT_TRUE(message.starts_with(file.string() + ": ")) << message;
    told.push_back(file.filename().string());
  };
  EXPECT_EQ(read_meshes(std::vector{folder / ""}, {}, tell).size(), 1u);
  EXPECT_EQ(told, (std::vector<std::string>{"a.stl", "c.ply"}));
  EXPECT_TRUE(error_of([&] { read_meshes(folder / ""); }).starts_with((folder / "a.stl").string()));
  fs::remove(folder / "b.off");
  EXPECT_EQ(error_of([&] { read_meshes(std::vector{folder / ""}, {}, tell); }),
            "none of the 2 model files can be read");
}

TEST(MeshFiles, WhatACameraWroteIsNoModel) {
  const TempFolder folder;
  const auto reading = [&](const char* name) { return error_of([&] { read_mesh_file(folder.file(name, "x")); }); };
  EXPECT_CONTAINS(reading("a.PNG"),
                  "a.PNG: is an image, not a model of a part; depth images and point clouds are scenes");
  EXPECT_CONTAINS(reading("a.pcd"), "a.pcd: is a point cloud, not a model of a part");
  EXPECT_CONTAINS(reading("a.json"), "a.json: is a JSON file, not a model of a part");
}

TEST(MeshFiles, OptionsAreChecked) {
  const TempFolder folder;
  const auto file = folder.file("b.off", off_triangles);
  const auto error = [&](const MeshReadOptions& options) { return error_of([&] { read_meshes(file, options); }); };
  EXPECT_EQ(error({.chord_tolerance_mm = 0}), "chord_tolerance_mm 0: must be positive");
  EXPECT_CONTAINS(error({.angle_tolerance_deg = 0.5}), "must be 1 to 90");
  EXPECT_CONTAINS(error({.split = "body"}), "\"product\", \"solid\" or \"whole\"");
}

TEST(MeshFiles, CoordinatesAreChecked) {
  const TempFolder folder;
  EXPECT_CONTAINS(error_of([&] { read_meshes(folder.file("a.off", replaced(off_triangles, "30 0 0", "3e7 0 0"))); }),
                  "coordinate 30000000 mm is beyond 1000000 mm: wrong units?");
  EXPECT_CONTAINS(error_of([&] { read_meshes(folder.file("a.off", "OFF\n3 1 3\n0 0 0\n1 1 1\n2 2 2\n3 0 1 2\n")); }),
                  "none of the 1 triangles has an area");
}

TEST(MeshFiles, Obj) {
  const TempFolder folder;
  const auto bracket = shapes::l_bracket();
  const auto path = folder.file("bracket.obj", obj_of(bracket));
  if (!reads_assimp_formats()) {
    EXPECT_CONTAINS(error_of([&] { read_meshes(path); }), "PARTPOSE_WITH_ASSIMP");
    return;
  }
  const auto parts = read_meshes(path);
  ASSERT_EQ(parts.size(), 1u) << "groups of an OBJ file are no parts";
  EXPECT_EQ(parts[0].name, "bracket");
  EXPECT_NEAR(shapes::volume(parts[0].mesh), shapes::volume(bracket), 0.01);
  EXPECT_TRUE(inspect_mesh(parts[0].mesh).sound());
  EXPECT_CONTAINS(error_of([&] { read_meshes(folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n")); }),
                  "vertex index out of range");
}

TEST(MeshFiles, ACrashOfALibraryIsAnError) {
  const fs::path path = "part.xyz";
  const auto error = [&](auto read) { return error_of([&] { read_isolated(path, "Reader", read); }); };
  using Parts = std::vector<NamedMesh>;
  EXPECT_EQ(error([]() -> Parts { std::abort(); }), "part.xyz: Reader crashed on it: the file is damaged or too large");
  EXPECT_EQ(error([]() -> Parts {
              std::raise(SIGSEGV);
              return {};
            }),
            "part.xyz: Reader crashed on it: the file is damaged or too large");
  EXPECT_EQ(error([]() -> Parts { throw std::bad_alloc(); }),
            "part.xyz: Reader gave up on it: the file is damaged or too large");
  EXPECT_EQ(error([]() -> Parts { throw Error("part.xyz: byte 7: odd"); }), "part.xyz: byte 7: odd");
  // More than a pipe holds.
  const auto ball = shapes::sphere(30, 200, 100);
  const auto parts = read_isolated(path, "Reader", [&] {
    return Parts{{"ball", ball, path, "mile"}, {"", {}, path, ""}};
  });
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name + parts[0].unit + parts[0].file.string(), "ballmilepart.xyz");
  EXPECT_TRUE(same_bits(parts[0].mesh.vertices, ball.vertices));
  EXPECT_EQ(parts[0].mesh.triangles, ball.triangles);
}

/// A ZIP archive of one file, as its specification says.
std::string zip_of(const std::string& name, const std::string& content, bool deflate_it) {
  std::string packed = content;
  if (deflate_it) {
    z_stream stream{};
    deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
    packed.resize(content.size() + 100);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
    stream.avail_in = static_cast<uInt>(content.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
  }
  const auto number = [](std::size_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i & 255);
    return text;
  };
  const std::string method = number(deflate_it ? 8 : 0, 2), checksum(4, '\0');
  const std::string sizes = number(packed.size(), 4) + number(content.size(), 4);
  const std::string local = "PK\x03\x04" + number(20, 2) + number(0, 2) + method + number(0, 4) + checksum + sizes +
                            number(name.size(), 2) + number(0, 2) + name + packed;
  const std::string central = "PK\x01\x02" + number(20, 4) + number(0, 2) + method + number(0, 4) + checksum + sizes +
                              number(name.size(), 2) + number(0, 16) + name;
  return local + central + "PK\x05\x06" + number(0, 4) + number(1, 2) + number(1, 2) + number(central.size(), 4) +
         number(local.size(), 4) + number(0, 2);
}

TEST(Zip, FindsAFileStoredOrDeflated) {
  const std::string model = "<model unit=\"inch\"> " + std::string(5000, 'x');
  for (const bool deflated : {false, true}) {
    const auto archive = zip_of("3D/3dmodel.MODEL", model, deflated);
    EXPECT_EQ(zip_entry(archive, ".model", 1 << 16, "a.zip"), model);
    EXPECT_EQ(zip_entry(archive, ".model", 20, "a.zip"), model.substr(0, 20));
    EXPECT_EQ(error_of([&] { zip_entry(archive, ".xml", 9, "a.zip"); }), "a.zip: has no file that ends with \".xml\"");
    survive_damage(
        archive, [](const fs::path& path) { zip_entry(content(path), ".model", 1 << 16, path.string()); }, 500);
  }
}

#ifdef PARTPOSE_HAS_OCCT

TEST(Step, ABoredBlockWithinTheChordTolerance) {
  const TempFolder folder;
  step_files::write(folder / "block.step", {{"a name", step_files::bored_block()}});
  const double exact = 40 * 30 * 20 - std::numbers::pi * 25 * 20;
  std::size_t triangles = 0;
  for (const double tolerance : {0.5, 0.1, 0.01}) {
    const auto parts = read_meshes(folder / "block.step", {.chord_tolerance_mm = tolerance, .angle_tolerance_deg = 90});
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_EQ(parts[0].name, "block") << "one part is known by its file";
    EXPECT_EQ(parts[0].unit, "millimetre");
    const auto& mesh = parts[0].mesh;
    const auto found = inspect_mesh(mesh);
    EXPECT_TRUE(found.sound());
    EXPECT_EQ(found.size_mm, (std::array<double, 3>{40, 30, 20}));
    // Chords of the bore leave more material, at most a ring of the tolerance.
    EXPECT_GE(*found.volume_mm3, exact - 0.1);
    EXPECT_LE(*found.volume_mm3, exact + tolerance * 2 * std::numbers::pi * 5 * 20);
    EXPECT_GT(mesh.triangles.size(), triangles) << "finer";
    triangles = mesh.triangles.size();
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3f middle = (mesh.vertices[t[k]] + mesh.vertices[t[(k + 1) % 3]]) / 2;
        const double radius = std::hypot(middle.x() - 15, middle.y() - 12);
        EXPECT_GE(radius, 5 - tolerance - 1e-3);
      }
  }
  const auto once = read_meshes(folder / "block.step"), again = read_meshes(folder / "block.step");
  EXPECT_TRUE(same_bits(once[0].mesh.vertices, again[0].mesh.vertices));
}

TEST(Step, UnitsAreHonoured) {
  const TempFolder folder;
  for (const char* unit : {"INCH", "M", "CM"}) {
    step_files::write(folder / "block.stp", {{"block", step_files::bored_block()}}, unit);
    const auto parts = read_meshes(folder / "block.stp");
    const auto size = bounding_box(parts[0].mesh).sizes();
    EXPECT_NEAR((size - Eigen::Vector3d(40, 30, 20)).norm(), 0, 1e-4) << unit;
    EXPECT_NE(parts[0].unit, "millimetre");
  }
}

TEST(Step, AnAssemblyIsSplitIntoItsProducts) {
  const TempFolder folder;
  const std::vector<gp_XYZ> corners = {{5, 5, 20}, {35, 25, 20}};
  step_files::write(folder / "assembly.step",
                    {{"plate", step_files::bored_block()}, {"bolt", step_files::cylinder(0, 0, 0, 2, 12), corners}});
  const auto parts = read_meshes(folder / "assembly.step");
  ASSERT_EQ(parts.size(), 2u) << "the bolt once";
  EXPECT_EQ(parts[0].name, "plate");
  EXPECT_EQ(parts[1].name, "bolt");
  const auto bolt = bounding_box(parts[1].mesh);
  EXPECT_NEAR((bolt.center() - Eigen::Vector3d(5, 5, 26)).norm(), 0, 0.1) << "where it stands first";
  EXPECT_TRUE(inspect_mesh(parts[1].mesh).sound());

  const auto whole = read_meshes(folder / "assembly.step", {.split = "whole"});
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_EQ(whole[0].name, "assembly");
  EXPECT_EQ(inspect_mesh(whole[0].mesh).shells, 3);
  EXPECT_NEAR(bounding_box(whole[0].mesh).max().z(), 32, 1e-4);
}

TEST(Step, AProductOfTwoSolidsIsOnePartUnlessAsked) {
  const TempFolder folder;
  TopoDS_Compound two;
  BRep_Builder builder;
  builder.MakeCompound(two);
  builder.Add(two, step_files::block(10, 20, 30));
  builder.Add(two, step_files::at(step_files::block(10, 10, 10), 50, 0, 0));
  step_files::write(folder / "motor.step", {{"motor", two}});
  EXPECT_EQ(inspect_mesh(read_meshes(folder / "motor.step", {.split = "whole"})[0].mesh).shells, 2);
  const auto solids = read_meshes(folder / "motor.step", {.split = "solid"});
  ASSERT_EQ(solids.size(), 2u);
  EXPECT_NE(solids[0].name, solids[1].name);
  EXPECT_NEAR(shapes::volume(solids[0].mesh), 6000, 1e-3);
  EXPECT_NEAR(shapes::volume(solids[1].mesh), 1000, 1e-3);
}

TEST(Step, SaysWhatIsWrong) {
  const TempFolder folder;
  step_files::write(folder / "face.step", {{"face", step_files::face(20)}});
  EXPECT_CONTAINS(error_of([&] { read_meshes(folder / "face.step"); }), "holds no solid but 1 loose faces");
  step_files::write(folder / "block.step", {{"block", step_files::bored_block()}});
  const std::string bytes = content(folder / "block.step");
  EXPECT_CONTAINS(error_of([&] { read_meshes(folder.file("cut.step", bytes.substr(0, bytes.size() / 2))); }),
                  "the file ends here without 'END-ISO-10303-21;': truncated");
  EXPECT_CONTAINS(error_of([&] { read_meshes(folder.file("cut.step", "solid x\n")); }), "not a STEP file");
  // Damage within: a model or an Error, whatever OpenCASCADE makes of it.
  std::mt19937 random(7);
  for (int copy = 0; copy < 40; ++copy) {
    std::string damaged = bytes;
    for (int change = 0; change < 3; ++change)
      damaged[random() % damaged.size()] = static_cast<char>('0' + random() % 10);
    fs::remove(folder / "damaged.step");
    reads_or_complains(folder, damaged, [&](const fs::path& path) {
      const fs::path step = path.string() + ".step";
      fs::rename(path, step);
      try {
        read_meshes(step);
      } catch (const Error& error) {
        throw Error(replaced(error.what(), step.string(), path.string()));
      }
    });
  }
}

#else

TEST(Step, ABuildWithoutOpenCascadeSaysSo) {
  const TempFolder folder;
  EXPECT_FALSE(reads_step());
  EXPECT_CONTAINS(error_of([&] { read_meshes(folder.file("a.step", "ISO-10303-21;")); }), "PARTPOSE_WITH_OCCT");
}

#endif

}  // namespace
}  // namespace partpose
