// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/core/depth_image.hpp"
#include "partpose/core/mesh.hpp"
#include "partpose/geometry/symmetries.hpp"

#include <Eigen/Geometry>

#include <memory>
#include <string>
#include <vector>

/// Views that do not determine the pose: a keyed shaft whose key is hidden, a plate whose pockets point away.
namespace partpose {

/// When two depth images are the same to a camera. All lengths in mm unless they say px.
struct AmbiguityOptions {
  double disparity_sigma_px = 0.08;
  double baseline_mm = 55;
  double floor_mm = 0.3;
  double slow_percent = 0;
  double sigmas = 3;
  double max_share = 0.01;
  int max_px = 25;
  double max_rms_sigmas = 1;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("disparity_sigma_px", self.disparity_sigma_px, "standard deviation of the disparity [px], >= 0");
    visit("baseline_mm", self.baseline_mm, "distance of the stereo camera's imagers [mm], > 0");
    visit("floor_mm", self.floor_mm, "standard deviation that is there at any depth [mm], > 0 (1 mm steps: 0.29)");
    visit("slow_percent", self.slow_percent,
          "largest error of the depth, of either sign, that is the same all over a part [%], 0 to 20");
    visit("sigmas", self.sigmas, "depths farther apart than so many standard deviations differ, > 0");
    visit("max_share", self.max_share, "share of the pixels that may differ, 0 to 1");
    visit("max_px", self.max_px, "pixels that may differ in any case, >= 0");
    visit("max_rms_sigmas", self.max_rms_sigmas,
          "root mean square difference of the others [standard deviations], > 0");
  }
  void check() const;

  /// As far as a virtual camera's noise lets depths differ unseen.
  static AmbiguityOptions of(const NoiseOptions& noise);

  /// Of one measured depth: sqrt(floor^2 + (z^2 disparity_sigma / (f baseline))^2).
  double sigma_mm(double z_mm, double fx_px) const;
};

/// How far apart two depth images are. A pixel of one agrees with the other when the depth there, at the same pixel or
/// at one of its eight neighbours, differs by at most `sigmas` standard deviations: edges that grow or shrink by a
/// pixel and lateral shifts of less than a pixel are within what a stereo camera does. What is seen in one and not in
/// the other differs without limit. A factor between all depths of the two, by up to `slow_percent`, is no difference:
/// a camera that errs so does not know it.
struct DepthDifference {
  int union_px = 0;       ///< where at least one of the two is seen
  int differing_px = 0;   ///< of them, those where one of the two does not agree with the other
  double rms_sigmas = 0;  ///< over those that agree

  double share() const { return union_px ? static_cast<double>(differing_px) / union_px : 0; }
  /// At most `max_share` of the pixels (or `max_px`, but never more than a quarter) differ, and the others by no more
  /// than noise. Two parts of which nothing is seen cannot be told apart.
  bool indistinguishable(const AmbiguityOptions& options) const;
};

DepthDifference depth_difference(const DepthImage& a, const DepthImage& b, double fx_px,
                                 const AmbiguityOptions& options);

/// As rendered by this camera, nothing else in view.
DepthDifference depth_difference(const TriangleMesh& part_a, const Eigen::Isometry3d& camera_from_a,
                                 const TriangleMesh& part_b, const Eigen::Isometry3d& camera_from_b,
                                 const Intrinsics& camera, const AmbiguityOptions& options = {});

/// Whether this camera can tell part a at its pose from part b at its pose.
bool indistinguishable(const TriangleMesh& part_a, const Eigen::Isometry3d& camera_from_a, const TriangleMesh& part_b,
                       const Eigen::Isometry3d& camera_from_b, const Intrinsics& camera,
                       const AmbiguityOptions& options = {});

/// The same in a frame in which something may be before the part: where that was measured nearer than both renderings,
/// neither shows. It is looked for where it hides part b at its pose, the true one, and from there on as far as it is
/// before part a: a table that a wrong pose reaches into hides nothing. What is the same with nothing before it remains
/// so. `measured`: as large as the camera's images; throws Error else.
bool indistinguishable(const TriangleMesh& part_a, const Eigen::Isometry3d& camera_from_a, const TriangleMesh& part_b,
                       const Eigen::Isometry3d& camera_from_b, const Intrinsics& camera,
                       const AmbiguityOptions& options, const DepthImage& measured);

struct AmbiguityPart {
  std::string name;
  TriangleMesh mesh;
  Symmetries symmetries;
};

struct AmbiguousPose {
  int part = -1;  ///< whose; may be another part than the one seen
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  DepthDifference difference;
  /// Of the part seen: largest distance of a surface point to where it is at the nearest equivalent pose (MSSD).
  /// Infinite for another part.
  double displacement_mm = 0;
};

/// Finds, for a part at a pose, other poses of it and poses of other parts that a camera cannot tell from it. Poses
/// that its symmetries explain, and those nearer than `min_displacement` of its diameter, are no others. The search
/// tries
///
/// - turns about the part's principal axes, and the axes and motions that are symmetries but for a detail, and
/// - every rotation on a grid of about 16 degrees of every part, its outline as large as that seen;
///
/// those that fit the visible surface are refined on it, rendered and compared. What it lists is certain (rendered);
/// that it lists everything is not.
class AmbiguitySearch {
 public:
  struct Options {
    AmbiguityOptions difference;
    double min_displacement = 0.05;  ///< relative to the diameter
    double turn_step_deg = 10;
    int most_poses = 40;  ///< listed for each part
  };

  /// Throws Error for no parts, a part without area, and options out of range.
  AmbiguitySearch(std::vector<AmbiguityPart> parts, const Intrinsics& camera, const Options& options);
  AmbiguitySearch(std::vector<AmbiguityPart> parts, const Intrinsics& camera);
  ~AmbiguitySearch();
  AmbiguitySearch(AmbiguitySearch&&) noexcept;

  /// By rising part, best first; empty when the view determines part and pose. Thread-safe.
  std::vector<AmbiguousPose> at(int part, const Eigen::Isometry3d& camera_from_model) const;

  const std::vector<AmbiguityPart>& parts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partpose
