// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/point_layout.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>

namespace partpose {

PointLayout PointLayout::of(const PointCloud& cloud) { return {cloud.has_normals(), cloud.has_curvatures()}; }

PointLayout PointLayout::of(std::span<const std::string_view> columns, const PointNames& names,
                            std::string_view place) {
  std::array<bool, 7> found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto count = std::ranges::count(columns, names[i]);
    if (count > 1) throw Error("{}: {} is there {} times", place, names[i], count);
    found[i] = count == 1;
  }
  if (!(found[0] && found[1] && found[2]))
    throw Error("{}: a point cloud needs {}, {} and {}", place, names[0], names[1], names[2]);
  if (found[3] != found[4] || found[4] != found[5])
    throw Error("{}: a normal needs {}, {} and {}", place, names[3], names[4], names[5]);
  return {found[3], found[6]};
}

std::vector<std::string_view> PointLayout::columns(const PointNames& names) const {
  std::vector<std::string_view> columns(names.begin(), names.begin() + 3);
  if (normals) columns.insert(columns.end(), names.begin() + 3, names.begin() + 6);
  if (curvatures) columns.push_back(names[6]);
  return columns;
}

void PointLayout::append(PointCloud& cloud, std::span<const float> numbers) const {
  cloud.points.emplace_back(numbers[0], numbers[1], numbers[2]);
  if (normals) cloud.normals.emplace_back(numbers[3], numbers[4], numbers[5]);
  if (curvatures) cloud.curvatures.push_back(numbers.back());
}

std::vector<float> PointLayout::rows(const PointCloud& cloud) const {
  std::vector<float> rows;
  rows.reserve(cloud.size() * 7);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    rows.insert(rows.end(), cloud.points[i].begin(), cloud.points[i].end());
    if (normals) rows.insert(rows.end(), cloud.normals[i].begin(), cloud.normals[i].end());
    if (curvatures) rows.push_back(cloud.curvatures[i]);
  }
  return rows;
}

}  // namespace partpose
