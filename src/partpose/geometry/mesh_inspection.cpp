// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/mesh_inspection.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <unordered_map>

namespace partpose {

namespace {

using Triangle = std::array<int, 3>;

void check(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error("the mesh has no triangles");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int v : mesh.triangles[t]) {
      if (v < 0 || v >= static_cast<int>(mesh.vertices.size()))
        throw Error("triangle {} has vertex {}, the mesh has {} vertices", t, v, mesh.vertices.size());
      if (!mesh.vertices[v].allFinite()) throw Error("vertex {} is not finite", v);
    }
}

bool has_equal_corners(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// A use of an edge by a triangle, from its corner `k` to the next.
struct EdgeUse {
  std::uint64_t edge;  ///< smaller vertex above larger one
  int triangle;
  bool rising;  ///< from the smaller to the larger vertex

  bool operator<(const EdgeUse& other) const {
    return edge != other.edge ? edge < other.edge : triangle < other.triangle;
  }
};

std::vector<EdgeUse> edge_uses(const std::vector<Triangle>& triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint64_t>(triangles[t][k]),
                 b = static_cast<std::uint64_t>(triangles[t][(k + 1) % 3]);
      uses.push_back({std::min(a, b) << 32 | std::max(a, b), static_cast<int>(t), a < b});
    }
  std::sort(uses.begin(), uses.end());
  return uses;
}

/// Calls `visit(first, last)` for the uses of each edge.
template <typename Visit>
void for_each_edge(const std::vector<EdgeUse>& uses, const Visit& visit) {
  for (auto first = uses.begin(); first != uses.end();) {
    const auto last = std::find_if(first, uses.end(), [&](const EdgeUse& use) { return use.edge != first->edge; });
    visit(first, last);
    first = last;
  }
}

int open_edges(const std::vector<Triangle>& triangles) {
  int open = 0;
  for_each_edge(edge_uses(triangles), [&](auto first, auto last) { open += (last - first) % 2 != 0; });
  return open;
}

/// Without triangles of two equal corners and without copies. A copy has the same three corners, wound either way.
struct Cleaned {
  std::vector<Triangle> triangles;
  int equal_corners = 0, duplicates = 0;
};

Cleaned cleaned(const std::vector<Triangle>& triangles) {
  Cleaned out;
  std::vector<std::pair<Triangle, int>> keys;
  std::vector<char> keep(triangles.size(), 1);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (has_equal_corners(triangles[t])) {
      ++out.equal_corners;
      keep[t] = 0;
      continue;
    }
    Triangle key = triangles[t];
    std::sort(key.begin(), key.end());
    keys.emplace_back(key, static_cast<int>(t));
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (keys[i].first == keys[i - 1].first) {
      ++out.duplicates;
      keep[keys[i].second] = 0;
    }
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (keep[t]) out.triangles.push_back(triangles[t]);
  return out;
}

/// Pieces of surface, and how to turn them outwards.
struct Orientation {
  int shells = 0;
  std::vector<char> turn;  ///< per triangle
  int turned() const { return static_cast<int>(std::count(turn.begin(), turn.end(), 1)); }
};

double signed_volume(const TriangleMesh& mesh, const Triangle& t, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>() - origin;
  const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>() - origin;
  const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>() - origin;
  return a.dot(b.cross(c)) / 6;
}

/// The solid angle of a triangle seen from a point, signed (van Oosterom and Strackee 1983, eq. 8).
double solid_angle(const TriangleMesh& mesh, const Triangle& t, const Eigen::Vector3d& from) {
  const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>() - from;
  const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>() - from;
  const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>() - from;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

struct Shell {
  std::vector<int> triangles;
  Eigen::AlignedBox3d box;
  bool closed = true;
  double volume = 0;  ///< signed, from the middle of the box
};

Orientation oriented(const TriangleMesh& mesh, const std::vector<Triangle>& triangles) {
  // Neighbours across edges of two triangles, with whether they are wound alike; sheets meet at the other edges, where
  // nothing tells which belongs to which.
  std::vector<std::vector<std::pair<int, bool>>> neighbours(triangles.size());
  std::vector<char> at_gap(triangles.size(), 0);
  for_each_edge(edge_uses(triangles), [&](auto first, auto last) {
    if (last - first == 2) {
      const bool alike = first[0].rising != first[1].rising;
      neighbours[first[0].triangle].emplace_back(first[1].triangle, alike);
      neighbours[first[1].triangle].emplace_back(first[0].triangle, alike);
    } else if ((last - first) % 2 != 0) {
      for (auto use = first; use != last; ++use) at_gap[use->triangle] = 1;
    }
  });

  Orientation out;
  out.turn.assign(triangles.size(), 0);
  std::vector<int> shell_of(triangles.size(), -1);
  std::vector<Shell> shells;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (shell_of[seed] >= 0) continue;
    const int id = static_cast<int>(shells.size());
    Shell& shell = shells.emplace_back();
    shell.triangles = {static_cast<int>(seed)};
    shell_of[seed] = id;
    for (std::size_t next = 0; next < shell.triangles.size(); ++next) {
      const int t = shell.triangles[next];
      if (at_gap[t]) shell.closed = false;
      for (const int v : triangles[t]) shell.box.extend(mesh.vertices[v].cast<double>());
      for (const auto& [other, alike] : neighbours[t]) {
        if (shell_of[other] >= 0) continue;
        shell_of[other] = id;
        out.turn[other] = alike ? out.turn[t] : !out.turn[t];
        shell.triangles.push_back(other);
      }
    }
    for (const int t : shell.triangles)
      shell.volume += (out.turn[t] ? -1 : 1) * signed_volume(mesh, triangles[t], shell.box.center());
  }
  out.shells = static_cast<int>(shells.size());

  for (std::size_t s = 0; s < shells.size(); ++s) {
    const Shell& shell = shells[s];
    // In how many closed shells it lies: within one, it bounds a cavity when it faces inwards.
    int depth = 0;
    if (shell.volume < 0 && shell.closed) {
      const Eigen::Vector3d point = mesh.vertices[triangles[shell.triangles[0]][0]].cast<double>();
      for (std::size_t o = 0; o < shells.size(); ++o) {
        if (o == s || !shells[o].closed || !shells[o].box.contains(shell.box)) continue;
        double angle = 0;
        for (const int t : shells[o].triangles)
          angle += (out.turn[t] ? -1 : 1) * solid_angle(mesh, triangles[t], point);
        depth += std::abs(angle) > 2 * std::numbers::pi;
      }
    }
    const double box_volume = shell.box.diagonal().prod();
    const bool is_flat = std::abs(shell.volume) <= 1e-6 * box_volume || !(box_volume > 0);
    const bool is_cavity = depth % 2 == 1;
    int turned = 0;
    for (const int t : shell.triangles) turned += out.turn[t];
    // A flat sheet has no outside: only neighbours are made alike, by the majority.
    const bool turn_all =
        is_flat ? 2 * turned > static_cast<int>(shell.triangles.size()) : shell.volume < 0 && !is_cavity;
    if (turn_all)
      for (const int t : shell.triangles) out.turn[t] = !out.turn[t];
  }
  return out;
}

/// The first vertex, by their order, within `distance` of each; by a grid of cells of that size.
std::vector<int> welded(const TriangleMesh& mesh, double distance) {
  struct Hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& cell) const {
      std::uint64_t h = 1469598103934665603ull;
      for (const auto c : cell) h = (h ^ static_cast<std::uint64_t>(c)) * 1099511628211ull;
      return h ^ (h >> 29);
    }
  };
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<int>, Hash> cells;
  std::vector<int> index(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d p = mesh.vertices[i].cast<double>();
    std::array<std::int64_t, 3> cell;
    for (int k = 0; k < 3; ++k) cell[k] = static_cast<std::int64_t>(std::floor(p[k] / distance));
    int found = -1;
    for (int n = 0; n < 27; ++n) {
      const auto there = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (there == cells.end()) continue;
      for (const int other : there->second)
        if ((mesh.vertices[other].cast<double>() - p).norm() <= distance && (found < 0 || other < found)) found = other;
    }
    if (found < 0) cells[cell].push_back(found = static_cast<int>(i));
    index[i] = found;
  }
  return index;
}

std::vector<Triangle> renumbered(const std::vector<Triangle>& triangles, const std::vector<int>& index) {
  std::vector<Triangle> out;
  out.reserve(triangles.size());
  for (const auto& t : triangles) out.push_back({index[t[0]], index[t[1]], index[t[2]]});
  return out;
}

/// Only the vertices that triangles use, in their order.
TriangleMesh without_unused_vertices(const TriangleMesh& mesh) {
  std::vector<int> index(mesh.vertices.size(), -1);
  for (const auto& t : mesh.triangles)
    for (const int v : t) index[v] = 0;
  TriangleMesh out;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (index[v] < 0) continue;
    index[v] = static_cast<int>(out.vertices.size());
    out.vertices.push_back(mesh.vertices[v]);
  }
  out.triangles = renumbered(mesh.triangles, index);
  return out;
}

struct UnitGuess {
  const char* name;
  double mm;
};
constexpr std::array<UnitGuess, 3> units = {{{"metre", 1000}, {"inch", 25.4}, {"micrometre", 1e-3}}};

}  // namespace

std::string guess_unit(double diagonal_mm) {
  constexpr double largest_in_metres = 2, largest_in_inches = 12, largest_in_mm = 5000;
  if (!(diagonal_mm > 0)) return {};
  if (diagonal_mm < largest_in_metres) return "metre";
  if (diagonal_mm < largest_in_inches) return "inch";
  return diagonal_mm > largest_in_mm ? "micrometre" : "";
}

double mm_per_unit(const std::string& unit) {
  for (const auto& known : units)
    if (unit == known.name) return known.mm;
  return 1;
}

MeshInspection inspect_mesh(const TriangleMesh& given) {
  check(given);
  const TriangleMesh mesh = without_unused_vertices(with_merged_vertices(given));
  MeshInspection out;
  out.triangles = static_cast<int>(mesh.triangles.size());
  out.vertices = static_cast<int>(mesh.vertices.size());
  const auto box = bounding_box(mesh);
  for (int k = 0; k < 3; ++k) out.size_mm[k] = box.sizes()[k];
  out.diagonal_mm = box.diagonal().norm();
  out.unit_guess = guess_unit(out.diagonal_mm);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    out.degenerate_triangles += has_equal_corners(mesh.triangles[t]) || mesh.face_normal(t).isZero();

  const Cleaned clean = cleaned(mesh.triangles);
  out.duplicate_triangles = clean.duplicates;
  for (const auto& t : clean.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    out.area_mm2 += (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a).norm() / 2;
  }
  for_each_edge(edge_uses(clean.triangles), [&](auto first, auto last) {
    out.open_edges += (last - first) % 2 != 0;
    out.non_manifold_edges += last - first > 2;
  });
  out.watertight = out.open_edges == 0 && !clean.triangles.empty();
  const Orientation orientation = oriented(mesh, clean.triangles);
  out.shells = orientation.shells;
  out.flipped_triangles = orientation.turned();
  if (out.watertight && out.flipped_triangles == 0) {
    double volume = 0;
    for (const auto& t : clean.triangles) volume += signed_volume(mesh, t, box.center());
    out.volume_mm3 = volume;
  }
  return out;
}

MeshRepair repair_mesh(const TriangleMesh& given, std::optional<double> weld_distance_mm) {
  check(given);
  if (weld_distance_mm && !(*weld_distance_mm > 0 && std::isfinite(*weld_distance_mm)))
    throw Error("weld_distance_mm {}: must be positive", *weld_distance_mm);
  MeshRepair out;
  TriangleMesh mesh = without_unused_vertices(with_merged_vertices(given));

  constexpr double relative_weld_distance = 1e-6;
  const double distance = weld_distance_mm.value_or(relative_weld_distance * bounding_box_diagonal(mesh));
  if (distance > 0) {
    const auto index = welded(mesh, distance);
    const auto triangles = renumbered(mesh.triangles, index);
    if (open_edges(cleaned(triangles).triangles) < open_edges(cleaned(mesh.triangles).triangles)) {
      for (std::size_t v = 0; v < index.size(); ++v) out.welded_vertices += index[v] != static_cast<int>(v);
      out.weld_distance_mm = distance;
      mesh.triangles = triangles;
    }
  }

  Cleaned clean = cleaned(mesh.triangles);
  out.removed_degenerate = clean.equal_corners;
  out.removed_duplicates = clean.duplicates;
  mesh.triangles = std::move(clean.triangles);
  // Triangles without area stay where they close the surface between their neighbours.
  std::vector<char> at_gap(mesh.triangles.size(), 0);
  for_each_edge(edge_uses(mesh.triangles), [&](auto first, auto last) {
    if (last - first != 2)
      for (auto use = first; use != last; ++use) at_gap[use->triangle] = 1;
  });
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (at_gap[t] && mesh.face_normal(t).isZero())
      ++out.removed_degenerate;
    else
      kept.push_back(mesh.triangles[t]);
  mesh.triangles = std::move(kept);
  if (mesh.triangles.empty()) throw Error("none of the {} triangles has an area", given.triangles.size());

  const Orientation orientation = oriented(mesh, mesh.triangles);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (orientation.turn[t]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  out.turned_triangles = orientation.turned();
  out.mesh = without_unused_vertices(mesh);
  return out;
}

}  // namespace partpose
