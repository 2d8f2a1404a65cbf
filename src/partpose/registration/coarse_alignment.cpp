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
                                                 const CoarseAlignmentOptions& options) {
  const Eigen::Vector3d target = options.use_correction_by_centroids ? scene.centroid_mm : view.centroid_mm;
  std::vector<Eigen::Isometry3d> alignments;
  if (!options.use_crh) {
    alignments.emplace_back(Eigen::Translation3d(target - view.centroid_mm));
    return alignments;
  }
  const Eigen::Matrix3d sight_from_view = sight_frame(view.centroid_mm);
  const Eigen::Matrix3d sight_from_scene = sight_frame(scene.centroid_mm);
  for (const auto& peak : roll_peaks(view.roll_histogram, scene.roll_histogram, options.crh_peaks)) {
    const Eigen::Matrix3d roll = Eigen::AngleAxisd(peak.angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    Eigen::Isometry3d alignment = Eigen::Isometry3d::Identity();
    alignment.linear() = sight_from_scene.transpose() * roll * sight_from_view;
    alignment.translation() = target - alignment.linear() * view.centroid_mm;
    alignments.push_back(alignment);
  }
  return alignments;
}

}  // namespace partpose
