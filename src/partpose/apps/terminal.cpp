// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "terminal.hpp"

#include "interruption.hpp"

#include "partpose/core/stopwatch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

namespace partpose::apps {

namespace {

/// Whether what is written can move the cursor and be coloured.
bool is_terminal(std::FILE* stream) {
  const char* kind = std::getenv("TERM");
  return isatty(fileno(stream)) != 0 && kind && *kind && std::string_view(kind) != "dumb";
}

struct State {
  bool is_terminal = apps::is_terminal(stderr);
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

Progress terminal_progress(const Common& common) {
  if (common.quiet) return [](std::string_view, std::size_t, std::size_t) { check_not_interrupted(); };
  return [state = std::make_shared<State>()](std::string_view what, std::size_t done, std::size_t total) {
    check_not_interrupted();
    if (total == 0) return;
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

std::string coloured(std::FILE* stream, Colour colour, std::string_view text) {
  const char* no_colour = std::getenv("NO_COLOR");
  if (!is_terminal(stream) || (no_colour && *no_colour)) return std::string(text);
  return fmt::format("\033[{}m{}\033[0m", static_cast<int>(colour), text);
}

void complain(std::string_view message) {
  // A progress bar may stand in this line.
  fmt::print(stderr, "{}{} {}\n", is_terminal(stderr) ? "\r\033[K" : "", coloured(stderr, Colour::red, "partpose:"),
             message);
}

void note(const Common& common, std::string_view message) {
  if (common.verbose) fmt::print(stderr, "{}{}\n", is_terminal(stderr) ? "\r\033[K" : "", message);
}

}  // namespace partpose::apps
