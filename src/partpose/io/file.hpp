// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace partpose {

/// Error when `path` is missing, a folder or anything else than a regular file.
void check_is_file(const std::filesystem::path& path);

/// The whole content of a file. Error as for check_is_file, and when it is unreadable or empty.
std::string read_file(const std::filesystem::path& path);

/// Writes a temporary file beside `path` and renames it, so that nobody ever sees a half-written file; an old file of
/// that name is replaced. Error when that fails; then `path` is as it was and the temporary file is gone.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// How many temporary files of write_file_atomically there are right now. May be called by a signal handler, which must
/// not end the process meanwhile.
int files_being_written() noexcept;

}  // namespace partpose
