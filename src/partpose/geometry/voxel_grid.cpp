// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/voxel_grid.hpp"

#include "partpose/core/error.hpp"
#include "partpose/geometry/point_grid.hpp"

namespace partpose {

PointCloud voxel_grid(const PointCloud& cloud, float voxel_mm) {
  if (!(voxel_mm > 0)) throw Error("voxel size {} mm: must be positive", voxel_mm);
  std::vector<int> finite;
  std::vector<std::uint64_t> keys;
  finite.reserve(cloud.size());
  keys.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    finite.push_back(static_cast<int>(i));
    keys.push_back(cell_key(cloud.points[i], voxel_mm));
  }
  const auto order = order_by_key(keys);
  const bool normals = cloud.has_normals(), curvatures = cloud.has_curvatures();

  PointCloud out;
  for (std::size_t begin = 0; begin < order.size();) {
    const auto key = keys[order[begin]];
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float curvature = 0;
    std::size_t end = begin;
    for (; end < order.size() && keys[order[end]] == key; ++end) {
      const int i = finite[order[end]];
      point += cloud.points[i].cast<double>();
      if (normals) normal += cloud.normals[i];
      if (curvatures) curvature += cloud.curvatures[i];
    }
    const auto count = static_cast<double>(end - begin);
    out.points.push_back((point / count).cast<float>());
    if (normals) out.normals.push_back(normal.norm() > 0 ? normal.normalized() : normal);
    if (curvatures) out.curvatures.push_back(curvature / static_cast<float>(count));
    begin = end;
  }
  out.width = static_cast<int>(out.size());
  out.height = 1;
  return out;
}

}  // namespace partpose
