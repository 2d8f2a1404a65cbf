// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/resting_poses.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace partpose {

namespace {

/// Centre of mass of a mesh by its volume integral, if it is closed and its triangles face one way.
std::optional<Eigen::Vector3d> centre_of_solid(const TriangleMesh& mesh) {
  const TriangleMesh merged = with_merged_vertices(mesh);
  std::map<std::pair<int, int>, int> uses;  // of each directed edge, less those of the opposite one
  const Eigen::Vector3d centre = bounding_box(merged).center();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double volume = 0;
  for (const auto& [a, b, c] : merged.triangles) {
    if (a == b || b == c || c == a) continue;
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
      uses[std::minmax(from, to)] += from < to ? 1 : -1;
    const Eigen::Vector3d va = merged.vertices[a].cast<double>() - centre,
                          vb = merged.vertices[b].cast<double>() - centre,
                          vc = merged.vertices[c].cast<double>() - centre;
    const double tetrahedron = va.dot(vb.cross(vc)) / 6;
    volume += tetrahedron;
    moment += tetrahedron * (va + vb + vc) / 4;
  }
  for (const auto& [edge, count] : uses)
    if (count != 0) return std::nullopt;
  // Inside out all over is as good. Two sheets back to back are closed, but have no volume.
  if (std::abs(volume) < 1e-6 * std::pow(bounding_box_diagonal(merged), 3)) return std::nullopt;
  return centre + moment / volume;
}

/// Solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983, eq. 8); positive from below it.
double solid_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// A face of the hull: all its triangles that touch a table together.
struct Face {
  Eigen::Vector3d down;  ///< outward unit normal
  double share = 0;      ///< of the solid angle
  double height_mm = 0;  ///< of the centre of mass when the part lies on it
  struct Edge {
    double distance_mm;  ///< of the projected centre of mass to the edge, positive inside
    int beyond;          ///< the face that comes next when the part topples over it
  };
  std::vector<Edge> edges;

  double stability_deg() const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& edge : edges) least = std::min(least, edge.distance_mm);
    return degrees(std::atan2(least, height_mm));
  }
};

class Faces {
 public:
  Faces(const ConvexHull& hull, const Eigen::Vector3d& centre, double tolerance_mm)
      : hull_(hull), centre_(centre), face_of_(hull.triangles.size(), -1) {
    group_triangles(tolerance_mm);
    faces.resize(triangles_.size());
    for (std::size_t f = 0; f < faces.size(); ++f) measure(static_cast<int>(f));
    double sum = 0;
    for (const auto& face : faces) sum += face.share;
    for (auto& face : faces) face.share /= sum;
  }

  std::vector<Face> faces;

 private:
  Eigen::Vector3d area_vector(int t) const {
    const auto& [a, b, c] = hull_.triangles[t];
    return (hull_.vertices[b] - hull_.vertices[a]).cross(hull_.vertices[c] - hull_.vertices[a]) / 2;
  }

  /// Largest triangles first, each with the neighbours that lie in its plane within the tolerance.
  void group_triangles(double tolerance_mm) {
    std::vector<int> order(hull_.triangles.size());
    std::iota(order.begin(), order.end(), 0);
    std::vector<double> area(order.size());
    for (const int t : order) area[t] = area_vector(t).norm();
    std::stable_sort(order.begin(), order.end(), [&](int s, int t) { return area[s] > area[t]; });
    for (const int seed : order) {
      if (face_of_[seed] >= 0) continue;
      const int face = static_cast<int>(triangles_.size());
      const Eigen::Vector3d normal = area_vector(seed).normalized();
      const double level = normal.dot(hull_.vertices[hull_.triangles[seed][0]]);
      triangles_.push_back({seed});
      face_of_[seed] = face;
      for (std::size_t i = 0; i < triangles_[face].size(); ++i)
        for (const int next : hull_.neighbours[triangles_[face][i]]) {
          if (face_of_[next] >= 0) continue;
          // A sliver at the rim of a thin plate lies in the planes of both sides: it belongs to the one that it faces.
          bool touches = area_vector(next).dot(normal) >= 0;
          for (const int v : hull_.triangles[next])
            touches = touches && normal.dot(hull_.vertices[v]) > level - tolerance_mm;
          if (!touches) continue;
          face_of_[next] = face;
          triangles_[face].push_back(next);
        }
    }
  }

  void measure(int f) {
    Face& face = faces[f];
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const int t : triangles_[f]) normal += area_vector(t);
    face.down = normal.normalized();
    for (const int t : triangles_[f]) {
      const auto& [a, b, c] = hull_.triangles[t];
      face.share += hull_.flat ? area_vector(t).norm()
                               : std::max(0.0, solid_angle(hull_.vertices[a] - centre_, hull_.vertices[b] - centre_,
                                                           hull_.vertices[c] - centre_));
    }
    std::map<int, std::pair<int, int>> border;  // from a vertex: the next one, and the face beyond
    for (const int t : triangles_[f])
      for (int k = 0; k < 3; ++k) {
        const int beyond = face_of_[hull_.neighbours[t][k]];
        if (beyond != f) border[hull_.triangles[t][k]] = {hull_.triangles[t][(k + 1) % 3], beyond};
      }
    for (const auto& [v, unused] : border)
      face.height_mm = std::max(face.height_mm, face.down.dot(hull_.vertices[v] - centre_));
    support_polygon(face, border);
  }

  /// The convex outline of a face in its own plane. A border that is a little dented (corners within the tolerance of
  /// the plane) must not cut off the middle, hence the outline; the face beyond is that of the longest edge skipped.
  void support_polygon(Face& face, const std::map<int, std::pair<int, int>>& border) const {
    const Eigen::Vector3d x = face.down.unitOrthogonal(), y = face.down.cross(x);  // counter-clockwise from outside
    std::vector<Eigen::Vector2d> corners;
    std::vector<int> vertex;
    for (const auto& [v, unused] : border) {
      const Eigen::Vector3d p = hull_.vertices[v] - centre_;
      corners.emplace_back(p.dot(x), p.dot(y));
      vertex.push_back(v);
    }
    const std::vector<int> outline = convex_outline(corners);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const int from = outline[i], to = outline[(i + 1) % outline.size()];
      const Eigen::Vector2d &a = corners[from], edge = corners[to] - a;
      if (!(edge.norm() > 0)) continue;
      const double distance = (a.x() * edge.y() - a.y() * edge.x()) / edge.norm();  // of the point below the centre
      face.edges.push_back({distance, face_beyond(border, vertex[from], vertex[to])});
    }
  }

  int face_beyond(const std::map<int, std::pair<int, int>>& border, int from, int to) const {
    double longest = -1;
    int beyond = border.at(from).second;
    for (std::size_t steps = 0; from != to && steps < border.size(); ++steps) {
      const auto it = border.find(from);
      if (it == border.end()) break;
      const auto& [next, face] = it->second;
      const double length = (hull_.vertices[next] - hull_.vertices[from]).norm();
      if (length > longest) {
        longest = length;
        beyond = face;
      }
      from = next;
    }
    return beyond;
  }

  const ConvexHull& hull_;
  const Eigen::Vector3d& centre_;
  std::vector<int> face_of_;                 ///< of each triangle
  std::vector<std::vector<int>> triangles_;  ///< of each face
};

/// Indices of faces from the highest centre of mass to the lowest.
std::vector<int> from_high_to_low(const std::vector<Face>& faces) {
  std::vector<int> order(faces.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int f, int g) { return faces[f].height_mm > faces[g].height_mm; });
  return order;
}

struct Outcome {
  std::vector<int> rests_on;        ///< for each face that the part may land on, before any nudge
  std::vector<double> probability;  ///< that it ends on each face
};

/// Where a part that lands on each face comes to rest. Toppling lowers the centre of mass, so it ends.
Outcome after_toppling(const std::vector<Face>& faces, double least_stability_deg, double level_tolerance) {
  const std::vector<int> order = from_high_to_low(faces);
  std::vector<int> rank(faces.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<int>(i);

  Outcome out{std::vector<int>(faces.size()), std::vector<double>(faces.size(), 0.0)};
  for (auto it = order.rbegin(); it != order.rend(); ++it) {  // low to high: what is below is known
    const int f = *it;
    out.rests_on[f] = f;
    double farthest = 0;
    for (const auto& edge : faces[f].edges)
      if (edge.distance_mm < farthest && rank[edge.beyond] > rank[f]) {
        farthest = edge.distance_mm;
        out.rests_on[f] = out.rests_on[edge.beyond];
      }
  }
  for (std::size_t f = 0; f < faces.size(); ++f) out.probability[out.rests_on[f]] += faces[f].share;

  // A nudge topples what hardly stands if there is somewhere lower to go, sooner over the nearer edges.
  for (const int f : order) {
    const double reach_mm = faces[f].height_mm * std::tan(radians(least_stability_deg));
    const auto weight = [&](const Face::Edge& edge) {
      const bool lower = faces[out.rests_on[edge.beyond]].height_mm < (1 - level_tolerance) * faces[f].height_mm;
      return lower ? std::max(0.0, reach_mm - edge.distance_mm) : 0.0;
    };
    double sum = 0;
    for (const auto& edge : faces[f].edges) sum += weight(edge);
    if (out.probability[f] == 0 || sum == 0) continue;
    for (const auto& edge : faces[f].edges)
      out.probability[out.rests_on[edge.beyond]] += out.probability[f] * weight(edge) / sum;
    out.probability[f] = 0;
  }
  return out;
}

/// Faces that roll into one another: neighbours at the same height within the tolerance, both at rest, with little to
/// roll over on the way.
std::vector<int> rolling_groups(const std::vector<Face>& faces, const Outcome& outcome, double level_tolerance) {
  std::vector<int> parent(faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int f) {
    while (parent[f] != f) f = parent[f] = parent[parent[f]];
    return f;
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (outcome.probability[f] == 0) continue;
    for (const auto& edge : faces[f].edges) {
      // Narrow faces of a curve may topple on to the next: follow to where it rests.
      const int g = outcome.rests_on[edge.beyond];
      if (outcome.probability[g] == 0) continue;
      const double h = faces[f].height_mm;
      const double on_edge_mm = std::hypot(h, edge.distance_mm);
      if (std::abs(faces[g].height_mm - h) <= level_tolerance * h && on_edge_mm - h <= level_tolerance * h)
        parent[std::max(root(f), root(g))] = std::min(root(f), root(g));
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f) parent[f] = root(static_cast<int>(f));
  return parent;
}

Eigen::Isometry3d table_from_model(const ConvexHull& hull, const Eigen::Vector3d& centre, const Eigen::Vector3d& down) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond::FromTwoVectors(down, -Eigen::Vector3d::UnitZ()).toRotationMatrix();
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto& v : hull.vertices) lowest = std::min(lowest, pose.linear().row(2).dot(v));
  const Eigen::Vector3d turned = pose.linear() * centre;
  pose.translation() = Eigen::Vector3d(-turned.x(), -turned.y(), -lowest);
  return pose;
}

}  // namespace

void RestingPoseOptions::check() const {
  if (!(contact_tolerance >= 1e-6 && contact_tolerance <= 0.1))
    throw Error("contact_tolerance {}: must be 1e-6 to 0.1", contact_tolerance);
  if (!(least_stability_deg >= 0 && least_stability_deg <= 45))
    throw Error("least_stability_deg {}: must be 0 to 45", least_stability_deg);
  if (!(merge_deg >= 0 && merge_deg <= 45)) throw Error("merge_deg {}: must be 0 to 45", merge_deg);
  if (!(level_tolerance >= 0 && level_tolerance <= 0.5))
    throw Error("level_tolerance {}: must be 0 to 0.5", level_tolerance);
}

RestingPoses resting_poses(const TriangleMesh& mesh, const RestingPoseOptions& options) {
  options.check();
  // Only vertices of triangles count; an exporter's leftovers do not hold a part up.
  std::vector<Eigen::Vector3f> points;
  for (const auto& triangle : mesh.triangles)
    for (const int v : triangle) points.push_back(mesh.vertices.at(v));
  const ConvexHull hull = convex_hull(points);
  const double diagonal_mm = bounding_box_diagonal(mesh);

  RestingPoses out;
  const auto of_solid = hull.flat ? std::nullopt : centre_of_solid(mesh);
  out.centre_of_mass_mm = of_solid.value_or(hull.centroid());
  out.centre_of_mass_from_mesh = of_solid.has_value();
  // The centre of mass of a solid is inside its hull; anything else comes of pieces that are inside out.
  for (const auto& [a, b, c] : hull.triangles)
    if ((hull.vertices[b] - hull.vertices[a])
                .cross(hull.vertices[c] - hull.vertices[a])
                .dot(out.centre_of_mass_mm - hull.vertices[a]) >= 0 &&
        !hull.flat) {
      out.centre_of_mass_mm = hull.centroid();
      out.centre_of_mass_from_mesh = false;
    }

  const Faces hull_faces(hull, out.centre_of_mass_mm, options.contact_tolerance * diagonal_mm);
  const auto& faces = hull_faces.faces;
  const Outcome outcome = after_toppling(faces, options.least_stability_deg, options.level_tolerance);
  const auto& probability = outcome.probability;
  std::vector<int> group = rolling_groups(faces, outcome, options.level_tolerance);

  std::vector<int> order;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (probability[f] > 0) order.push_back(static_cast<int>(f));
  std::stable_sort(order.begin(), order.end(), [&](int f, int g) { return probability[f] > probability[g]; });

  std::vector<int> merged_into;  // the face of each pose
  for (const int f : order) {
    int pose = -1;
    double best = std::cos(radians(options.merge_deg));
    for (std::size_t i = 0; i < out.poses.size(); ++i) {
      const double cosine = out.poses[i].down.dot(faces[f].down);
      if (cosine > best) {
        best = cosine;
        pose = static_cast<int>(i);
      }
    }
    if (pose >= 0) {
      out.poses[pose].probability += probability[f];
      const int a = group[f], b = group[merged_into[pose]];  // what is one pose is of one group
      std::replace(group.begin(), group.end(), std::max(a, b), std::min(a, b));
      continue;
    }
    out.poses.push_back({table_from_model(hull, out.centre_of_mass_mm, faces[f].down), probability[f],
                         faces[f].height_mm, std::max(0.0, faces[f].stability_deg()), 0, faces[f].down});
    merged_into.push_back(f);
  }

  std::vector<std::size_t> by_probability(out.poses.size());
  std::iota(by_probability.begin(), by_probability.end(), 0);
  std::stable_sort(by_probability.begin(), by_probability.end(),
                   [&](auto i, auto j) { return out.poses[i].probability > out.poses[j].probability; });
  std::vector<RestingPose> sorted;
  std::map<int, int> number;  // groups from 0 on, in order of appearance
  for (const auto i : by_probability) {
    sorted.push_back(out.poses[i]);
    sorted.back().group = number.try_emplace(group[merged_into[i]], static_cast<int>(number.size())).first->second;
  }
  out.poses = std::move(sorted);
  out.groups = static_cast<int>(number.size());
  return out;
}

}  // namespace partpose
