// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/evaluation/accuracy.hpp"
#include "partpose/evaluation/ambiguity.hpp"
#include "partpose/pipeline/catalogue.hpp"

#include <memory>
#include <string>
#include <vector>

namespace partpose {

/// What a pose is judged with beside the two poses: the camera, and what it measured.
struct JudgedFrame {
  Intrinsics camera;
  DepthImage depth;        ///< as measured; empty: all of the part is taken for visible
  AmbiguityOptions noise;  ///< of this sensor
};

/// Judges results by figures that know the parts' symmetries and what a camera can tell apart. Immutable, thread-safe.
class PoseJudge {
 public:
  /// The parts' symmetries are those that their dataset states; they are searched for where it states none, when a
  /// part is first judged.
  explicit PoseJudge(const Catalogue& catalogue);
  ~PoseJudge();
  PoseJudge(PoseJudge&&) noexcept;

  /// `evaluate` with the figures beside: ADD, ADI, MSSD, MSPD, VSD (the mean over the ten taus of BOP) when the part is
  /// right, and whether the camera can tell part and pose from the truth. The truth must be one of the catalogue's
  /// parts or none.
  Evaluation judge(const Result& result, const GroundTruth& truth, const JudgedFrame& frame) const;

  /// Largest distance of two vertices. Throws Error for a part that is not in the catalogue.
  double diameter_mm(const std::string& part) const;

  /// Of the poses that are the same as `truth` by the part's symmetry the one nearest to `estimate`: in which no vertex
  /// is farther than the MSSD from where it is in `estimate`. Throws Error for a part that is not in the catalogue.
  Eigen::Isometry3d nearest_equivalent(const std::string& part, const Eigen::Isometry3d& estimate,
                                       const Eigen::Isometry3d& truth) const;

  /// MSSD of an estimate. Throws Error for a part that is not in the catalogue.
  double deviation_mm(const std::string& part, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth) const;

  /// Whether the camera cannot tell one part at its pose from another, which is really there, with what is before it in
  /// this frame. Throws Error for parts not in the catalogue.
  bool same_to_camera(const std::string& part_a, const Eigen::Isometry3d& camera_from_a, const std::string& part_b,
                      const Eigen::Isometry3d& camera_from_b, const JudgedFrame& frame) const;

  /// The part's mesh. Throws Error for a part that is not in the catalogue.
  const TriangleMesh& mesh(const std::string& part) const;

  /// Whether the part may be turned about an axis by any angle.
  bool is_continuous(const std::string& part) const;

 private:
  struct Part;
  const Part* find(const std::string& name) const;
  const Part& get(const std::string& name) const;
  std::vector<std::unique_ptr<Part>> parts_;
};

/// Whether the largest deviation (MSSD) is below a share of the part's diameter.
bool mssd_below(const Evaluation& evaluation, double share_of_diameter);

}  // namespace partpose
