// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace partpose {

/// A small seeded generator (SplitMix64, Steele et al. 2014) whose numbers are the same on every machine and library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// The generator for item `index` of a seed: each item has its own, so that the order of the work does not matter.
  Random(std::uint64_t seed, std::uint64_t index) : state_(Random(seed).next() ^ (index * 0xD1342543DE82EF95ull)) {
    next();
  }

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// In [0, count).
  std::uint64_t below(std::uint64_t count) { return next() % count; }
  /// Two independent draws of the standard normal distribution (Box and Muller 1958).
  std::pair<double, double> normal_pair() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  std::uint64_t state_;
};

}  // namespace partpose
