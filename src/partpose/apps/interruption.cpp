// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"

#include "partpose/io/file.hpp"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>

namespace partpose::apps {

namespace {

std::atomic<int> signal_that_came = 0;
std::atomic<int> unfinished = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // what a signal handler may touch

/// Looks again in a moment while a file is between its temporary and its own name.
void end_when_files_are_whole(int) {
  if (files_being_written() == 0) _exit(128 + signal_that_came);
  const itimerval moment{{0, 0}, {0, 10'000}};
  setitimer(ITIMER_REAL, &moment, nullptr);
}

void on_signal(int number) {
  int none = 0;
  const bool first = signal_that_came.compare_exchange_strong(none, number);
  if (!first) _exit(128 + number);
  if (unfinished == 0) end_when_files_are_whole(0);
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
  struct sigaction again {};
  again.sa_handler = end_when_files_are_whole;
  again.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &again, nullptr);
}

void check_not_interrupted() {
  if (signal_that_came != 0) throw Interrupted{};
}

int exit_code_of_signal() { return signal_that_came == 0 ? 0 : 128 + signal_that_came; }

void accept_signal() { signal_that_came = 0; }

Unfinished::Unfinished() { ++unfinished; }
Unfinished::~Unfinished() { --unfinished; }

}  // namespace partpose::apps
