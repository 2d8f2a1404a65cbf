// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/stopwatch.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace partpose {
namespace {

TEST(Stopwatch, CountsMillisecondsSinceTheLastRestart) {
  Stopwatch watch;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const double elapsed_ms = watch.elapsed_ms();
  EXPECT_GE(elapsed_ms, 20);
  EXPECT_LT(elapsed_ms, 5000);
  watch.restart();
  EXPECT_LT(watch.elapsed_ms(), elapsed_ms);
}

}  // namespace
}  // namespace partpose
