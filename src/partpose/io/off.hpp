// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"

#include <filesystem>

namespace partpose {

/// An OFF file (ASCII; header OFF, COFF, NOFF or CNOFF, comments begin with #) in mm: polygons as fans of triangles,
/// equal vertices merged, what a line has beyond them (normals, colours) ignored. Error naming file, line and byte when
/// anything is not as the format says, when a corner is no vertex, and when there is no triangle.
TriangleMesh read_off(const std::filesystem::path& path);

}  // namespace partpose
