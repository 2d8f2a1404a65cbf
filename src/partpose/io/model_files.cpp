// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/model_files.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cctype>

namespace partpose {

namespace fs = std::filesystem;

std::vector<fs::path> model_files(const fs::path& file_or_folder) {
  if (!fs::exists(file_or_folder)) throw Error("{}: no such file or folder", file_or_folder.string());
  if (!fs::is_directory(file_or_folder)) return {file_or_folder};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(file_or_folder)) {
    std::string extension = entry.path().extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (extension == ".stl" && entry.is_regular_file()) files.push_back(entry.path());
  }
  if (files.empty()) throw Error("{}: has no STL files", file_or_folder.string());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace partpose
