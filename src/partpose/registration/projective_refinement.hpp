// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/registration/normal_equations.hpp"

#include <Eigen/Geometry>

#include <limits>

namespace partpose {

struct ProjectiveRefinementOptions {
  float gate_mm = 10;  ///< pixels whose depths differ by more do not count
  int max_iterations = 10;
  float converged_mm = 0.02f;  ///< an iteration that moves the part's surface by less is the last
  Faces faces = Faces::both;   ///< that are drawn
  double damping = 0;          ///< of each iteration's step, in pairs: what fewer pairs determine hardly moves
};

struct ProjectiveRefinement {
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  int pixels = 0;  ///< pairs in the last iteration; fewer than 20 say nothing, and nothing is moved
  double rms_mm = std::numeric_limits<double>::infinity();  ///< of their distances in depth; infinite without any
  /// Of the last iteration, about `centre_mm` (camera frame), in rotation vector [rad] and translation [mm]: the normal
  /// equations' matrix, each pair counted by its weight.
  Matrix6d hessian = Matrix6d::Zero();
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
};

/// Moves a part so that its rendered surface meets the measured depth: each iteration renders the part, pairs each
/// pixel's model point with the measured point of the same pixel (Blais and Levine 1995) and solves the point-to-plane
/// objective (Chen and Medioni 1992) about the pairs' centre, with Tukey weights on the scale of the residuals seen.
/// The distances are divided by the cosine of incidence: what errs is the depth, by the same at any slant.
ProjectiveRefinement refine_projectively(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                         const DepthImage& depth, const Intrinsics& camera,
                                         const ProjectiveRefinementOptions& options);

}  // namespace partpose
