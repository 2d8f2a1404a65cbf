// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace partpose {

/// What a window that was matched makes of a surface along one row or column: the mean over `*centre` and the pairs of
/// pixels that lie opposite each other on the same surface, up to `reach` pixels away, so that a plane stays as it is.
/// A pair that bends by more than `edge`, or has a pixel without a value (0), ends it. `stride` is from one pixel to
/// the next, `room` the number of pixels that there are on both sides.
inline float matched_mean(const float* centre, std::ptrdiff_t stride, int room, int reach, float edge) {
  const float value = *centre;
  if (!(value > 0)) return value;
  float offsets = 0;
  int count = 1;
  for (int k = 1; k <= std::min(room, reach); ++k) {
    const float a = centre[-k * stride], b = centre[k * stride];
    const float bend = (a - value) + (b - value);
    if (!(a > 0 && b > 0) || std::abs(bend) > edge) break;
    offsets += bend;
    count += 2;
  }
  return value + offsets / static_cast<float>(count);
}

/// `matched_mean` of all pixels of a row, side by side.
class MatchedRow {
 public:
  MatchedRow(int width, int reach, float edge)
      : width_(width), reach_(reach), edge_(edge), offsets_(width), count_(width), holds_(width) {}

  /// With windows along the row.
  void along(const float* row, float* out) { find(row, out, 1, reach_); }
  /// With windows across it; `room`: so many rows are above it and below it, each `width` from the next.
  void across(const float* row, float* out, int room) { find(row, out, width_, std::min(room, reach_)); }

 private:
  void find(const float* row, float* out, std::ptrdiff_t stride, int reach);

  int width_, reach_;
  float edge_;
  std::vector<float> offsets_, count_, holds_;  ///< of each window
};

}  // namespace partpose
