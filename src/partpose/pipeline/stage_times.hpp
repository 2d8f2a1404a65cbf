// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/stopwatch.hpp"
#include "partpose/pipeline/records.hpp"

#include <vector>

namespace partpose {

/// Adds up the time of each stage of a recognition, however often it is run.
class StageTimes {
 public:
  explicit StageTimes(std::vector<MeasuredOperation>& stages) : stages_(stages) {}
  /// Runs `body` as a part of the stage `name`, and returns what it returns.
  template <typename Body>
  auto operator()(const char* name, const Body& body) {
    struct Add {
      StageTimes& times;
      const char* name;
      Stopwatch watch;
      ~Add() { times.add(name, watch.elapsed_ms()); }
    } const add{*this, name, {}};
    return body();
  }

 private:
  void add(const char* name, double ms) {
    for (auto& stage : stages_)
      if (stage.tag == name) {
        stage.measure_ms += ms;
        return;
      }
    stages_.push_back({ms, name});
  }
  std::vector<MeasuredOperation>& stages_;
};

}  // namespace partpose
