// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/crh.hpp"

#include <Eigen/Geometry>

#include <vector>

namespace partpose {

struct CoarseAlignmentOptions {
  bool use_crh = true;
  bool use_descriptor_if_possible = true;
  bool use_correction_by_centroids = true;
  int crh_peaks = 4;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("use_crh", self.use_crh, "turn the candidate about the line of sight by the Camera Roll Histogram");
    visit("use_descriptor_if_possible", self.use_descriptor_if_possible,
          "align by the descriptor's own reference frame (\"ourcvfh\", \"good\"); VFH has none");
    visit("use_correction_by_centroids", self.use_correction_by_centroids,
          "move the candidate's centroid to the scene's");
    visit("crh_peaks", self.crh_peaks, "how many of the histogram's best turns are tried for each candidate, >= 1");
  }
  void check() const;
};

/// What the coarse alignment needs to know of a cloud, camera frame.
struct AlignmentFeatures {
  Eigen::Vector3d centroid_mm = Eigen::Vector3d::Zero();
  CameraRollHistogram roll_histogram{};
};

/// The cloud needs normals.
AlignmentFeatures alignment_features(const PointCloud& cloud);

/// T3: the transformations that may bring a view onto the scene, most likely first, at least one.
std::vector<Eigen::Isometry3d> coarse_alignments(const AlignmentFeatures& view, const AlignmentFeatures& scene,
                                                 const CoarseAlignmentOptions& options);

}  // namespace partpose
