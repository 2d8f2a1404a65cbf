// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/esf.hpp"

#include "partpose/core/error.hpp"

namespace partpose {

void EsfOptions::check() const { check_neighbours(k_nn); }

std::unique_ptr<GlobalDescriptor> make_descriptor(const EsfOptions&) {
  throw Error("global_descriptor \"esf\" is not in this version yet; use \"vfh\"");
}

}  // namespace partpose
