// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"
#include "partpose/engine/depth_template.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace partpose {

/// Views of a part about places on its surface, in place of its middle: of a part that is partly hidden, or that
/// touches another, the middle is not known, but some place on it is.
struct AnchoredViews {
  static constexpr int per_view = 12;

  struct Anchor {
    /// Model frame to sight frame: origin in the place, z along the line of sight through it.
    Eigen::Isometry3f sight_from_model = Eigen::Isometry3f::Identity();
    std::int16_t view = 0;
    CellSet surface = 0;  ///< of its template
  };
  std::vector<Anchor> anchors;
  std::vector<SmallTemplate> templates;  ///< about each anchor

  /// Adds those of one view: what is seen, in the camera's frame, `spacing_mm` between neighbouring points.
  void add(int view, const PointCloud& seen, const Eigen::Isometry3d& camera_from_model, double spacing_mm,
           const TemplateScale& scale);
};

/// `count` of the points, or fewer, spread over them and away from their edges: those nearest to the means of groups of
/// about one size (Lloyd 1982). Indices into `points`.
std::vector<int> spread_places(std::span<const Eigen::Vector3f> points, int count);

/// The mean of the points within `reach_mm` of a place.
Eigen::Vector3d local_mean(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& place, double reach_mm);

/// How much of a model's template a scene's explains, less what speaks against it, in steps of depth summed over the
/// cells where the model has a surface: `cap` where the two agree, down to 0 where the scene is nearer (something else
/// may hide the part there), down to -`cap` where it is farther or background (the part cannot be there). 0 where the
/// scene is unknown.
int explained_steps(const SmallTemplate& model, const SmallTemplate& scene, int cap);

/// A scene's template such that what a model's surface gains is `cap` less two capped differences.
struct SceneCells {
  SceneCells() = default;
  SceneCells(const SmallTemplate& scene, int cap);
  alignas(32) std::array<std::uint8_t, SmallTemplate::cells> lower;  ///< farther than the model's by so much
  alignas(32) std::array<std::uint8_t, SmallTemplate::cells> upper;  ///< nearer by so much, `cap` added; 0: unknown
};

/// By how many cells of its surface a model is explained at most, whatever its depths, in full steps of `cap`: it has
/// `surface` of them, `seen` where the scene has a surface as well, and as many as possible of the others fall on the
/// scene's `unknown` cells, where nothing speaks against it.
inline int most_explained_cells(int surface, int seen, int unknown) {
  return seen - std::max(surface - seen - unknown, 0);
}

/// explained_steps() of several scenes; `cap` at most 40. Those whose bit in `wanted` is 0 may be left out.
void explained_steps(const SmallTemplate& model, std::span<const SceneCells> scenes, std::uint32_t wanted, int cap,
                     std::int16_t* out);

}  // namespace partpose
