// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"

#include <filesystem>
#include <string_view>

namespace partpose {

/// A binary or ASCII STL file (several solids are read as one mesh) in mm, equal vertices merged; triangles keep the
/// file's order, degenerate ones included. Stored normals are ignored: the winding counts. Error, naming the file and
/// the byte (line and byte of an ASCII file), when anything is not as the format says, when a coordinate is not finite
/// or beyond 1e6 mm, and when no triangle has an area.
TriangleMesh read_stl(const std::filesystem::path& path);

/// The same from the content of a file; `name` is what errors call it.
TriangleMesh parse_stl(std::string_view bytes, std::string_view name);

/// The normals that an STL file stores, which read_stl ignores: programs that trust them draw the part wrongly.
struct StlNormals {
  int missing = 0;  ///< zero or no numbers; of triangles with an area
  int against = 0;  ///< that point to the other side than the winding says

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("missing", self.missing, "triangles whose stored normal is zero or no number");
    visit("against", self.against, "triangles whose stored normal points to the other side than their winding says");
  }
};

/// Errors as of read_stl.
StlNormals stl_normals(const std::filesystem::path& path);

/// Binary, in mm, normals by the winding. Error when read_stl would not take the mesh back (no triangle, a coordinate
/// not finite or beyond 1e6 mm), when an index is out of range, or when the file cannot be written.
void write_stl(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace partpose
