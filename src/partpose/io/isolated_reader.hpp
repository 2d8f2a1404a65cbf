// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/mesh_files.hpp"

#include <functional>

namespace partpose {

/// Calls `read` in a child process and hands over what it returns or the Error that it throws. The large libraries that
/// read CAD formats crash on some damaged files: then the child dies, and this is an Error that names the file and the
/// library. What they print is dropped.
std::vector<NamedMesh> read_isolated(const std::filesystem::path& path, const char* library,
                                     const std::function<std::vector<NamedMesh>()>& read);

}  // namespace partpose
