// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/pipeline/catalogue.hpp"

#include <filesystem>
#include <vector>

namespace partpose {

/// $XDG_CACHE_HOME/partpose, or else ~/.cache/partpose, or else partpose in the system's temporary folder.
std::filesystem::path default_cache_folder();

/// The catalogue of some parts, made on first use and kept under `cache_folder`; another part, name, mesh or
/// configuration makes another one.
Catalogue cached_catalogue(const std::vector<NamedMesh>& parts, const DatasetPreparationConfig& dataset,
                           const GlobalPipelineConfig& pipeline, const std::filesystem::path& cache_folder,
                           const Progress& progress = {});

/// The same of all parts of these files and folders; Error when one cannot be read.
Catalogue cached_catalogue(const std::vector<std::filesystem::path>& model_paths, const DatasetPreparationConfig& dataset,
                           const GlobalPipelineConfig& pipeline, const std::filesystem::path& cache_folder,
                           const Progress& progress = {});

}  // namespace partpose
