// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

namespace partpose {

/// What a pixel of a frame shows.
enum class PixelLabel : std::uint8_t {
  nothing,     ///< no depth was measured
  object,      ///< the segment under examination
  background,  ///< the table, or another object
};

/// The neighbourhood of one segment in a frame: what a rendering is compared with.
struct LabelledDepth {
  Intrinsics camera;  ///< of this cutting
  DepthImage depth;
  std::vector<PixelLabel> label;  ///< row by row
};

struct RenderCompareOptions {
  float tolerance_mm = 4;      ///< a difference of so much in depth explains nothing any more
  float nothing_cost = 0.6f;   ///< of a pixel where the part should be and nothing was measured: holes are common
  float hidden_cost = 0.2f;    ///< of a pixel where the part would be behind the background: it may be, but who knows
};

/// Counts of pixels, in both directions. The cost of a pixel goes from 0 (depths agree) to 1 (they differ by the tolerance
/// or more); a pixel may agree with any of its eight neighbours too, since a stereo camera fattens edges.
struct RenderComparison {
  int model = 0;         ///< pixels where the part is rendered
  int free_space = 0;    ///< of them: before a background that was seen; the part cannot be there
  int hidden = 0;        ///< of them: behind or at the background
  int nothing = 0;       ///< of them: nothing was measured
  int object = 0;        ///< pixels of the object
  int unexplained = 0;   ///< of them: no part is rendered at or beside them
  double cost = 0;       ///< sum over both directions

  /// 1: the part explains all of the object and the object all of the part; 0: nothing in common.
  double score() const;
};

/// Renders the part at a pose and compares its depth with what was measured, in both directions.
RenderComparison render_and_compare(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                    const LabelledDepth& frame, const RenderCompareOptions& options);

}  // namespace partpose
