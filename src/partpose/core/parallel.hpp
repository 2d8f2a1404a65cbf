// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace partpose {

/// Calls `body(begin, end)` for disjoint ranges that cover [0, count), on the threads that the machine or a ThreadLimit
/// allows. Results must depend on the index alone, never on how the ranges are cut: same bits for any number of threads.
void parallel_ranges(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body,
                     std::size_t smallest_range = 1);

/// Calls `body(i)` for each i in [0, count).
template <typename Body>
void parallel_for(std::size_t count, const Body& body, std::size_t smallest_range = 1) {
  parallel_ranges(
      count,
      [&body](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
      },
      smallest_range);
}

/// While it lives, the library uses at most `threads` threads (0: as many as the machine has).
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partpose
