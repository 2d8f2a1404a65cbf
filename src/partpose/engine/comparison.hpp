// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/registration/row_products.hpp"
#include "partpose/verification/render_compare.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace partpose {

/// What a sensor does to the depth of a part, for the comparison of a rendering with a frame.
struct SensorModel {
  double noise_mm = 1;    ///< standard deviation of a depth
  double outlier = 0.05;  ///< share of pixels that say nothing about the surface
  double hole = 0.15;     ///< share of the part's pixels without a depth
  double hidden = 0.7;    ///< share of the part's pixels where something else is before it
  int outline_px = 1;     ///< so far an object's outline may be off, in pixels of the comparison
  double growth_px = 0;   ///< so far what is in front grows over what is behind it, in pixels of the comparison: half
                          ///< of the window that was matched, which averages surfaces as well
  double waves_px = 0;    ///< depths so near to one another err together, in pixels of the comparison; 0: not asked
  double edge_mm = 10;    ///< from such a jump in depth on
  double size_mm = 100;   ///< the depths in question: where nothing is known, a depth is anywhere in it
};

/// The neighbourhood of an object in a frame, and the table there.
struct FrameWindow : LabelledDepth {
  std::vector<float> before_table_mm;  ///< how far each depth lies before the table; empty: there is no table

  static constexpr float not_table_mm = 1e6f;  ///< of a pixel that belongs to an object
};

/// Fine shape: what depths differ by from their mean within some pixels. Sums over the pixels that a part explains, in
/// squared deviations of the noise.
struct FineShape {
  int pixels = 0;
  double measured = 0, part = 0, common = 0;  ///< of the one, of the other, of their product

  double correlation() const;
  /// So much of the part's fine shape is measured, 1: all. Shape that is far finer than the noise is none.
  double gain() const;
};

/// A rendering against a frame, pixel by pixel, in both directions. Next to an outline (`SensorModel::outline_px`) a
/// camera may add to an object and take from it: such pixels say little.
struct DepthComparison {
  int model = 0;                   ///< pixels where the part is rendered
  int explained = 0;               ///< of them: measured there within three deviations, or at a neighbour
  int free_space = 0;              ///< of them: before what was measured; the part cannot be there
  int below_table = 0;             ///< of them: beneath the table that was measured there; the part cannot be there
  int hidden = 0;                  ///< of them: behind something else that was measured
  int nothing = 0;                 ///< of them: nothing was measured
  int model_outline = 0;           ///< of them: not the object's, but next to it
  int narrower = 0;                ///< of those: something else is measured there
  int object = 0;                  ///< pixels of the object
  int unexplained = 0;             ///< of them: no part is rendered there within three deviations, nor at a neighbour
  int object_outline = 0;          ///< of them: not the part's, but next to it
  int near = 0;                    ///< pixels of both whose depths are at once within six deviations
  double near_deviations = 0;      ///< sum of their squares, in deviations
  double local_deviations = 0;     ///< sum of squares over the pixels that are explained at once, each at most nine:
                                   ///< from the mean within `waves_px`, in which a camera's slow waves are
  FineShape fine_shape;            ///< only with `waves_px`
  int jumps = 0;                   ///< pixels of both beside a jump in depth of one of them, only with `waves_px`
  int common_jumps = 0;            ///< of them: the other has one there too
  double log_likelihood = 0;       ///< sum over the pixels; 0: what a surface of unknown shape would have
  double best_log_likelihood = 0;  ///< of a rendering that meets every object pixel exactly
  double soft = 0;                 ///< sum of the agreement of both directions, each pixel 0 to 1
  double judged = 0;               ///< the most that this could be; what is hidden is not judged

  /// Pixels where the part shows, as far as anything was measured.
  int shown() const { return model - hidden - nothing - below_table; }
  double score() const { return judged > 0 ? soft / judged : 0; }  ///< 1: the two explain each other wholly
};

/// Depths with a margin around them, infinite where there is none: so that neighbours are looked at without asking
/// where the image ends.
class PaddedDepth {
 public:
  PaddedDepth(int width, int height, int reach);

  float* row(int v) { return &z_mm_[static_cast<std::size_t>(v + reach_) * row_length_ + reach_]; }
  const float* row(int v) const { return &z_mm_[static_cast<std::size_t>(v + reach_) * row_length_ + reach_]; }
  /// To the pixels within `reach` of one; infinite when none of them has a depth.
  float smallest_difference(float z_mm, int u, int v) const;

 private:
  using Lanes = NumberLanes<float>;

  int reach_, row_length_;
  std::vector<float> z_mm_;
  std::vector<Lanes> beyond_;  ///< of each lane of a row: infinite where it is out of reach, else 0
};

/// Compares parts at poses with one window of a frame, which must outlive it.
class DepthComparer {
 public:
  DepthComparer(const FrameWindow& frame, const SensorModel& sensor);

  /// `covered`: pixels of the window outside of which the part is not seen at this pose. `faces`: that are drawn.
  DepthComparison operator()(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                             const Eigen::AlignedBox2d& covered, Faces faces = Faces::both) const;

 private:
  /// Log-density of a depth's difference against the hypothesis that a depth is anywhere within the part's size.
  float log_density(float difference_mm) const {
    return log_density_[static_cast<int>(std::min(difference_mm * steps_per_mm_, static_cast<float>(entries)))];
  }
  /// In the box of this size at (u0, v0), `part` being seen there.
  void count_jumps(const PaddedDepth& part, int u0, int v0, int width, int height, DepthComparison& out) const;
  static constexpr int steps = 32, entries = 6 * steps;  // beyond six deviations it is an outlier

  const FrameWindow& frame_;
  SensorModel sensor_;
  PaddedDepth object_;                     ///< its depths alone
  std::vector<std::uint8_t> near_object_;  ///< of each pixel: whether the object is within the outline's width of it
  Eigen::AlignedBox2i object_box_;
  float steps_per_mm_;
  std::array<float, entries + 1> log_density_;
};

}  // namespace partpose
