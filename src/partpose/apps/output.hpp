// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/json.hpp"
#include "partpose/pipeline/records.hpp"

#include <filesystem>
#include <fstream>
#include <span>

namespace partpose::apps {

/// "-" is standard output. Throws Error when the file cannot be written.
std::ofstream open_for_writing(const std::filesystem::path& path);

/// One document on standard output.
void print_json(const Json& json);

/// {"total": ms, step: ms, ...}
Json times_of(std::span<const MeasuredOperation> stages);

}  // namespace partpose::apps
