// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// The 3D models of parts, whatever program they come from: see docs/cad.md.
namespace partpose {

struct MeshReadOptions {
  double chord_tolerance_mm = 0.1;
  double angle_tolerance_deg = 20;
  std::string split = "product";

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("chord_tolerance_mm", self.chord_tolerance_mm,
          "STEP: largest distance of a triangle from the curved surface that it stands for [mm], > 0");
    visit("angle_tolerance_deg", self.angle_tolerance_deg,
          "STEP: largest angle between neighbouring facets of a curved surface [deg], 1 to 90");
    visit(
        "split", self.split,
        "what is a part of its own: each \"product\" of an assembly, each \"solid\" of each product, or the \"whole\" "
        "file");
  }
  void check() const;
};

/// A part: its mesh in mm, in the file's own frame (of an assembly: where the part stands first).
struct NamedMesh {
  std::string name;  ///< the file's, without its ending; of several parts in a file, the part's own
  TriangleMesh mesh;
  std::filesystem::path file;
  std::string unit;  ///< as the file states it, "millimetre", "inch", ...; empty when it does not
};

/// The endings of the files that read_meshes knows, lower case with the dot, whether or not this build reads them.
const std::vector<std::string>& mesh_file_endings();

/// Whether this build reads STEP (by OpenCASCADE), and OBJ, 3MF and glTF (by Assimp). STL, PLY and OFF always.
bool reads_step();
bool reads_assimp_formats();

/// All parts of a file, or of the files of a folder that have one of the endings, by the files' names (not of
/// subfolders). At least one. Throws Error when a file cannot be read, and when two parts have the same name.
std::vector<NamedMesh> read_meshes(const std::filesystem::path& file_or_folder, const MeshReadOptions& options = {});

/// Told of a file that cannot be read; the message is one line that begins with the file.
using BrokenMeshFile = std::function<void(const std::filesystem::path& file, const std::string& message)>;

/// The parts of several files or folders. With `broken`, files that cannot be read are told there and left out; it is
/// an Error when nothing is left. Two parts of one name are an Error that names both files in any case.
std::vector<NamedMesh> read_meshes(const std::vector<std::filesystem::path>& files_and_folders,
                                   const MeshReadOptions& options = {}, const BrokenMeshFile& broken = {});

/// The parts of one file, whose names may be those of another file's.
std::vector<NamedMesh> read_mesh_file(const std::filesystem::path& file, const MeshReadOptions& options = {});

/// For people, of a part whose file states no unit: its size is as if it were in metres, inches, ...; or empty.
std::string doubt_about_unit(const NamedMesh& part);

/// Tells whether a mesh changed.
std::string content_hash(const TriangleMesh& mesh);

/// Throws Error, naming both files, when two parts have the same name.
void check_names_differ(const std::vector<NamedMesh>& parts);

}  // namespace partpose
