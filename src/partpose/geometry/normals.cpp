// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/normals.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/geometry/point_grid.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <limits>

namespace partpose {

namespace {

/// Count, sums and sums of products of the offsets from the query, over the neighbours within the radius.
struct Moments {
  float n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  void add(const PointGrid& grid, PointGrid::Range range, const Eigen::Vector3f& query, float squared_radius) {
    const float* px = grid.x().data();
    const float* py = grid.y().data();
    const float* pz = grid.z().data();
    const float qx = query.x(), qy = query.y(), qz = query.z();
    float sn = 0, sx = 0, sy = 0, sz = 0, sxx = 0, sxy = 0, sxz = 0, syy = 0, syz = 0, szz = 0;
#pragma omp simd reduction(+ : sn, sx, sy, sz, sxx, sxy, sxz, syy, syz, szz)
    for (int i = range.begin; i < range.end; ++i) {
      const float dx = px[i] - qx, dy = py[i] - qy, dz = pz[i] - qz;
      const float w = dx * dx + dy * dy + dz * dz <= squared_radius ? 1.f : 0.f;
      const float wx = w * dx, wy = w * dy, wz = w * dz;
      sn += w;
      sx += wx;
      sy += wy;
      sz += wz;
      sxx += wx * dx;
      sxy += wx * dy;
      sxz += wx * dz;
      syy += wy * dy;
      syz += wy * dz;
      szz += wz * dz;
    }
    n += sn, x += sx, y += sy, z += sz;
    xx += sxx, xy += sxy, xz += sxz, yy += syy, yz += syz, zz += szz;
  }

  Eigen::Matrix3d covariance() const {
    const double count = n;
    const Eigen::Vector3d mean = Eigen::Vector3d(x, y, z) / count;
    Eigen::Matrix3d c;
    c << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return c / count - mean * mean.transpose();
  }
};

}  // namespace

void estimate_normals(PointCloud& cloud, float radius_mm, const Eigen::Vector3f& viewpoint_mm) {
  if (!(radius_mm > 0)) throw Error("normal estimation: radius {} mm must be positive", radius_mm);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  cloud.normals.assign(cloud.size(), Eigen::Vector3f::Constant(nan));
  cloud.curvatures.assign(cloud.size(), nan);
  const PointGrid grid(cloud.points, radius_mm);

  parallel_for(grid.cell_count(), [&](std::size_t c) {
    const auto ranges = grid.neighbourhood(c);
    const auto cell = grid.cell(c);
    for (int s = cell.begin; s < cell.end; ++s) {
      const int i = grid.original(s);
      const Eigen::Vector3f& point = cloud.points[i];
      Moments moments;
      for (const auto range : ranges) moments.add(grid, range, point, radius_mm * radius_mm);
      if (moments.n < 3) continue;
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
      solver.computeDirect(moments.covariance());
      const Eigen::Vector3d values = solver.eigenvalues().cwiseMax(0.0);
      // On a line (or in one place), to the precision of float sums, there is no direction of least variance.
      if (!(values[1] > 1e-5 * values[2])) continue;
      Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
      if (normal.dot(viewpoint_mm - point) < 0) normal = -normal;
      cloud.normals[i] = normal;
      cloud.curvatures[i] = static_cast<float>(values[0] / values.sum());
    }
  }, 8);
}

}  // namespace partpose
