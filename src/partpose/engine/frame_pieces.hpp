// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/engine/comparison.hpp"

#include <Eigen/Core>

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <vector>

namespace partpose {

struct FramePiecesOptions {
  float largest_part_mm = 300;  ///< diameter of the largest part that may be seen
  float smallest_part_mm = 10;  ///< diameter of the smallest
  int min_pixels = 60;          ///< a piece with fewer says nothing
  int most_pieces = 16;         ///< in a cluttered frame the largest are kept
  int most_pairs = 4;           ///< of pieces that nearly touch
};

/// Pixels that may be one object: some of the frame's pieces, or all that was measured.
struct FrameObject {
  std::bitset<256> labels;               ///< of the pixels that belong to it
  bool whole_frame = false;              ///< everything measured, as if there were no table
  bool larger_than_a_part = false;       ///< parts that touch, or none
  int u0 = 0, v0 = 0, u1 = -1, v1 = -1;  ///< the box of its pixels, both ends included
  int pixels = 0;
};

/// A table, a wall or a floor as a camera sees it: a plane by its inverse depths, 1 / z = q . (x / z, y / z, 1), in
/// which a stereo camera's noise is the same everywhere, and how the camera bends it: a polynomial over the image.
struct FlatSurface {
  static constexpr int degree = 4;
  static constexpr int terms = (degree + 1) * (degree + 2) / 2;

  Eigen::Vector3f q = Eigen::Vector3f::Zero();
  std::array<float, terms> bend_mm{};  ///< of x^i y^j, (x, y, 1) being the ray: i + j <= degree, by rising j, then i
  float rms_mm = 0;                    ///< of the heights of what lies on it

  /// The polynomial at one y, by its powers of x.
  std::array<float, degree + 1> bend_along_x(float ray_y) const;
  /// The polynomial at one place.
  float bend_mm_at(float ray_x, float ray_y) const {
    float bent = 0;
    for (int j = degree, k = terms; j >= 0; --j) {
      float along_x = 0;
      for (int i = degree - j; i >= 0; --i) along_x = along_x * ray_x + bend_mm[--k];
      bent = bent * ray_y + along_x;
    }
    return bent;
  }
  /// No less than its bend anywhere in the camera's image.
  float most_bend_mm(const Intrinsics& camera) const;
  /// How far a point lies on the camera's side; `ray` is the point over its z.
  float height_mm(const Eigen::Vector3f& ray, float z_mm) const;
};

/// A frame with what may be single objects in it. The depth image must outlive it.
struct FramePieces {
  const DepthImage* depth = nullptr;
  Intrinsics camera;
  /// Of each pixel, row by row: 0: not measured; 1: background; else a piece.
  std::vector<std::uint8_t> label;
  int measured_pixels = 0;
  std::vector<FrameObject> objects;  ///< largest first
  std::optional<FlatSurface> table;  ///< the dominant plane, where there is one
  /// So far what is in front grows over what is behind it. A stereo camera matches windows, which make neighbouring
  /// depths err together and the foreground wider by about half of one; where neighbours err each for itself, nothing
  /// was matched, and outlines are what they are.
  double foreground_growth_px = 0;
  /// Of each pixel that is not measured since something nearer beside it hides it from one of a stereo camera's
  /// imagers: the pixel of that; -1 elsewhere. Empty: not looked for (find_shadows).
  std::vector<std::int32_t> shadow_of;

  static constexpr double baseline_mm = 55;  ///< between a stereo camera's imagers, about

  /// From such a jump in depth on: a disparity of 0.75 px.
  double edge_mm(double z_mm) const { return z_mm * z_mm * 0.75 / (camera.fx * baseline_mm); }

  static constexpr std::uint8_t not_measured = 0, background = 1, first_piece = 2;
};

/// Takes the dominant plane (table, wall) away, splits what is left where depth jumps, and drops what is too large or
/// too small for any part; in a piece that is too large another plane is looked for. Where the whole frame is no larger
/// than a part, it is an object too: the frame may show a part without a table. Pieces that nearly touch are objects
/// together as well, two of them or all: a part may hide its own middle. Works on every second pixel (or n-th: about
/// 80,000) and tells the others by them.
FramePieces split_frame(const DepthImage& depth, const Intrinsics& camera, const FramePiecesOptions& options);

/// Whether a pixel that belongs to no piece shows the table, or what is behind it; `pixel`: row by row.
bool is_on_table(const FramePieces& frame, std::int32_t pixel);

/// Fills `shadow_of`. What hides a pixel from one imager may hide it from the other as well: there a part may be
/// hidden.
void find_shadows(FramePieces& frame);

/// Every `stride`-th pixel of the box [u0, u1] x [v0, v1], which may reach beyond the frame: nothing is known there.
FrameWindow window(const FramePieces& frame, const FrameObject& object, int u0, int v0, int u1, int v1, int stride);

}  // namespace partpose
