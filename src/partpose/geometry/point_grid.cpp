// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/point_grid.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace partpose {

namespace {
constexpr std::uint64_t bits = 21;
constexpr double half_range = 1 << (bits - 1);
}  // namespace

std::uint64_t cell_key(const Eigen::Vector3f& point_mm, float cell_mm) {
  std::uint64_t key = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const double cell = std::floor(static_cast<double>(point_mm[axis]) / cell_mm) + half_range;
    // One cell of margin at both ends, so that a neighbour's key never borrows from the next axis.
    if (!(cell >= 1 && cell < 2 * half_range - 1))
      throw Error("coordinate {} mm is too far from the origin for cells of {} mm (or not finite)", point_mm[axis], cell_mm);
    key = (key << bits) | static_cast<std::uint64_t>(cell);
  }
  return key;
}

std::vector<int> order_by_key(std::span<const std::uint64_t> keys) {
  // Least-significant-digit radix sort, 11 bits a pass; passes in which all keys agree are skipped.
  std::vector<int> order(keys.size()), next(keys.size());
  std::iota(order.begin(), order.end(), 0);
  if (keys.empty()) return order;
  std::uint64_t differing = 0;
  for (const auto key : keys) differing |= key ^ keys[0];
  constexpr int digit_bits = 11;
  for (int shift = 0; shift < 64; shift += digit_bits) {
    constexpr std::uint64_t mask = (1u << digit_bits) - 1;
    if (((differing >> shift) & mask) == 0) continue;
    std::array<int, mask + 2> begin{};
    for (const auto key : keys) ++begin[((key >> shift) & mask) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (const int i : order) next[begin[(keys[i] >> shift) & mask]++] = i;
    order.swap(next);
  }
  return order;
}

PointGrid::PointGrid(std::span<const Eigen::Vector3f> points_mm, float cell_mm) {
  if (!(cell_mm > 0)) throw Error("cell size {} mm: must be positive", cell_mm);
  std::vector<std::uint64_t> keys(points_mm.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = cell_key(points_mm[i], cell_mm);
  original_ = order_by_key(keys);
  x_.reserve(keys.size());
  y_.reserve(keys.size());
  z_.reserve(keys.size());
  for (std::size_t s = 0; s < keys.size(); ++s) {
    const int i = original_[s];
    if (cell_key_.empty() || keys[i] != cell_key_.back()) {
      cell_key_.push_back(keys[i]);
      cell_begin_.push_back(static_cast<int>(s));
    }
    x_.push_back(points_mm[i].x());
    y_.push_back(points_mm[i].y());
    z_.push_back(points_mm[i].z());
  }
  cell_begin_.push_back(static_cast<int>(keys.size()));
}

std::array<PointGrid::Range, 9> PointGrid::neighbourhood(std::size_t c) const {
  std::array<Range, 9> ranges;
  std::size_t r = 0;
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      const std::int64_t offset = (static_cast<std::int64_t>(dz) << (2 * bits)) + (static_cast<std::int64_t>(dy) << bits);
      const std::uint64_t row = cell_key_[c] + static_cast<std::uint64_t>(offset);
      const auto first = std::lower_bound(cell_key_.begin(), cell_key_.end(), row - 1);
      auto last = first;
      while (last != cell_key_.end() && *last <= row + 1) ++last;
      ranges[r++] = {cell_begin_[first - cell_key_.begin()], cell_begin_[last - cell_key_.begin()]};
    }
  }
  return ranges;
}

}  // namespace partpose
