// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace partpose {

struct Match {
  int row = -1;        ///< which histogram, in the order of adding
  float distance = 0;  ///< L1
};

/// Histograms of equal length in one block, searched exhaustively: at some tens of thousands of views this takes less
/// time than a tree, and it is exact.
class DescriptorIndex {
 public:
  explicit DescriptorIndex(int bins) : bins_(bins) {}

  /// Throws Error when the length is not the index's.
  void add(std::span<const float> histogram);
  int bins() const { return bins_; }
  int size() const { return static_cast<int>(values_.size() / bins_); }
  std::span<const float> row(int index) const {
    return {values_.data() + static_cast<std::size_t>(index) * bins_, static_cast<std::size_t>(bins_)};
  }

  /// The k nearest by the L1 distance, nearest first, of equal ones the earlier first; fewer when the index has fewer.
  std::vector<Match> nearest(std::span<const float> histogram, int k) const;

 private:
  int bins_;
  std::vector<float> values_;
};

}  // namespace partpose
