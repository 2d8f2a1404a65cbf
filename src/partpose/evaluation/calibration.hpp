// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

/// Whether stated probabilities are true.
namespace partpose {

/// Statements whose probability lies in [from, to); the last bin holds 1 as well.
struct ReliabilityBin {
  double from = 0, to = 0;
  int count = 0, right = 0;
  double mean_confidence = 0;  ///< 0 when there are none
  double share_right() const { return count ? static_cast<double>(right) / count : 0; }
};

struct Reliability {
  std::vector<ReliabilityBin> bins;
  int count = 0;
  /// Expected calibration error: mean over all statements of |share right - mean confidence| of their bin, 0 to 1
  /// (Naeini, Cooper and Hauskrecht, AAAI 2015; Guo et al., ICML 2017, equation 3).
  double expected_error = 0;
};

/// Of (stated probability, whether it was right), in bins of equal width. Probabilities beyond 0 and 1 count as these.
Reliability reliability(const std::vector<std::pair<double, bool>>& statements, int bins = 10);

}  // namespace partpose
