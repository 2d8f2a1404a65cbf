// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>

namespace partpose {

/// Numbers that are computed side by side: as many as fit into 256 bits.
template <typename Number>
struct NumberLanes {
  static constexpr int count = 32 / sizeof(Number);
  alignas(32) Number value[count];

  Number sum() const {
    Number out = 0;
    for (const Number each : value) out += each;
    return out;
  }
};

/// Weighted sums over points of the products of a row's entries: the derivatives of a residual, and itself.
template <typename Number, int row_entries = 7>
class RowProducts {
 public:
  using Lanes = NumberLanes<Number>;
  static constexpr int entries = row_entries;

  void add(const std::array<Lanes, entries>& row, const Lanes& weight) {
    int k = 0;
#pragma GCC unroll 16
    for (int a = 0; a < entries; ++a) {
      Lanes weighted;
#pragma omp simd
      for (int i = 0; i < Lanes::count; ++i) weighted.value[i] = weight.value[i] * row[a].value[i];
#pragma GCC unroll 16
      for (int b = a; b < entries; ++b, ++k)
#pragma omp simd
        for (int i = 0; i < Lanes::count; ++i) sums_[k].value[i] += weighted.value[i] * row[b].value[i];
    }
  }

  Eigen::Matrix<Number, entries, entries> total() const {
    Eigen::Matrix<Number, entries, entries> out;
    int k = 0;
    for (int a = 0; a < entries; ++a)
      for (int b = a; b < entries; ++b, ++k) out(a, b) = out(b, a) = sums_[k].sum();
    return out;
  }

 private:
  std::array<Lanes, entries*(entries + 1) / 2> sums_{};
};

}  // namespace partpose
