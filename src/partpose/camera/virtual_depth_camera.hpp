// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/stereo_sensor.hpp"
#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace partpose {

struct NoiseOptions {
  std::string model = "none";
  float standard_deviation_mm = 0;
  std::optional<StereoSensorOptions> stereo = std::nullopt;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("model", self.model,
          "\"none\", \"gaussian\" (independent in x, y and z), \"gaussianray\" (along the line of sight) or \"stereo\" "
          "(a stereo "
          "camera's errors)");
    visit("standard_deviation_mm", self.standard_deviation_mm,
          "standard deviation of the noise of \"gaussian\" and \"gaussianray\" [mm], >= 0");
    visit("stereo", self.stereo, "the sensor of \"stereo\"; without it a D415");
  }
  void check() const;
};

/// The defaults resemble an Intel RealSense D415 at 640x480.
struct VirtualDepthCameraOptions {
  std::array<double, 2> field_of_view_deg = {50.0, 40.0};
  NoiseOptions noise;
  std::array<int, 2> resolution_px = {640, 480};
  std::string normals = "mesh";
  float normal_estimation_radius_mm = 9;
  std::uint64_t noise_seed = 1;
  std::optional<bool> organized_output;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("field_of_view_deg", self.field_of_view_deg, "horizontal and vertical field of view [deg], 0 to 180");
    visit("noise", self.noise, "what is added to the depth");
    visit("resolution_px", self.resolution_px, "horizontal and vertical resolution [px]");
    visit("normals", self.normals, "\"mesh\" (of the triangle seen) or \"estimated\" (from the captured points)");
    visit("normal_estimation_radius_mm", self.normal_estimation_radius_mm,
          "radius for \"estimated\" normals [mm], > 0");
    visit("noise_seed", self.noise_seed, "the same seed gives the same noise");
    visit("organized_output", self.organized_output, "the same as the key of this name one level up");
  }
  void check() const;
  Intrinsics intrinsics() const;
};

/// Pose of a camera at `position` (mm) that looks at `target`, its x axis in the xy plane of the base frame, its y axis
/// down (towards -z of the base where the line of sight leaves a choice).
Eigen::Isometry3d look_at(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& target_mm);

/// One frame of a mesh: the visible points in the camera frame with unit normals, with noise. `frame` selects the
/// noise: each frame of a camera has its own. Organized clouds have NaN where nothing is seen. With the noise model
/// "stereo" the points are those of the measured depth image, and a "mesh" normal is that of the surface which was
/// measured there.
PointCloud capture(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                   const VirtualDepthCameraOptions& options, bool organized, std::uint64_t frame = 0);

}  // namespace partpose
