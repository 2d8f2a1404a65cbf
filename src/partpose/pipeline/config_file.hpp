// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/dataset/dataset.hpp"
#include "partpose/pipeline/config.hpp"

#include <filesystem>

namespace partpose {

/// Read a configuration file; absent keys keep their defaults. Throws Error naming file and key for an unknown key, a wrong
/// type or a value out of range.
GlobalPipelineConfig read_pipeline_config(const std::filesystem::path& path);
DatasetPreparationConfig read_dataset_config(const std::filesystem::path& path);

}  // namespace partpose
