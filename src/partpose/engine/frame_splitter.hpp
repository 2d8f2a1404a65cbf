// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/frame_pieces.hpp"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <vector>

namespace partpose {

/// How far a piece may exceed the largest part, for noise and for what sticks to it.
constexpr float size_margin = 1.25f;

/// Every n-th pixel of a frame, with its ray.
class CellGrid {
 public:
  CellGrid(const DepthImage& depth, const Intrinsics& camera);

  Eigen::Vector3f ray(int cell) const { return {ray_x[cell % width], ray_y[cell / width], 1}; }
  Eigen::Vector3f point(int cell) const { return z_mm[cell] * ray(cell); }
  /// Depths of neighbouring cells differ by less on one surface: up to about 70 degrees steep it holds together, and
  /// the jump from a part to what is behind it is larger.
  float jump_mm(float z) const { return 2 + limit_per_mm * z; }

  int stride, width, height;
  std::vector<float> z_mm, ray_x, ray_y;
  float limit_per_mm = 0;
};

using Cells = std::vector<int>;  ///< indices into a CellGrid, rising

struct CutPlane {
  FlatSurface plane;
  float cut_mm = 0;  ///< what lies nearer to it belongs to it
  float at_mm = 0;   ///< the distance from the camera that this is meant for: noise grows with its square
};

/// Heights over a surface along one row of an image, all of whose rays have the same y.
class RowHeights {
 public:
  RowHeights(const FlatSurface& surface, float ray_y)
      : along_x_(surface.q.x()),
        along_rest_(surface.q.y() * ray_y + surface.q.z()),
        per_norm_(1 / surface.q.norm()),
        bend_(surface.bend_along_x(ray_y)) {}
  float operator()(float ray_x, float z_mm) const {
    float bent = bend_.back();
    for (int i = FlatSurface::degree - 1; i >= 0; --i) bent = bent * ray_x + bend_[i];
    return (1 - z_mm * (along_x_ * ray_x + along_rest_)) * per_norm_ - bent;
  }
  /// Of several places, side by side.
  void operator()(const float* ray_x, const float* z_mm, float* out, int count) const {
    const RowHeights height = *this;  // which `out` is not a part of
#pragma omp simd
    for (int i = 0; i < count; ++i) out[i] = height(ray_x[i], z_mm[i]);
  }

 private:
  float along_x_, along_rest_, per_norm_;
  std::array<float, FlatSurface::degree + 1> bend_;
};

/// What may be single objects: groups of cells, largest first.
struct FrameSplit {
  struct Piece {
    Cells cells;
    CutPlane plane;  ///< that was taken away beside it
    bool larger_than_a_part = false;
  };
  std::vector<Piece> pieces;
  bool whole_frame = false;  ///< everything measured may be one part
  std::optional<CutPlane> table;
};
FrameSplit split_cells(const CellGrid& grid, const Intrinsics& camera, const FramePiecesOptions& options);

}  // namespace partpose
