// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/registration/coarse_alignment.hpp"

#include "partpose/core/error.hpp"

namespace partpose {

void CoarseAlignmentOptions::check() const {
  if (crh_peaks < 1) throw Error("crh_peaks {}: must be 1 or more", crh_peaks);
}

AlignmentFeatures alignment_features(const PointCloud& cloud) {
  const Eigen::Vector3d centre = centroid(cloud);
  return {centre, camera_roll_histogram(cloud, centre)};
}

std::vector<Eigen::Isometry3d> coarse_alignments(const AlignmentFeatures& view, const AlignmentFeatures& scene,
                                                 const std::vector<ReferenceFrames>& frames,
                                                 const CoarseAlignmentOptions& options) {
  std::vector<Eigen::Isometry3d> alignments;
  if (options.use_descriptor_if_possible)
    for (const auto& [view_from_reference, scene_from_reference] : frames)
      alignments.push_back(scene_from_reference * view_from_reference.inverse());
  if (options.use_crh) {
    const Eigen::Matrix3d sight_from_view = sight_frame(view.centroid_mm);
    const Eigen::Matrix3d sight_from_scene = sight_frame(scene.centroid_mm);
    for (const auto& peak : roll_peaks(view.roll_histogram, scene.roll_histogram, options.crh_peaks)) {
      const Eigen::Matrix3d roll = Eigen::AngleAxisd(peak.angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      const Eigen::Matrix3d rotation = sight_from_scene.transpose() * roll * sight_from_view;
      alignments.emplace_back(Eigen::Translation3d(view.centroid_mm) * Eigen::Isometry3d(rotation) *
                              Eigen::Translation3d(-view.centroid_mm));
    }
  }
  if (alignments.empty()) alignments.push_back(Eigen::Isometry3d::Identity());
  if (options.use_correction_by_centroids)
    for (auto& alignment : alignments) alignment.pretranslate(scene.centroid_mm - alignment * view.centroid_mm);
  return alignments;
}

}  // namespace partpose
