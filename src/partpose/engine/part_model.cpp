// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/part_model.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/random.hpp"
#include "partpose/descriptor/crh.hpp"
#include "partpose/engine/field_refinement.hpp"
#include "partpose/geometry/icosphere.hpp"
#include "partpose/geometry/resting_poses.hpp"

#include <meshoptimizer.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace partpose {

namespace {

constexpr int subdivisions = 2;          // 162 views, some 15 degrees apart
constexpr double distance_share = 6;     // of the camera from the part's middle, in diameters
constexpr int pixels_per_diameter = 72;  // 6 for each cell of a template
constexpr int surface_samples = 512;

Intrinsics view_camera() {
  Intrinsics camera;
  camera.fx = camera.fy = pixels_per_diameter * distance_share;
  camera.width = camera.height = static_cast<int>(1.25 * pixels_per_diameter);
  camera.cx = camera.cy = (camera.width - 1) / 2.0;
  return camera;
}

/// Fewer triangles for a surface that nowhere moves by more than about `error_mm`.
TriangleMesh simplified(const TriangleMesh& mesh, double error_mm) {
  const TriangleMesh merged = with_merged_vertices(mesh);
  std::vector<unsigned> indices;
  for (const auto& triangle : merged.triangles)
    for (const int corner : triangle) indices.push_back(static_cast<unsigned>(corner));
  const float* positions = merged.vertices[0].data();
  const float scale_mm = meshopt_simplifyScale(positions, merged.vertices.size(), sizeof(Eigen::Vector3f));
  std::vector<unsigned> fewer(indices.size());
  fewer.resize(meshopt_simplify(fewer.data(), indices.data(), indices.size(), positions, merged.vertices.size(),
                                sizeof(Eigen::Vector3f), 0, static_cast<float>(error_mm) / scale_mm, 0, nullptr));
  if (fewer.empty()) return merged;
  TriangleMesh out;
  std::vector<int> moved(merged.vertices.size(), -1);
  for (std::size_t i = 0; i + 2 < fewer.size(); i += 3) {
    std::array<int, 3> triangle;
    for (int k = 0; k < 3; ++k) {
      int& vertex = moved[fewer[i + k]];
      if (vertex < 0) {
        vertex = static_cast<int>(out.vertices.size());
        out.vertices.push_back(merged.vertices[fewer[i + k]]);
      }
      triangle[k] = vertex;
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

/// Where a mesh is not closed, or turned inside out somewhere, its front faces alone show something else: seen so from
/// around it.
Faces faces_needed(const TriangleMesh& mesh, const Eigen::Vector3d& middle_mm, double diameter_mm) {
  constexpr double most_differing = 0.001;
  const Intrinsics camera = view_camera();
  int seen = 0, differing = 0;
  for (const auto& direction : icosphere_directions(0, true)) {
    const Eigen::Isometry3d camera_from_model =
        look_at(middle_mm + distance_share * diameter_mm * direction, middle_mm).inverse();
    const DepthImage both = render_depth(mesh, camera_from_model, camera);
    const DepthImage front = render_depth(mesh, camera_from_model, camera, Faces::front);
    for (std::size_t p = 0; p < both.z_mm.size(); ++p) {
      seen += both.z_mm[p] > 0;
      differing += std::abs(both.z_mm[p] - front.z_mm[p]) > most_differing * diameter_mm;
    }
  }
  return differing <= most_differing * seen ? Faces::front : Faces::both;
}

/// Evenly by area.
std::vector<Eigen::Vector3f> surface_points(const TriangleMesh& mesh, int count) {
  std::vector<double> area_to;  // of the triangles up to each
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f normal = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    area_to.push_back(area += std::isfinite(normal.norm()) ? normal.norm() : 0);
  }
  Random random(1);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < count; ++i) {
    const double at = area * (i + random.uniform()) / count;
    const auto found = std::upper_bound(area_to.begin(), area_to.end(), at) - area_to.begin();
    const auto& [a, b, c] = mesh.triangles[std::min<std::size_t>(found, mesh.triangles.size() - 1)];
    const auto root = static_cast<float>(std::sqrt(random.uniform())), share = static_cast<float>(random.uniform());
    points.push_back((1 - root) * mesh.vertices[a] + root * (1 - share) * mesh.vertices[b] +
                     root * share * mesh.vertices[c]);
  }
  return points;
}

/// With what they give one after the other, each once.
void close_under_composition(std::vector<Eigen::Isometry3d>& turns) {
  constexpr std::size_t most = 60;  // of an icosahedron
  constexpr double same_deg = 12;
  for (std::size_t i = 0; i < turns.size(); ++i)
    for (std::size_t k = 0; k <= i && turns.size() < most; ++k)
      for (const Eigen::Isometry3d& both : {turns[i] * turns[k], turns[k] * turns[i]})
        if (rotation_error_deg(both, Eigen::Isometry3d::Identity()) > same_deg &&
            std::none_of(turns.begin(), turns.end(),
                         [&](const Eigen::Isometry3d& turn) { return rotation_error_deg(turn, both) < same_deg; }))
          turns.push_back(both);
}

/// Finds `partners`, `nearly_round`, `symmetries` and `round`: turns about the box's axes and the surface's principal
/// axes after which the surface lies near itself, or is where it was.
void find_partners(PartModel& model) {
  const ProbePoints probes(model.samples_mm);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& p : model.samples_mm) {
    const Eigen::Vector3d arm = p.cast<double>() - probes.centre_mm();
    spread += arm * arm.transpose();
  }
  const Eigen::Matrix3d principal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  std::vector<PartModel::Axis> axes;
  for (int k = 0; k < 3; ++k) axes.push_back({Eigen::Vector3d::Unit(k), model.middle_mm});
  for (int k = 0; k < 3; ++k)
    if (principal.col(k).cwiseAbs().maxCoeff() < 0.999) axes.push_back({principal.col(k), probes.centre_mm()});

  struct Partner {
    double cost;
    Eigen::Isometry3d turn;
  };
  const double scale_mm = 0.02 * model.diameter_mm;
  const auto partner_at = [&](const PartModel::Axis& axis, double angle_deg) {
    const Eigen::Isometry3d turn = axis.turn(radians(angle_deg));
    const auto refined = refine_on_field(model.field, turn.inverse(), probes,
                                         {.start_scale_mm = scale_mm, .end_scale_mm = scale_mm, .max_iterations = 3});
    return Partner{refined.mean_capped, refined.camera_from_model};
  };
  constexpr double most_cost = 1.2;  // on the average farther away than about 2 % of the diameter
  const auto is_near = [&](const Partner& partner) { return partner.cost < most_cost; };
  const auto is_same = [&](const Eigen::Isometry3d& turn) {
    return model.is_symmetry(turn, 0.005 * model.diameter_mm);
  };
  std::vector<Partner> found, same;
  const auto add = [&](const Partner& partner) {
    if (!is_near(partner) || rotation_error_deg(partner.turn, Eigen::Isometry3d::Identity()) < 12) return;
    std::vector<Partner>& kind = is_same(partner.turn) ? same : found;
    const bool known = std::any_of(kind.begin(), kind.end(), [&](const Partner& other) {
      return rotation_error_deg(other.turn, partner.turn) < 12;
    });
    if (!known) kind.push_back(partner);
  };
  for (const auto& axis : axes) {
    const std::array<double, 7> angles_deg = {180, 90, 270, 120, 240, 60, 300};
    std::vector<Partner> turned;
    for (const double angle_deg : angles_deg) turned.push_back(partner_at(axis, angle_deg));
    for (const Partner& partner : turned) add(partner);
    constexpr double between_deg = 20;
    if (!std::all_of(turned.begin(), turned.end(), is_near) || !is_near(partner_at(axis, between_deg))) continue;
    bool round = true;
    for (const double angle_deg : {between_deg, 90.0, 120.0, 180.0})
      round = round && is_same(axis.turn(radians(angle_deg)));
    const auto is_known = [&](const std::vector<PartModel::Axis>& among) {
      return std::any_of(among.begin(), among.end(), [&](const PartModel::Axis& other) {
        return std::abs(other.direction.dot(axis.direction)) > 0.99;
      });
    };
    if (round && !is_known(model.round)) model.round.push_back(axis);
    if (round || is_known(model.nearly_round)) continue;
    // The detail moves the box: halfway to where half a turn lays the surface best onto itself lies the axis.
    const auto half_turn = refine_on_field(model.field, axis.turn(std::numbers::pi), probes,
                                           {.start_scale_mm = 5 * scale_mm, .end_scale_mm = 0.25 * scale_mm});
    const Eigen::Vector3d on_axis_mm = 0.5 * (axis.place_mm + half_turn.camera_from_model * axis.place_mm);
    model.nearly_round.push_back({axis.direction, on_axis_mm});
  }
  for (const auto& [cost, turn] : same) {
    const bool about_round = std::any_of(model.round.begin(), model.round.end(), [&](const PartModel::Axis& axis) {
      return (turn.linear() * axis.direction).dot(axis.direction) > 0.99;
    });
    if (!about_round) model.symmetries.push_back(turn);
  }
  close_under_composition(model.symmetries);
  std::stable_sort(found.begin(), found.end(), [](const Partner& a, const Partner& b) { return a.cost < b.cost; });
  constexpr std::size_t most = 24;
  for (const auto& [cost, turn] : found) {
    const bool known = std::any_of(model.partners.begin(), model.partners.end(), [&](const Eigen::Isometry3d& other) {
      return model.is_about_the_same(other, turn);
    });
    if (!known && model.partners.size() < most) model.partners.push_back(turn);
  }
}

std::vector<PartModel::Rest> find_rests(const TriangleMesh& mesh) {
  constexpr std::size_t most = 16;
  constexpr double merge_deg = 10;  // a refinement makes up for it
  std::vector<PartModel::Rest> rests;
  for (const auto& pose : resting_poses(mesh, {.merge_deg = merge_deg}).poses)
    if (rests.size() < most) rests.push_back({pose.down, pose.table_from_model.translation().z()});
  return rests;
}

PartView make_view(const PointCloud& seen, const Eigen::Isometry3d& camera_from_model,
                   const Eigen::Isometry3d& sight_from_camera) {
  PartView view;
  view.sight_from_model = (sight_from_camera * camera_from_model).cast<float>();
  const Eigen::Isometry3f model_from_camera = camera_from_model.inverse().cast<float>();
  for (int i = 0; i < PartView::visible_points; ++i)
    view.visible_mm[i] = model_from_camera * seen.points[(2 * i + 1) * seen.size() / (2 * PartView::visible_points)];
  return view;
}

}  // namespace

PartModel::PartModel(const TriangleMesh& mesh)
    : diameter_mm(diameter(mesh)),
      middle_mm(bounding_box(mesh).center()),
      box_mm(bounding_box(mesh)),
      scale(template_scale(diameter_mm)),
      field(mesh) {
  const auto simpler = [&](double share) {
    const TriangleMesh fewer = simplified(mesh, share * diameter_mm);
    return PartMesh{fewer, faces_needed(fewer, middle_mm, diameter_mm)};
  };
  outline = simpler(outline_share);
  surface = simpler(surface_share);
  samples_mm = surface_points(mesh, surface_samples);
  const Intrinsics camera = view_camera();
  struct Made {
    PartView view;
    DepthTemplate cells;
    AnchoredViews anchored;
    bool seen = false;
  };
  const auto directions = icosphere_directions(subdivisions, true);
  std::vector<Made> made(directions.size());
  parallel_for(directions.size(), [&](std::size_t i) {
    const Eigen::Isometry3d camera_from_model =
        look_at(middle_mm + distance_share * diameter_mm * directions[i], middle_mm).inverse();
    const PointCloud seen = to_point_cloud(render_depth(surface, camera_from_model, camera), camera);
    if (seen.empty()) return;
    const Eigen::Vector3d centre = centroid(seen);
    Eigen::Isometry3d sight_from_camera = Eigen::Isometry3d::Identity();
    sight_from_camera.linear() = sight_frame(centre);
    sight_from_camera.translation() = -sight_from_camera.linear() * centre;
    const double spacing_mm = centre.norm() / camera.fx;
    made[i].cells = make_template(transformed(seen, sight_from_camera).points, 0, spacing_mm, scale);
    made[i].view = make_view(seen, camera_from_model, sight_from_camera);
    made[i].view.seen_mm2 = static_cast<float>(static_cast<double>(seen.size()) * spacing_mm * spacing_mm);
    made[i].anchored.add(0, seen, camera_from_model, spacing_mm, scale);
    made[i].seen = true;
  });
  for (Made& of_view : made) {
    if (!of_view.seen) continue;
    for (auto& anchor : of_view.anchored.anchors) {
      anchor.view = static_cast<std::int16_t>(views.size());
      anchored.anchors.push_back(anchor);
    }
    anchored.templates.insert(anchored.templates.end(), of_view.anchored.templates.begin(),
                              of_view.anchored.templates.end());
    templates.push_back(of_view.cells);
    small_templates.push_back(halved(of_view.cells));
    small_surfaces.push_back(cells_with_surface(small_templates.back()));
    views.push_back(of_view.view);
  }
  find_partners(*this);
  rests = find_rests(surface);
}

Eigen::Isometry3d PartModel::Axis::turn(double angle_rad) const {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.linear() = Eigen::AngleAxisd(angle_rad, direction).toRotationMatrix();
  turn.translation() = place_mm - turn.linear() * place_mm;
  return turn;
}

bool PartModel::is_symmetry(const Eigen::Isometry3d& model_from_model, double tolerance_mm) const {
  const Eigen::Isometry3f motion = model_from_model.cast<float>();
  return std::all_of(samples_mm.begin(), samples_mm.end(), [&](const Eigen::Vector3f& p) {
    return std::abs(field.at(motion * p).distance_mm) <= tolerance_mm;
  });
}

bool PartModel::is_about_the_same(const Eigen::Isometry3d& camera_from_model, const Eigen::Isometry3d& other) const {
  constexpr double most_moved = 0.05, most_turned_deg = 8;
  const double least_cosine = std::cos(radians(most_turned_deg));
  if ((camera_from_model * middle_mm - other * middle_mm).norm() > most_moved * diameter_mm) return false;
  const Eigen::Matrix3d turned = camera_from_model.linear().transpose() * other.linear();
  const auto is_about = [&](const Eigen::Matrix3d& turn) {
    return turn.trace() > 1 + 2 * least_cosine || std::any_of(round.begin(), round.end(), [&](const Axis& axis) {
             return axis.direction.dot(turn * axis.direction) > least_cosine;
           });
  };
  return is_about(turned) || std::any_of(symmetries.begin(), symmetries.end(), [&](const Eigen::Isometry3d& symmetry) {
           return is_about(turned * symmetry.linear());
         });
}

int PartModel::view_from(const Eigen::Vector3d& sight) const {
  const Eigen::Vector3f direction = sight.cast<float>();
  const auto cosine = [&](const PartView& view) { return view.sight_from_model.linear().row(2).dot(direction); };
  const auto nearest = std::max_element(views.begin(), views.end(),
                                        [&](const PartView& a, const PartView& b) { return cosine(a) < cosine(b); });
  return static_cast<int>(nearest - views.begin());
}

Eigen::AlignedBox2d PartModel::covered(const Intrinsics& camera, const Eigen::Isometry3d& camera_from_model) const {
  Eigen::AlignedBox2d box;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d corner = camera_from_model * box_mm.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
    if (corner.z() >= 1) box.extend(camera.project(corner));
  }
  return box;
}

std::size_t PartModel::memory_bytes() const {
  const auto mesh_bytes = [](const TriangleMesh& mesh) {
    return mesh.vertices.size() * sizeof(mesh.vertices[0]) + mesh.triangles.size() * sizeof(mesh.triangles[0]);
  };
  return sizeof(*this) + mesh_bytes(outline) + mesh_bytes(surface) + views.size() * sizeof(PartView) +
         templates.size() * sizeof(DepthTemplate) + small_templates.size() * (sizeof(SmallTemplate) + sizeof(CellSet)) +
         anchored.anchors.size() * (sizeof(AnchoredViews::Anchor) + sizeof(SmallTemplate)) + field.memory_bytes() +
         samples_mm.size() * sizeof(samples_mm[0]) + partners.size() * sizeof(partners[0]) +
         (nearly_round.size() + round.size()) * sizeof(Axis) + symmetries.size() * sizeof(symmetries[0]) +
         rests.size() * sizeof(Rest);
}

}  // namespace partpose
