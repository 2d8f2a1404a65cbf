// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>

namespace partpose {

/// What a part looks like from one side in side x side cells of a fixed size in mm, seen along the line of sight
/// through the centroid of what is visible: 8-bit depth relative to that centroid. Row by row.
template <int side_cells>
struct CellDepths {
  static constexpr int side = side_cells;
  static constexpr int cells = side * side;
  static constexpr std::uint8_t background = 255;
  static constexpr std::uint8_t unknown = 254;  ///< something else may hide what is there; agrees with anything
  static constexpr std::uint8_t nearest = 1, middle = 108, farthest = 215;

  alignas(32) std::array<std::uint8_t, cells> cell;
};
using DepthTemplate = CellDepths<16>;
using SmallTemplate = CellDepths<8>;  ///< the same with cells twice as wide, for a first look

/// How the cells of templates are sized for parts of about one size.
struct TemplateScale {
  double cell_mm = 0;
  double depth_unit_mm = 0;  ///< of one step of the 8 bits
  int cap = 0;               ///< a difference of so many steps, or against the background, is as bad as any
};

/// For a part of that diameter; the same for all parts whose diameters round to the same half octave.
TemplateScale template_scale(double diameter_mm);

/// The template of points given relative to their centroid, z along the line of sight, turned by `roll_rad` about it.
/// `point_spacing_mm`: between neighbouring points where the surface faces the camera.
DepthTemplate make_template(std::span<const Eigen::Vector3f> points_mm, double roll_rad, double point_spacing_mm,
                            const TemplateScale& scale);

/// The same turned by 90 degrees more about the line of sight.
template <int side>
CellDepths<side> quarter_turned(const CellDepths<side>& cells) {
  CellDepths<side> out;
  for (int v = 0; v < side; ++v)
    for (int u = 0; u < side; ++u) out.cell[u * side + side - 1 - v] = cells.cell[v * side + u];
  return out;
}

/// A cell is the mean of the four that it covers; background where most of them are, unknown where half of them are.
SmallTemplate halved(const DepthTemplate& full);

/// Cells of a SmallTemplate: one bit each.
using CellSet = std::uint64_t;
CellSet cells_with_surface(const SmallTemplate& cells);

/// Sum over the cells of the absolute difference, none counted for more than `cap`; none where `b` is unknown.
template <int side>
int capped_difference(const CellDepths<side>& a, const CellDepths<side>& b, int cap);

}  // namespace partpose
