// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"
#include "partpose/core/point_cloud.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

namespace partpose {

/// The vertices of a PLY file (ASCII or binary of either byte order) in mm, as an unorganized cloud. Vertex properties
/// x y z, of any numeric type, are needed; nx ny nz and curvature are read when there. All other properties and
/// elements are skipped, but checked to be whole. Numbers that are not finite are kept. Error, naming the file and the
/// byte (and line, in the header and in ASCII data), when anything is not as the format says.
PointCloud read_ply(const std::filesystem::path& path);

/// The mesh of a PLY file in mm: the vertices as above, and the polygons of the element "face" (list vertex_indices or
/// vertex_index) as fans of triangles. Error as above, and when a coordinate is not finite, a corner is no vertex, or
/// there is no triangle.
TriangleMesh read_ply_mesh(const std::filesystem::path& path);

/// ASCII PLY in mm, coordinates that read back to the same bits, with vertex normals (of the faces around, by area).
/// Error when a coordinate is not finite, a corner is no vertex, or the file cannot be written.
void write_ply_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

struct PlyOptions {
  /// Red, green, blue per point, 0 to 255; none, or as many as points.
  std::span<const std::array<std::uint8_t, 3>> colours;
};

/// Binary little-endian PLY in mm with 32-bit floats, normals and curvatures when the cloud has them. The width and
/// height of an organized cloud are lost: PLY has no place for them. Error when the number of colours is wrong, or the
/// file cannot be written.
void write_ply(const std::filesystem::path& path, const PointCloud& cloud, const PlyOptions& options = {});

}  // namespace partpose
