// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"

#include "partpose/core/error.hpp"

namespace partpose::apps {

bool is_standard_output(const std::filesystem::path& path) { return path == "-" || path == "/dev/stdout"; }

std::ofstream open_for_writing(const std::filesystem::path& path) {
  // Standard output may be a file that others append to: it is never truncated.
  const bool standard_output = is_standard_output(path);
  std::ofstream file(standard_output ? "/dev/stdout" : path, standard_output ? std::ios::app : std::ios::trunc);
  if (!file) throw Error("{}: cannot be written", path.string());
  return file;
}

void print_json(const Json& json) { fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace)); }

Json times_of(std::span<const MeasuredOperation> stages) {
  const auto rounded = [](double ms) { return std::round(ms * 1000) / 1000; };
  Json times;
  double total = 0;
  for (const auto& stage : stages) total += stage.measure_ms;
  times["total"] = rounded(total);
  for (const auto& stage : stages) times[stage.tag] = rounded(stage.measure_ms);
  return times;
}

}  // namespace partpose::apps
