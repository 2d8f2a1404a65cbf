// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/stereo_sensor.hpp"
#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/geometry/resting_poses.hpp"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace partpose {

/// Where the camera of a scene stands. The defaults resemble an Intel RealSense D415 at 640x480 above a work table.
/// Ranges are {smallest, largest}; each frame draws evenly from them.
struct SceneCameraOptions {
  Intrinsics intrinsics{640, 480, 615, 615, 319.5, 239.5};
  std::array<double, 2> distance_mm = {500, 800};
  std::array<double, 2> elevation_deg = {30, 90};
  std::array<double, 2> roll_deg = {-10, 10};
  double aim_radius_mm = 30;
  double farthest_mm = 6000;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("width", self.intrinsics.width, "image width [px]");
    visit("height", self.intrinsics.height, "image height [px]");
    visit("fx", self.intrinsics.fx, "focal length in x [px]");
    visit("fy", self.intrinsics.fy, "focal length in y [px]");
    visit("cx", self.intrinsics.cx, "principal point in x [px], pixel centres at integers");
    visit("cy", self.intrinsics.cy, "principal point in y [px], pixel centres at integers");
    visit("distance_mm", self.distance_mm, "range of the distance to the point that the camera aims at [mm]");
    visit("elevation_deg", self.elevation_deg, "range of the camera's elevation above the table, 5 to 90 [deg]");
    visit("roll_deg", self.roll_deg, "range of the turn about the line of sight [deg]");
    visit("aim_radius_mm", self.aim_radius_mm, "the camera aims at a point this near the table's centre [mm], >= 0");
    visit("farthest_mm", self.farthest_mm, "what is farther gives no depth [mm], up to 65000");
  }
  void check() const;
};

/// What is on the table. Ranges are {smallest, largest}, both included.
struct SceneOptions {
  SceneCameraOptions camera;
  std::array<int, 2> parts = {1, 1};
  std::array<int, 2> unknown_parts = {0, 0};
  std::array<int, 2> clutter = {0, 0};
  std::array<double, 2> clutter_size_mm = {20, 100};
  std::string poses = "natural";
  double least_visible_fraction = 0.3;
  std::array<double, 2> hidden_fraction = {0, 0};
  double place_radius_mm = 120;
  double gap_mm = 3;
  std::string contact = "apart";
  std::array<double, 2> table_size_mm = {1000, 700};
  double floor_below_mm = 720;
  RestingPoseOptions resting_poses;
  std::uint64_t seed = 1;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("camera", self.camera, "the camera and where it stands");
    visit("parts", self.parts, "range of the number of catalogue parts in a frame");
    visit("unknown_parts", self.unknown_parts, "range of the number of parts that are not in the catalogue");
    visit("clutter", self.clutter, "range of the number of boxes and cylinders");
    visit("clutter_size_mm", self.clutter_size_mm, "range of their edge lengths, diameters and heights [mm]");
    visit("poses", self.poses,
          "\"natural\": as often as the part comes to rest so; \"uniform\": each group of resting poses equally often");
    visit("least_visible_fraction", self.least_visible_fraction,
          "at least this share of each part, catalogue or not, is seen, 0 to 1");
    visit("hidden_fraction", self.hidden_fraction,
          "range of the share of the first part that is hidden by intention, 0 to 1; [0, 0]: nothing is put before it");
    visit("place_radius_mm", self.place_radius_mm,
          "things lie this near the table's centre [mm], > 0; farther only where they find no room");
    visit("gap_mm", self.gap_mm, "least distance between things that lie apart, seen from above [mm], >= 0");
    visit("contact", self.contact,
          "\"apart\", or \"touching\": each thing but the first is slid along the table until it touches another");
    visit("table_size_mm", self.table_size_mm, "length and width of the table [mm], > 0");
    visit("floor_below_mm", self.floor_below_mm, "the floor is this far below the table's top [mm]; 0: there is none");
    visit("resting_poses", self.resting_poses, "how resting poses are found");
    visit("seed", self.seed, "the same seed gives the same frames");
  }
  void check() const;
};

struct ScenePart {
  std::string name;
  TriangleMesh mesh;  ///< mm, model frame
};

/// Anything in a scene.
struct ScenePiece {
  enum class Kind { part, unknown_part, clutter, occluder, table, floor };
  Kind kind = Kind::clutter;
  int index = -1;  ///< of the part in the catalogue, or among the unknown parts; -1 for anything else
  std::string name;
  std::shared_ptr<const TriangleMesh> mesh;
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  int resting_pose = -1;  ///< which of the part's resting poses; -1 for anything else

  // Parts alone; the silhouette may reach beyond the image, as far as one image's size on either side.
  int silhouette_px = 0;
  int visible_px = 0;
  std::array<int, 4> silhouette_box = {-1, -1, -1, -1};  ///< x, y, width, height [px]
  std::array<int, 4> visible_box = {-1, -1, -1, -1};     ///< the same of what is visible
  double visible_fraction() const { return silhouette_px > 0 ? double(visible_px) / silhouette_px : 0; }
  bool in_catalogue() const { return kind == Kind::part; }
};

/// A frame and the truth about it.
struct SyntheticScene {
  std::uint64_t frame = 0;
  Intrinsics intrinsics;
  Eigen::Isometry3d camera_from_table = Eigen::Isometry3d::Identity();  ///< table frame: z = 0 its top, z up
  std::vector<ScenePiece> pieces;                                       ///< catalogue parts first
  DepthImage depth;                                                     ///< without noise; 0 where nothing is seen
  std::vector<int> piece_at;  ///< index of the piece seen at each pixel, row by row; -1: none
  double farthest_mm = 0;     ///< what is farther gives no depth
};

/// The depth of a scene's pieces for another camera beside its own, without noise: the second imager of a stereo
/// camera.
DepthImage render_scene(const SyntheticScene& scene, const Eigen::Isometry3d& other_from_camera,
                        const Intrinsics& intrinsics);

/// What a sensor measures of a scene. `seed` selects the noise.
using SceneSensor = std::function<DepthImage(const SyntheticScene& scene, std::uint64_t seed)>;

/// The depth without noise.
SceneSensor ideal_sensor();
/// Independent normally distributed noise along the line of sight. Throws Error unless the deviation is >= 0.
SceneSensor gaussian_ray_sensor(double standard_deviation_mm);
/// A stereo camera whose left imager the scene's camera is: the pieces are drawn once more for the right one.
SceneSensor stereo_scene_sensor(const StereoSensorOptions& options);

/// Draws frames of parts that rest on a table. Frame i depends on the options, the parts and i alone: frames may be
/// drawn in any order and by several threads at once.
///
/// The first catalogue part of frame i is part i modulo their number, the others are drawn without repetition as long
/// as they last. Each lies in one of its resting poses, turned and placed at random. Nothing interpenetrates: the
/// outlines of all things, seen from above, are apart; or, with `contact` "touching", each thing after the first comes
/// from outside, straight along the table, and stops where it meets another. Things that touch lie as they would alone:
/// none leans on another. From an oblique camera the near ones then hide some of the far ones. With `hidden_fraction` a
/// plate stands before the first part, or is held over it where the camera looks down steeply, so that just a share
/// drawn from that range is hidden.
class SceneGenerator {
 public:
  /// Finds the resting poses of all parts. Throws Error, naming the part, for meshes without resting poses, and for
  /// options that cannot be met (no parts, but a number above 0 asked for).
  SceneGenerator(std::vector<ScenePart> catalogue, std::vector<ScenePart> unknown, const SceneOptions& options);
  ~SceneGenerator();
  SceneGenerator(SceneGenerator&&) noexcept;

  /// Throws Error when no arrangement in 200 meets the options: parts too many, too large or too far from the camera.
  SyntheticScene generate(std::uint64_t frame) const;

  const SceneOptions& options() const;
  const std::vector<std::string>& names() const;  ///< of the catalogue parts
  const TriangleMesh& mesh(int catalogue_index) const;
  const RestingPoses& resting_poses(int catalogue_index) const;
  const std::vector<std::string>& unknown_names() const;
  const TriangleMesh& unknown_mesh(int unknown_index) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace partpose
