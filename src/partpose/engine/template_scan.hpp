// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/part_model.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

namespace partpose {

constexpr int rolls = 24;

/// The object's templates at each turn, for parts of one size, about one place.
struct TurnedTemplates {
  Eigen::Vector3d centre_mm;  ///< camera frame
  std::vector<DepthTemplate> full;
  std::vector<SmallTemplate> small;
  float known = 1;       ///< share of the cells that are not unknown, at the first turn
  float beyond_mm2 = 0;  ///< of the object's surface that is too far away for a part of this size
};

using TurnedByScale = std::map<double, std::vector<TurnedTemplates>>;  ///< by the cells' size in mm, about some places

/// A view of a part at a turn.
struct Look {
  float cost;  ///< mm2 of surface that differs
  std::int32_t part;
  std::int16_t view;
  std::int8_t roll, place;

  bool operator<(const Look& other) const {
    return std::tuple(cost, part, view, roll, place) <
           std::tuple(other.cost, other.part, other.view, other.roll, other.place);
  }
};

/// In mm2 of surface that differs by the cap or more, so that parts of different size compare.
float cost_of_step(const TemplateScale& scale);

/// Those whose small templates are nearest to the object's: at most `most`, of each part at most `most_per_part`. A part
/// is left out when its coarse views (about 30 degrees apart) are all farther than `most` looks of parts before it.
std::vector<Look> best_looks(std::span<const PartModel* const> models, const TurnedByScale& turned,
                             std::size_t most_per_part, std::size_t most);

}  // namespace partpose
