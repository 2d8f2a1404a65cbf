// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

/// How far an estimated pose is from the true one, by the definitions of the BOP benchmark (Hodan et al., BOP Challenge
/// 2020 on 6D Object Localization, section 2.2; bop_toolkit, pose_error.py), to the last digits. Poses are
/// camera_from_model, lengths mm. Rotations may be rounded (not exactly orthonormal): nothing here transposes to
/// invert. Rotation and translation error (equations 2.2 and 2.3) are in core/pose.hpp.
namespace partpose {

/// ADD: mean distance of each vertex at one pose from itself at the other (Hinterstoisser et al. 2012). Throws Error,
/// as all below, without vertices.
double add_mm(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
              const Eigen::Isometry3d& truth);

/// ADI (ADD-S): mean distance of each vertex at the true pose from the nearest one at the estimated pose.
double adi_mm(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
              const Eigen::Isometry3d& truth);

/// AD: ADI of an object with symmetries, or else ADD.
double ad_mm(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
             const Eigen::Isometry3d& truth, bool symmetric);

/// MSSD: the largest distance of a vertex from itself, at the nearest of the true pose's equivalents. `symmetries`
/// (model_from_model, see symmetry_transformations) holds the identity at least.
double mssd_mm(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
               const Eigen::Isometry3d& truth, std::span<const Eigen::Isometry3d> symmetries);

/// MSPD: the same with distances in the image of a camera matrix (which may have skew), in px. Vertices behind the
/// camera are projected like all others.
double mspd_px(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
               const Eigen::Isometry3d& truth, std::span<const Eigen::Isometry3d> symmetries, const Eigen::Matrix3d& K);

/// The mean distance of the vertices' projections in px, symmetry ignored.
double projection_error_px(std::span<const Eigen::Vector3f> vertices, const Eigen::Isometry3d& estimate,
                           const Eigen::Isometry3d& truth, const Eigen::Matrix3d& K);

/// Distances from the camera's centre, in mm, row by row; 0: none.
struct DistanceImage {
  int width = 0;
  int height = 0;
  std::vector<double> mm;
};

/// Depth along the optical axis made distance along each pixel's ray.
DistanceImage distance_image(const DepthImage& depth, const Eigen::Matrix3d& K);

struct VsdOptions {
  double delta_mm = 15;                ///< a surface this far behind what was measured is still visible
  bool normalized_by_diameter = true;  ///< the taus are fractions of the diameter, or else mm
};

/// VSD with its pixel counts.
struct VisibleSurface {
  std::vector<double> vsd;  ///< for each tau, 0 to 1
  int visible_gt = 0;       ///< px where the object in the true pose is visible
  int visible_estimate = 0;
  int intersection_px = 0;
  int union_px = 0;
};

/// VSD, cost "step": of the pixels where the object is visible in either pose, the share of those where it is visible
/// in one only or where the two surfaces are `tau` or more apart. A rendered surface is visible where nothing was
/// measured or what was measured is no more than delta before it; that comparison is of 32-bit floats, as in the
/// toolkit. 1 where nothing is visible. Throws Error when the images differ in size.
VisibleSurface visible_surface_discrepancy(const DistanceImage& measured, const DistanceImage& estimate,
                                           const DistanceImage& truth, double diameter_mm, std::span<const double> taus,
                                           const VsdOptions& options = {});

// The toolkit's evaluation, not its error functions, takes a pose that is far off for infinitely wrong:

/// Whether two balls of the object's diameter, about the models' origins, overlap. Where they do not, ADD, ADI, AD and
/// MSSD count as infinite.
bool spheres_overlap(const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth, double diameter_mm);

/// Whether the (approximate) projections of these balls overlap. Where they do not, VSD counts as 1.
bool sphere_projections_overlap(const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth, double diameter_mm);

/// 0.05, 0.10, ..., 0.50 to the bit as numpy.arange(0.05, 0.51, 0.05) has them: the thresholds of MSSD (fractions of
/// the diameter) and VSD, and the taus.
std::span<const double> bop_fractions();
/// 5, 10, ..., 50: the thresholds of MSPD in px of an image 640 px wide.
std::span<const double> bop_pixels();
/// The factor from px of an image to px of one 640 px wide.
double bop_pixel_factor(int image_width);

}  // namespace partpose
