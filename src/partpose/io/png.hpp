// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace partpose {

/// Red, green, blue from 0 to 255, row by row.
struct ColourImage {
  int width = 0;
  int height = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;
};

/// A 16-bit greyscale PNG whose values are units of `depth_scale_mm` mm; 0 is no value. Sides up to 65536 px, 2^28
/// pixels. Error, naming the file and the byte, when it is no PNG, of another kind, truncated or corrupted, and when
/// the scale is not positive.
DepthImage read_depth_png(const std::filesystem::path& path, double depth_scale_mm);

/// Whether a file is a PNG of another kind than depth images: 8-bit or in colours. By its header alone; false for what
/// is no PNG.
bool is_picture_png(const std::filesystem::path& path);

/// Depth rounded to the nearest unit of `depth_scale_mm` mm: less than half a unit becomes 0, no value. Error when a
/// depth is negative, not finite or more than 65535 units, when the image's size or the scale is wrong, or the file
/// cannot be written.
void write_depth_png(const std::filesystem::path& path, const DepthImage& depth, double depth_scale_mm);

/// An 8-bit RGB, RGBA, greyscale (also of 1, 2 or 4 bits, or with alpha) or palette PNG; alpha is dropped. Errors as
/// above.
ColourImage read_png(const std::filesystem::path& path);

/// 8-bit RGB. Error when the image's size is wrong, or the file cannot be written.
void write_png(const std::filesystem::path& path, const ColourImage& image);

}  // namespace partpose
