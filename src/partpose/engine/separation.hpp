// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/hypothesis.hpp"

#include <bitset>
#include <span>
#include <vector>

namespace partpose {

/// A part that was found among others, or behind them.
struct SeparatedPart {
  std::vector<Hypothesis> hypotheses;  ///< best first: it, and others for about the same pixels
  FrameObject object;                  ///< the pixels that are its
};

/// A part that is sure already, and the labels of its pixels.
struct KnownPart {
  Hypothesis hypothesis;
  std::bitset<256> labels;
};

/// Finds parts that touch or cover one another, or of which something hides a part, where the whole of what is
/// connected says little: in the pixels of the labels in `unexplained`, and of the `known` parts that explain some of
/// these as well, which are tried with the others. Starts are the parts' views about places on the surface
/// (AnchoredViews); what the best of them explain together is taken away, and what is left is looked at again, until
/// nothing good is found. The pixels of each part get a label of their own, which objects that lose more to it than
/// their edge get as well. Null models are left out.
std::vector<SeparatedPart> separate(std::span<const PartModel* const> models, FramePieces& frame,
                                    const std::bitset<256>& unexplained, std::span<const KnownPart> known);

/// The same for known hypotheses alone: of what is no part lies beside a part, so that the whole is like none.
std::vector<SeparatedPart> separate_known(std::span<const PartModel* const> models, FramePieces& frame,
                                          const std::bitset<256>& unexplained, std::span<const Hypothesis> known);

}  // namespace partpose
