// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/stereo_sensor.hpp"
#include "partpose/core/depth_image.hpp"
#include "partpose/core/progress.hpp"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace partpose {

struct SensorFitOptions {
  double baseline_mm = 0;                       ///< of the camera that captured the wall; must be given
  std::array<int, 4> region_px = {0, 0, 0, 0};  ///< left, top, width, height of the wall; all 0: the whole image
  double depth_unit_mm = 0;  ///< length of one unit of the depth images; 0: unknown, the depth step is not looked for
  double plane_percent = 2;  ///< pixels farther from the plane than this share of the distance are no wall [%]
};

/// What captures of a flat wall tell about a stereo depth camera.
struct StereoSensorFit {
  int frames = 0;
  int pixels = 0;              ///< on the wall, of the first frame
  double distance_mm = 0;      ///< median depth of the wall
  double mm_per_px = 0;        ///< depth for each pixel of disparity at that distance
  double tilt_deg = 0;         ///< between the optical axis and the wall's normal
  double fill_rate = 0;        ///< measured pixels of all in the region
  double plane_rms_mm = 0;     ///< RealSense's depth quality tool, plane fit RMS
  double subpixel_rms_px = 0;  ///< RealSense's depth quality tool, sub-pixel RMS
  double disparity_noise_px = 0;
  double correlation_px = 0;
  double white_share = 0;
  double static_pattern_percent = 0;
  std::optional<double> subpixel_wave_px;   ///< none when the wall's disparity does not pass through enough pixels
  std::optional<double> disparity_step_px;  ///< none when noise or the depth's step hides it
  std::optional<double> depth_step_mm;      ///< none when the unit is not known
  std::optional<double> temporal_noise_px;  ///< of one pixel from frame to frame; none for a single frame
  std::optional<double> temporal_noise_mm;  ///< the same at the wall's distance
  std::optional<double> frozen_share;       ///< none for a single frame
  std::vector<std::string> notes;           ///< what could not be told from these frames, and how to
  StereoSensorOptions stereo;               ///< the model with these figures; what a wall cannot tell keeps its default

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("frames", self.frames, "captures of the wall");
    visit("pixels", self.pixels, "pixels on the wall");
    visit("distance_mm", self.distance_mm, "median depth of the wall [mm]");
    visit("mm_per_px", self.mm_per_px, "depth for each pixel of disparity there [mm]");
    visit("tilt_deg", self.tilt_deg, "between the optical axis and the wall's normal [deg]");
    visit("fill_rate", self.fill_rate, "measured pixels of all in the region");
    visit("plane_rms_mm", self.plane_rms_mm, "RMS distance to the plane [mm]");
    visit("subpixel_rms_px", self.subpixel_rms_px, "the same as disparity [px]");
    visit("disparity_noise_px", self.disparity_noise_px,
          "standard deviation without pattern, waves and quantisation [px]");
    visit("correlation_px", self.correlation_px, "distance over which its correlation falls to 1/e [px]");
    visit("white_share", self.white_share, "share of its variance that is new at each pixel");
    visit("static_pattern_percent", self.static_pattern_percent, "slow error, peak to peak [% of the depth]");
    visit("subpixel_wave_px", self.subpixel_wave_px, "amplitude of the waves [px]");
    visit("disparity_step_px", self.disparity_step_px, "the disparity's quantisation [px]");
    visit("depth_step_mm", self.depth_step_mm, "the depth's quantisation [mm]");
    visit("temporal_noise_px", self.temporal_noise_px, "of one pixel from frame to frame [px]");
    visit("temporal_noise_mm", self.temporal_noise_mm, "of one pixel from frame to frame [mm]");
    visit("frozen_share", self.frozen_share, "share of the correlated variance that is the same in each frame");
    visit("notes", self.notes, "what could not be told, and how to");
    visit("stereo", self.stereo, "for the key \"stereo\" of the noise");
  }
};

/// Estimates the noise figures from one or several depth images of one flat wall that fills the picture (or
/// `region_px`). The camera must not have moved between them. Throws Error when there is no baseline, fewer than 2,000
/// measured pixels, or no plane that four fifths of them lie on.
StereoSensorFit fit_stereo_sensor(std::span<const DepthImage> frames, const Intrinsics& camera,
                                  const SensorFitOptions& options, const Progress& progress = {});

}  // namespace partpose
