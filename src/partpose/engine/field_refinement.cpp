// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/field_refinement.hpp"

#include "partpose/core/pose.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace partpose {

namespace {

using Matrix6f = Eigen::Matrix<float, 6, 6>;
using Vector6f = Eigen::Matrix<float, 6, 1>;

}  // namespace

FieldRefinement refine_on_field(const SurfaceField& field, const Eigen::Isometry3d& camera_from_model,
                                std::span<const Eigen::Vector3f> points_mm, const Eigen::Vector3f& centre_mm,
                                const FieldRefinementOptions& options) {
  FieldRefinement out;
  out.camera_from_model = camera_from_model;
  double scale_mm = options.start_scale_mm;
  for (int iteration = 0; iteration <= options.max_iterations; ++iteration) {
    const Eigen::Isometry3f model_from_camera = out.camera_from_model.inverse().cast<float>();
    const Eigen::Matrix3f rotation = out.camera_from_model.linear().cast<float>();
    const Eigen::Vector3f camera_mm = model_from_camera.translation();
    Matrix6f hessian = Matrix6f::Zero();
    Vector6f gradient = Vector6f::Zero();
    float weight_sum = 0, squared = 0, extent = 0;
    double capped = 0;
    const auto inverse_scale = static_cast<float>(1 / scale_mm);
    const auto cap_mm = static_cast<float>(3 * options.end_scale_mm);
    for (const auto& p : points_mm) {
      const Eigen::Vector3f q = model_from_camera * p;
      const auto nearest = field.nearest(q, camera_mm - q);
      capped += std::min(nearest.distance_mm, cap_mm);
      const float share = nearest.distance_mm * inverse_scale;
      const float root = 1 / (1 + share * share);
      const float w = root * root;
      // The distance, as the points move about their centre, grows along this direction.
      const Eigen::Vector3f direction = rotation * nearest.direction;
      const Eigen::Vector3f arm = p - centre_mm;
      Vector6f jacobian;
      jacobian << arm.cross(direction), direction;
      const Vector6f weighted = w * jacobian;
      hessian.noalias() += weighted * jacobian.transpose();
      gradient.noalias() += nearest.distance_mm * weighted;
      weight_sum += w;
      squared += w * nearest.distance_mm * nearest.distance_mm;
      extent += w * arm.squaredNorm();
    }
    out.mean_capped = capped / (options.end_scale_mm * static_cast<double>(std::max<std::size_t>(points_mm.size(), 1)));
    if (!(weight_sum > 0)) break;
    out.rms_mm = std::sqrt(squared / weight_sum);
    if (iteration == options.max_iterations) break;
    // What the surface leaves free hardly moves.
    const float radius = std::sqrt(std::max(extent / weight_sum, 1e-6f));
    hessian.diagonal().head<3>().array() += 1e-3f * weight_sum * radius * radius;
    hessian.diagonal().tail<3>().array() += 1e-3f * weight_sum;
    const Vector6f step = hessian.ldlt().solve(-gradient);
    if (!step.allFinite()) break;
    // The step moves the points onto the surface; the part moves the other way.
    const Eigen::Vector3d centre = centre_mm.cast<double>();
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = rotation_from_vector(-step.head<3>().cast<double>());
    motion.translation() = centre - step.tail<3>().cast<double>() - motion.linear() * centre;
    out.camera_from_model = motion * out.camera_from_model;
    const bool at_end = scale_mm <= options.end_scale_mm;
    if (at_end && step.head<3>().norm() * radius + step.tail<3>().norm() < options.converged_mm) break;
    scale_mm = std::max(options.end_scale_mm, 0.6 * scale_mm);
  }
  return out;
}

}  // namespace partpose
