// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>

namespace partpose {

/// What a part looks like from one side in 16 x 16 cells of a fixed size in mm, seen along the line of sight through
/// the centroid of what is visible: 8-bit depth relative to that centroid. Row by row.
struct DepthTemplate {
  static constexpr int side = 16;
  static constexpr int cells = side * side;
  static constexpr std::uint8_t background = 255;
  static constexpr std::uint8_t nearest = 1, middle = 108, farthest = 215;

  alignas(32) std::array<std::uint8_t, cells> cell;
};

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

/// Sum over the cells of the absolute difference, none counted for more than `cap`.
int capped_difference(const DepthTemplate& a, const DepthTemplate& b, int cap);

}  // namespace partpose
