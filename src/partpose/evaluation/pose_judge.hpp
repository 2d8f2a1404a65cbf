// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/evaluation/accuracy.hpp"
#include "partpose/evaluation/ambiguity.hpp"
#include "partpose/pipeline/catalogue.hpp"

#include <string>
#include <vector>

namespace partpose {

/// What a pose is judged with beside the two poses: the camera, and what it measured.
struct JudgedFrame {
  Intrinsics camera;
  DepthImage depth;        ///< as measured; empty: VSD takes all of the part for visible
  AmbiguityOptions noise;  ///< of this sensor
};

/// Judges results by figures that know the parts' symmetries and what a camera can tell apart. Immutable, thread-safe.
class PoseJudge {
 public:
  /// The parts' symmetries are those that their dataset states; they are searched for where it states none.
  explicit PoseJudge(const Catalogue& catalogue);
  ~PoseJudge();
  PoseJudge(PoseJudge&&) noexcept;

  /// `evaluate` with the figures beside: ADD, ADI, MSSD, MSPD, VSD (the mean over the ten taus of BOP) when the part is
  /// right, and whether the camera can tell part and pose from the truth. The truth must be one of the catalogue's
  /// parts or none.
  Evaluation judge(const Result& result, const GroundTruth& truth, const JudgedFrame& frame) const;

  /// Largest distance of two vertices. Throws Error for a part that is not in the catalogue.
  double diameter_mm(const std::string& part) const;

 private:
  struct Part;
  const Part* find(const std::string& name) const;
  std::vector<Part> parts_;
};

/// Whether the largest deviation (MSSD) is below a share of the part's diameter.
bool mssd_below(const Evaluation& evaluation, double share_of_diameter);

}  // namespace partpose
