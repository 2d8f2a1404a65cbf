// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.hpp"

#include "partpose/io/mesh_files.hpp"

#include <filesystem>
#include <vector>

namespace partpose::apps {

/// What the help of every command that takes parts says of them.
inline constexpr const char* part_files_help = "Model files (STL, STEP, OBJ, PLY, OFF, 3MF, glTF), or folders of them";

/// --chord-tolerance, --angle-tolerance, --split.
void add_reading_options(CLI::App& command, MeshReadOptions& options);

/// Of one of guess_unit's.
std::string plural_of_unit(const std::string& unit);

/// The parts of files and folders. Of a file that cannot be read, one line goes to standard error, and it is counted in
/// `common.failures`; the others are used. Throws Error when none is left.
std::vector<NamedMesh> read_parts(const std::vector<std::filesystem::path>& files_and_folders,
                                  const MeshReadOptions& options, const Common& common);

}  // namespace partpose::apps
