// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/mesh_files.hpp"

namespace partpose {

/// OBJ, 3MF, glTF and GLB by Assimp, in mm: glTF is in metres, 3MF says its unit, OBJ has none and is taken to be in
/// mm. The objects of 3MF and glTF are parts (unless `split` is "whole"), an OBJ file is one part. Throws Error when
/// the file is damaged or has no triangle, and in a build without Assimp.
std::vector<NamedMesh> read_with_assimp(const std::filesystem::path& path, const MeshReadOptions& options);

}  // namespace partpose
