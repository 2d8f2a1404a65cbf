// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/json.hpp"
#include "partpose/io/png.hpp"
#include "partpose/io/scene.hpp"
#include "partpose/pipeline/global_pipeline.hpp"

#include <filesystem>

namespace partpose::apps {

/// The line of `--jsonl`: scene, model_name or null, T_final (camera_from_model, mm), distances, times by step.
Json line_of(const std::filesystem::path& scene, const Recognition& recognition);

void print_pose(const Eigen::Isometry3d& pose);
void print_for_people(const std::filesystem::path& scene, const Recognition& recognition);

/// The scene with the part drawn over it; a cloud is drawn as a camera that just covers it would see it.
ColourImage picture_of(const Scene& scene, const Recognition& recognition, const Catalogue& catalogue);

}  // namespace partpose::apps
