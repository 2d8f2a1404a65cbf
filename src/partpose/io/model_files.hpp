// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace partpose {

/// The file itself, or the STL files of a folder by name (not of its subfolders).
/// Throws Error when there is no such file, or no STL in the folder.
std::vector<std::filesystem::path> model_files(const std::filesystem::path& file_or_folder);

}  // namespace partpose
