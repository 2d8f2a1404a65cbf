// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/verification/render_compare.hpp"

#include <Eigen/Geometry>

namespace partpose {

/// What a sensor does to the depth of a part, for the comparison of a rendering with a frame.
struct SensorModel {
  double noise_mm = 1;    ///< standard deviation of a depth
  double outlier = 0.05;  ///< share of pixels that say nothing about the surface
  double hole = 0.2;      ///< share of the part's pixels without a depth
  double hidden = 0.05;   ///< share of the part's pixels where something else is before it
  double size_mm = 100;   ///< the depths in question: where nothing is known, a depth is anywhere in it
};

/// A rendering against a frame, pixel by pixel, in both directions.
struct DepthComparison {
  int model = 0;                   ///< pixels where the part is rendered
  int explained = 0;               ///< of them: measured there within three deviations, or at a neighbour
  int free_space = 0;              ///< of them: before what was measured; the part cannot be there
  int hidden = 0;                  ///< of them: behind what was measured, which is no part of the object
  int nothing = 0;                 ///< of them: nothing was measured
  int object = 0;                  ///< pixels of the object
  int unexplained = 0;             ///< of them: no part is rendered there within three deviations, nor at a neighbour
  double log_likelihood = 0;       ///< sum over the pixels; 0: what a surface of unknown shape would have
  double best_log_likelihood = 0;  ///< of a rendering that meets every object pixel exactly
  double score() const;            ///< 1: the part explains all of the object and the object all of the part
  double soft = 0;                 ///< sum of the agreement of both directions, each pixel 0 to 1
};

DepthComparison compare_depth(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                              const LabelledDepth& frame, const SensorModel& sensor);

}  // namespace partpose
