// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/mesh_files.hpp"

namespace partpose {

/// The solids of a STEP file (ISO 10303-21: AP203, AP214, AP242), by OpenCASCADE: in mm whatever the file's unit, cut
/// into triangles, outwards. A part that an assembly holds several times comes once. Throws Error when the file is not
/// STEP, ends early or holds no solid, and in a build without OpenCASCADE.
std::vector<NamedMesh> read_step(const std::filesystem::path& path, const MeshReadOptions& options);

}  // namespace partpose
