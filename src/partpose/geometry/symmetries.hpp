// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <vector>

namespace partpose {

/// The rigid motions of a part, in its model frame (mm), that map its shape onto itself: the symmetries of a BOP
/// models_info.json.
struct Symmetries {
  /// All turns about the line through `offset_mm` along `axis`.
  struct Continuous {
    Eigen::Vector3d axis, offset_mm;  ///< the axis need not be of unit length
  };

  std::vector<Eigen::Isometry3d> discrete;  ///< model_from_model, without the identity
  std::vector<Continuous> continuous;

  bool empty() const { return discrete.empty() && continuous.empty(); }
};

/// The symmetries as a finite list of model_from_model as the BOP toolkit enumerates them: for the identity and then
/// for each discrete one, all turns of all continuous ones after it (from 0 on, one axis after the other, turns of two
/// axes are not combined). A turn is so small that no point of a part moves by more than about `max_step` of the part's
/// diameter: ceil(pi / max_step) turns for each axis. Throws Error for a zero or non-finite axis, and a step that is
/// not in (0, pi].
std::vector<Eigen::Isometry3d> symmetry_transformations(const Symmetries& symmetries, double max_step = 0.01);

}  // namespace partpose
