// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace partpose::apps {

/// Ctrl-C (or SIGTERM, SIGHUP) came while something half written was to be finished or taken away first. No
/// std::exception: whoever catches those goes on with the next file, and this must get through to main.
struct Interrupted {};

/// From now on a signal ends the process at once with 128 + its number, but while an Unfinished lives: then
/// check_not_interrupted() throws instead. A second signal ends it in any case. Signals that the process was started
/// with ignored (nohup) stay so.
void handle_signals();

/// Throws Interrupted when a signal came.
void check_not_interrupted();

/// 128 + the number of the signal that came; 0: none.
int exit_code_of_signal();

/// For commands that go on until a signal ends them: the one that came, if any, was meant so.
void accept_signal();

/// While it lives there is half-written output that must not be left behind.
class Unfinished {
 public:
  Unfinished();
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
};

}  // namespace partpose::apps
