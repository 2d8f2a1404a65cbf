// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/best_together.hpp"

#include <algorithm>
#include <cmath>

namespace partpose {

namespace {

struct Set {
  std::vector<int> items;
  double worth = 0;
};

/// The items, and the best of the others as long as one adds to them.
Set filled(const std::vector<int>& items, const Eigen::VectorXd& worth, const Eigen::MatrixXd& shared) {
  Set set;
  Eigen::VectorXd adds = worth;
  const auto put = [&](Eigen::Index i) {
    set.items.push_back(static_cast<int>(i));
    set.worth += adds[i];
    adds -= shared.col(i);
    adds[i] = 0;
  };
  for (const int i : items) put(i);
  for (Eigen::Index best = 0; adds.size() > 0 && adds.maxCoeff(&best) > 0;) put(best);
  return set;
}

}  // namespace

std::vector<int> best_together(const Eigen::VectorXd& worth, const Eigen::MatrixXd& shared) {
  constexpr double least_better = 1e-6;  // of the worth, lest rounding goes round in circles
  Set best = filled({}, worth, shared);
  for (bool better = true; better;) {
    better = false;
    for (int i = 0; i < worth.size() && !better; ++i) {
      if (!(worth[i] > 0) || std::count(best.items.begin(), best.items.end(), i) > 0) continue;
      std::vector<int> with{i};
      for (const int j : best.items)
        if (std::isfinite(shared(i, j))) with.push_back(j);
      Set other = filled(with, worth, shared);
      if (other.worth <= best.worth * (1 + least_better)) continue;
      best = std::move(other);
      better = true;
    }
  }
  return best.items;
}

}  // namespace partpose
