// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/symmetries.hpp"

#include "partpose/core/error.hpp"

#include <cmath>
#include <numbers>

namespace partpose {

std::vector<Eigen::Isometry3d> symmetry_transformations(const Symmetries& symmetries, double max_step) {
  if (!(max_step > 0 && max_step <= std::numbers::pi))
    throw Error("symmetry step {}: must be positive and at most pi", max_step);
  const int turns = static_cast<int>(std::ceil(std::numbers::pi / max_step));

  std::vector<Eigen::Isometry3d> turned;
  for (const auto& [axis, offset_mm] : symmetries.continuous) {
    const double length = axis.norm();
    if (!(length > 0) || !std::isfinite(length) || !offset_mm.allFinite())
      throw Error("continuous symmetry: axis ({}, {}, {}) through ({}, {}, {}): the axis must have a direction",
                  axis.x(), axis.y(), axis.z(), offset_mm.x(), offset_mm.y(), offset_mm.z());
    for (int i = 0; i < turns; ++i) {
      Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
      turn.linear() = Eigen::AngleAxisd(i * (2 * std::numbers::pi / turns), axis / length).toRotationMatrix();
      turn.translation() = offset_mm - turn.linear() * offset_mm;
      turned.push_back(turn);
    }
  }
  if (turned.empty()) turned.push_back(Eigen::Isometry3d::Identity());

  std::vector<Eigen::Isometry3d> transformations;
  transformations.reserve((1 + symmetries.discrete.size()) * turned.size());
  const auto append_turned = [&](const Eigen::Isometry3d& discrete) {
    for (const auto& turn : turned) transformations.push_back(turn * discrete);
  };
  append_turned(Eigen::Isometry3d::Identity());
  for (const auto& discrete : symmetries.discrete) append_turned(discrete);
  return transformations;
}

}  // namespace partpose
