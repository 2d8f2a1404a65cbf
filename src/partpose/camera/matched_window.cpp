// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/matched_window.hpp"

namespace partpose {

void MatchedRow::find(const float* row, float* out, std::ptrdiff_t stride, int reach) {
  const float edge = edge_;
  float *offsets = offsets_.data(), *count = count_.data(), *holds = holds_.data();
  for (int u = 0; u < width_; ++u) {
    offsets[u] = 0;
    count[u] = 1;
    holds[u] = row[u] > 0 ? 1.0f : 0.0f;  // until a pair ends it
  }
  for (int k = 1; k <= reach; ++k) {
    const float *before = row - k * stride, *behind = row + k * stride;
    const int margin = stride == 1 ? k : 0;
#pragma omp simd
    for (int u = margin; u < width_ - margin; ++u) {
      const float a = before[u], b = behind[u], bend = (a - row[u]) + (b - row[u]);
      holds[u] = (a > 0) & (b > 0) & (std::abs(bend) <= edge) ? holds[u] : 0.0f;
      offsets[u] += holds[u] * bend;
      count[u] += 2 * holds[u];
    }
  }
#pragma omp simd
  for (int u = 0; u < width_; ++u) out[u] = row[u] + offsets[u] / count[u];
}

}  // namespace partpose
