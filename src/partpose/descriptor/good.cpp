// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/good.hpp"

#include "partpose/core/error.hpp"

namespace partpose {

void GoodOptions::check() const {
  check_neighbours(k_nn);
  if (num_of_bins < 1) throw Error("num_of_bins {}: must be 1 or more", num_of_bins);
  if (!(threshold >= 0)) throw Error("threshold {}: must be 0 or more", threshold);
}

std::unique_ptr<GlobalDescriptor> make_descriptor(const GoodOptions&) {
  throw Error("global_descriptor \"good\" is not in this version yet; use \"vfh\"");
}

}  // namespace partpose
