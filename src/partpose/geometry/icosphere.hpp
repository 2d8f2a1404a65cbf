// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace partpose {

/// Unit directions of an icosahedron whose triangles were split in four `subdivide` times (0 to 4), new vertices put
/// back on the sphere: its vertices (12, 42, 162, ...) or its face centres (20, 80, 320, ...).
/// Throws Error when `subdivide` is out of range.
std::vector<Eigen::Vector3d> icosphere_directions(int subdivide, bool use_vertices);

}  // namespace partpose
