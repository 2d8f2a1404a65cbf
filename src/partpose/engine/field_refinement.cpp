// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/field_refinement.hpp"

#include "partpose/core/pose.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

namespace partpose {

namespace {

constexpr int lanes = Lanes::count;

/// Where points are in the model frame, and from there seen from their centre.
struct PlacedGroup {
  Lanes x, y, z, arm_x, arm_y, arm_z;
};

PlacedGroup placed(const ProbePoints::Group& group, const Eigen::Matrix3f& turn, const Eigen::Vector3f& centre) {
  PlacedGroup out;
  for (int i = 0; i < lanes; ++i) {
    const float px = group.x_mm.value[i], py = group.y_mm.value[i], pz = group.z_mm.value[i];
    out.arm_x.value[i] = turn(0, 0) * px + turn(0, 1) * py + turn(0, 2) * pz;
    out.arm_y.value[i] = turn(1, 0) * px + turn(1, 1) * py + turn(1, 2) * pz;
    out.arm_z.value[i] = turn(2, 0) * px + turn(2, 1) * py + turn(2, 2) * pz;
    out.x.value[i] = out.arm_x.value[i] + centre.x();
    out.y.value[i] = out.arm_y.value[i] + centre.y();
    out.z.value[i] = out.arm_z.value[i] + centre.z();
  }
  return out;
}

/// The turn about a direction and the two moves across it, as columns of rotation and translation.
Eigen::Matrix<float, 6, 3> moves_on_table(const Eigen::Vector3f& upright) {
  Eigen::Matrix<float, 6, 3> moves = Eigen::Matrix<float, 6, 3>::Zero();
  moves.block<3, 1>(0, 0) = upright;
  moves.block<3, 1>(3, 1) = upright.unitOrthogonal();
  moves.block<3, 1>(3, 2) = upright.cross(moves.block<3, 1>(3, 1));
  return moves;
}

}  // namespace

ProbePoints::ProbePoints(std::span<const Eigen::Vector3f> points_mm) : size_(points_mm.size()) {
  for (const auto& p : points_mm) centre_mm_ += p.cast<double>();
  centre_mm_ /= static_cast<double>(std::max<std::size_t>(size_, 1));
  groups_.resize((size_ + lanes - 1) / lanes, Group{});
  for (std::size_t i = 0; i < size_; ++i) {
    Group& group = groups_[i / lanes];
    const Eigen::Vector3f relative = (points_mm[i].cast<double>() - centre_mm_).cast<float>();
    group.x_mm.value[i % lanes] = relative.x();
    group.y_mm.value[i % lanes] = relative.y();
    group.z_mm.value[i % lanes] = relative.z();
    group.weight.value[i % lanes] = 1;
  }
}

double mean_distance_mm(const SurfaceField& field, const Eigen::Isometry3d& camera_from_model,
                        const ProbePoints& points, double cap_mm) {
  const Eigen::Isometry3d model_from_camera = camera_from_model.inverse();
  const Eigen::Matrix3f turn = model_from_camera.linear().cast<float>();
  const Eigen::Vector3f centre = (model_from_camera * points.centre_mm()).cast<float>();
  Lanes sum{};
  for (const auto& group : points.groups()) {
    const PlacedGroup at = placed(group, turn, centre);
    const Lanes distance_mm = field.at(at.x, at.y, at.z).distance_mm;
    for (int i = 0; i < lanes; ++i)
      sum.value[i] += group.weight.value[i] * std::min(std::abs(distance_mm.value[i]), static_cast<float>(cap_mm));
  }
  return sum.sum() / static_cast<double>(std::max<std::size_t>(points.size(), 1));
}

FieldRefinement refine_on_field(const SurfaceField& field, const Eigen::Isometry3d& camera_from_model,
                                const ProbePoints& points, const FieldRefinementOptions& options) {
  FieldRefinement out;
  out.camera_from_model = camera_from_model;
  if (points.size() == 0) return out;
  const auto cap_mm = static_cast<float>(3 * options.end_scale_mm);
  double scale_mm = options.start_scale_mm;
  int iteration = 0;
  for (; iteration < options.max_iterations; ++iteration) {
    // In the model frame the surface stands still and the points move about their centre.
    const Eigen::Isometry3d model_from_camera = out.camera_from_model.inverse();
    const Eigen::Matrix3f turn = model_from_camera.linear().cast<float>();
    const Eigen::Vector3f centre = (model_from_camera * points.centre_mm()).cast<float>();
    const auto per_scale = static_cast<float>(1 / scale_mm);
    RowProducts<float> products;
    Lanes capped{}, weights{}, extent{};
    for (const auto& group : points.groups()) {
      const auto [x, y, z, arm_x, arm_y, arm_z] = placed(group, turn, centre);
      const auto sample = field.at(x, y, z);
      std::array<Lanes, RowProducts<float>::entries> row;
      Lanes weight;
      for (int i = 0; i < lanes; ++i) {
        const float distance = sample.distance_mm.value[i];
        const float gx = sample.gradient_x.value[i], gy = sample.gradient_y.value[i], gz = sample.gradient_z.value[i];
        const float share = distance * per_scale;
        const float root = 1 / (1 + share * share);
        weight.value[i] = group.weight.value[i] * root * root;
        row[0].value[i] = arm_y.value[i] * gz - arm_z.value[i] * gy;
        row[1].value[i] = arm_z.value[i] * gx - arm_x.value[i] * gz;
        row[2].value[i] = arm_x.value[i] * gy - arm_y.value[i] * gx;
        row[3].value[i] = gx;
        row[4].value[i] = gy;
        row[5].value[i] = gz;
        row[6].value[i] = distance;
        capped.value[i] += group.weight.value[i] * std::min(std::abs(distance), cap_mm);
        weights.value[i] += weight.value[i];
        extent.value[i] += weight.value[i] * (arm_x.value[i] * arm_x.value[i] + arm_y.value[i] * arm_y.value[i] +
                                              arm_z.value[i] * arm_z.value[i]);
      }
      products.add(row, weight);
    }
    out.mean_capped = capped.sum() / (options.end_scale_mm * static_cast<double>(points.size()));
    const float weight_sum = weights.sum();
    if (!(weight_sum > 0)) break;
    const auto total = products.total();

    // What the surface leaves free hardly moves.
    Eigen::Matrix<float, 6, 6> hessian = total.topLeftCorner<6, 6>();
    const float radius = std::sqrt(std::max(extent.sum() / weight_sum, 1e-6f));
    hessian.diagonal().head<3>().array() += 1e-3f * weight_sum * radius * radius;
    hessian.diagonal().tail<3>().array() += 1e-3f * weight_sum;
    const Eigen::Matrix<float, 6, 1> gradient = total.col(6).head<6>();
    Eigen::Matrix<float, 6, 1> step;
    if (options.upright) {
      const Eigen::Matrix<float, 6, 3> free = moves_on_table(turn * options.upright->cast<float>());
      step = -free * (free.transpose() * hessian * free).llt().solve(free.transpose() * gradient);
    } else {
      step = -hessian.llt().solve(gradient);
    }
    if (!step.allFinite()) break;
    // The step moves the points onto the surface; the part moves the other way.
    Eigen::Isometry3d points_motion = Eigen::Isometry3d::Identity();
    points_motion.linear() = rotation_from_vector(step.head<3>().cast<double>());
    points_motion.translation() =
        centre.cast<double>() + step.tail<3>().cast<double>() - points_motion.linear() * centre.cast<double>();
    out.camera_from_model = out.camera_from_model * points_motion.inverse();
    const bool at_end = scale_mm <= options.end_scale_mm;
    if (at_end && step.head<3>().norm() * radius + step.tail<3>().norm() < options.converged_mm) break;
    scale_mm = std::max(options.end_scale_mm, 0.6 * scale_mm);
  }
  if (options.rate_end && iteration == options.max_iterations)
    out.mean_capped = mean_distance_mm(field, out.camera_from_model, points, cap_mm) / options.end_scale_mm;
  return out;
}

}  // namespace partpose
