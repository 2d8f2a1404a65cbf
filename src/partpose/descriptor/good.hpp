// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/global_descriptor.hpp"

namespace partpose {

struct GoodOptions {
  int k_nn = 6;
  int num_of_bins = 6;
  float threshold = 200;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
    visit("num_of_bins", self.num_of_bins, "bins along each side of an orthographic view, >= 1");
    visit("threshold", self.threshold, "for the sign of the axes [mm], >= 0");
  }
  void check() const;
};

std::unique_ptr<GlobalDescriptor> make_descriptor(const GoodOptions& options);

}  // namespace partpose
