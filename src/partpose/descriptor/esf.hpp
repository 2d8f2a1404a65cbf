// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/global_descriptor.hpp"

namespace partpose {

struct EsfOptions {
  int k_nn = 6;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("k_nn", self.k_nn, "number of nearest neighbours, >= 1");
  }
  void check() const;
};

std::unique_ptr<GlobalDescriptor> make_descriptor(const EsfOptions& options);

}  // namespace partpose
