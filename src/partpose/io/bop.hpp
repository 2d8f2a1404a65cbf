// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/geometry/symmetries.hpp"

#include <Eigen/Geometry>

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Datasets and results in the formats of the BOP benchmark (Hodan et al. 2018 and 2020; bop_toolkit,
/// docs/bop_datasets_format.md). Lengths in mm; poses map model to camera (x right, y down, z forward). A dataset is
///
///     DATASET/camera.json, test_targets_bop19.json
///     DATASET/models/models_info.json, obj_000001.ply, ...       (and models_eval/, the meshes that errors are taken
///     of) DATASET/SPLIT/000001/scene_camera.json, scene_gt.json, scene_gt_info.json, depth/000000.png, ...
///
/// Keys that are not known are ignored: datasets bring keys of their own. What is missing or damaged is an Error naming
/// file and key. Poses keep the numbers of their files: rotations may be rounded, so `linear()` need not be orthonormal
/// to the last digit, and `inverse()` of an Isometry3d (which transposes) is to be used with care.
namespace partpose {

/// An object's entry of models_info.json.
struct BopModelInfo {
  double diameter_mm = 0;  ///< largest distance of two vertices
  Eigen::AlignedBox3d box_mm;
  Symmetries symmetries;
};

/// An image's entry of scene_camera.json.
struct BopCamera {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();  ///< px; pixel centres at integers
  double depth_scale_mm = 1;                        ///< mm for each unit of the depth image
  std::optional<Eigen::Isometry3d> camera_from_world;

  static BopCamera of(const Intrinsics& intrinsics, double depth_scale_mm = 1);
  /// Throws Error when K has skew or is no camera matrix.
  Intrinsics intrinsics(int width, int height) const;
};

/// A ground truth's entry of scene_gt_info.json. Boxes are x, y, width, height in px.
struct BopVisibility {
  std::array<int, 4> bbox_obj = {-1, -1, -1, -1};    ///< of the silhouette, which may reach beyond the image
  std::array<int, 4> bbox_visib = {-1, -1, -1, -1};  ///< of its visible part
  int px_count_all = 0;                              ///< of the silhouette
  int px_count_valid = 0;                            ///< where the depth image has a value
  int px_count_visib = 0;                            ///< of the visible part
  double visib_fract = 1;                            ///< px_count_visib / px_count_all
};

/// An instance in an image: an entry of scene_gt.json, and of scene_gt_info.json if there.
struct BopGroundTruth {
  int obj_id = 0;
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  std::optional<BopVisibility> visibility;
};

struct BopImage {
  int id = 0;
  BopCamera camera;
  std::vector<BopGroundTruth> ground_truths;  ///< the position is the ground truth's id
};

struct BopScene {
  int id = 0;
  std::filesystem::path folder;
  bool has_ground_truth = true;  ///< false: there is no scene_gt.json, as in test sets whose truth is kept secret
  std::vector<BopImage> images;  ///< by rising id

  /// Throws Error when there is no such image.
  const BopImage& image(int im_id) const;
  std::filesystem::path depth_path(const BopImage& image) const;
  DepthImage read_depth(const BopImage& image) const;
};

/// An entry of test_targets_bop19.json: find `inst_count` instances of an object in an image.
struct BopTarget {
  int scene_id = 0;
  int im_id = 0;
  int obj_id = 0;
  int inst_count = 1;
};

/// camera.json: the camera that the dataset is meant for. Images may have cameras of their own.
struct BopDatasetCamera {
  Intrinsics intrinsics;
  double depth_scale_mm = 1;
};

struct BopDataset {
  std::filesystem::path folder;
  std::string split;
  std::optional<BopDatasetCamera> camera;
  std::filesystem::path models_folder;  ///< models_eval/ if there, or else models/
  std::map<int, BopModelInfo> models;   ///< by obj_id
  std::map<int, BopScene> scenes;       ///< by scene_id; depth images are read on demand
  std::vector<BopTarget> targets;       ///< as in the file; without one: all ground truths

  TriangleMesh read_model(int obj_id) const;
  /// Throws Error when there is no such scene.
  const BopScene& scene(int scene_id) const;
};

/// Throws Error when the folder has no models_info.json or no scene with scene_camera.json, when anything is damaged,
/// and when a target or a ground truth names an object, scene or image that is not there.
BopDataset read_bop_dataset(const std::filesystem::path& folder, const std::string& split = "test");

/// `DATASET/SPLIT/000001`.
std::filesystem::path bop_scene_folder(const std::filesystem::path& dataset, const std::string& split, int scene_id);
/// `obj_000001.ply`.
std::string bop_model_name(int obj_id);

/// Diameter and box of a mesh.
BopModelInfo bop_model_info(const TriangleMesh& mesh, Symmetries symmetries = {});

std::map<int, BopModelInfo> read_bop_models_info(const std::filesystem::path& file);
/// Reads scene_camera.json, and scene_gt.json and scene_gt_info.json if there.
BopScene read_bop_scene(const std::filesystem::path& scene_folder, int scene_id);
std::vector<BopTarget> read_bop_targets(const std::filesystem::path& file);

// Writers. Each file is written beside and renamed; folders are made as needed. Errors when a file cannot be written.

/// `models_folder/obj_000001.ply`, ASCII with vertex normals. The infos are for write_bop_models_info.
void write_bop_model(const std::filesystem::path& models_folder, int obj_id, const TriangleMesh& mesh);
void write_bop_models_info(const std::filesystem::path& models_folder, const std::map<int, BopModelInfo>& models);
/// `DATASET/camera.json`.
void write_bop_camera(const std::filesystem::path& dataset, const BopDatasetCamera& camera);
/// `scene_folder/depth/000000.png`.
void write_bop_depth(const std::filesystem::path& scene_folder, int im_id, const DepthImage& depth,
                     double depth_scale_mm);
/// scene_camera.json, and scene_gt.json if `has_ground_truth`, and scene_gt_info.json if all ground truths have a
/// visibility, into the scene's folder. No depth images.
void write_bop_scene(const BopScene& scene);
/// `DATASET/test_targets_bop19.json`.
void write_bop_targets(const std::filesystem::path& dataset, std::span<const BopTarget> targets);
/// A target for each object in each image that is at least `min_visib_fract` visible (of unknown visibility: always).
std::vector<BopTarget> bop_targets_of(std::span<const BopScene> scenes, double min_visib_fract = 0.1);

/// A row of a results file.
struct BopEstimate {
  int scene_id = 0;
  int im_id = 0;
  int obj_id = 0;
  double score = 0;  ///< higher: more certain
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  double time_s = -1;  ///< for the whole image, equal in all its rows; -1: not known
};

/// `scene_id,im_id,obj_id,score,R,t,time`, R row by row. Error, naming the line, when a row is damaged, a rotation is
/// none, or the times of an image differ by more than 1 ms.
std::vector<BopEstimate> read_bop_results(const std::filesystem::path& file);
/// Error as for read_bop_results.
void write_bop_results(const std::filesystem::path& file, std::span<const BopEstimate> estimates);

}  // namespace partpose
