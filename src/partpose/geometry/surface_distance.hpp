// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <limits>
#include <span>
#include <vector>

namespace partpose {

/// The nearest place on a mesh's triangles, exact, by a tree of boxes. The mesh is copied; queries are thread-safe.
class SurfaceDistance {
 public:
  struct Nearest {
    double distance_mm = std::numeric_limits<double>::infinity();
    Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();  ///< on the surface
    int triangle = -1;                                   ///< of the mesh given; -1: nothing within the limit
  };

  /// Throws Error when the mesh has no triangle.
  explicit SurfaceDistance(const TriangleMesh& mesh);

  /// The nearest place nearer than `limit_mm`. The search ends at the first place found within `enough_mm`: for those
  /// who only ask whether the surface is as near as that.
  Nearest nearest(const Eigen::Vector3d& query_mm, double limit_mm = std::numeric_limits<double>::infinity(),
                  double enough_mm = 0) const;

  /// Unit normal of a triangle by its winding; zero for a degenerate one.
  Eigen::Vector3d normal(int triangle) const { return mesh_.face_normal(triangle).cast<double>(); }

 private:
  struct Node {
    Eigen::AlignedBox3f box;
    int begin = 0, end = 0;  ///< into order_
    int right = -1;          ///< the second child, the first follows its parent; -1: a leaf
  };
  static constexpr int deepest = 96;  ///< levels: below half of them triangles are simply halved
  int build(int begin, int end, const std::vector<Eigen::AlignedBox3f>& boxes, int level);
  int cheapest_split(int begin, int end, const std::vector<Eigen::AlignedBox3f>& boxes);

  TriangleMesh mesh_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

/// Points spread evenly over a mesh's surface: each stands for the same area, and their places within the triangles
/// follow a low-discrepancy sequence. Always the same for the same mesh. Empty for a mesh without area.
std::vector<Eigen::Vector3d> even_surface_samples(const TriangleMesh& mesh, int count);

/// The rigid motion near `start` that puts points onto a surface: Gauss-Newton on the distances, those far beyond
/// `scale_mm` without influence (Geman and McClure 1987, the scale lowered to `scale_mm` from iteration to iteration;
/// Zhou et al. 2016). What the surface leaves free stays as it is. `turn_centre_mm`: what small turns are taken about,
/// best in the middle of the points.
Eigen::Isometry3d align_to_surface(std::span<const Eigen::Vector3d> points_mm, const SurfaceDistance& surface,
                                   const Eigen::Isometry3d& start, double scale_mm,
                                   const Eigen::Vector3d& turn_centre_mm, int max_iterations = 20);

}  // namespace partpose
