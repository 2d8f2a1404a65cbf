// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace partpose {

/// Distance to the nearest of a set of points, tabulated over their bounding box and a margin: a look-up instead of a
/// search, right to about half a cell.
class DistanceGrid {
 public:
  /// Cells are cubes, about `cells_along_longest` of them along the box's longest side with its margin.
  DistanceGrid(std::span<const Eigen::Vector3f> points_mm, float margin_mm, int cells_along_longest = 48);

  /// In mm, at the cell of `p`; outside the grid the distance to the grid is added.
  float at(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f cell = (p - origin_) * per_mm_;
    const Eigen::Vector3f inside = cell.cwiseMax(0.f).cwiseMin(last_);
    const Eigen::Vector3i i = inside.cast<int>();
    return distance_mm_[(static_cast<std::size_t>(i.z()) * size_.y() + i.y()) * size_.x() + i.x()] +
           (cell - inside).norm() / per_mm_;
  }
  float cell_mm() const { return 1 / per_mm_; }

 private:
  Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f last_ = Eigen::Vector3f::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Ones();
  float per_mm_ = 1;
  std::vector<float> distance_mm_;
};

}  // namespace partpose
