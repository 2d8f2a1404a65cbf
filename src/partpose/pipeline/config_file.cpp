// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/config_file.hpp"

#include "partpose/io/json.hpp"

namespace partpose {

GlobalPipelineConfig read_pipeline_config(const std::filesystem::path& path) {
  return read_json<GlobalPipelineConfig>(path);
}

DatasetPreparationConfig read_dataset_config(const std::filesystem::path& path) {
  auto config = read_json<DatasetPreparationConfig>(path);
  if (config.symmetries) config.symmetries = (path.parent_path() / *config.symmetries).string();
  return config;
}

}  // namespace partpose
