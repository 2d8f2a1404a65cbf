// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/hypothesis.hpp"

#include <span>
#include <vector>

namespace partpose {

struct AnchoredSearch {
  int most_seeds = 8;       ///< places on the surface
  bool every_part = false;  ///< every part keeps its best at each place, however much others explain there
};

/// Parts at poses about places on the surface of `rest`, refined; best first, their cost is minus the mm2 of `rest`
/// that they explain, less what speaks against them. Null models are left out.
std::vector<Hypothesis> anchored_hypotheses(std::span<const PartModel* const> models, const FramePieces& frame,
                                            const FrameObject& rest, const AnchoredSearch& search = {});

}  // namespace partpose
