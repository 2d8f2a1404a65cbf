// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace partpose {

/// The file itself, or the files of a folder that have one of mesh_file_endings(), by name (not those of its
/// subfolders). Throws Error when there is no such file, or none in the folder.
std::vector<std::filesystem::path> model_files(const std::filesystem::path& file_or_folder);

/// Whether its name has one of mesh_file_endings().
bool is_model_file(const std::filesystem::path& file);

/// ".stl" of "Part.STL".
std::string lower_case_ending(const std::filesystem::path& path);

}  // namespace partpose
