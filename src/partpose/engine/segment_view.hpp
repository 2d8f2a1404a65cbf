// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/preprocess/segmentation.hpp"
#include "partpose/verification/render_compare.hpp"

#include <Eigen/Core>

#include <vector>

namespace partpose {

/// The neighbourhood of a segment, `margin_mm` around it, every n-th pixel of the frame so that about `wanted_pixels`
/// are the object's.
LabelledDepth neighbourhood(const DepthImage& depth, const Intrinsics& camera, const Segment& segment, double margin_mm,
                            int wanted_pixels);

/// The segments, and besides them what two that nearly touch in the image make together while it is no larger than
/// `largest_mm`: a part may hide its own middle. At most `most` pairs, the largest first.
std::vector<Segment> with_pairs(std::vector<Segment> segments, const DepthImage& depth, const Intrinsics& camera,
                                double largest_mm, int most);

/// The points of the object's pixels, camera frame.
std::vector<Eigen::Vector3f> object_points(const LabelledDepth& frame);

/// Standard deviation of the depths' noise, in mm, as neighbouring pixels of the segment show it: the median over
/// windows of 5 x 5 pixels of the deviation from the plane that fits best. Slow waves are not seen. 0 when no window is
/// full.
double local_noise_mm(const DepthImage& depth, const Segment& segment);

/// The part of a frame that covers the pixels [u0, u1] x [v0, v1], cut to the frame.
LabelledDepth cropped(const LabelledDepth& frame, int u0, int v0, int u1, int v1);

}  // namespace partpose
