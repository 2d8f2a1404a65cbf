// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/calibration.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cmath>

namespace partpose {

Reliability reliability(const std::vector<std::pair<double, bool>>& statements, int bins) {
  if (bins < 1) throw Error("reliability: {} bins: must be 1 or more", bins);
  Reliability out;
  out.count = static_cast<int>(statements.size());
  for (int b = 0; b < bins; ++b)
    out.bins.push_back({static_cast<double>(b) / bins, static_cast<double>(b + 1) / bins, 0, 0, 0});
  for (const auto& [stated, right] : statements) {
    const double confidence = std::isfinite(stated) ? std::clamp(stated, 0.0, 1.0) : 0;
    ReliabilityBin& bin = out.bins[std::min(bins - 1, static_cast<int>(confidence * bins))];
    ++bin.count;
    bin.right += right;
    bin.mean_confidence += confidence;
  }
  for (auto& bin : out.bins) {
    if (bin.count == 0) continue;
    bin.mean_confidence /= bin.count;
    out.expected_error += std::abs(bin.share_right() - bin.mean_confidence) * bin.count / out.count;
  }
  return out;
}

}  // namespace partpose
