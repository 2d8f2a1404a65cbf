// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

namespace partpose {

/// One point per occupied cell of a grid through the origin: the centroid of its points, with the normalised mean of
/// their normals and the mean curvature. Cells come sorted by z, y, x. Points that are not finite are dropped.
/// Throws Error when `voxel_mm` is not positive.
PointCloud voxel_grid(const PointCloud& cloud, float voxel_mm);

}  // namespace partpose
