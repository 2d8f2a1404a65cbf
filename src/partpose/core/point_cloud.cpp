// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/point_cloud.hpp"

namespace partpose {

PointCloud select(const PointCloud& cloud, std::span<const int> indices) {
  PointCloud out;
  out.points.reserve(indices.size());
  for (const int i : indices) out.points.push_back(cloud.points[i]);
  if (cloud.has_normals()) {
    out.normals.reserve(indices.size());
    for (const int i : indices) out.normals.push_back(cloud.normals[i]);
  }
  if (cloud.has_curvatures()) {
    out.curvatures.reserve(indices.size());
    for (const int i : indices) out.curvatures.push_back(cloud.curvatures[i]);
  }
  out.width = static_cast<int>(indices.size());
  out.height = 1;
  return out;
}

PointCloud every_nth(const PointCloud& cloud, std::size_t step) {
  std::vector<int> indices;
  for (std::size_t i = 0; i < cloud.size(); i += step) indices.push_back(static_cast<int>(i));
  return select(cloud, indices);
}

PointCloud without_missing(const PointCloud& cloud) {
  std::vector<int> kept;
  kept.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.points[i].allFinite() && (!cloud.has_normals() || cloud.normals[i].allFinite()))
      kept.push_back(static_cast<int>(i));
  }
  return select(cloud, kept);
}

PointCloud before_camera(const PointCloud& cloud) {
  constexpr float tangent_of_89_deg = 57.3f;
  std::vector<int> kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto& p = cloud.points[i];
    if (p.allFinite() && p.z() > 0 && p.head<2>().norm() < tangent_of_89_deg * p.z()) kept.push_back(static_cast<int>(i));
  }
  return select(cloud, kept);
}

PointCloud transformed(const PointCloud& cloud, const Eigen::Isometry3d& target_from_cloud) {
  PointCloud out = cloud;
  const Eigen::Matrix3f rotation = target_from_cloud.linear().cast<float>();
  const Eigen::Vector3f translation = target_from_cloud.translation().cast<float>();
  for (auto& p : out.points) p = rotation * p + translation;
  for (auto& n : out.normals) n = rotation * n;
  return out;
}

Eigen::Vector3d centroid(const PointCloud& cloud) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : cloud.points) sum += p.cast<double>();
  return cloud.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(cloud.size()));
}

void append(PointCloud& cloud, const PointCloud& other) {
  if (other.empty()) return;
  const bool first = cloud.empty();
  const bool normals = other.has_normals() && (first || cloud.has_normals());
  const bool curvatures = other.has_curvatures() && (first || cloud.has_curvatures());
  cloud.points.insert(cloud.points.end(), other.points.begin(), other.points.end());
  if (normals) cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
  else cloud.normals.clear();
  if (curvatures) cloud.curvatures.insert(cloud.curvatures.end(), other.curvatures.begin(), other.curvatures.end());
  else cloud.curvatures.clear();
  cloud.width = static_cast<int>(cloud.size());
  cloud.height = 1;
}

}  // namespace partpose
