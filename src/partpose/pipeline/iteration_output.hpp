// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/scene.hpp"
#include "partpose/pipeline/recognition.hpp"

#include <filesystem>

namespace partpose {

/// Writes the iteration output folder of the reference, `folder`/timestamp/: result.json always, the rest as `debug`
/// says. Clouds are in the camera frame, mm (scene_original.ply as it was given, before any scaling); candidate_N.ply
/// is candidate N's view at its final pose, result_partial the accepted one's, result_full the whole part. What a
/// report reads besides, with the point clouds or the pictures: scene_depth.png (of a depth image) with its camera,
/// scene_preprocessed.ply, all objects in detections.json, and the parts' meshes in `folder`/meshes/, once for all
/// iterations. Returns the iteration's folder.
std::filesystem::path write_iteration(const std::filesystem::path& folder, const Recognition& recognition,
                                      const Scene& scene, const Catalogue& catalogue,
                                      const GlobalPipelineConfig& config);

}  // namespace partpose
