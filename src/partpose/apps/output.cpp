// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"

#include "partpose/core/error.hpp"

#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

void check_access(const fs::path& existing, int mode, const fs::path& asked) {
  if (access(existing.c_str(), mode) != 0)
    throw Error("{}: cannot be written: {}", asked.string(), std::generic_category().message(errno));
}

}  // namespace

void check_file_can_be_written(const fs::path& file) {
  if (file.empty() || is_standard_output(file)) return;
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw Error("{}: cannot be written: is a folder", file.string());
  if (access(file.c_str(), W_OK) == 0) return;
  const fs::path folder = fs::absolute(file).parent_path();
  if (!fs::is_directory(folder, ignored))
    throw Error("{}: cannot be written: there is no folder {}", file.string(), folder.string());
  check_access(folder, W_OK | X_OK, file);
}

void check_folder_can_be_written(const fs::path& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  fs::path existing = fs::absolute(folder);
  while (!fs::exists(existing, ignored) && existing.has_relative_path()) existing = existing.parent_path();
  if (!fs::is_directory(existing, ignored))
    throw Error("{}: cannot be written: {} is not a folder", folder.string(), existing.string());
  check_access(existing, W_OK | X_OK, folder);
}

bool is_standard_output(const std::filesystem::path& path) { return path == "-" || path == "/dev/stdout"; }

std::ofstream open_for_writing(const std::filesystem::path& path) {
  // Standard output may be a file that others append to: it is never truncated.
  const bool standard_output = is_standard_output(path);
  std::ofstream file(standard_output ? "/dev/stdout" : path, standard_output ? std::ios::app : std::ios::trunc);
  if (!file) throw Error("{}: cannot be written", path.string());
  return file;
}

std::string counted(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
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
