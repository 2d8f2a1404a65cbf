// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace partpose {

/// Points in millimetres, optionally with unit normals and curvatures.
/// `normals` and `curvatures` are either empty or as long as `points`. An organized cloud has `width * height == size()`
/// with `height > 1`, row by row as in the depth image; its missing points are NaN. Unorganized: `height == 1`, or both 0.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<float> curvatures;
  int width = 0;
  int height = 0;

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
  bool has_normals() const { return !points.empty() && normals.size() == points.size(); }
  bool has_curvatures() const { return !points.empty() && curvatures.size() == points.size(); }
  bool is_organized() const {
    return height > 1 && static_cast<std::size_t>(width) * static_cast<std::size_t>(height) == points.size();
  }
};

/// The points at `indices`, in that order, with their normals and curvatures; the result is unorganized.
PointCloud select(const PointCloud& cloud, std::span<const int> indices);

/// Points 0, step, 2 step, ...: an even thinning of a cloud whose order follows space, as a voxel grid's does.
PointCloud every_nth(const PointCloud& cloud, std::size_t step);

/// Without points (or normals) that are not finite; the result is unorganized.
PointCloud without_missing(const PointCloud& cloud);

/// The finite points that a camera at the origin can see: z > 0, and no more than 89 degrees off its axis.
PointCloud before_camera(const PointCloud& cloud);

/// Points and normals moved by a rigid transformation.
PointCloud transformed(const PointCloud& cloud, const Eigen::Isometry3d& target_from_cloud);

/// The mean of the points, in mm. Zero for an empty cloud.
Eigen::Vector3d centroid(const PointCloud& cloud);

/// The points of `other` behind those of `cloud`. Normals (curvatures) are kept only when both clouds have them.
void append(PointCloud& cloud, const PointCloud& other);

}  // namespace partpose
