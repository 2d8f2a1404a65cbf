// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/synthesis/synthetic_scene.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/random.hpp"
#include "partpose/geometry/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

namespace partpose {

namespace {

constexpr int most_attempts = 200;
constexpr double table_thickness_mm = 30;
constexpr double floor_half_mm = 10000;
constexpr double nearest_mm = 100;  ///< nothing is nearer to the camera

void check_range(const std::array<double, 2>& range, const char* name, double least, double most) {
  if (!(range[0] >= least && range[0] <= range[1] && range[1] <= most))
    throw Error("{} [{}, {}]: must be [smallest, largest], both {:g} to {:g}", name, range[0], range[1], least, most);
}

void check_count(const std::array<int, 2>& range, const char* name) {
  if (range[0] < 0 || range[0] > range[1] || range[1] > 100)
    throw Error("{} [{}, {}]: must be [smallest, largest], both 0 to 100", name, range[0], range[1]);
}

double draw(Random& random, const std::array<double, 2>& range) {
  return range[0] + (range[1] - range[0]) * random.uniform();
}

int draw(Random& random, const std::array<int, 2>& range) {
  return range[0] + static_cast<int>(random.below(static_cast<std::uint64_t>(range[1] - range[0] + 1)));
}

Eigen::Vector2d draw_in_disc(Random& random, double radius) {
  const double r = radius * std::sqrt(random.uniform()), angle = 2 * std::numbers::pi * random.uniform();
  return {r * std::cos(angle), r * std::sin(angle)};
}

Eigen::Isometry3d turned_about_z(double angle_rad) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
}

// --- Shapes
// -----------------------------------------------------------------------------------------------------------

TriangleMesh box_mesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back(Eigen::Vector3d(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                                            corner & 4 ? high.z() : low.z())
                                .cast<float>());
  for (const auto& [a, b, c, d] : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                                   std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

/// About z, standing on z = 0.
TriangleMesh cylinder_mesh(double radius, double height) {
  constexpr int segments = 48;
  TriangleMesh mesh;
  for (const double z : {0.0, height}) {
    mesh.vertices.emplace_back(0.0f, 0.0f, static_cast<float>(z));
    for (int s = 0; s < segments; ++s) {
      const double angle = 2 * std::numbers::pi * s / segments;
      mesh.vertices.push_back(Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z).cast<float>());
    }
  }
  const int top = segments + 1;
  for (int s = 0; s < segments; ++s) {
    const int a = 1 + s, b = 1 + (s + 1) % segments;
    mesh.triangles.push_back({0, b, a});
    mesh.triangles.push_back({top, top + a, top + b});
    mesh.triangles.push_back({a, b, top + b});
    mesh.triangles.push_back({a, top + b, top + a});
  }
  return mesh;
}

/// A horizontal rectangle, normal up.
TriangleMesh rectangle_mesh(double half_x, double half_y, double z) {
  TriangleMesh mesh;
  for (const auto& [x, y] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}})
    mesh.vertices.push_back(Eigen::Vector3d(x * half_x, y * half_y, z).cast<float>());
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// --- Room on the table
// ------------------------------------------------------------------------------------------------

/// What something covers of the table, seen from above: its convex outline.
using Footprint = std::vector<Eigen::Vector2d>;

Footprint moved(const Footprint& footprint, const Eigen::Vector2d& by) {
  Footprint out = footprint;
  for (auto& p : out) p += by;
  return out;
}

/// How far apart two outlines are at least: the widest gap between them along the normal of an edge (the separating
/// axis theorem). Negative when they overlap.
double gap_between(const Footprint& a, const Footprint& b) {
  double widest = -std::numeric_limits<double>::infinity();
  for (const auto& [one, other] : {std::pair{&a, &b}, std::pair{&b, &a}})
    for (std::size_t i = 0; i < one->size(); ++i) {
      const Eigen::Vector2d& p = (*one)[i];
      const Eigen::Vector2d edge = (*one)[(i + 1) % one->size()] - p;
      if (!(edge.norm() > 0)) continue;
      const Eigen::Vector2d outward = Eigen::Vector2d(edge.y(), -edge.x()).normalized();
      double gap = std::numeric_limits<double>::infinity();
      for (const auto& q : *other) gap = std::min(gap, outward.dot(q - p));
      widest = std::max(widest, gap);
    }
  return widest;
}

bool fits(const Footprint& footprint, const std::vector<Footprint>& others, double gap_mm) {
  return std::all_of(others.begin(), others.end(),
                     [&](const Footprint& other) { return gap_between(footprint, other) >= gap_mm; });
}

bool on_table(const Footprint& footprint, const std::array<double, 2>& size_mm) {
  return std::all_of(footprint.begin(), footprint.end(), [&](const Eigen::Vector2d& p) {
    return std::abs(p.x()) <= size_mm[0] / 2 && std::abs(p.y()) <= size_mm[1] / 2;
  });
}

/// A mesh with what is asked of it again and again.
struct Body {
  std::string name;
  std::shared_ptr<const TriangleMesh> mesh;
  std::vector<Eigen::Vector3d> corners;  ///< of a convex body around it, model frame

  Body(std::string name, TriangleMesh mesh_of_body)
      : name(std::move(name)), mesh(std::make_shared<const TriangleMesh>(std::move(mesh_of_body))) {
    corners = convex_hull(mesh->vertices).vertices;
  }
  /// Its box for its hull.
  explicit Body(std::shared_ptr<const TriangleMesh> shared_mesh) : mesh(std::move(shared_mesh)) {
    const auto box = bounding_box(*mesh);
    for (int i = 0; i < 8; ++i) corners.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  }
  Footprint footprint(const Eigen::Isometry3d& table_from_model) const {
    Footprint points;
    for (const auto& corner : corners) points.push_back((table_from_model * corner).head<2>());
    Footprint out;
    for (const int i : convex_outline(points)) out.push_back(points[i]);
    return out;
  }
  double top_mm(const Eigen::Isometry3d& table_from_model) const {
    double top = 0;
    for (const auto& corner : corners) top = std::max(top, (table_from_model * corner).z());
    return top;
  }
};

/// How far a body reaches along a level direction, for each line of that direction: what meets first when it slides.
/// Lines are sampled every half millimetre across and in height.
class Reach {
 public:
  static constexpr double cell_mm = 0.5;

  /// `sign` 1: how far it reaches along +x; -1: along -x. `across_from_model`: x along the direction, z up.
  Reach(const TriangleMesh& mesh, const Eigen::Isometry3d& across_from_model, double sign) {
    std::vector<Eigen::Vector3d> corners;
    Eigen::AlignedBox3d box;
    for (const auto& vertex : mesh.vertices) {
      corners.push_back(across_from_model * vertex.cast<double>());
      corners.back().x() *= sign;
      box.extend(corners.back());
    }
    y0_ = cell_of(box.min().y()) - 1;
    z0_ = cell_of(box.min().z()) - 1;
    columns_ = cell_of(box.max().y()) + 2 - y0_;
    rows_ = cell_of(box.max().z()) + 2 - z0_;
    farthest_.assign(static_cast<std::size_t>(columns_) * rows_, -std::numeric_limits<double>::infinity());
    for (const auto& c : corners) add(cell_of(c.y()), cell_of(c.z()), c.x());
    for (const auto& t : mesh.triangles) add_triangle(corners[t[0]], corners[t[1]], corners[t[2]]);
  }

  /// A sampled line knows nothing of what lies between it and its neighbours: the farthest of them stands for it.
  Reach grown() const {
    Reach out = *this;
    for (int z = 1; z + 1 < rows_; ++z)
      for (int y = 1; y + 1 < columns_; ++y)
        for (int dz = -1; dz <= 1; ++dz)
          for (int dy = -1; dy <= 1; ++dy) out.at(y + dy, z + dz) = std::max(out.at(y + dy, z + dz), at(y, z));
    return out;
  }

  /// How far `coming` (seen along -x) is from meeting this body (seen along +x), moved against x; infinite when it
  /// passes by.
  double distance_to(const Reach& coming) const {
    double least = std::numeric_limits<double>::infinity();
    for (int z = std::max(z0_, coming.z0_); z < std::min(z0_ + rows_, coming.z0_ + coming.rows_); ++z)
      for (int y = std::max(y0_, coming.y0_); y < std::min(y0_ + columns_, coming.y0_ + coming.columns_); ++y)
        least = std::min(least, -coming.at(y - coming.y0_, z - coming.z0_) - at(y - y0_, z - z0_));
    return least;
  }

 private:
  static int cell_of(double mm) { return static_cast<int>(std::floor(mm / cell_mm)); }
  double& at(int y, int z) { return farthest_[static_cast<std::size_t>(z) * columns_ + y]; }
  double at(int y, int z) const { return farthest_[static_cast<std::size_t>(z) * columns_ + y]; }
  void add(int y, int z, double x) { at(y - y0_, z - z0_) = std::max(at(y - y0_, z - z0_), x); }

  void add_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const Eigen::Vector2d A = a.tail<2>(), AB = b.tail<2>() - A, AC = c.tail<2>() - A;
    const double area = AB.x() * AC.y() - AB.y() * AC.x();
    if (std::abs(area) < 1e-9) return;  // seen on edge: its neighbours cover it
    const double low_y = std::min({a.y(), b.y(), c.y()}), high_y = std::max({a.y(), b.y(), c.y()});
    const double low_z = std::min({a.z(), b.z(), c.z()}), high_z = std::max({a.z(), b.z(), c.z()});
    for (int z = cell_of(low_z); z <= cell_of(high_z); ++z)
      for (int y = cell_of(low_y); y <= cell_of(high_y); ++y) {
        const Eigen::Vector2d p = Eigen::Vector2d((y + 0.5) * cell_mm, (z + 0.5) * cell_mm) - A;
        const double u = (p.x() * AC.y() - p.y() * AC.x()) / area, v = (AB.x() * p.y() - AB.y() * p.x()) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        add(y, z, a.x() + u * (b.x() - a.x()) + v * (c.x() - a.x()));
      }
  }

  int y0_ = 0, z0_ = 0, columns_ = 0, rows_ = 0;
  std::vector<double> farthest_;
};

struct PartBody {
  Body body;
  RestingPoses resting;
};

/// A body in its place.
struct Placed {
  ScenePiece::Kind kind;
  int index;
  int resting_pose;
  Body body;
  Eigen::Isometry3d table_from_model;
  Footprint footprint;
};

// --- Drawing
// ----------------------------------------------------------------------------------------------------------

/// The depth of one thing alone, cut to where it is; the cut may reach beyond the image.
struct Silhouette {
  int left = 0, top = 0;
  DepthImage depth;

  float at(int u, int v) const {
    const int x = u - left, y = v - top;
    return x < 0 || y < 0 || x >= depth.width || y >= depth.height ? 0.0f : depth.at(x, y);
  }
};

/// `beyond`: also what is outside the image, as far as its size on each side (as BOP counts silhouettes).
Silhouette silhouette(const Body& body, const Eigen::Isometry3d& camera_from_model, const Intrinsics& camera,
                      bool beyond) {
  const double margin_x = beyond ? camera.width : 0, margin_y = beyond ? camera.height : 0;
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const auto& corner : body.corners) {
    const Eigen::Vector3d p = camera_from_model * corner;
    if (p.z() < nearest_mm) {  // large things alone, the table and the floor: anywhere
      left = top = -1e9;
      right = bottom = 1e9;
      break;
    }
    const Eigen::Vector2d pixel = camera.project(p);
    left = std::min(left, pixel.x());
    right = std::max(right, pixel.x());
    top = std::min(top, pixel.y());
    bottom = std::max(bottom, pixel.y());
  }
  Silhouette out;
  out.left = static_cast<int>(std::floor(std::clamp(left, -margin_x, camera.width + margin_x)));
  out.top = static_cast<int>(std::floor(std::clamp(top, -margin_y, camera.height + margin_y)));
  Intrinsics cut = camera;
  cut.width = static_cast<int>(std::ceil(std::clamp(right + 1, -margin_x, camera.width + margin_x))) - out.left;
  cut.height = static_cast<int>(std::ceil(std::clamp(bottom + 1, -margin_y, camera.height + margin_y))) - out.top;
  cut.cx -= out.left;
  cut.cy -= out.top;
  if (cut.width > 0 && cut.height > 0) out.depth = render(*body.mesh, camera_from_model, cut).depth;
  return out;
}

struct Composite {
  DepthImage depth;
  std::vector<int> piece_at;
};

Composite composed(const std::vector<Silhouette>& silhouettes, const Intrinsics& camera) {
  Composite out{DepthImage(camera.width, camera.height), {}};
  out.piece_at.assign(out.depth.z_mm.size(), -1);
  for (std::size_t i = 0; i < silhouettes.size(); ++i) {
    const Silhouette& s = silhouettes[i];
    const int first_u = std::max(0, s.left), last_u = std::min(camera.width, s.left + s.depth.width);
    const int first_v = std::max(0, s.top), last_v = std::min(camera.height, s.top + s.depth.height);
    for (int v = first_v; v < last_v; ++v)
      for (int u = first_u; u < last_u; ++u) {
        const float z = s.depth.at(u - s.left, v - s.top);
        float& nearest = out.depth.at(u, v);
        if (z > 0 && (nearest == 0 || z < nearest)) {
          nearest = z;
          out.piece_at[static_cast<std::size_t>(v) * camera.width + u] = static_cast<int>(i);
        }
      }
  }
  return out;
}

struct GrowingBox {
  int left = std::numeric_limits<int>::max(), top = left, right = std::numeric_limits<int>::min(), bottom = right;
  void add(int u, int v) {
    left = std::min(left, u);
    right = std::max(right, u);
    top = std::min(top, v);
    bottom = std::max(bottom, v);
  }
  std::array<int, 4> xywh() const {
    if (right < left) return {-1, -1, -1, -1};
    return {left, top, right - left + 1, bottom - top + 1};
  }
};

void count_visible(ScenePiece& piece, int number, const Silhouette& s, const Composite& composite) {
  GrowingBox all, visible;
  piece.silhouette_px = piece.visible_px = 0;
  for (int y = 0; y < s.depth.height; ++y)
    for (int x = 0; x < s.depth.width; ++x) {
      if (s.depth.at(x, y) <= 0) continue;
      const int u = s.left + x, v = s.top + y;
      ++piece.silhouette_px;
      all.add(u, v);
      if (u < 0 || v < 0 || u >= composite.depth.width || v >= composite.depth.height) continue;
      if (composite.piece_at[static_cast<std::size_t>(v) * composite.depth.width + u] != number) continue;
      ++piece.visible_px;
      visible.add(u, v);
    }
  piece.silhouette_box = all.xywh();
  piece.visible_box = visible.xywh();
}

void drop_far(DepthImage& depth, double farthest_mm) {
  for (float& z : depth.z_mm)
    if (z > farthest_mm) z = 0;
}

}  // namespace

// --- Options
// ----------------------------------------------------------------------------------------------------------

void SceneCameraOptions::check() const {
  intrinsics.check();
  check_range(distance_mm, "distance_mm", 2 * nearest_mm, 20000);
  check_range(elevation_deg, "elevation_deg", 5, 90);
  check_range(roll_deg, "roll_deg", -180, 180);
  if (!(aim_radius_mm >= 0 && aim_radius_mm <= 10000))
    throw Error("aim_radius_mm {}: must be 0 to 10000", aim_radius_mm);
  if (!(farthest_mm >= nearest_mm && farthest_mm <= 65000))
    throw Error("farthest_mm {}: must be {} to 65000", farthest_mm, nearest_mm);
}

void SceneOptions::check() const {
  camera.check();
  check_count(parts, "parts");
  check_count(unknown_parts, "unknown_parts");
  check_count(clutter, "clutter");
  check_range(clutter_size_mm, "clutter_size_mm", 1, 1000);
  if (poses != "natural" && poses != "uniform") throw Error("poses \"{}\": must be \"natural\" or \"uniform\"", poses);
  if (!(least_visible_fraction >= 0 && least_visible_fraction <= 1))
    throw Error("least_visible_fraction {}: must be 0 to 1", least_visible_fraction);
  check_range(hidden_fraction, "hidden_fraction", 0, 0.99);
  if (hidden_fraction[1] > 0 && hidden_fraction[1] - hidden_fraction[0] < 0.005)
    throw Error("hidden_fraction [{}, {}]: the range must be 0.005 wide or more: pixels are countable",
                hidden_fraction[0], hidden_fraction[1]);
  if (!(place_radius_mm > 0 && place_radius_mm <= 10000))
    throw Error("place_radius_mm {}: must be positive, up to 10000", place_radius_mm);
  if (contact != "apart" && contact != "touching")
    throw Error("contact \"{}\": must be \"apart\" or \"touching\"", contact);
  if (!(gap_mm >= 0 && gap_mm <= 1000)) throw Error("gap_mm {}: must be 0 to 1000", gap_mm);
  for (const double side : table_size_mm)
    if (!(side > 0 && side <= 20000)) throw Error("table_size_mm {}: must be positive, up to 20000", side);
  if (!(floor_below_mm == 0 || (floor_below_mm > table_thickness_mm && floor_below_mm <= 20000)))
    throw Error("floor_below_mm {}: must be 0 (no floor) or more than {}, the table's thickness", floor_below_mm,
                table_thickness_mm);
  resting_poses.check();
}

// --- The generator
// ----------------------------------------------------------------------------------------------------

struct SceneGenerator::Impl {
  SceneOptions options;
  std::vector<PartBody> catalogue, unknown;
  std::vector<std::string> names, unknown_names;
  Body table, floor;

  Impl(std::vector<ScenePart> parts, std::vector<ScenePart> unknown_parts, const SceneOptions& given)
      : options(given),
        table("table", box_mesh({-given.table_size_mm[0] / 2, -given.table_size_mm[1] / 2, -table_thickness_mm},
                                {given.table_size_mm[0] / 2, given.table_size_mm[1] / 2, 0})),
        floor("floor", rectangle_mesh(floor_half_mm, floor_half_mm, -given.floor_below_mm)) {
    if (parts.empty() && options.parts[1] > 0)
      throw Error("scenes: no catalogue parts are given, but \"parts\" asks for up to {}", options.parts[1]);
    if (unknown_parts.empty() && options.unknown_parts[1] > 0)
      throw Error("scenes: no unknown parts are given, but \"unknown_parts\" asks for up to {}",
                  options.unknown_parts[1]);
    if (options.hidden_fraction[1] > 0 && options.parts[0] < 1)
      throw Error("scenes: \"hidden_fraction\" needs a part in each frame; \"parts\" starts at 0");
    for (const auto* list : {&parts, &unknown_parts})
      for (const auto& part : *list) check_size(part);
    catalogue = bodies(std::move(parts));
    unknown = bodies(std::move(unknown_parts));
    for (const auto& part : catalogue) names.push_back(part.body.name);
    for (const auto& part : unknown) unknown_names.push_back(part.body.name);
  }

  /// A part that the camera would not see, or that is larger than the table, is in another unit than it should be.
  void check_size(const ScenePart& part) const {
    const double diagonal_mm = bounding_box_diagonal(part.mesh), distance_mm = options.camera.distance_mm[1];
    constexpr double fewest_px = 3;
    if (diagonal_mm * options.camera.intrinsics.fx / distance_mm < fewest_px)
      throw Error("part \"{}\": is {:.4g} mm large, too small to be seen from {:.4g} mm: is it in millimetres?",
                  part.name, diagonal_mm, distance_mm);
    if (diagonal_mm > 2 * std::max(options.table_size_mm[0], options.table_size_mm[1]))
      throw Error("part \"{}\": is {:.4g} mm large, too large for the table of {:g} x {:g} mm: is it in millimetres?",
                  part.name, diagonal_mm, options.table_size_mm[0], options.table_size_mm[1]);
  }

  std::vector<PartBody> bodies(std::vector<ScenePart> parts) const {
    std::vector<std::optional<PartBody>> found(parts.size());
    parallel_for(parts.size(), [&](std::size_t i) {
      try {
        RestingPoses resting = partpose::resting_poses(parts[i].mesh, options.resting_poses);
        found[i].emplace(PartBody{Body(parts[i].name, std::move(parts[i].mesh)), std::move(resting)});
      } catch (const Error& error) {
        throw Error("part \"{}\": {}", parts[i].name, error.what());
      }
    });
    std::vector<PartBody> out;
    for (auto& part : found) out.push_back(std::move(*part));
    return out;
  }

  int draw_pose(Random& random, const RestingPoses& resting) const {
    const bool uniform = options.poses == "uniform";
    const int group = uniform ? static_cast<int>(random.below(static_cast<std::uint64_t>(resting.groups))) : -1;
    double sum = 0;
    for (const auto& pose : resting.poses)
      if (!uniform || pose.group == group) sum += pose.probability;
    double left = sum * random.uniform();
    int last = 0;
    for (std::size_t i = 0; i < resting.poses.size(); ++i) {
      if (uniform && resting.poses[i].group != group) continue;
      last = static_cast<int>(i);
      left -= resting.poses[i].probability;
      if (left < 0) break;
    }
    return last;
  }

  /// At a random place where it fits, in a disc that grows until there is one.
  std::optional<Placed> placed(Random& random, Placed thing, const std::vector<Footprint>& taken) const {
    const Footprint at_origin = thing.body.footprint(thing.table_from_model);
    for (double radius = options.place_radius_mm; radius < 3 * options.place_radius_mm; radius *= 1.1)
      for (int i = 0; i < 10; ++i) {
        const Eigen::Vector2d place = draw_in_disc(random, radius);
        Footprint footprint = moved(at_origin, place);
        if (!on_table(footprint, options.table_size_mm) || !fits(footprint, taken, options.gap_mm)) continue;
        thing.table_from_model.pretranslate(Eigen::Vector3d(place.x(), place.y(), 0));
        thing.footprint = std::move(footprint);
        return thing;
      }
    return std::nullopt;
  }

  /// Slid along the table from a random direction towards one of the others until it meets any of them. Nothing when it
  /// would pass all of them, or fall off.
  std::optional<Placed> touching(Random& random, Placed thing, const std::vector<Placed>& others) const {
    constexpr double clearance_mm = 0.05;
    for (int attempt = 0; attempt < 10; ++attempt) {
      const Placed& target = others[random.below(others.size())];
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const auto& p : target.footprint) middle += p / static_cast<double>(target.footprint.size());
      double radius = 0;
      for (const auto& p : target.footprint) radius = std::max(radius, (p - middle).norm());
      const Eigen::Isometry3d across_from_table = turned_about_z(-2 * std::numbers::pi * random.uniform());
      const double beside = 0.5 * radius * (2 * random.uniform() - 1);
      // Before it: the thing at the target's middle, so far to one side, and so far out that it meets nothing yet.
      const Eigen::Vector3d lane = across_from_table * Eigen::Vector3d(middle.x(), middle.y(), 0);
      constexpr double outside_mm = 10000;
      const Eigen::Isometry3d start = across_from_table.inverse() *
                                      Eigen::Translation3d(lane.x() + outside_mm, lane.y() + beside, 0) *
                                      across_from_table * thing.table_from_model;
      const Reach coming = Reach(*thing.body.mesh, across_from_table * start, -1).grown();
      double distance = std::numeric_limits<double>::infinity();
      for (const auto& other : others)
        distance = std::min(distance,
                            Reach(*other.body.mesh, across_from_table * other.table_from_model, 1).distance_to(coming));
      if (!std::isfinite(distance)) continue;
      const Eigen::Vector3d back = across_from_table.inverse() * Eigen::Vector3d(clearance_mm - distance, 0, 0);
      Placed placed = thing;
      placed.table_from_model = Eigen::Translation3d(back) * start;
      placed.footprint = placed.body.footprint(placed.table_from_model);
      if (on_table(placed.footprint, options.table_size_mm)) return placed;
    }
    return std::nullopt;
  }

  Placed resting_part(Random& random, const PartBody& part, ScenePiece::Kind kind, int index) const {
    const int pose = draw_pose(random, part.resting);
    const Eigen::Isometry3d turn = turned_about_z(2 * std::numbers::pi * random.uniform());
    return {kind, index, pose, part.body, turn * part.resting.poses[pose].table_from_model, {}};
  }

  Placed clutter_piece(Random& random) const {
    const auto size = [&] { return draw(random, options.clutter_size_mm); };
    const Eigen::Isometry3d turn = turned_about_z(2 * std::numbers::pi * random.uniform());
    if (random.below(2) == 0) {
      const Eigen::Vector3d half(size() / 2, size() / 2, 0);
      Eigen::Vector3d high = half;
      high.z() = size();
      return {ScenePiece::Kind::clutter, -1, -1, Body("box", box_mesh(-half, high)), turn, {}};
    }
    const double radius = size() / 2, height = size();
    Eigen::Isometry3d pose = turn;
    if (random.below(2) == 0)  // on its side
      pose = turn * Eigen::Translation3d(0, height / 2, radius) *
             Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX());
    return {ScenePiece::Kind::clutter, -1, -1, Body("cylinder", cylinder_mesh(radius, height)), pose, {}};
  }

  /// `count` of `total`, without repetition as long as they last; the first is `first` if that is not negative.
  static std::vector<int> choice(Random& random, int count, int total, int first) {
    std::vector<int> out, left;
    while (static_cast<int>(out.size()) < count) {
      if (left.empty()) {
        left.resize(static_cast<std::size_t>(total));
        std::iota(left.begin(), left.end(), 0);
      }
      const auto it = out.empty() && first >= 0 ? left.begin() + first
                                                : left.begin() + static_cast<std::ptrdiff_t>(random.below(left.size()));
      out.push_back(*it);
      left.erase(it);
    }
    return out;
  }

  std::optional<std::vector<Placed>> arrangement(Random& random, std::uint64_t frame) const {
    std::vector<Placed> things;
    const int part_count = draw(random, options.parts);
    const int first = catalogue.empty() ? -1 : static_cast<int>(frame % catalogue.size());
    for (const int i : choice(random, part_count, static_cast<int>(catalogue.size()), first))
      things.push_back(resting_part(random, catalogue[i], ScenePiece::Kind::part, i));
    const int unknown_count = draw(random, options.unknown_parts);
    for (const int i : choice(random, unknown_count, static_cast<int>(unknown.size()), -1))
      things.push_back(resting_part(random, unknown[i], ScenePiece::Kind::unknown_part, i));
    const int clutter_count = draw(random, options.clutter);
    for (int i = 0; i < clutter_count; ++i) things.push_back(clutter_piece(random));

    std::vector<Placed> lying;
    std::vector<Footprint> taken;
    for (auto& thing : things) {
      auto found = options.contact == "touching" && !lying.empty() ? touching(random, std::move(thing), lying)
                                                                   : placed(random, std::move(thing), taken);
      if (!found) return std::nullopt;
      lying.push_back(std::move(*found));
      taken.push_back(lying.back().footprint);
    }
    return lying;
  }

  Eigen::Isometry3d draw_camera(Random& random) const {
    const double distance = draw(random, options.camera.distance_mm);
    const double elevation = radians(draw(random, options.camera.elevation_deg));
    const double azimuth = 2 * std::numbers::pi * random.uniform();
    const double roll = radians(draw(random, options.camera.roll_deg));
    const Eigen::Vector2d aim = draw_in_disc(random, options.camera.aim_radius_mm);
    const Eigen::Vector3d target(aim.x(), aim.y(), 0);
    const Eigen::Vector3d away(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                               std::sin(elevation));
    return turned_about_z(roll) * look_at(target + distance * away, target).inverse();
  }

  /// Stands before the part on the camera's side, or is held over it, so far to one side that the share `hidden` of the
  /// part's silhouette cannot be seen. `visible`: what of it could be, row by row. Nothing when there is no room.
  std::optional<Placed> occluder(Random& random, const std::vector<Placed>& things,
                                 const Eigen::Isometry3d& camera_from_table, const Silhouette& part,
                                 const std::vector<char>& visible, double hidden) const {
    const Placed& target = things.front();
    const Eigen::Vector3d camera = camera_from_table.inverse().translation();
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const auto& p : target.footprint) middle += p / static_cast<double>(target.footprint.size());
    double reach = 0, highest = 0;
    for (const auto& p : target.footprint) reach = std::max(reach, (p - middle).norm());
    for (const auto& thing : things) highest = std::max(highest, thing.body.top_mm(thing.table_from_model));
    const double top = target.body.top_mm(target.table_from_model);

    const Eigen::Vector2d level = camera.head<2>() - middle;
    const double slope = camera.z() / std::max(level.norm(), 1e-6);  // of the line of sight
    const double depth = 10 + 20 * random.uniform();
    const double distance = reach + options.gap_mm + depth / 2 + 30 * random.uniform();
    const double height_needed = top + slope * (distance + reach);
    const bool stands = height_needed < 300 && height_needed < 0.7 * camera.z();
    const double angle = stands ? std::atan2(level.y(), level.x()) : 2 * std::numbers::pi * random.uniform();
    const double side = random.below(2) == 0 ? 1 : -1;
    // No wider than the task asks, so that the plate does not become the largest plane in the picture.
    const double half_width = std::min(reach, 1.3 * hidden * reach) + 10, half_length = reach + 10;

    Eigen::Vector3d centre;  // where it hides all
    std::optional<Body> body;
    if (stands) {
      const Eigen::Vector2d at = middle + distance * level.normalized();
      centre = {at.x(), at.y(), 0};
      body.emplace("plate", box_mesh({-depth / 2, -half_width, 0}, {depth / 2, half_width, height_needed}));
    } else {
      const double height = highest + 20 + 60 * random.uniform();
      if (height + depth > 0.7 * camera.z()) return std::nullopt;
      const double along = (height - top / 2) / (camera.z() - top / 2);
      const Eigen::Vector2d at = middle + along * level;
      centre = {at.x(), at.y(), height};
      body.emplace("plate", box_mesh({-half_length, -half_width, 0}, {half_length, half_width, depth}));
    }
    const Eigen::Vector3d sideways(-side * std::sin(angle), side * std::cos(angle), 0);
    const auto pose_at = [&](double shift_mm) {
      return Eigen::Translation3d(centre + shift_mm * sideways) * turned_about_z(angle);
    };
    const auto hidden_at = [&](double shift_mm) {
      const Silhouette plate =
          silhouette(*body, camera_from_table * pose_at(shift_mm), options.camera.intrinsics, true);
      int all = 0, seen = 0;
      for (int y = 0; y < part.depth.height; ++y)
        for (int x = 0; x < part.depth.width; ++x) {
          const float z = part.depth.at(x, y);
          if (z <= 0) continue;
          ++all;
          if (!visible[static_cast<std::size_t>(y) * part.depth.width + x]) continue;
          const float in_front = plate.at(part.left + x, part.top + y);
          seen += !(in_front > 0 && in_front < z);
        }
      return all == 0 ? 1.0 : 1 - static_cast<double>(seen) / all;
    };
    // Between these shifts the plate's outer edge is beyond the part: the farther out, the less it hides.
    double hides = std::max(0.0, reach + 10 - half_width), shows = reach + half_width + 50;
    if (hidden_at(hides) < hidden) return std::nullopt;
    for (int i = 0; i < 16; ++i) {
      const double shift = 0.5 * (hides + shows);
      (hidden_at(shift) >= hidden ? hides : shows) = shift;
    }
    Placed out{ScenePiece::Kind::occluder, -1, -1, *body, Eigen::Isometry3d(pose_at(hides)), {}};
    if (!stands) return out;
    out.footprint = out.body.footprint(out.table_from_model);
    for (const auto& thing : things)
      if (gap_between(out.footprint, thing.footprint) < options.gap_mm) return std::nullopt;
    return on_table(out.footprint, options.table_size_mm) ? std::optional(out) : std::nullopt;
  }

  std::optional<SyntheticScene> attempt(Random& random, std::uint64_t frame) const {
    const Intrinsics& intrinsics = options.camera.intrinsics;
    const Eigen::Isometry3d camera_from_table = draw_camera(random);
    auto things = arrangement(random, frame);
    if (!things) return std::nullopt;
    for (const auto& thing : *things)
      for (const auto& corner : thing.body.corners)
        if ((camera_from_table * thing.table_from_model * corner).z() < nearest_mm) return std::nullopt;

    std::vector<Silhouette> silhouettes;
    for (const auto& thing : *things)
      silhouettes.push_back(silhouette(thing.body, camera_from_table * thing.table_from_model, intrinsics,
                                       thing.kind != ScenePiece::Kind::clutter));
    if (options.hidden_fraction[1] > 0) {
      const Composite without = composed(silhouettes, intrinsics);
      const Silhouette& part = silhouettes.front();
      std::vector<char> visible(part.depth.z_mm.size(), 0);
      int all = 0, seen = 0;
      for (int y = 0; y < part.depth.height; ++y)
        for (int x = 0; x < part.depth.width; ++x) {
          if (part.depth.at(x, y) <= 0) continue;
          ++all;
          const int u = part.left + x, v = part.top + y;
          if (u < 0 || v < 0 || u >= intrinsics.width || v >= intrinsics.height) continue;
          if (without.piece_at[static_cast<std::size_t>(v) * intrinsics.width + u] != 0) continue;
          visible[static_cast<std::size_t>(y) * part.depth.width + x] = 1;
          ++seen;
        }
      const double aim = draw(random, options.hidden_fraction);
      if (all == 0) return std::nullopt;
      if (1 - static_cast<double>(seen) / all < aim) {
        auto plate = occluder(random, *things, camera_from_table, part, visible, aim);
        if (!plate) return std::nullopt;
        silhouettes.push_back(silhouette(plate->body, camera_from_table * plate->table_from_model, intrinsics, false));
        things->push_back(std::move(*plate));
      }
    }

    SyntheticScene scene;
    scene.frame = frame;
    scene.intrinsics = intrinsics;
    scene.camera_from_table = camera_from_table;
    scene.farthest_mm = options.camera.farthest_mm;
    for (const auto& thing : *things) {
      ScenePiece piece;
      piece.kind = thing.kind;
      piece.index = thing.index;
      piece.name = thing.body.name;
      piece.mesh = thing.body.mesh;
      piece.camera_from_model = camera_from_table * thing.table_from_model;
      piece.resting_pose = thing.resting_pose;
      scene.pieces.push_back(std::move(piece));
    }
    const auto add_ground = [&](const Body& body, ScenePiece::Kind kind) {
      ScenePiece piece;
      piece.kind = kind;
      piece.name = body.name;
      piece.mesh = body.mesh;
      piece.camera_from_model = camera_from_table;
      scene.pieces.push_back(std::move(piece));
      silhouettes.push_back(silhouette(body, camera_from_table, intrinsics, false));
    };
    add_ground(table, ScenePiece::Kind::table);
    if (options.floor_below_mm > 0) add_ground(floor, ScenePiece::Kind::floor);

    Composite composite = composed(silhouettes, intrinsics);
    for (std::size_t i = 0; i < scene.pieces.size(); ++i) {
      ScenePiece& piece = scene.pieces[i];
      if (piece.kind != ScenePiece::Kind::part && piece.kind != ScenePiece::Kind::unknown_part) continue;
      count_visible(piece, static_cast<int>(i), silhouettes[i], composite);
      const bool by_intention = i == 0 && options.hidden_fraction[1] > 0;
      const double hidden = 1 - piece.visible_fraction();
      if (by_intention ? hidden < options.hidden_fraction[0] || hidden > options.hidden_fraction[1]
                       : piece.visible_fraction() < options.least_visible_fraction)
        return std::nullopt;
      if (piece.visible_px == 0) return std::nullopt;  // nothing seen is no ground truth
    }
    scene.depth = std::move(composite.depth);
    scene.piece_at = std::move(composite.piece_at);
    drop_far(scene.depth, scene.farthest_mm);
    for (std::size_t p = 0; p < scene.piece_at.size(); ++p)
      if (scene.depth.z_mm[p] == 0) scene.piece_at[p] = -1;
    return scene;
  }
};

SceneGenerator::SceneGenerator(std::vector<ScenePart> catalogue, std::vector<ScenePart> unknown,
                               const SceneOptions& options) {
  options.check();
  impl_ = std::make_unique<const Impl>(std::move(catalogue), std::move(unknown), options);
}
SceneGenerator::~SceneGenerator() = default;
SceneGenerator::SceneGenerator(SceneGenerator&&) noexcept = default;

const SceneOptions& SceneGenerator::options() const { return impl_->options; }
const std::vector<std::string>& SceneGenerator::names() const { return impl_->names; }
const TriangleMesh& SceneGenerator::mesh(int catalogue_index) const {
  return *impl_->catalogue.at(catalogue_index).body.mesh;
}
const RestingPoses& SceneGenerator::resting_poses(int catalogue_index) const {
  return impl_->catalogue.at(catalogue_index).resting;
}
const std::vector<std::string>& SceneGenerator::unknown_names() const { return impl_->unknown_names; }
const TriangleMesh& SceneGenerator::unknown_mesh(int unknown_index) const {
  return *impl_->unknown.at(unknown_index).body.mesh;
}

SyntheticScene SceneGenerator::generate(std::uint64_t frame) const {
  Random random(impl_->options.seed, frame);
  for (int i = 0; i < most_attempts; ++i)
    if (auto scene = impl_->attempt(random, frame)) return std::move(*scene);
  throw Error(
      "scenes: frame {}: no arrangement in {} has all parts on the table and visible enough; ask for fewer "
      "parts or less clutter, lower least_visible_fraction, or a farther camera",
      frame, most_attempts);
}

DepthImage render_scene(const SyntheticScene& scene, const Eigen::Isometry3d& other_from_camera,
                        const Intrinsics& intrinsics) {
  std::vector<Silhouette> silhouettes;
  for (const auto& piece : scene.pieces)
    silhouettes.push_back(silhouette(Body(piece.mesh), other_from_camera * piece.camera_from_model, intrinsics, false));
  DepthImage depth = composed(silhouettes, intrinsics).depth;
  drop_far(depth, scene.farthest_mm);
  return depth;
}

SceneSensor ideal_sensor() {
  return [](const SyntheticScene& scene, std::uint64_t) { return scene.depth; };
}

SceneSensor gaussian_ray_sensor(double standard_deviation_mm) {
  if (!(standard_deviation_mm >= 0 && standard_deviation_mm <= 1000))
    throw Error("standard deviation {} mm: must be 0 to 1000", standard_deviation_mm);
  return [standard_deviation_mm](const SyntheticScene& scene, std::uint64_t seed) {
    DepthImage depth = scene.depth;
    const std::uint64_t frame_seed = Random(seed, scene.frame).next();
    for (int v = 0; v < depth.height; ++v)
      for (int u = 0; u < depth.width; ++u) {
        float& z = depth.at(u, v);
        if (z <= 0) continue;
        const double length = scene.intrinsics.unproject(u, v, z).cast<double>().norm();
        const double noise = Random(frame_seed, static_cast<std::uint64_t>(v) * depth.width + u).normal_pair().first;
        z = static_cast<float>(std::max(0.0, z * (1 + standard_deviation_mm * noise / length)));
      }
    drop_far(depth, scene.farthest_mm);
    return depth;
  };
}

SceneSensor stereo_scene_sensor(const StereoSensorOptions& options) {
  options.check();
  return [options](const SyntheticScene& scene, std::uint64_t seed) {
    const DepthImage right = render_scene(scene, right_from_left(options), scene.intrinsics);
    StereoCapture capture =
        stereo_capture(scene.depth, right, scene.intrinsics, options, Random(seed, scene.frame).next());
    drop_far(capture.depth, scene.farthest_mm);
    return std::move(capture.depth);
  };
}

}  // namespace partpose
