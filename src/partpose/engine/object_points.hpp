// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/frame_pieces.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace partpose {

/// Points of the object, camera frame, at most about `wanted` of them: each is the mean over a block of pixels that are
/// near each other in depth. Pixels that the object may have grown over are left out where enough others are left.
/// `block_px`: the blocks' width.
struct ObjectPoints {
  std::vector<Eigen::Vector3f> points_mm;
  int block_px = 1;
};
ObjectPoints object_points(const FramePieces& frame, const FrameObject& object, int wanted);

/// Standard deviation of the depths' noise, in mm, as neighbouring pixels of the object show it: the median over
/// windows of 5 x 5 pixels (3 x 3 where none of these is full) of the deviation from the plane that fits best. Slow
/// waves are not seen. 0 when no window is full.
double local_noise_mm(const FramePieces& frame, const FrameObject& object);

/// How much the noise of a pixel's depth is that of its neighbours in the row and column, -1 to 1: the median over
/// windows of 7 x 7 pixels of the correlation of what a plane leaves, 0 where that is nothing. None when fewer than
/// three are full.
std::optional<double> neighbour_correlation(const FramePieces& frame, const FrameObject& object);

}  // namespace partpose
