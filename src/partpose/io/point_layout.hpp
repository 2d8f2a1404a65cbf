// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace partpose {

/// What a format calls x, y, z, the normal's x, y, z and the curvature.
using PointNames = std::array<std::string_view, 7>;

/// The numbers that a file holds per point, in this order: x y z, then the normal when `normals`, then the curvature
/// when `curvatures`.
struct PointLayout {
  bool normals = false;
  bool curvatures = false;

  static PointLayout of(const PointCloud& cloud);

  /// The layout that a file with these columns (in any order, among others) has. Error, beginning with `place`, when x,
  /// y or z is missing, a normal is incomplete or one of the names is there twice.
  static PointLayout of(std::span<const std::string_view> columns, const PointNames& names, std::string_view place);

  /// Names of the numbers, in order.
  std::vector<std::string_view> columns(const PointNames& names) const;

  /// Appends a point of these numbers.
  void append(PointCloud& cloud, std::span<const float> numbers) const;

  /// All points' numbers, one point after the other.
  std::vector<float> rows(const PointCloud& cloud) const;
};

}  // namespace partpose
