// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"

#include <Eigen/Geometry>

#include <vector>

namespace partpose {

struct RestingPoseOptions {
  double contact_tolerance = 1e-4;
  double least_stability_deg = 3;
  double merge_deg = 4;
  double level_tolerance = 0.01;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("contact_tolerance", self.contact_tolerance,
          "points this near the table touch it, as a share of the part's diagonal, 1e-6 to 0.1");
    visit("least_stability_deg", self.least_stability_deg,
          "a pose that a smaller tilt topples into a lower one is not kept [deg], 0 to 45");
    visit("merge_deg", self.merge_deg, "poses whose down directions differ by less are one pose [deg], 0 to 45");
    visit(
        "level_tolerance", self.level_tolerance,
        "poses roll into one another, not topple, when their centres of mass differ in height by less than this share, "
        "0 to 0.5");
  }
  void check() const;
};

/// A pose in which a part stays on a level table by itself, up to the turn about the vertical.
struct RestingPose {
  /// Table frame: z = 0 is the table, z up. The centre of mass is above the origin; the lowest point is at z = 0.
  Eigen::Isometry3d table_from_model = Eigen::Isometry3d::Identity();
  double probability = 0;       ///< that the part, dropped in any orientation, comes to rest like this
  double centre_height_mm = 0;  ///< of the centre of mass above the table
  double stability_deg = 0;     ///< the smallest tilt that topples it
  int group = 0;                ///< poses that roll into one another on the level have the same
  Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();  ///< unit direction in the model frame that points to the table
};

struct RestingPoses {
  std::vector<RestingPose> poses;  ///< most probable first; the probabilities sum to 1
  int groups = 0;
  Eigen::Vector3d centre_of_mass_mm = Eigen::Vector3d::Zero();  ///< model frame
  /// False: the mesh is open or its triangles face different ways, and the centre of mass is that of its convex hull.
  bool centre_of_mass_from_mesh = true;
};

/// The resting poses of a part of even density. The part falls without speed and without bouncing (Wiegley, Rao and
/// Goldberg 1992; Goldberg et al. 1999): it lands on the face of its convex hull under which the centre of mass hangs,
/// with a chance of the solid angle of the face as seen from there; when the centre of mass is not above the face, it
/// topples over the edge that the centre of mass is farthest beyond, until it rests. Then
///
/// - a face that rests, but within `least_stability_deg` of an edge, passes its chance on if what lies beyond that edge
///   leads to a pose that is lower by more than `level_tolerance`;
/// - poses with nearly the same down direction are merged into the most probable of them;
/// - neighbouring faces at the same height (the sides of a cylinder, all of a sphere) stay poses of their own, because
/// a
///   part need not be symmetric where its hull is (a shaft with a keyway), but are of one `group`.
///
/// An open, flat or inconsistent mesh has the centre of mass of its convex hull. Throws Error for a mesh without
/// vertices, with a coordinate that is not finite, or with all vertices on one line.
RestingPoses resting_poses(const TriangleMesh& mesh, const RestingPoseOptions& options = {});

}  // namespace partpose
