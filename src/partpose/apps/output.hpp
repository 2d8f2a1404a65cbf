// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/json.hpp"
#include "partpose/pipeline/records.hpp"

#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace partpose::apps {

/// "-" or /dev/stdout: text for people must not come between its lines then.
bool is_standard_output(const std::filesystem::path& path);

/// Throw Error when a file, or a folder and what comes into it, cannot be written: to be asked before long work, as
/// they make and change nothing. An empty path is none.
void check_file_can_be_written(const std::filesystem::path& file);
void check_folder_can_be_written(const std::filesystem::path& folder);

/// "-" is standard output. Throws Error when the file cannot be written.
std::ofstream open_for_writing(const std::filesystem::path& path);

/// "1 part", "2 parts".
std::string counted(std::size_t count, const char* noun);

/// One document on standard output.
void print_json(const Json& json);

/// {"total": ms, step: ms, ...}
Json times_of(std::span<const MeasuredOperation> stages);

}  // namespace partpose::apps
