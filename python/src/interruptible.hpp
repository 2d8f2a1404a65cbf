// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "casters.hpp"

#include <atomic>
#include <chrono>
#include <exception>
#include <future>

namespace partpose::python {

/// Runs work(progress) on a thread of its own while this one, which Python delivers Ctrl-C to, looks for it. A stop
/// takes effect when the work tells of its progress next; then the exception is thrown here. To be called without the
/// interpreter's lock.
template <typename Work>
auto interruptible(const Callback& callback, const Work& work) {
  struct Stopped {};
  std::atomic<bool> stop = false;
  const Progress progress = [&](std::string_view what, std::size_t done, std::size_t total) {
    if (stop) throw Stopped{};
    if (!callback.wanted) return;
    nb::gil_scoped_acquire gil;
    (*callback.function)(nb::str(what.data(), what.size()), done, total);
  };
  auto result = std::async(std::launch::async, [&] { return work(progress); });
  std::exception_ptr interrupt;
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    if (stop) continue;
    nb::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() == 0) continue;
    try {
      throw nb::python_error();
    } catch (...) {
      interrupt = std::current_exception();
    }
    stop = true;
  }
  if (interrupt) {
    result.wait();
    std::rethrow_exception(interrupt);
  }
  return result.get();
}

}  // namespace partpose::python
