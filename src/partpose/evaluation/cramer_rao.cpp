// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/cramer_rao.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <limits>

namespace partpose {

double PoseBound::rotation_deg() const { return degrees(std::sqrt(covariance.topLeftCorner<3, 3>().trace())); }

double PoseBound::translation_mm() const { return std::sqrt(covariance.bottomRightCorner<3, 3>().trace()); }

PoseBound pose_bound(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& camera,
                     double sigma_mm) {
  if (!(sigma_mm > 0)) throw Error("pose_bound: sigma {} mm: must be positive", sigma_mm);
  const Rendering seen = render(mesh, camera_from_model, camera);
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  const Eigen::Vector3d centre = camera_from_model * box.center();
  std::vector<Eigen::Vector3d> normals;  // camera frame; zero for a triangle without area
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Eigen::Vector3d cross =
        (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a);
    normals.push_back(camera_from_model.linear() * cross.stableNormalized());
  }

  PoseBound bound;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const int triangle = seen.triangle[static_cast<std::size_t>(v) * camera.width + u];
      if (triangle < 0) continue;
      const Eigen::Vector3d p = camera.unproject(u, v, seen.depth.at(u, v)).cast<double>();
      const Eigen::Vector3d& n = normals[triangle];
      const double incidence = n.dot(p.normalized());
      constexpr double on_edge = 1e-4;
      if (std::abs(incidence) < on_edge) continue;
      Eigen::Matrix<double, 6, 1> J;
      J << (p - centre).cross(n), n;
      J /= incidence * sigma_mm;
      bound.information.noalias() += J * J.transpose();
      ++bound.pixels;
    }

  // Turns as lengths at the part's radius, so that the six directions compare.
  const double radius_mm = 0.5 * box.diagonal().norm();
  bound.weakest_mm = std::numeric_limits<double>::infinity();
  if (bound.pixels == 0 || !(radius_mm > 0)) return bound;
  Eigen::Matrix<double, 6, 1> scale;
  scale << Eigen::Vector3d::Constant(1 / radius_mm), Eigen::Vector3d::Ones();
  const Eigen::Matrix<double, 6, 6> in_mm = scale.asDiagonal() * bound.information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(in_mm);
  const double least = solver.eigenvalues()[0], most = solver.eigenvalues()[5];
  if (least > 1e-12 * most) bound.weakest_mm = 1 / std::sqrt(least);
  bound.determined = bound.weakest_mm < centre.z() / camera.fx;
  if (bound.determined) {
    const Eigen::Matrix<double, 6, 6> inverse =
        solver.eigenvectors() * solver.eigenvalues().cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
    bound.covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  }
  return bound;
}

}  // namespace partpose
