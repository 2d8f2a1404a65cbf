// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/model_files.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/mesh_files.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace partpose {

namespace fs = std::filesystem;

std::string lower_case_ending(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

bool is_model_file(const fs::path& file) {
  const auto& known = mesh_file_endings();
  return std::find(known.begin(), known.end(), lower_case_ending(file)) != known.end();
}

namespace {

/// Of a folder without model files: one right below that has some.
std::string hint_of_subfolders(const fs::path& folder) {
  std::error_code unreadable;
  for (const auto& below : fs::directory_iterator(folder))
    if (below.is_directory())
      for (const auto& entry : fs::directory_iterator(below, unreadable))
        if (is_model_file(entry.path()))
          return fmt::format("; subfolders are not searched: give {} itself", below.path().string());
  return {};
}

}  // namespace

std::vector<fs::path> model_files(const fs::path& file_or_folder) {
  if (!fs::exists(file_or_folder)) throw Error("{}: no such file or folder", file_or_folder.string());
  if (!fs::is_directory(file_or_folder)) return {file_or_folder};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(file_or_folder))
    if (is_model_file(entry.path()) && !entry.is_directory()) files.push_back(entry.path());
  if (files.empty())
    throw Error("{}: has no model files (nothing that ends with {}){}", file_or_folder.string(),
                fmt::join(mesh_file_endings(), ", "), hint_of_subfolders(file_or_folder));
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace partpose
