// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "terminal.hpp"

#include "partpose/core/stopwatch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>

namespace partpose::apps {

namespace {

struct State {
  bool is_terminal = isatty(STDERR_FILENO) != 0;
  std::string what;
  Stopwatch since_start;
  double drawn_ms = -1e9;
  std::size_t tenths = 0;
};

void draw_bar(State& state, std::size_t done, std::size_t total) {
  const double elapsed = state.since_start.elapsed_ms();
  if (done < total && elapsed - state.drawn_ms < 100) return;
  state.drawn_ms = elapsed;
  constexpr std::size_t width = 30;
  const std::size_t filled = width * done / total;
  const double left_s = done ? elapsed / 1000 * static_cast<double>(total - done) / static_cast<double>(done) : 0;
  fmt::print(stderr, "\r{:<20} [{}{}] {}/{}  {:.0f} s left ", state.what, std::string(filled, '='),
             std::string(width - filled, ' '), done, total, left_s);
  if (done == total) fmt::print(stderr, "\r{:<79}\r", "");
  std::fflush(stderr);
}

}  // namespace

Progress terminal_progress(bool quiet) {
  if (quiet) return {};
  return [state = std::make_shared<State>()](std::string_view what, std::size_t done, std::size_t total) {
    if (state->what != what || done <= 1) {
      state->what = what;
      state->since_start.restart();
      state->drawn_ms = -1e9;
      state->tenths = 0;
    }
    if (state->is_terminal) {
      draw_bar(*state, done, total);
    } else if (const std::size_t tenths = 10 * done / total; tenths > state->tenths || done == total) {
      // Short work says nothing in a log; long work a line for each tenth.
      state->tenths = tenths;
      if (state->since_start.elapsed_ms() > 2000) fmt::print(stderr, "{}: {} of {}\n", what, done, total);
    }
  };
}

}  // namespace partpose::apps
