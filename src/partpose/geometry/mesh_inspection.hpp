// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

/// What a person should know before trusting a mesh, and the repairs that lose nothing.
namespace partpose {

/// Vertices with equal coordinates count as one. Edges and shells are counted without the triangles that are removed
/// by repair: those with two equal corners, and copies.
struct MeshInspection {
  int triangles = 0;
  int vertices = 0;  ///< used by triangles, different ones
  std::array<double, 3> size_mm{};
  double diagonal_mm = 0;
  double area_mm2 = 0;
  std::optional<double> volume_mm3;
  bool watertight = false;
  int open_edges = 0;
  int non_manifold_edges = 0;
  int shells = 0;
  int degenerate_triangles = 0;
  int duplicate_triangles = 0;
  int flipped_triangles = 0;
  std::string unit_guess;

  /// Nothing that repair or a person should look at; size aside.
  bool sound() const {
    return watertight && degenerate_triangles == 0 && duplicate_triangles == 0 && flipped_triangles == 0;
  }

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("triangles", self.triangles, "of the file, all kinds");
    visit("vertices", self.vertices, "different ones that triangles use");
    visit("size_mm", self.size_mm, "of the bounding box along x, y, z [mm]");
    visit("diagonal_mm", self.diagonal_mm, "of the bounding box [mm]");
    visit("area_mm2", self.area_mm2, "of all triangles [mm^2]");
    visit("volume_mm3", self.volume_mm3, "enclosed [mm^3]; of watertight meshes without flipped triangles only");
    visit("watertight", self.watertight, "every edge belongs to an even number of triangles, at least two");
    visit("open_edges", self.open_edges, "edges of one triangle, or of an odd number: the surface has a gap there");
    visit("non_manifold_edges", self.non_manifold_edges, "edges of more than two triangles: sheets that meet");
    visit("shells", self.shells, "pieces of surface that no edge connects");
    visit("degenerate_triangles", self.degenerate_triangles, "triangles without area");
    visit("duplicate_triangles", self.duplicate_triangles, "triangles that are there already, wound either way");
    visit("flipped_triangles", self.flipped_triangles, "triangles that face inwards: repair turns so many");
    visit("unit_guess", self.unit_guess,
          "\"metre\" or \"inch\" when the size is that of a common part in this unit, \"micrometre\" when it is huge; "
          "else empty");
  }
};

/// Throws Error for a mesh without triangles, a corner that is no vertex, and coordinates that are not finite.
MeshInspection inspect_mesh(const TriangleMesh& mesh);

/// In which unit a part of this diagonal (its number taken as mm) more likely is: "metre" below 2, "inch" up to 12,
/// "micrometre" above 5000, else nothing. Depth cameras see parts from about 12 mm to some metres.
std::string guess_unit(double diagonal_mm);

/// One of guess_unit's in mm; 1 for any other text.
double mm_per_unit(const std::string& unit);

struct MeshRepair {
  TriangleMesh mesh;
  double weld_distance_mm = 0;
  int welded_vertices = 0;     ///< that lay within weld_distance_mm of another one
  int removed_degenerate = 0;  ///< triangles with two equal corners, and others without area beside a gap
  int removed_duplicates = 0;
  int turned_triangles = 0;

  bool changed_anything() const {
    return welded_vertices > 0 || removed_degenerate > 0 || removed_duplicates > 0 || turned_triangles > 0;
  }
};

/// Welds vertices where that closes gaps, removes triangles that say nothing, and turns the surface outwards: shell by
/// shell, neighbours alike; then a closed shell by its signed volume (a cavity within another shell keeps facing
/// inwards), an open one by its flux from the middle. The shape stays. Errors as above, and when no triangle is left.
/// @param weld_distance_mm  none: 1e-6 of the diagonal; used only if it lessens the number of open edges
MeshRepair repair_mesh(const TriangleMesh& mesh, std::optional<double> weld_distance_mm = {});

}  // namespace partpose
