// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/engine/anchored_template.hpp"
#include "partpose/engine/depth_template.hpp"
#include "partpose/engine/surface_field.hpp"

#include <Eigen/Geometry>

#include <array>
#include <vector>

namespace partpose {

/// A part as it looks from one side.
struct PartView {
  static constexpr int visible_points = 64;

  /// Model frame to sight frame: origin in the centroid of what is visible, z along the line of sight through it.
  Eigen::Isometry3f sight_from_model = Eigen::Isometry3f::Identity();
  std::array<Eigen::Vector3f, visible_points> visible_mm;  ///< spread over what is visible, model frame
  float seen_mm2 = 0;                                      ///< what is visible covers, across the line of sight
};

struct PartMesh : TriangleMesh {
  Faces faces = Faces::both;  ///< front: they show the same, seen from around the part
};

/// All that the engine knows of a part, made from its mesh alone.
struct PartModel {
  explicit PartModel(const TriangleMesh& mesh);

  double diameter_mm = 0;
  Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();  ///< of the bounding box
  Eigen::AlignedBox3d box_mm;
  PartMesh outline;  ///< for a first look: few triangles, as near to the surface as `outline_share` of the diameter
  PartMesh surface;  ///< for the last: as near as `surface_share`
  TemplateScale scale;
  std::vector<PartView> views;
  std::vector<DepthTemplate> templates;        ///< of each view
  std::vector<SmallTemplate> small_templates;  ///< of each view
  std::vector<CellSet> small_surfaces;         ///< where these have a surface
  AnchoredViews anchored;
  SurfaceField field;
  std::vector<Eigen::Vector3f> samples_mm;  ///< spread evenly over the surface, model frame
  /// Turns (model_from_model) that put the part nearly back onto itself: where it may be mistaken for itself.
  std::vector<Eigen::Isometry3d> partners;
  /// The part is round about them but for a detail, which may be at any turn: model frame.
  struct Axis {
    Eigen::Vector3d direction, place_mm;

    Eigen::Isometry3d turn(double angle_rad) const;  ///< model_from_model
  };
  std::vector<Axis> nearly_round;
  /// Turns (model_from_model) that put the part back onto itself, the identity left out, and axes about which it is
  /// round: those about its box's and principal axes by multiples of 60 and 90 degrees, which cost nothing beside the
  /// partners. `find_symmetries` finds all, in several times the time that the rest of a model takes.
  std::vector<Eigen::Isometry3d> symmetries;
  std::vector<Axis> round;
  /// How it stays on a table by itself, up to a turn about the vertical: model frame, most probable first.
  struct Rest {
    Eigen::Vector3d down;     ///< unit direction to the table
    double origin_height_mm;  ///< of the model frame's origin above the table
  };
  std::vector<Rest> rests;

  static constexpr double outline_share = 0.006, surface_share = 0.001;

  /// Whether the part, moved so, is where it was, to within `tolerance_mm` everywhere.
  bool is_symmetry(const Eigen::Isometry3d& model_from_model, double tolerance_mm) const;

  /// Whether the part is at about the same place and turned about the same at both poses, up to its symmetries: by a
  /// twentieth of its diameter and 8 degrees.
  bool is_about_the_same(const Eigen::Isometry3d& camera_from_model, const Eigen::Isometry3d& other) const;

  /// The view whose line of sight is nearest to a direction, camera to part, model frame.
  int view_from(const Eigen::Vector3d& sight) const;

  /// The box of where its own box's corners are seen, in pixels; empty when all are behind the camera.
  Eigen::AlignedBox2d covered(const Intrinsics& camera, const Eigen::Isometry3d& camera_from_model) const;

  std::size_t memory_bytes() const;
};

}  // namespace partpose
