// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/pose_judge.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/evaluation/pose_error.hpp"
#include "partpose/geometry/convex_hull.hpp"
#include "partpose/geometry/symmetry_search.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>

namespace partpose {

struct PoseJudge::Part {
  std::string name;
  TriangleMesh mesh;
  std::optional<Symmetries> stated;

  /// What takes a search, done once when it is first asked for: of a thousand parts few are ever judged.
  struct Shape {
    double diameter_mm = 0;
    std::vector<Eigen::Isometry3d> symmetries;   ///< model_from_model, the identity first
    std::optional<Eigen::Vector3d> ball_centre;  ///< of a part that may be turned about several axes: about any
    bool continuous = false;
    /// MSSD is the largest value of a convex function of the point (the length of an affine map), which a corner of
    /// the hull takes.
    std::vector<Eigen::Vector3f> hull;
  };
  const Shape& shape() const;
  /// BOP does not combine the turns of several axes. Of a ball the equivalent pose turned like the estimate is the
  /// best.
  std::vector<Eigen::Isometry3d> symmetries(const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth) const;

 private:
  mutable std::once_flag once_;
  mutable Shape shape_;
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

const PoseJudge::Part::Shape& PoseJudge::Part::shape() const {
  std::call_once(once_, [this] {
    shape_.diameter_mm = diameter(mesh);
    const Symmetries found =
        stated ? *stated : find_symmetries(mesh, default_symmetry_tolerance_mm(shape_.diameter_mm));
    shape_.symmetries = symmetry_transformations(found);
    shape_.continuous = !found.continuous.empty();
    if (found.continuous.size() > 1) shape_.ball_centre = found.continuous[0].offset_mm;
    shape_.hull = hull_corners(mesh);
  });
  return shape_;
}

std::vector<Eigen::Isometry3d> PoseJudge::Part::symmetries(const Eigen::Isometry3d& estimate,
                                                           const Eigen::Isometry3d& truth) const {
  if (!shape().ball_centre) return shape().symmetries;
  const Eigen::Vector3d& centre = *shape().ball_centre;
  return {Eigen::Translation3d(centre) * Eigen::Isometry3d(truth.linear().transpose() * estimate.linear()) *
          Eigen::Translation3d(-centre)};
}

PoseJudge::PoseJudge(const Catalogue& catalogue) {
  for (const CataloguePart& from : catalogue.parts) {
    auto part = std::make_unique<Part>();
    part->name = from.name;
    part->mesh = from.mesh;
    const auto& models = catalogue.dataset.out.models;
    const auto model = std::find_if(models.begin(), models.end(), [&](const auto& m) { return m.id == from.id; });
    if (model != models.end() && (model->symmetries.symmetries_discrete || model->symmetries.symmetries_continuous ||
                                  model->symmetries.symmetry_tolerance_mm))
      part->stated = model->symmetries.symmetries();
    parts_.push_back(std::move(part));
  }
}

PoseJudge::~PoseJudge() = default;
PoseJudge::PoseJudge(PoseJudge&&) noexcept = default;

const PoseJudge::Part* PoseJudge::find(const std::string& name) const {
  const auto it = std::find_if(parts_.begin(), parts_.end(), [&](const auto& part) { return part->name == name; });
  return it == parts_.end() ? nullptr : it->get();
}

const PoseJudge::Part& PoseJudge::get(const std::string& name) const {
  const Part* found = find(name);
  if (!found) throw Error("the catalogue has no part \"{}\"", name);
  return *found;
}

double PoseJudge::diameter_mm(const std::string& part) const { return get(part).shape().diameter_mm; }

const TriangleMesh& PoseJudge::mesh(const std::string& part) const { return get(part).mesh; }

bool PoseJudge::is_continuous(const std::string& part) const { return get(part).shape().continuous; }

Eigen::Isometry3d PoseJudge::nearest_equivalent(const std::string& name, const Eigen::Isometry3d& estimate,
                                                const Eigen::Isometry3d& truth) const {
  const Part& part = get(name);
  double least_mm = std::numeric_limits<double>::infinity();
  Eigen::Isometry3d nearest = truth;
  const std::array same = {Eigen::Isometry3d::Identity()};
  for (const auto& symmetry : part.symmetries(estimate, truth)) {
    const double mm = mssd_mm(part.shape().hull, estimate, truth * symmetry, same);
    if (mm < least_mm) least_mm = mm, nearest = truth * symmetry;
  }
  return nearest;
}

double PoseJudge::deviation_mm(const std::string& name, const Eigen::Isometry3d& estimate,
                               const Eigen::Isometry3d& truth) const {
  const Part& part = get(name);
  return mssd_mm(part.shape().hull, estimate, truth, part.symmetries(estimate, truth));
}

bool PoseJudge::same_to_camera(const std::string& part_a, const Eigen::Isometry3d& camera_from_a,
                               const std::string& part_b, const Eigen::Isometry3d& camera_from_b,
                               const JudgedFrame& frame) const {
  const TriangleMesh &a = mesh(part_a), &b = mesh(part_b);
  if (frame.depth.z_mm.empty()) return indistinguishable(a, camera_from_a, b, camera_from_b, frame.camera, frame.noise);
  return indistinguishable(a, camera_from_a, b, camera_from_b, frame.camera, frame.noise, frame.depth);
}

Evaluation PoseJudge::judge(const Result& result, const GroundTruth& truth, const JudgedFrame& frame) const {
  Evaluation out = evaluate(result, truth);
  const Part* shown = find(truth.model_name);
  const Part* named = find(result.model_name);
  if (!shown || !named) return out;
  const Eigen::Isometry3d &estimate = result.T_final, &pose = truth.camera_from_model;
  out.diameter_mm = static_cast<float>(shown->shape().diameter_mm);
  if (out.recognized_correctly) {
    const Eigen::Matrix3d K = camera_matrix(frame.camera);
    const DepthImage estimated = render(shown->mesh, estimate, frame.camera).depth;
    const DepthImage true_depth = render(shown->mesh, pose, frame.camera).depth;
    out.add_mm = static_cast<float>(add_mm(shown->mesh.vertices, estimate, pose));
    out.adi_mm = static_cast<float>(adi_mm(shown->mesh.vertices, estimate, pose));
    const auto symmetries = shown->symmetries(estimate, pose);
    out.mssd_mm = static_cast<float>(mssd_mm(shown->shape().hull, estimate, pose, symmetries));
    out.mspd_px = static_cast<float>(mspd_px(shown->mesh.vertices, estimate, pose, symmetries, K) *
                                     bop_pixel_factor(frame.camera.width));
    const DepthImage measured =
        frame.depth.z_mm.empty() ? DepthImage(frame.camera.width, frame.camera.height) : frame.depth;
    const auto vsd =
        visible_surface_discrepancy(distance_image(measured, K), distance_image(estimated, K),
                                    distance_image(true_depth, K), shown->shape().diameter_mm, bop_fractions())
            .vsd;
    out.vsd = static_cast<float>(std::accumulate(vsd.begin(), vsd.end(), 0.0) / static_cast<double>(vsd.size()));
  }
  // A pose that is nearly the true one needs no excuse; the others may look the same to this camera.
  out.indistinguishable =
      mssd_below(out, 0.05) || same_to_camera(result.model_name, estimate, truth.model_name, pose, frame);
  return out;
}

bool mssd_below(const Evaluation& evaluation, double share_of_diameter) {
  return evaluation.mssd_mm && evaluation.diameter_mm &&
         static_cast<double>(*evaluation.mssd_mm) / *evaluation.diameter_mm < share_of_diameter;
}

}  // namespace partpose
