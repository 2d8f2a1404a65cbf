// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/mesh_files.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/hash.hpp"
#include "partpose/geometry/mesh_inspection.hpp"
#include "partpose/io/assimp_meshes.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/off.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/io/step.hpp"
#include "partpose/io/stl.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace partpose {

namespace fs = std::filesystem;

namespace {

constexpr float largest_mm = 1e6f;  // as in STL files: beyond, the unit is another one

/// Names by which a folder, a table or a JSON key can hold the parts: none empty, none twice.
void give_names(std::vector<NamedMesh>& parts, const fs::path& file) {
  const std::string stem = file.stem().string();
  if (parts.size() == 1) {
    parts[0].name = stem;
    return;
  }
  std::set<std::string> taken;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::string& name = parts[i].name;
    for (char& c : name)
      if (static_cast<unsigned char>(c) < ' ' || c == '/' || c == '\\') c = '_';
    while (!name.empty() && name.back() == ' ') name.pop_back();
    if (name.empty()) name = fmt::format("{}_{}", stem, i + 1);
    const std::string base = name;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}_{}", base, k);
  }
}

void check_usable(const NamedMesh& part) {
  const auto where = [&] { return fmt::format("{}: part \"{}\"", part.file.string(), part.name); };
  for (const auto& v : part.mesh.vertices)
    for (const float mm : v) {
      if (!std::isfinite(mm)) throw Error("{}: coordinate {} is not finite", where(), mm);
      if (std::abs(mm) > largest_mm)
        throw Error("{}: coordinate {} mm is beyond {} mm: wrong units?", where(), mm, largest_mm);
    }
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t)
    if (!part.mesh.face_normal(t).isZero()) return;
  throw Error("{}: none of the {} triangles has an area", where(), part.mesh.triangles.size());
}

/// What a camera wrote, or a text beside it, by the file's ending; null: it may be a model.
const char* other_than_a_model(const std::string& ending) {
  for (const char* image : {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".exr"})
    if (ending == image) return "an image";
  if (ending == ".pcd" || ending == ".xyz") return "a point cloud";
  return ending == ".json" ? "a JSON file" : nullptr;
}

}  // namespace

void MeshReadOptions::check() const {
  if (!(chord_tolerance_mm > 0) || !std::isfinite(chord_tolerance_mm))
    throw Error("chord_tolerance_mm {}: must be positive", chord_tolerance_mm);
  if (!(angle_tolerance_deg >= 1 && angle_tolerance_deg <= 90))
    throw Error("angle_tolerance_deg {}: must be 1 to 90", angle_tolerance_deg);
  if (split != "product" && split != "solid" && split != "whole")
    throw Error("split \"{}\": must be \"product\", \"solid\" or \"whole\"", split);
}

const std::vector<std::string>& mesh_file_endings() {
  static const std::vector<std::string> endings = {".stl", ".step", ".stp",  ".obj", ".ply",
                                                   ".off", ".3mf",  ".gltf", ".glb"};
  return endings;
}

std::vector<NamedMesh> read_mesh_file(const fs::path& file, const MeshReadOptions& options) {
  options.check();
  check_is_file(file);
  const std::string ending = lower_case_ending(file);
  if (const char* kind = other_than_a_model(ending))
    throw Error("{}: is {}, not a model of a part; depth images and point clouds are scenes, models end with {}",
                file.string(), kind, fmt::join(mesh_file_endings(), ", "));
  if (!is_model_file(file))
    throw Error("{}: is no model file by its name; models end with {}", file.string(),
                fmt::join(mesh_file_endings(), ", "));
  std::vector<NamedMesh> parts;
  if (ending == ".step" || ending == ".stp")
    parts = read_step(file, options);
  else if (ending == ".ply")
    parts.push_back({"", read_ply_mesh(file), file, ""});
  else if (ending == ".off")
    parts.push_back({"", read_off(file), file, ""});
  else if (ending == ".stl")
    parts.push_back({"", read_stl(file), file, ""});
  else
    parts = read_with_assimp(file, options);
  give_names(parts, file);
  for (const auto& part : parts) check_usable(part);
  return parts;
}

std::string doubt_about_unit(const NamedMesh& part) {
  const double diagonal_mm = bounding_box_diagonal(part.mesh);
  const std::string guess = part.unit.empty() ? guess_unit(diagonal_mm) : "";
  if (guess.empty()) return {};
  return fmt::format("{}: is {:.4g} mm across; is it in {}? partpose inspect tells more, and converts it",
                     part.file.string(), diagonal_mm, guess == "inch" ? "inches or centimetres" : guess + "s");
}

std::string content_hash(const TriangleMesh& mesh) {
  const auto bytes_of = [](const auto& items) {
    return std::string_view(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(items[0]));
  };
  return content_hash(bytes_of(mesh.vertices)) + content_hash(bytes_of(mesh.triangles));
}

void check_names_differ(const std::vector<NamedMesh>& parts) {
  std::map<std::string, const NamedMesh*> known;
  for (const auto& part : parts)
    if (const auto [other, added] = known.emplace(part.name, &part); !added)
      throw Error("{}: another model is already named \"{}\": {}; rename or leave out one of the two",
                  part.file.string(), part.name, other->second->file.string());
}

std::vector<NamedMesh> read_meshes(const fs::path& file_or_folder, const MeshReadOptions& options) {
  return read_meshes(std::vector{file_or_folder}, options);
}

std::vector<NamedMesh> read_meshes(const std::vector<fs::path>& files_and_folders, const MeshReadOptions& options,
                                   const BrokenMeshFile& broken) {
  options.check();
  std::vector<fs::path> files;
  for (const auto& path : files_and_folders) {
    const auto found = model_files(path);
    files.insert(files.end(), found.begin(), found.end());
  }
  if (files.empty()) throw Error("no models given: at least one file or folder is needed");
  std::vector<NamedMesh> parts;
  for (const auto& file : files) {
    try {
      auto found = read_mesh_file(file, options);
      std::move(found.begin(), found.end(), std::back_inserter(parts));
    } catch (const Error& error) {
      if (!broken || files.size() == 1) throw;
      broken(file, error.what());
    }
  }
  if (parts.empty()) throw Error("none of the {} model files can be read", files.size());
  check_names_differ(parts);
  return parts;
}

}  // namespace partpose
