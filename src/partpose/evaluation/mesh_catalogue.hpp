// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/mesh_files.hpp"
#include "partpose/pipeline/catalogue.hpp"

#include <vector>

namespace partpose {

/// A catalogue of meshes alone, for a recognizer that needs neither views nor descriptors (the Engine): each part with
/// one empty view from the side. Ids count from 1 in the order given. No dataset stands behind it: its `dataset` has no
/// folder.
Catalogue mesh_catalogue(std::vector<NamedMesh> parts);

}  // namespace partpose
