// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/core/progress.hpp"
#include "partpose/dataset/model_info.hpp"
#include "partpose/io/mesh_files.hpp"

#include <Eigen/Geometry>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace partpose {

struct IcosahedronOptions {
  double capture_distance_mm = 650;
  int subdivide = 1;
  bool use_vertices = true;
  double xyz_rotation_deg = 5;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("capture_distance_mm", self.capture_distance_mm, "distance of the cameras from the part's centre [mm], > 0");
    visit("subdivide", self.subdivide, "how often the icosahedron's faces are split in four, 0 to 4");
    visit("use_vertices", self.use_vertices,
          "cameras at the vertices (12, 42, 162 views) or at the face centres (20, 80, 320 views)");
    visit("xyz_rotation_deg", self.xyz_rotation_deg, "the icosahedron is turned by this about x, then y, then z [deg]");
  }
  void check() const;
};

/// Appendix C.1.1 of the reference.
struct DatasetPreparationConfig {
  std::string tag;
  VirtualDepthCameraOptions virtual_depth_camera;
  bool organized_output = false;
  IcosahedronOptions virtual_views_icosahedron;
  std::optional<std::string> symmetries;  ///< a path; relative ones in a file are relative to that file's folder
  std::optional<double> symmetry_tolerance_mm;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("tag", self.tag, "a note of yours");
    visit("virtual_depth_camera", self.virtual_depth_camera, "the camera that takes the views");
    visit("organized_output", self.organized_output, "views keep the image's rows and columns (larger files)");
    visit("virtual_views_icosahedron", self.virtual_views_icosahedron, "where the camera stands");
    visit("symmetries", self.symmetries,
          "a JSON like BOP's models_info.json, by the parts' names or ids: what it says of a part is not searched for");
    visit("symmetry_tolerance_mm", self.symmetry_tolerance_mm,
          "largest distance between a surface and its turned copy [mm], > 0; absent: by the part's size");
  }
  void check() const;
  bool organized() const { return virtual_depth_camera.organized_output.value_or(organized_output); }
};

/// Appendix C.1.2. Paths are relative to the file that lists them.
struct ModelList {
  std::vector<std::string> model_paths;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("model_paths", self.model_paths, "paths to the parts' model files");
  }
};

struct DatasetModel {
  Eigen::Isometry3d T1 = Eigen::Isometry3d::Identity();  ///< centred_from_model: the bounding box's centre to the origin
  int id = 0;
  std::string name;
  std::optional<std::string> mesh_hash;  ///< of mesh.stl when its views were rendered; none if another program did
  ModelSymmetries symmetries;            ///< model frame; empty in older datasets

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("T1", self.T1, "moves the bounding box's centre to the origin, 4x4 [mm]");
    visit("id", self.id, "names the folder under models/");
    visit("name", self.name, "the model file's name without its ending, or the part's own");
    visit("mesh_hash", self.mesh_hash, "tells whether mesh.stl changed since its views were rendered");
    ModelSymmetries::describe(self.symmetries, visit);
  }
  void check() const { symmetries.check(); }
};

struct DatasetView {
  Eigen::Isometry3d T2 = Eigen::Isometry3d::Identity();  ///< camera_from_centred
  int id = 0;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("T2", self.T2, "inverse of the camera's pose, 4x4 [mm]");
    visit("id", self.id, "names the file under views/");
  }
};

/// Appendix C.1.3, the dataset's dataset.json.
struct DatasetOut {
  DatasetPreparationConfig dataset_preparation_config;
  std::vector<DatasetModel> models;
  std::vector<DatasetView> views;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("dataset_preparation_config", self.dataset_preparation_config, "as it was given");
    visit("models", self.models, "the parts");
    visit("views", self.views, "the cameras");
  }
};

/// The camera poses of an icosahedron, as T2 (camera_from_centred), ids from 0.
std::vector<DatasetView> icosahedron_views(const IcosahedronOptions& options);

/// T1 of a mesh: moves its bounding box's centre to the origin.
Eigen::Isometry3d centred_from_model(const TriangleMesh& mesh);

/// The folder of appendix C.1.4.
struct Dataset {
  std::filesystem::path folder;
  DatasetOut out;

  std::filesystem::path model_folder(int model_id) const;
  std::filesystem::path mesh_path(int model_id) const;
  std::filesystem::path view_path(int model_id, int view_id) const;
  /// T2 * T1 of a view: camera_from_model.
  Eigen::Isometry3d camera_from_model(std::size_t model_index, std::size_t view_index) const;
};

/// Reads and checks dataset.json. Throws Error when the folder is not a complete dataset.
Dataset open_dataset(const std::filesystem::path& folder);

/// Finds the symmetries of all parts, renders their views and writes the folder: beside `folder` first, then renamed, so
/// that a half-written dataset is never seen. An older dataset at `folder` is replaced; anything else there is an Error.
/// Throws Error for no parts, for two of the same name, and for a file of symmetries that names none of them.
Dataset create_dataset(const DatasetPreparationConfig& config, const std::vector<NamedMesh>& parts,
                       const std::filesystem::path& folder, const Progress& progress = {});

/// The same of all parts of these files and folders; Error when one cannot be read.
Dataset create_dataset(const DatasetPreparationConfig& config, const std::vector<std::filesystem::path>& model_paths,
                       const std::filesystem::path& folder, const Progress& progress = {});

/// Renders the views of those models again whose mesh.stl changed since, and finds their symmetries again unless they
/// were given. Returns how many there were.
int refresh_dataset(Dataset& dataset, const Progress& progress = {});

/// The paths of a model list, made relative to the list's own folder.
std::vector<std::filesystem::path> read_model_list(const std::filesystem::path& path);

}  // namespace partpose
