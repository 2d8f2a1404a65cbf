// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/catalogue_cache.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/hash.hpp"
#include "partpose/io/json.hpp"

#include <cstdlib>

namespace partpose {

namespace fs = std::filesystem;

namespace {
/// Raised whenever the same mesh gives other views, or more is known of it.
constexpr int renderer_version = 2;
}  // namespace

fs::path default_cache_folder() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return fs::path(xdg) / "partpose";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "partpose";
  return fs::temp_directory_path() / "partpose";
}

Catalogue cached_catalogue(const std::vector<fs::path>& model_paths, const DatasetPreparationConfig& dataset,
                           const GlobalPipelineConfig& pipeline, const fs::path& cache_folder, const Progress& progress) {
  return cached_catalogue(read_meshes(model_paths), dataset, pipeline, cache_folder, progress);
}

Catalogue cached_catalogue(const std::vector<NamedMesh>& parts, const DatasetPreparationConfig& dataset,
                           const GlobalPipelineConfig& pipeline, const fs::path& cache_folder, const Progress& progress) {
  std::string content = fmt::format("renderer {}\n", renderer_version) + to_json(dataset).dump();
  for (const auto& part : parts) content += part.name + "\n" + content_hash(part.mesh) + "\n";
  const fs::path folder = cache_folder / content_hash(content);
  try {
    return load_catalogue(open_dataset(folder), pipeline, progress);
  } catch (const std::exception&) {
    // Not there, or damaged: made anew below.
  }
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  try {
    fs::create_directories(cache_folder);
  } catch (const fs::filesystem_error&) {
    throw Error("{}: the cache folder cannot be written; give another one with --cache", cache_folder.string());
  }
  return load_catalogue(create_dataset(dataset, parts, folder, progress), pipeline, progress);
}

}  // namespace partpose
