// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"
#include "partpose/geometry/symmetries.hpp"

#include <optional>
#include <vector>

namespace partpose {

/// Symmetries and how exact each is: the largest distance between the surface and its moved copy, both ways, in mm.
struct MeasuredSymmetries {
  Symmetries symmetries;
  std::vector<double> discrete_deviation_mm;    ///< of each of symmetries.discrete
  std::vector<double> continuous_deviation_mm;  ///< of each axis: the largest over its turns

  /// The largest of them; 0 without any.
  double largest_deviation_mm() const;
};

struct SymmetrySearch {
  MeasuredSymmetries found;  ///< within the tolerance
  MeasuredSymmetries near;   ///< but for a detail: at most near_area_share of the surface is beyond the tolerance
  double tolerance_mm = 0;
  double diameter_mm = 0;

  static constexpr double near_area_share = 0.1;
};

/// 0.5 mm, or 0.5 % of the diameter if that is more: what a stereo camera can tell at best (docs/symmetry.md). Never
/// more than 2 % of the diameter.
double default_symmetry_tolerance_mm(double diameter_mm);

/// The rotations, no reflections, that put a part's surface back onto itself within a tolerance (none: the default), by
/// its surface alone: neither tessellation nor closedness matters, nor where its origin lies.
///
/// - Discrete ones: the whole group, without the identity, sorted by angle.
/// - A surface of revolution: its axis, plus one half turn about a line across it if that is a symmetry as well; all
///   others follow from the two. Facets count as round while they are within the tolerance.
/// - A sphere: three axes, as BOP's files list it. Their turns, not combined with each other, are a part of its
///   symmetries only.
///
/// A motion is taken where it fits the surface best in the least-squares sense (robustly, so that a detail does not
/// pull at it), and is then measured. Throws Error for a mesh without area or with non-finite vertices, and a tolerance
/// that is not positive.
SymmetrySearch search_symmetries(const TriangleMesh& mesh, std::optional<double> tolerance_mm = {});

/// Those within the tolerance.
inline Symmetries find_symmetries(const TriangleMesh& mesh, double tolerance_mm) {
  return search_symmetries(mesh, tolerance_mm).found.symmetries;
}

}  // namespace partpose
