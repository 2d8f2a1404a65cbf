// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace partpose {

/// Points sorted into cubic cells, coordinates apart (structure of arrays): all neighbours within one cell edge of a
/// point lie in at most nine runs of consecutive points, which loops can go through eight at a time.
class PointGrid {
 public:
  struct Range {
    int begin = 0;
    int end = 0;
  };

  /// Throws Error when `cell_mm` is not positive or a coordinate lies more than 2^20 cells from the origin.
  PointGrid(std::span<const Eigen::Vector3f> points_mm, float cell_mm);

  std::size_t cell_count() const { return cell_begin_.empty() ? 0 : cell_begin_.size() - 1; }
  /// The sorted positions of the points in cell `c`.
  Range cell(std::size_t c) const { return {cell_begin_[c], cell_begin_[c + 1]}; }
  /// The runs of sorted positions that hold cell `c` and its 26 neighbours; empty ones have begin == end.
  std::array<Range, 9> neighbourhood(std::size_t c) const;

  const std::vector<float>& x() const { return x_; }
  const std::vector<float>& y() const { return y_; }
  const std::vector<float>& z() const { return z_; }
  /// The index, in the points given, of the point at a sorted position.
  int original(int sorted) const { return original_[sorted]; }

 private:
  std::vector<std::uint64_t> cell_key_;
  std::vector<int> cell_begin_;
  std::vector<float> x_, y_, z_;
  std::vector<int> original_;
};

/// Cell coordinates in 21 bits each, x fastest. Throws Error when `point` is too far from the origin for `cell_mm`.
std::uint64_t cell_key(const Eigen::Vector3f& point_mm, float cell_mm);

/// Positions into `keys` sorted by key; of equal keys the earlier comes first.
std::vector<int> order_by_key(std::span<const std::uint64_t> keys);

}  // namespace partpose
