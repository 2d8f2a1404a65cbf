// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/matching/descriptor_index.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cmath>

namespace partpose {

void DescriptorIndex::add(std::span<const float> histogram) {
  if (static_cast<int>(histogram.size()) != bins_)
    throw Error("descriptor has {} bins, the index holds descriptors of {}", histogram.size(), bins_);
  values_.insert(values_.end(), histogram.begin(), histogram.end());
}

std::vector<Match> DescriptorIndex::nearest(std::span<const float> histogram, int k) const {
  if (static_cast<int>(histogram.size()) != bins_)
    throw Error("descriptor has {} bins, the index holds descriptors of {}", histogram.size(), bins_);
  std::vector<Match> matches(size());
  for (int r = 0; r < size(); ++r) {
    const float* values = row(r).data();
    const float* query = histogram.data();
    float sum = 0;
#pragma omp simd reduction(+ : sum)
    for (int b = 0; b < bins_; ++b) sum += std::abs(values[b] - query[b]);
    matches[r] = {r, sum};
  }
  const auto count = std::min<std::size_t>(std::max(k, 0), matches.size());
  std::partial_sort(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(count), matches.end(),
                    [](const Match& a, const Match& b) {
                      return a.distance < b.distance || (a.distance == b.distance && a.row < b.row);
                    });
  matches.resize(count);
  return matches;
}

}  // namespace partpose
