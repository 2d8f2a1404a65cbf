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
          "align by the descriptor's own reference frame too (\"ourcvfh\" and \"good\" have one)");
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

/// The reference frames of two descriptions that match: of a view's and of the scene's.
struct ReferenceFrames {
  Eigen::Isometry3d view_from_reference = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d scene_from_reference = Eigen::Isometry3d::Identity();
};

/// T3: the transformations that may bring a view onto the scene, at least one: those of the descriptors' reference
/// frames, best match first, then the turns of the Camera Roll Histogram, highest peak first, as far as the options ask
/// for them. Without any of them the translation alone.
std::vector<Eigen::Isometry3d> coarse_alignments(const AlignmentFeatures& view, const AlignmentFeatures& scene,
                                                 const std::vector<ReferenceFrames>& frames,
                                                 const CoarseAlignmentOptions& options);

}  // namespace partpose
