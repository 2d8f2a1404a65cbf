// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/part_model.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/descriptor/crh.hpp"
#include "partpose/geometry/icosphere.hpp"

#include <cmath>
#include <numbers>

namespace partpose {

namespace {

constexpr int subdivisions = 2;          // 162 views, some 15 degrees apart
constexpr double distance_share = 6;     // of the camera from the part's middle, in diameters
constexpr int pixels_per_diameter = 72;  // 6 for each cell of a template
constexpr int visible_points = 128;

Intrinsics view_camera() {
  Intrinsics camera;
  camera.fx = camera.fy = pixels_per_diameter * distance_share;
  camera.width = camera.height = static_cast<int>(1.25 * pixels_per_diameter);
  camera.cx = camera.cy = (camera.width - 1) / 2.0;
  return camera;
}

/// The half turns about the axes of the part's bounding box: where it is nearly symmetric, these mistake it.
std::vector<Eigen::Isometry3d> half_turns(const TriangleMesh& mesh) {
  const Eigen::Vector3d centre = bounding_box(mesh).center();
  std::vector<Eigen::Isometry3d> out;
  for (int k = 0; k < 3; ++k) {
    Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
    turn.linear() = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::Unit(k)).toRotationMatrix();
    turn.translation() = centre - turn.linear() * centre;
    out.push_back(turn);
  }
  return out;
}

}  // namespace

PartModel::PartModel(const TriangleMesh& mesh, double part_diameter_mm)
    : diameter_mm(part_diameter_mm), scale(template_scale(part_diameter_mm)), field(mesh), partners(half_turns(mesh)) {
  const Intrinsics camera = view_camera();
  const Eigen::Vector3d middle = bounding_box(mesh).center();
  for (const auto& direction : icosphere_directions(subdivisions, true)) {
    const Eigen::Isometry3d camera_from_model =
        look_at(middle + distance_share * diameter_mm * direction, middle).inverse();
    const DepthImage depth = render(mesh, camera_from_model, camera).depth;
    PointCloud seen = to_point_cloud(depth, camera);
    if (seen.empty()) continue;
    PartView view;
    const Eigen::Vector3d centre = centroid(seen);
    Eigen::Isometry3d sight_from_camera = Eigen::Isometry3d::Identity();
    sight_from_camera.linear() = sight_frame(centre);
    sight_from_camera.translation() = -sight_from_camera.linear() * centre;
    view.sight_from_model = sight_from_camera * camera_from_model;
    const Eigen::Isometry3f model_from_camera = camera_from_model.inverse().cast<float>();
    const double step = std::max(1.0, static_cast<double>(seen.size()) / visible_points);
    for (double i = 0.5 * step; i < static_cast<double>(seen.size()); i += step)
      view.visible_mm.push_back(model_from_camera * seen.points[static_cast<std::size_t>(i)]);
    const PointCloud relative = transformed(seen, sight_from_camera);
    templates.push_back(make_template(relative.points, 0, centre.norm() / camera.fx, scale));
    views.push_back(std::move(view));
  }
}

}  // namespace partpose
