// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/projective_refinement.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/pose.hpp"

#include <algorithm>
#include <cmath>

namespace partpose {

namespace {

struct PixelPair {
  Eigen::Vector3d model;
  Eigen::Vector3d normal;
  double residual = 0;  ///< how far the model point lies before the measured point, along the normal
};

std::vector<PixelPair> pair_pixels(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                   const DepthImage& depth, const Intrinsics& camera, float gate_mm) {
  const Rendering rendering = render(mesh, camera_from_model, camera);
  std::vector<PixelPair> pairs;
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const float model_z = rendering.depth.at(u, v), measured_z = depth.at(u, v);
      if (!(model_z > 0) || !(measured_z > 0) || std::abs(model_z - measured_z) > gate_mm) continue;
      const int triangle = rendering.triangle[static_cast<std::size_t>(v) * depth.width + u];
      PixelPair pair;
      pair.normal = camera_from_model.linear() * mesh.face_normal(triangle).cast<double>();
      pair.model = camera.unproject(u, v, model_z).cast<double>();
      pair.residual = pair.normal.dot(pair.model - camera.unproject(u, v, measured_z).cast<double>());
      pairs.push_back(pair);
    }
  }
  return pairs;
}

double median_of_absolute_residuals(const std::vector<PixelPair>& pairs) {
  std::vector<double> absolute;
  for (const auto& pair : pairs) absolute.push_back(std::abs(pair.residual));
  const auto middle = absolute.begin() + static_cast<std::ptrdiff_t>(absolute.size() / 2);
  std::nth_element(absolute.begin(), middle, absolute.end());
  return *middle;
}

}  // namespace

ProjectiveRefinement refine_projectively(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                         const DepthImage& depth, const Intrinsics& camera,
                                         const ProjectiveRefinementOptions& options) {
  ProjectiveRefinement out;
  out.camera_from_model = camera_from_model;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const auto pairs = pair_pixels(mesh, out.camera_from_model, depth, camera, options.gate_mm);
    out.pixels = static_cast<int>(pairs.size());
    if (pairs.size() < 20) break;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto& pair : pairs) centre += pair.model;
    centre /= static_cast<double>(pairs.size());

    // 1.4826 times the median is the standard deviation of normal noise; 4.685 deviations are Tukey's limit.
    const double limit = 4.685 * std::max(1.4826 * median_of_absolute_residuals(pairs), 0.05);
    NormalEquations equations;
    double squared = 0;
    for (const auto& pair : pairs) {
      const double share = pair.residual / limit;
      if (std::abs(share) >= 1) continue;
      const double weight = (1 - share * share) * (1 - share * share);
      const Eigen::Vector3d arm = pair.model - centre;
      equations.add(arm, pair.normal, pair.residual, weight, arm.squaredNorm());
      squared += weight * pair.residual * pair.residual;
    }
    if (!(equations.weight > 0)) break;
    out.rms_mm = std::sqrt(squared / equations.weight);
    out.hessian = equations.hessian;
    out.centre_mm = centre;
    const Vector6d solution = equations.solve();
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
    step.linear() = rotation_from_vector(solution.head<3>());
    step.translation() = centre + solution.tail<3>() - step.linear() * centre;
    out.camera_from_model = step * out.camera_from_model;
    const double extent = std::sqrt(equations.squared_extent_mm2 / equations.weight);
    if (solution.head<3>().norm() * extent + solution.tail<3>().norm() < options.converged_mm) break;
  }
  return out;
}

}  // namespace partpose
