// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"
#include "partpose/geometry/kd_tree.hpp"

#include <Eigen/Geometry>

namespace partpose {

struct PoseRefinementOptions {
  bool voxelize_scene = true;
  bool voxelize_view = true;
  float voxel_size = 3;
  bool enforce_same_direction_normals = true;
  float euclidean_fitness_epsilon = 0.1f;
  float max_correspondence_distance = 1500;
  int max_iterations = 150;
  float transformation_epsilon = 0.1f;
  bool use_symmetric_objective = true;
  float correspondence_gate_factor = 3;
  bool two_sided_fitness = true;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("voxelize_scene", self.voxelize_scene, "thin out the scene before the refinement");
    visit("voxelize_view", self.voxelize_view, "thin out the candidates' views before the refinement");
    visit("voxel_size", self.voxel_size, "edge of a voxel for both [mm], > 0");
    visit("enforce_same_direction_normals", self.enforce_same_direction_normals,
          "pairs whose normals are more than 90 degrees apart do not count");
    visit("euclidean_fitness_epsilon", self.euclidean_fitness_epsilon,
          "converged when an iteration changes the mean squared distance of the pairs by less [mm^2] and "
          "transformation_epsilon holds too");
    visit("max_correspondence_distance", self.max_correspondence_distance,
          "pairs farther apart do not count [mm], > 0");
    visit("max_iterations", self.max_iterations, "gives up after so many iterations, >= 1");
    visit("transformation_epsilon", self.transformation_epsilon,
          "converged when an iteration moves no point by more [mm] and euclidean_fitness_epsilon holds too");
    visit("use_symmetric_objective", self.use_symmetric_objective,
          "symmetric objective (Rusinkiewicz 2019) instead of point-to-plane");
    visit("correspondence_gate_factor", self.correspondence_gate_factor,
          "pairs farther apart than so many times the median distance do not count; 0: no such gate");
    visit("two_sided_fitness", self.two_sided_fitness,
          "icp_fitness is the mean of both directions, view to scene and scene to view; otherwise the first alone");
  }
  void check() const;
};

struct IcpResult {
  Eigen::Isometry3d target_from_source = Eigen::Isometry3d::Identity();
  bool converged = false;
  int iterations = 0;
  int pairs = 0;  ///< in the last iteration
};

/// Registers `source` to `target`, both with normals, starting from where the source lies. Each iteration solves the
/// linearised objective in double precision about the centre of the pairs: rotation about the part, not the camera.
/// Point-to-plane (Chen and Medioni 1992) or the symmetric objective (Rusinkiewicz 2019, eq. 9 and 11). Directions that the
/// pairs leave free (the turn of a cylinder) are not moved. Gives up when the pairs come no nearer for ten iterations. Fewer than six pairs: not converged, stops.
IcpResult icp(const PointCloud& source, const PointCloud& target, const KdTree& target_tree,
              const PoseRefinementOptions& options);

/// Mean distance in mm from each point to the nearest point of the tree; 0 for an empty cloud.
double mean_nearest_distance_mm(const PointCloud& cloud, const Eigen::Isometry3d& tree_from_cloud, const KdTree& tree);

}  // namespace partpose
