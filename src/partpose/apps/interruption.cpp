// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>

namespace partpose::apps {

namespace {

std::atomic<int> signal_that_came = 0;
std::atomic<int> unfinished = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // what a signal handler may touch

void on_signal(int number) {
  int none = 0;
  const bool first = signal_that_came.compare_exchange_strong(none, number);
  if (!first || unfinished == 0) _exit(128 + number);
}

}  // namespace

void handle_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigaction(number, &action, nullptr);
  }
}

void check_not_interrupted() {
  if (signal_that_came != 0) throw Interrupted{};
}

int exit_code_of_signal() { return signal_that_came == 0 ? 0 : 128 + signal_that_came; }

Unfinished::Unfinished() { ++unfinished; }
Unfinished::~Unfinished() { --unfinished; }

}  // namespace partpose::apps
