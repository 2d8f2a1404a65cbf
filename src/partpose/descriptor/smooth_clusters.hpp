// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <vector>

namespace partpose {

/// What a smooth cluster is: these are among the options of CVFH and OUR-CVFH, which say what they mean.
struct SmoothClusterLimits {
  int min_points = 200;
  float cluster_tolerance_distance = 9;  ///< mm
  float eps_angle_threshold_deg = 20;
  float radius_normals = 9;  ///< mm
  float curvature_threshold = 0.03f;

  void check() const;
};

template <typename Options>
SmoothClusterLimits cluster_limits(const Options& options) {
  return {options.min_points, options.cluster_tolerance_distance, options.eps_angle_threshold_deg,
          options.radius_normals, options.curvature_threshold};
}

struct SmoothCluster {
  std::vector<int> members;  ///< into SmoothClusters::points, rising
  Eigen::Vector3f centre_mm = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< mean of the members', of unit length
};

struct SmoothClusters {
  PointCloud points;  ///< the smooth ones, with the normals that the clusters were found by
  std::vector<SmoothCluster> clusters;
};

/// The points and normals that are finite, sorted by x, then y, then z (then the normal): what is computed from them in
/// this order does not depend on the cloud's order. Without curvatures all of them are 0.
PointCloud sorted_by_position(const PointCloud& cloud);

/// The smooth regions of a cloud seen from the origin (Aldoma et al. 2011, section 3.1). Points of high curvature are
/// left out; the normals of the others are estimated anew from themselves. Points are neighbours when they are at most
/// the tolerance apart and their normals differ by less than the largest angle; a cluster is a set of points connected
/// by neighbours, with at least `min_points` of them. Points without a normal (fewer than three within the radius, or
/// all on a line) belong to none. The largest cluster comes first; of equally large ones that with the smaller z (then
/// y, then x) of the centre. Same bits for any order of the points when the cloud is sorted by position.
SmoothClusters smooth_clusters(const PointCloud& cloud, const SmoothClusterLimits& limits);

/// Sets centre and normal from the members.
void set_means(SmoothCluster& cluster, const PointCloud& points);

/// The cosine above which two directions differ by less than an angle: -2 for pi or more.
float cosine_limit(float angle_rad);

}  // namespace partpose
