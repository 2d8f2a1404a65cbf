// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <filesystem>

namespace partpose {

/// A point cloud file in mm, by its extension (in any case): .pcd or .ply. Error for another extension, and as read_pcd
/// and read_ply.
PointCloud read_cloud(const std::filesystem::path& path);

}  // namespace partpose
