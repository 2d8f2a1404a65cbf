// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/core/point_cloud.hpp"
#include "partpose/io/json.hpp"

#include <string>
#include <string_view>

/// The compact forms in which a report's page carries points, depth and meshes; web/src/packet.ts undoes them.
namespace partpose {

/// zlib's format (RFC 1950), which browsers call "deflate". Level 0 to 9.
std::string deflated(std::string_view bytes, int level = 9);
std::string base64(std::string_view bytes);

/// A JSON header and the binary sections that it refers to by offset: length of the header as 32 bits, header,
/// sections.
class Packet {
 public:
  Json header = Json::object();

  /// The finite points, at most `most_points` of them, evenly thinned; their coordinates rounded to 1/65535 of their
  /// box, in the order of a space-filling curve, as differences, high bytes and low bytes apart. Normals, if any, as
  /// octahedral coordinates of 8 bits (Meyer et al. 2010). Returns what describes the section:
  /// {"offset", "count", "of", "lo", "size", "normals"}.
  Json add(const PointCloud& cloud, std::size_t most_points);

  /// Depth in units of `unit_mm` as 16 bits, each pixel as its difference from the median prediction of its neighbours
  /// (Weinberger et al. 2000, LOCO-I), high bytes and low bytes apart: {"offset", "width", "height", "unit_mm"}.
  Json add(const DepthImage& depth, double unit_mm);

  /// Vertices as points are, triangles as differences of indices: {"offset", "vertices", "triangles", "lo", "size"}.
  Json add(const TriangleMesh& mesh);

  std::string bytes() const;

 private:
  std::string sections_;
};

/// `mesh` with at most about `most_triangles`: vertices merged in the cells of a grid that is as fine as that allows
/// (Rossignac and Borrel 1993).
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t most_triangles);

/// Every `factor`-th pixel of the part of an image that starts at (u, v), each the nearest depth of its block.
struct ReducedDepth {
  DepthImage depth;
  Intrinsics camera;
};
ReducedDepth reduced(const DepthImage& depth, const Intrinsics& camera, int u, int v, int width, int height,
                     int factor);

}  // namespace partpose
