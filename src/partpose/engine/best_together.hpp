// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace partpose {

/// The items that are worth most together. Of two, `shared` (symmetric) is what they are worth less than the sum of
/// both; infinity, where only one of them can be. A local search: the best first, and what can be beside it; then each
/// other one in place of those that exclude it, as long as that is better. Items that are worth nothing are left out.
std::vector<int> best_together(const Eigen::VectorXd& worth, const Eigen::MatrixXd& shared);

}  // namespace partpose
