// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"

#include <optional>
#include <string>
#include <vector>

namespace partpose {

struct SegmentationOptions {
  float largest_part_mm = 300;  ///< diameter of the largest part that may be seen
  float smallest_part_mm = 10;  ///< diameter of the smallest
  int min_pixels = 60;          ///< a segment with fewer says nothing
  int most_segments = 16;       ///< in a cluttered frame the largest are kept
};

/// Pixels (v * width + u) that may be one object, in rising order.
struct Segment {
  std::vector<int> pixels;
  bool whole_frame = false;  ///< everything measured, as if there were no table
};

/// The angular distance of neighbouring points of a cloud taken from the origin, in rad: the pixel of a camera that
/// would see about one point in each. Nothing when fewer than two directions are seen.
std::optional<double> angular_spacing_rad(const PointCloud& cloud);

/// The camera that a cloud was taken with, where its points still lie on the lines of sight through the pixels of one:
/// clouds of depth cameras and of simulations do. Nothing for others. Not necessarily of the same size: it just covers
/// the cloud.
std::optional<Intrinsics> pixel_grid_of(const PointCloud& cloud, int margin_px = 2);

/// The camera whose image a cloud taken from the origin fills without holes, pixels somewhat wider than the points'
/// spacing (and at most about 2000 a side); nothing when the cloud shows fewer than two directions. All points must lie
/// before the camera (`before_camera`).
std::optional<Intrinsics> intrinsics_of(const PointCloud& cloud, int margin_px = 2);

/// What may be single objects in a frame. Large planes (table, wall) are taken away, what is left is split where depth
/// jumps, and what is too large or too small for any part is dropped. Where the whole frame is no larger than a part,
/// it is a segment too: the frame may show a part without a table. Largest first.
std::vector<Segment> segment(const DepthImage& depth, const Intrinsics& camera, const SegmentationOptions& options);

/// For people: nothing of a frame may be an object, perhaps since it is empty or in another unit.
std::string why_nothing_stands_out(const DepthImage& depth);

/// For people, of a frame in which nothing was recognized: "; it is nearer or farther than ...: is it in another
/// unit?", or empty.
std::string hint_of_unit(const DepthImage& depth);
/// The same of points' distances along z in mm; those that are not positive do not count.
std::string hint_of_unit(std::vector<float> z_mm);

/// How many of the four neighbours of a measured pixel are measured, on average: 1 where there are no holes.
double share_of_neighbours(const DepthImage& depth);

/// For people, of a cloud in which nothing was recognized, put into a camera's pixels: "; it seems to be thinned ...",
/// or empty where few of them are empty.
std::string hint_of_thinning(const DepthImage& cloud_in_pixels);

}  // namespace partpose
