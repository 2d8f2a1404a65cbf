// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/hypothesis.hpp"

#include <bitset>
#include <cstdint>
#include <span>
#include <vector>

namespace partpose {

/// Stereo matching makes outlines wider by half its window.
constexpr int outline_px = 3;

/// The pixels of these labels as one object.
FrameObject object_of(const FramePieces& frame, const std::bitset<256>& labels);

/// A window about a part at its pose: every `stride`-th pixel from (u0, v0).
struct PartWindow {
  FrameWindow frame;
  int u0, v0, stride;
};
/// The pixels that the part covers, about `wanted` of them (0: all), and `margin_px` around its box. `rest`: the
/// object.
PartWindow part_window(const FramePieces& frame, const FrameObject& rest, const PartModel& model,
                       const Eigen::Isometry3d& camera_from_model, int wanted, int margin_px);

/// A rendering's surface where it would go on beyond its outline, straight on: as it is at the outline, and as it is
/// within a rounded or chamfered edge. The inverse depth of a plane is linear in the image.
struct BeyondOutline {
  DepthImage depth, within_edge;   ///< 0 where it does not reach
  std::vector<std::uint8_t> step;  ///< pixels from the outline
};
/// Up to `reach_px` of the frame's pixels beyond. `stride`: of the rendering's pixels, in the frame's.
BeyondOutline beyond_outline(const DepthImage& rendered, int reach_px, int stride);

/// Of each pixel whether something is rendered within `reach` of it: along the rows, then across them.
std::vector<std::uint8_t> near_rendered(const DepthImage& rendered, int reach);

/// Indices of the pixels of these labels that the part at its pose explains.
std::vector<std::size_t> explained_pixels(const PartModel& model, const Eigen::Isometry3d& camera_from_model,
                                          const FramePieces& frame, const std::bitset<256>& labels, double noise_mm);

/// The pixels of the largest connected piece of these labels that the hypothesis, if any, leaves unexplained; what is
/// no wider than an outline does not count.
int largest_left_px(const FramePieces& frame, const std::bitset<256>& labels, const Hypothesis* explained,
                    std::span<const PartModel* const> models, double noise_mm);

}  // namespace partpose
