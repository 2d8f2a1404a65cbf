// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/projective_refinement.hpp"

#include "partpose/core/pose.hpp"
#include "partpose/registration/row_products.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace partpose {

namespace {

using Lanes = NumberLanes<double>;

/// Model points and the measured points of the same pixels, camera frame.
struct PixelPairs {
  struct Group {
    Lanes x_mm, y_mm, z_mm;                    ///< of the model
    Lanes normal_x, normal_y, normal_z;        ///< there, over the cosine of incidence
    Lanes residual_mm = {1e9, 1e9, 1e9, 1e9};  ///< how far it lies before the measured point, along the line of sight
  };
  std::size_t size = 0;
  std::vector<Group> groups;
  Eigen::Vector3d sum_mm = Eigen::Vector3d::Zero();  ///< of the model points

  /// Of the residuals' absolute values. Of many some tell.
  double median_residual_mm() const {
    constexpr std::size_t enough = 500;
    const std::size_t step = std::max<std::size_t>(1, size / enough);
    std::vector<double> some;
    some.reserve(size / step + 1);
    for (std::size_t i = 0; i < size; i += step)
      some.push_back(std::abs(groups[i / Lanes::count].residual_mm.value[i % Lanes::count]));
    const auto middle = some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2);
    std::nth_element(some.begin(), middle, some.end());
    return *middle;
  }
};

PixelPairs pair_pixels(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const DepthImage& depth,
                       const Intrinsics& camera, const ProjectiveRefinementOptions& options, bool along_sight) {
  const Rendering rendering = render(mesh, camera_from_model, camera, options.faces);
  const std::vector<float>&model_z = rendering.depth.z_mm, &measured_z = depth.z_mm;
  PixelPairs pairs;
  std::vector<int> pixels(measured_z.size());
  for (std::size_t p = 0; p < pixels.size(); ++p) {  // without branches: they would be taken at random
    pixels[pairs.size] = static_cast<int>(p);
    pairs.size += static_cast<std::size_t>((model_z[p] > 0) & (measured_z[p] > 0) &
                                           (std::abs(model_z[p] - measured_z[p]) <= options.gate_mm));
  }
  pairs.groups.resize((pairs.size + Lanes::count - 1) / Lanes::count);
  const double per_fx = 1 / camera.fx, per_fy = 1 / camera.fy;
  int seen = -1, v = 0;
  Eigen::Vector3d normal;  // of the triangle seen
  for (std::size_t i = 0; i < pairs.size; ++i) {
    const int p = pixels[i];
    while (p >= (v + 1) * depth.width) ++v;
    const int u = p - v * depth.width;
    if (rendering.triangle[p] != seen) {
      seen = rendering.triangle[p];
      normal = camera_from_model.linear() * mesh.face_normal(seen).cast<double>();
    }
    const double z_mm = model_z[p];
    const Eigen::Vector3d ray((u - camera.cx) * per_fx, (v - camera.cy) * per_fy, 1), point_mm = z_mm * ray;
    // The noise is that of the depth, the same at any slant: as far as the slant itself is known.
    constexpr double least_incidence = 0.2;
    const double incidence = normal.dot(ray);
    const double factor = along_sight ? 1 / std::max(std::abs(incidence), least_incidence) : 1;
    PixelPairs::Group& group = pairs.groups[i / Lanes::count];
    const std::size_t lane = i % Lanes::count;
    group.x_mm.value[lane] = point_mm.x(), group.y_mm.value[lane] = point_mm.y(), group.z_mm.value[lane] = z_mm;
    group.normal_x.value[lane] = factor * normal.x();
    group.normal_y.value[lane] = factor * normal.y();
    group.normal_z.value[lane] = factor * normal.z();
    group.residual_mm.value[lane] = factor * (z_mm - measured_z[p]) * incidence;
    pairs.sum_mm += point_mm;
  }
  return pairs;
}

NormalEquations normal_equations(const PixelPairs& pairs, const Eigen::Vector3d& centre_mm, double limit_mm,
                                 double& squared) {
  RowProducts<double> products;
  Lanes weights{}, extent{};
  const double per_limit = 1 / limit_mm;
  for (const auto& group : pairs.groups) {
    std::array<Lanes, RowProducts<double>::entries> row;
    Lanes weight;
    for (int i = 0; i < Lanes::count; ++i) {
      const double residual = group.residual_mm.value[i];
      const double share = residual * per_limit, inside = std::max(1 - share * share, 0.0);
      weight.value[i] = inside * inside;
      const double x = group.x_mm.value[i] - centre_mm.x(), y = group.y_mm.value[i] - centre_mm.y();
      const double z = group.z_mm.value[i] - centre_mm.z();
      const double nx = group.normal_x.value[i], ny = group.normal_y.value[i], nz = group.normal_z.value[i];
      row[0].value[i] = y * nz - z * ny;
      row[1].value[i] = z * nx - x * nz;
      row[2].value[i] = x * ny - y * nx;
      row[3].value[i] = nx;
      row[4].value[i] = ny;
      row[5].value[i] = nz;
      row[6].value[i] = residual;
      weights.value[i] += weight.value[i];
      extent.value[i] += weight.value[i] * (x * x + y * y + z * z);
    }
    products.add(row, weight);
  }
  const auto total = products.total();
  NormalEquations out;
  out.hessian = total.topLeftCorner<6, 6>();
  out.gradient = total.col(6).head<6>();
  out.squared_extent_mm2 = extent.sum();
  out.weight = weights.sum();
  squared = total(6, 6);
  return out;
}

}  // namespace

ProjectiveRefinement refine_projectively(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                         const DepthImage& depth, const Intrinsics& camera,
                                         const ProjectiveRefinementOptions& options) {
  ProjectiveRefinement out;
  out.camera_from_model = camera_from_model;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    // Far from the end what lies at a slant is far away along the line of sight, and would pass for outliers.
    const bool along_sight = iteration > 0;
    const PixelPairs pairs = pair_pixels(mesh, out.camera_from_model, depth, camera, options, along_sight);
    out.pixels = static_cast<int>(pairs.size);
    if (pairs.size < 20) break;
    const Eigen::Vector3d centre = pairs.sum_mm / static_cast<double>(pairs.size);
    // 1.4826 times the median is the standard deviation of normal noise; 4.685 deviations are Tukey's limit.
    const double limit = 4.685 * std::max(1.4826 * pairs.median_residual_mm(), 0.05);
    double squared = 0;
    const NormalEquations equations = normal_equations(pairs, centre, limit, squared);
    if (!(equations.weight > 0)) break;
    out.rms_mm = std::sqrt(squared / equations.weight);
    out.hessian = equations.hessian;
    out.centre_mm = centre;
    const Vector6d solution = equations.solve(options.damping);
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
