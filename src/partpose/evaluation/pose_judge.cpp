// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/pose_judge.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/evaluation/pose_error.hpp"
#include "partpose/geometry/convex_hull.hpp"
#include "partpose/geometry/symmetry_search.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

namespace partpose {

struct PoseJudge::Part {
  std::string name;
  TriangleMesh mesh;
  double diameter_mm = 0;
  std::vector<Eigen::Isometry3d> symmetries;   ///< model_from_model, the identity first
  std::optional<Eigen::Vector3d> ball_centre;  ///< of a part that may be turned about several axes: about any
  /// MSSD is the largest value of a convex function of the point (the length of an affine map), which a corner of the
  /// hull takes.
  std::vector<Eigen::Vector3f> hull;
};

namespace {

Eigen::Matrix3d camera_matrix(const Intrinsics& camera) {
  Eigen::Matrix3d K;
  K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  return K;
}

std::vector<Eigen::Vector3f> hull_corners(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3f> corners;
  for (const int i : convex_hull(mesh.vertices).original) corners.push_back(mesh.vertices[i]);
  return corners;
}

}  // namespace

PoseJudge::PoseJudge(const Catalogue& catalogue) : parts_(catalogue.parts.size()) {
  parallel_for(parts_.size(), [&](std::size_t i) {
    const CataloguePart& from = catalogue.parts[i];
    Part& part = parts_[i];
    part.name = from.name;
    part.mesh = from.mesh;
    part.diameter_mm = diameter(from.mesh);
    const auto& models = catalogue.dataset.out.models;
    const auto model = std::find_if(models.begin(), models.end(), [&](const auto& m) { return m.id == from.id; });
    const bool stated =
        model != models.end() && (model->symmetries.symmetries_discrete || model->symmetries.symmetries_continuous ||
                                  model->symmetries.symmetry_tolerance_mm);
    const Symmetries symmetries = stated ? model->symmetries.symmetries()
                                         : find_symmetries(from.mesh, default_symmetry_tolerance_mm(part.diameter_mm));
    part.symmetries = symmetry_transformations(symmetries);
    if (symmetries.continuous.size() > 1) part.ball_centre = symmetries.continuous[0].offset_mm;
    part.hull = hull_corners(from.mesh);
  });
}

PoseJudge::~PoseJudge() = default;
PoseJudge::PoseJudge(PoseJudge&&) noexcept = default;

const PoseJudge::Part* PoseJudge::find(const std::string& name) const {
  const auto it = std::find_if(parts_.begin(), parts_.end(), [&](const Part& part) { return part.name == name; });
  return it == parts_.end() ? nullptr : &*it;
}

double PoseJudge::diameter_mm(const std::string& part) const {
  const Part* found = find(part);
  if (!found) throw Error("the catalogue has no part \"{}\"", part);
  return found->diameter_mm;
}

Evaluation PoseJudge::judge(const Result& result, const GroundTruth& truth, const JudgedFrame& frame) const {
  Evaluation out = evaluate(result, truth);
  const Part* shown = find(truth.model_name);
  const Part* named = find(result.model_name);
  if (!shown || !named) return out;
  const Eigen::Isometry3d &estimate = result.T_final, &pose = truth.camera_from_model;
  out.diameter_mm = static_cast<float>(shown->diameter_mm);
  if (out.recognized_correctly) {
    const Eigen::Matrix3d K = camera_matrix(frame.camera);
    const DepthImage estimated = render(shown->mesh, estimate, frame.camera).depth;
    const DepthImage true_depth = render(shown->mesh, pose, frame.camera).depth;
    out.add_mm = static_cast<float>(add_mm(shown->mesh.vertices, estimate, pose));
    out.adi_mm = static_cast<float>(adi_mm(shown->mesh.vertices, estimate, pose));
    // BOP does not combine the turns of several axes. Of a ball the equivalent pose turned like the estimate is the
    // best.
    auto symmetries = shown->symmetries;
    if (shown->ball_centre)
      symmetries = {Eigen::Translation3d(*shown->ball_centre) *
                    Eigen::Isometry3d(pose.linear().transpose() * estimate.linear()) *
                    Eigen::Translation3d(-*shown->ball_centre)};
    out.mssd_mm = static_cast<float>(mssd_mm(shown->hull, estimate, pose, symmetries));
    out.mspd_px = static_cast<float>(mspd_px(shown->mesh.vertices, estimate, pose, symmetries, K) *
                                     bop_pixel_factor(frame.camera.width));
    const DepthImage measured =
        frame.depth.z_mm.empty() ? DepthImage(frame.camera.width, frame.camera.height) : frame.depth;
    const auto vsd = visible_surface_discrepancy(distance_image(measured, K), distance_image(estimated, K),
                                                 distance_image(true_depth, K), shown->diameter_mm, bop_fractions())
                         .vsd;
    out.vsd = static_cast<float>(std::accumulate(vsd.begin(), vsd.end(), 0.0) / static_cast<double>(vsd.size()));
  }
  // A pose that is nearly the true one needs no excuse; the others may look the same to this camera.
  out.indistinguishable =
      mssd_below(out, 0.05) || indistinguishable(named->mesh, estimate, shown->mesh, pose, frame.camera, frame.noise);
  return out;
}

bool mssd_below(const Evaluation& evaluation, double share_of_diameter) {
  return evaluation.mssd_mm && evaluation.diameter_mm &&
         static_cast<double>(*evaluation.mssd_mm) / *evaluation.diameter_mm < share_of_diameter;
}

}  // namespace partpose
