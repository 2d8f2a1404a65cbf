// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace partpose {

/// What a stereo depth camera does to the ideal depth; docs/sensor.md has the formulas. The defaults resemble an Intel
/// RealSense D415. The left imager is the reference: depth images are in its frame, the right one is `baseline_mm`
/// along +x. 0 switches a disturbance off.
struct StereoSensorOptions {
  double baseline_mm = 55;
  double disparity_noise_px = 0.08;
  double correlation_px = 8;
  double white_share = 0.05;
  double frozen_share = 0;
  double subpixel_wave_px = 0.04;
  double static_pattern_percent = 1;
  std::uint64_t pattern_seed = 1;
  int smoothing_px = 3;
  double fattening_px = 3;
  double fattening_jitter_px = 1;
  double edge_jump_px = 0.75;
  double mixed_pixel_probability = 0.15;
  int edge_loss_px = 4;
  double edge_loss_probability = 0.35;
  double hole_share = 0;
  std::array<double, 2> grazing_drop_deg = {76, 86};
  bool invalid_band = true;
  bool occlusion_shadow = true;
  double max_disparity_px = 126;
  double disparity_step_px = 0.03125;
  double depth_step_mm = 1;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("baseline_mm", self.baseline_mm, "distance between left and right imager [mm], > 0");
    visit("disparity_noise_px", self.disparity_noise_px, "standard deviation of the disparity's noise [px], >= 0");
    visit("correlation_px", self.correlation_px,
          "distance over which the noise's correlation falls to 1/e [px], 0 to 64");
    visit("white_share", self.white_share, "share of the noise's variance that is new at each pixel, 0 to 1");
    visit("frozen_share", self.frozen_share, "share of the correlated variance that is the same in each frame, 0 to 1");
    visit("subpixel_wave_px", self.subpixel_wave_px,
          "amplitude of the error that repeats with each pixel of disparity [px]");
    visit("static_pattern_percent", self.static_pattern_percent,
          "the unit's slow depth error over the image, peak to peak [% of the depth], 0 to 20");
    visit("pattern_seed", self.pattern_seed, "the unit: which static pattern and frozen noise it has");
    visit("smoothing_px", self.smoothing_px,
          "half the width of the matching window that averages a surface [px], 0 to 16");
    visit("fattening_px", self.fattening_px, "how far a foreground grows over its background [px], 0 to 16");
    visit("fattening_jitter_px", self.fattening_jitter_px, "standard deviation of that along an edge [px], 0 to 4");
    visit("edge_jump_px", self.edge_jump_px, "a larger disparity difference of neighbours is an edge [px], > 0");
    visit("mixed_pixel_probability", self.mixed_pixel_probability,
          "that a pixel beside an edge lies between foreground and background, 0 to 1");
    visit("edge_loss_px", self.edge_loss_px,
          "width of the band of background beside an edge that may be missing [px], 0 to 16");
    visit("edge_loss_probability", self.edge_loss_probability,
          "that a pixel of this band is missing (in patches), 0 to 1");
    visit("hole_share", self.hole_share, "share of all pixels missing for want of texture, 0 to 1");
    visit("grazing_drop_deg", self.grazing_drop_deg,
          "angles between line of sight and surface normal from which pixels begin to be, and all are, missing [deg]");
    visit("invalid_band", self.invalid_band, "no depth at the left, where the right imager does not look");
    visit("occlusion_shadow", self.occlusion_shadow,
          "no depth where a foreground hides the surface from the right imager");
    visit("max_disparity_px", self.max_disparity_px, "nearer surfaces are missing [px], > 0");
    visit("disparity_step_px", self.disparity_step_px, "the disparity's quantisation [px], >= 0");
    visit("depth_step_mm", self.depth_step_mm, "the depth's quantisation [mm], >= 0");
  }
  void check() const;
};

struct StereoCapture {
  DepthImage depth;                ///< measured, mm, 0: missing
  std::vector<int> surface_pixel;  ///< the pixel of the ideal image whose surface was measured, row by row, -1: missing
};

/// The measured depth of what the left and the right imager would ideally see (0: nothing there, infinitely far).
/// Without a right image (empty) there is no occlusion shadow. The same seed gives the same bits, for any number of
/// threads; a pixel's noise does not depend on what else is seen. Throws Error when the sizes differ from the camera's.
StereoCapture stereo_capture(const DepthImage& left, const DepthImage& right, const Intrinsics& camera,
                             const StereoSensorOptions& options, std::uint64_t seed);

/// Draws the scene's ideal depth from a camera at `camera_from_left`.
using DepthRenderer = std::function<DepthImage(const Eigen::Isometry3d& camera_from_left)>;

/// Of a scene that `render` draws from both imagers.
StereoCapture stereo_capture(const DepthRenderer& render, const Intrinsics& camera, const StereoSensorOptions& options,
                             std::uint64_t seed);

/// Moves the left imager's coordinates to the right one's.
Eigen::Isometry3d right_from_left(const StereoSensorOptions& options);

/// Standard deviation of the depth (mm) on a surface at `z_mm` that noise, waves and quantisation together make:
/// z^2 sqrt(noise^2 + wave^2/2 + step^2/12) / (fx baseline), and depth_step^2/12 beside it. The static pattern is not
/// in it.
double predicted_depth_noise_mm(const StereoSensorOptions& options, const Intrinsics& camera, double z_mm);

/// The unit's static pattern as relative depth error (0.01: one per cent too far), row by row.
std::vector<float> static_pattern(int width, int height, const StereoSensorOptions& options);

}  // namespace partpose
