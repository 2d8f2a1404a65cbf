// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/assimp_meshes.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/text.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/isolated_reader.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/zip.hpp"

#ifdef PARTPOSE_HAS_ASSIMP
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>
#endif

#include <map>
#include <set>

namespace partpose {

namespace fs = std::filesystem;

#ifndef PARTPOSE_HAS_ASSIMP

bool reads_assimp_formats() { return false; }

std::vector<NamedMesh> read_with_assimp(const fs::path& path, const MeshReadOptions&) {
  throw Error("{}: this build of partpose reads no {} (PARTPOSE_WITH_ASSIMP: Assimp was not found); export it as STL",
              path.string(), path.extension().string());
}

#else

bool reads_assimp_formats() { return true; }

namespace {

struct Unit {
  std::string name;  ///< as the file states it
  double mm = 1;
};

/// The unit attribute of the model element, "millimeter" when it has none (3MF Core Specification 1.3, 3.4).
Unit unit_of_3mf(const fs::path& path) {
  static const std::map<std::string, double> units = {{"micron", 1e-3}, {"millimeter", 1}, {"centimeter", 10},
                                                      {"inch", 25.4},   {"foot", 304.8},   {"meter", 1000}};
  constexpr std::size_t enough_bytes = 1 << 16;
  const std::string xml = zip_entry(read_file(path), ".model", enough_bytes, path.string());
  const auto element = xml.find("<model");
  if (element == std::string::npos) throw Error("{}: its 3D model has no element <model>", path.string());
  const std::string tag = xml.substr(element, xml.find('>', element) - element);
  const auto key = tag.find(" unit");
  if (key == std::string::npos) return {"millimeter", 1};
  const auto open = tag.find_first_of("\"'", key);
  const auto close = open == std::string::npos ? open : tag.find(tag[open], open + 1);
  if (close == std::string::npos) throw Error("{}: the unit of its <model> is cut off", path.string());
  const std::string name = tag.substr(open + 1, close - open - 1);
  const auto unit = units.find(name);
  if (unit == units.end()) {
    std::vector<std::string> known;
    for (const auto& [word, mm] : units) known.push_back(word);
    throw Error("{}: unknown unit \"{}\"; did you mean \"{}\"?", path.string(), name, nearest_word(name, known));
  }
  return {name, unit->second};
}

/// Adds a node's own triangles, in the scene's frame.
void add_node(TriangleMesh& mesh, const aiScene& scene, const aiNode& node, const aiMatrix4x4& scene_from_node,
              double mm, const fs::path& path) {
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& piece = *scene.mMeshes[node.mMeshes[m]];
    const int first = static_cast<int>(mesh.vertices.size());
    for (unsigned v = 0; v < piece.mNumVertices; ++v) {
      const aiVector3D p = scene_from_node * piece.mVertices[v];
      mesh.vertices.push_back((mm * Eigen::Vector3d(p.x, p.y, p.z)).cast<float>());
    }
    const bool mirrored = scene_from_node.Determinant() < 0;
    for (unsigned f = 0; f < piece.mNumFaces; ++f) {
      const aiFace& face = piece.mFaces[f];
      if (face.mNumIndices != 3) continue;  // a point or a line
      std::array<int, 3> triangle;
      for (int k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= piece.mNumVertices)
          throw Error("{}: a face has vertex {}, there are {}", path.string(), face.mIndices[k], piece.mNumVertices);
        triangle[mirrored ? 2 - k : k] = first + static_cast<int>(face.mIndices[k]);
      }
      mesh.triangles.push_back(triangle);
    }
  }
}

void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& scene_from_parent, const Unit& unit,
             bool split, std::set<std::vector<unsigned> >& known, std::vector<NamedMesh>& parts, const fs::path& path) {
  const aiMatrix4x4 scene_from_node = scene_from_parent * node.mTransformation;
  const std::vector<unsigned> meshes(node.mMeshes, node.mMeshes + node.mNumMeshes);
  if (!meshes.empty() && (!split || known.insert(meshes).second)) {
    if (split || parts.empty()) parts.push_back({node.mName.C_Str(), {}, path, unit.name});
    add_node(parts.back().mesh, scene, node, scene_from_node, unit.mm, path);
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c)
    collect(scene, *node.mChildren[c], scene_from_node, unit, split, known, parts, path);
}

std::vector<NamedMesh> read_here(const fs::path& path, const MeshReadOptions& options) {
  read_file(path);  // says what is wrong with the file itself
  const std::string ending = lower_case_ending(path);
  const bool is_gltf = ending == ".gltf" || ending == ".glb", is_3mf = ending == ".3mf";
  const Unit unit = is_gltf ? Unit{"metre", 1000} : is_3mf ? unit_of_3mf(path) : Unit{};

  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_ValidateDataStructure);
  if (!scene || !scene->mRootNode || scene->mNumMeshes == 0) {
    const std::string why = importer.GetErrorString();
    if (why.find("bad_alloc") != std::string::npos)
      throw Error("{}: is not readable as {}: it asks for far more memory than a file of its size needs", path.string(),
                  ending.substr(1));
    throw Error("{}: is not readable as {}: {}", path.string(), ending.substr(1),
                why.empty() ? "it has no triangles" : why);
  }
  std::vector<NamedMesh> parts;
  std::set<std::vector<unsigned> > known;
  collect(*scene, *scene->mRootNode, aiMatrix4x4(), unit, (is_gltf || is_3mf) && options.split != "whole", known, parts,
          path);
  std::erase_if(parts, [](const NamedMesh& part) { return part.mesh.triangles.empty(); });
  if (parts.empty()) throw Error("{}: has no triangles", path.string());
  for (auto& part : parts) part.mesh = with_merged_vertices(part.mesh);
  return parts;
}

}  // namespace

std::vector<NamedMesh> read_with_assimp(const fs::path& path, const MeshReadOptions& options) {
  options.check();
  return read_isolated(path, "Assimp", [&] { return read_here(path, options); });
}

#endif

}  // namespace partpose
