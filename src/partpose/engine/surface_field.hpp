// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"
#include "partpose/registration/row_products.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace partpose {

using Lanes = NumberLanes<float>;

/// The signed distance to a part's surface in and around it, tabulated: negative inside where the mesh is closed and
/// wound outwards. Between the nodes of the grid it is interpolated in all three directions, so that distances near a
/// flat face are exact and walls need only be thicker than a cell to keep both sides; a thinner wall attracts points
/// to its middle, to half a cell. Immutable and thread-safe.
class SurfaceField {
 public:
  struct Sample {
    float distance_mm = 0;
    Eigen::Vector3f gradient = Eigen::Vector3f::Zero();  ///< of the interpolated distance; up to about 1 long
  };
  struct Samples {
    Lanes distance_mm, gradient_x, gradient_y, gradient_z;
  };

  /// The grid's cells are as small as `most_nodes` allow. Throws Error when the mesh has no triangle with an area.
  explicit SurfaceField(const TriangleMesh& mesh, int most_nodes = 250'000);

  /// At places in the model frame. Outside the grid, which reaches a tenth of the part's length around it, distances
  /// are those to the surface from the grid's edge and the way to there.
  Samples at(const Lanes& x_mm, const Lanes& y_mm, const Lanes& z_mm) const;
  Sample at(const Eigen::Vector3f& place_mm) const;

  float cell_mm() const { return cell_mm_; }
  std::size_t memory_bytes() const { return distance_.size() * sizeof(distance_[0]); }

 private:
  Eigen::Vector3f low_;
  float cell_mm_ = 1;
  float unit_mm_ = 1;  ///< of the tabulated distances
  Eigen::Vector3i size_;
  std::vector<std::int16_t> distance_;
};

}  // namespace partpose
