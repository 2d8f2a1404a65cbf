// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/parallel.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/random.hpp"
#include "partpose/core/stopwatch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace partpose {
namespace {

TEST(Parallel, CallsEachIndexOnce) {
  for (const int threads : {0, 1, 2, 5}) {
    const ThreadLimit limit(threads);
    for (const std::size_t count : {0, 1, 2, 7, 1000, 100003}) {
      for (const std::size_t smallest_range : {1, 8, 1000000}) {
        std::vector<std::atomic<int>> calls(count);
        parallel_for(
            count, [&](std::size_t i) { ++calls.at(i); }, smallest_range);
        EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const auto& c) { return c == 1; })) << count;
      }
    }
  }
}

TEST(Parallel, RangesAreDisjointAndCover) {
  std::mutex mutex;
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  parallel_ranges(
      12345,
      [&](std::size_t begin, std::size_t end) {
        const std::lock_guard lock(mutex);
        ranges.emplace_back(begin, end);
      },
      10);
  std::sort(ranges.begin(), ranges.end());
  std::size_t covered = 0;
  for (const auto& [begin, end] : ranges) {
    EXPECT_EQ(begin, covered);
    EXPECT_LT(begin, end);
    covered = end;
  }
  EXPECT_EQ(covered, 12345);
}

TEST(Parallel, AnInnerLoopIsCompleteAlsoWhereAnotherIterationFails) {
  const ThreadLimit limit(2);
  std::atomic<bool> started = false, failed = false;
  std::atomic<int> incomplete = 0, after_failure = 0;
  EXPECT_THROW(parallel_for(2,
                            [&](std::size_t i) {
                              const Stopwatch watch;
                              constexpr double longest_ms = 2000;
                              if (i == 1) {
                                while (!started && watch.elapsed_ms() < longest_ms) std::this_thread::yield();
                                failed = true;
                                throw Error("no space left");
                              }
                              started = true;
                              // Some loops longer, until the failure has come to all.
                              while (after_failure < 300 && watch.elapsed_ms() < longest_ms) {
                                after_failure += failed;
                                std::atomic<int> calls = 0;
                                parallel_for(100, [&](std::size_t) { ++calls; });
                                incomplete += calls != 100;
                              }
                            }),
               Error);
  EXPECT_EQ(incomplete, 0);
}

TEST(Parallel, SameResultForAnyNumberOfThreads) {
  const auto compute = [](int threads) {
    const ThreadLimit limit(threads);
    std::vector<double> result(20000);
    parallel_for(result.size(), [&](std::size_t i) { result[i] = Random(3, i).normal_pair().second; });
    return result;
  };
  const auto one = compute(1);
  EXPECT_EQ(one, compute(2));
  EXPECT_EQ(one, compute(4));
  EXPECT_EQ(one, compute(0));
}

TEST(ThreadLimit, OneThreadIsTheCallersOwn) {
  const ThreadLimit limit(1);
  std::mutex mutex;
  std::set<std::thread::id> seen;
  parallel_for(300, [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));  // time enough for another thread to come and help
    const std::lock_guard lock(mutex);
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(seen, std::set{std::this_thread::get_id()});
}

TEST(ThreadLimit, IsNeverExceeded) {
  const ThreadLimit limit(2);
  std::atomic<int> now = 0, most = 0;
  parallel_for(200, [&](std::size_t) {
    const int here = ++now;
    int before = most;
    while (here > before && !most.compare_exchange_weak(before, here)) {
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    --now;
  });
  EXPECT_LE(most, 2);
}

TEST(Parallel, ExceptionsReachTheCaller) {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const auto failing = [] {
      parallel_for(1000, [](std::size_t i) {
        if (i == 777) throw Error("item {} is bad", i);
      });
    };
    try {
      failing();
      ADD_FAILURE() << "no exception";
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "item 777 is bad");
    }
    std::atomic<int> calls = 0;
    parallel_for(100, [&](std::size_t) { ++calls; });
    EXPECT_EQ(calls, 100) << "it must go on working after an exception";
  }
}

TEST(Parallel, MayBeNested) {
  const ThreadLimit limit(2);
  std::vector<std::atomic<int>> calls(50 * 40);
  parallel_for(50, [&](std::size_t i) { parallel_for(40, [&](std::size_t k) { ++calls[i * 40 + k]; }); });
  EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const auto& c) { return c == 1; }));
}

}  // namespace
}  // namespace partpose
