// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/pipeline/recognition.hpp"

#include <filesystem>

namespace partpose {

/// Writes the iteration output folder of the reference, `folder`/timestamp/: result.json always, the rest as `debug`
/// says. Clouds are in the camera frame, mm (scene_original.ply as it was given, before any scaling); candidate_N.ply
/// is candidate N's view at its final pose, result_partial the accepted one's, result_full the whole part. Returns the
/// iteration's folder.
std::filesystem::path write_iteration(const std::filesystem::path& folder, const Recognition& recognition,
                                      const PointCloud& scene, const Catalogue& catalogue,
                                      const GlobalPipelineConfig& config);

}  // namespace partpose
