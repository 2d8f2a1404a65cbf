// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// Sums over points that are the same to the bit whatever the order of the points.
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace partpose {

/// Sum of value(0) to value(count - 1), each at most `largest` in magnitude and rounded to a 2^40th of it: the sum of
/// the rounded values is exact, so neither the order nor a doubling of all values changes their mean.
template <typename Value>
double order_free_sum(std::size_t count, double largest, const Value& value) {
  const int bits = std::min(40, 62 - static_cast<int>(std::bit_width(count)));
  int exponent = 0;
  std::frexp(largest, &exponent);
  const double scale = std::ldexp(1.0, bits - exponent);
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += std::llrint(value(i) * scale);
  return std::ldexp(static_cast<double>(sum), exponent - bits);
}

inline std::vector<Eigen::Vector3f> finite_points(const PointCloud& cloud) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(cloud.size());
  for (const auto& p : cloud.points)
    if (p.allFinite()) points.push_back(p);
  return points;
}

/// The mean of finite points, in mm. Zero without points.
inline Eigen::Vector3d order_free_centroid(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  if (points.empty()) return mean;
  float largest = 0;
  for (const auto& p : points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  for (int axis = 0; axis < 3; ++axis)
    mean[axis] = order_free_sum(points.size(), largest, [&](std::size_t i) { return points[i][axis]; }) /
                 static_cast<double>(points.size());
  return mean;
}

}  // namespace partpose
