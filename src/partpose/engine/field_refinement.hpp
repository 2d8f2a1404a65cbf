// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/surface_field.hpp"

#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

namespace partpose {

/// Measured points as the refinement reads them: about their centre, eight side by side.
class ProbePoints {
 public:
  ProbePoints() = default;
  /// Points in the camera frame.
  explicit ProbePoints(std::span<const Eigen::Vector3f> points_mm);

  struct Group {
    Lanes x_mm, y_mm, z_mm;  ///< from the centre
    Lanes weight;            ///< 1; 0 where there is no point
  };
  const std::vector<Group>& groups() const { return groups_; }
  const Eigen::Vector3d& centre_mm() const { return centre_mm_; }
  std::size_t size() const { return size_; }

 private:
  std::vector<Group> groups_;
  Eigen::Vector3d centre_mm_ = Eigen::Vector3d::Zero();
  std::size_t size_ = 0;
};

struct FieldRefinementOptions {
  double start_scale_mm = 10;  ///< distances much beyond this do not count, at first
  double end_scale_mm = 1;     ///< and in the end: about the noise
  int max_iterations = 10;
  double converged_mm = 0.01;  ///< an iteration at the end scale that moves the points by less is the last
  /// Camera frame, a unit vector: the part only turns about it and only moves across it, as on a table. None: any way.
  std::optional<Eigen::Vector3d> upright = {};
  bool rate_end = true;  ///< else the result's distances are those before the last step, which saves a look
};

struct FieldRefinement {
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  double mean_capped = 0;  ///< mean of the distances, none counted for more than three end scales, in end scales
};

/// Moves a part so that measured points lie on its surface: Gauss-Newton on the distances to it (Fitzgibbon 2003) about
/// the points' centre, with Geman and McClure's weights (1987) whose scale falls from `start_scale_mm` to
/// `end_scale_mm`.
FieldRefinement refine_on_field(const SurfaceField& field, const Eigen::Isometry3d& camera_from_model,
                                const ProbePoints& points, const FieldRefinementOptions& options);

/// Mean distance of measured points from a part's surface, none counted for more than `cap_mm`.
double mean_distance_mm(const SurfaceField& field, const Eigen::Isometry3d& camera_from_model,
                        const ProbePoints& points, double cap_mm);

}  // namespace partpose
