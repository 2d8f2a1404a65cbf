// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/parallel.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

namespace partpose {

void parallel_ranges(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body,
                     std::size_t smallest_range) {
  if (count == 0) return;
  if (tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) == 1) {
    body(0, count);  // a worker that is still awake would help otherwise
    return;
  }
  // Isolated: who waits for the end of an inner loop takes no other work of an outer one meanwhile, so that the times
  // of frames that are recognized side by side are their own.
  // With its own context: an exception in another iteration of the outer loop would else end this one too, and its
  // caller would go on with what is half computed.
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, smallest_range),
        [&body](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); },
        tbb::auto_partitioner(), own);
  });
}

struct ThreadLimit::Impl {
  explicit Impl(int threads)
      : control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
  if (threads > 0) impl_ = std::make_unique<Impl>(threads);
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace partpose
