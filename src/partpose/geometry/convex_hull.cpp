// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/convex_hull.hpp"

#include "partpose/core/error.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace partpose {

namespace {

/// Coordinates from 0 to 2^20: differences take 20 bits and a sign, cross products 41, volumes less than 63.
using GridPoint = Eigen::Matrix<std::int64_t, 3, 1>;
constexpr double grid_steps = 1 << 20;

struct GridPoints {
  std::vector<GridPoint> points;  ///< sorted, each once
  std::vector<int> original;
};

GridPoints on_grid(std::span<const Eigen::Vector3f> points_mm) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    if (!points_mm[i].allFinite()) throw Error("convex hull: point {} has a coordinate that is not finite", i);
    low = low.cwiseMin(points_mm[i].cast<double>());
    high = high.cwiseMax(points_mm[i].cast<double>());
  }
  if (points_mm.empty()) throw Error("convex hull: there are no points");
  const double extent = (high - low).maxCoeff();
  const double per_mm = extent > 0 ? grid_steps / extent : 0;

  std::vector<std::pair<std::array<std::int64_t, 3>, int>> rounded(points_mm.size());
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    for (int k = 0; k < 3; ++k) rounded[i].first[k] = std::llround((double(points_mm[i][k]) - low[k]) * per_mm);
    rounded[i].second = static_cast<int>(i);
  }
  std::sort(rounded.begin(), rounded.end());
  GridPoints out;
  for (std::size_t i = 0; i < rounded.size(); ++i) {
    if (i > 0 && rounded[i].first == rounded[i - 1].first) continue;
    const auto& [x, y, z] = rounded[i].first;
    out.points.emplace_back(x, y, z);
    out.original.push_back(rounded[i].second);
  }
  return out;
}

struct Face {
  std::array<int, 3> corner;
  std::array<int, 3> neighbour = {-1, -1, -1};  ///< beyond the edge from corner k to the next
  GridPoint normal;
  std::vector<int> above;  ///< points above it that are not yet in the hull
  bool removed = false;
};

class Quickhull {
 public:
  explicit Quickhull(const std::vector<GridPoint>& points) : points_(points) {}

  /// False when all points lie in one plane.
  bool run() {
    const auto simplex = first_simplex();
    if (!simplex) return false;
    start_with(*simplex);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (!faces_[f].removed && !faces_[f].above.empty()) add_farthest_above(static_cast<int>(f));
    return true;
  }
  const std::vector<Face>& faces() const { return faces_; }

  /// Three points that are not on one line, as far apart as a greedy choice makes them. Throws Error when all are.
  std::array<int, 3> first_triangle() const {
    int a = 0, b = static_cast<int>(points_.size()) - 1;  // sorted: the extremes of x
    int c = -1;
    double largest = 0;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
      const double area = (points_[b] - points_[a]).cross(points_[i] - points_[a]).cast<double>().squaredNorm();
      if (area > largest) {
        largest = area;
        c = i;
      }
    }
    if (c < 0) throw Error("convex hull: all points are on one line; a surface is needed");
    return {a, b, c};
  }

 private:
  std::int64_t height(const Face& face, int point) const {
    return face.normal.dot(points_[point] - points_[face.corner[0]]);
  }

  std::optional<std::array<int, 4>> first_simplex() const {
    const auto [a, b, c] = first_triangle();
    const GridPoint normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]);
    int d = -1;
    std::int64_t largest = 0;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
      const std::int64_t distance = std::abs(normal.dot(points_[i] - points_[a]));
      if (distance > largest) {
        largest = distance;
        d = i;
      }
    }
    if (d < 0) return std::nullopt;
    if (normal.dot(points_[d] - points_[a]) > 0) return std::array{a, c, b, d};
    return std::array{a, b, c, d};  // d below the triangle a b c
  }

  int add_face(int a, int b, int c) {
    Face face;
    face.corner = {a, b, c};
    face.normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]);
    faces_.push_back(std::move(face));
    return static_cast<int>(faces_.size()) - 1;
  }

  void start_with(const std::array<int, 4>& simplex) {
    const auto [a, b, c, d] = simplex;
    add_face(a, b, c);
    add_face(a, d, b);
    add_face(b, d, c);
    add_face(c, d, a);
    faces_[0].neighbour = {1, 2, 3};
    faces_[1].neighbour = {3, 2, 0};
    faces_[2].neighbour = {1, 3, 0};
    faces_[3].neighbour = {2, 1, 0};
    std::vector<int> all(points_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    distribute(all, {0, 1, 2, 3});
  }

  /// Each point to the first of the faces that it is above; points above none are inside.
  void distribute(const std::vector<int>& points, const std::vector<int>& faces) {
    for (const int p : points)
      for (const int f : faces)
        if (height(faces_[f], p) > 0) {
          faces_[f].above.push_back(p);
          break;
        }
  }

  void add_farthest_above(int start) {
    const Face& face = faces_[start];
    const int apex = *std::max_element(face.above.begin(), face.above.end(),
                                       [&](int p, int q) { return height(face, p) < height(face, q); });
    // What the point sees, and the border of it, which is one closed chain of edges.
    std::vector<int> visible = {start};
    faces_[start].removed = true;
    struct Edge {
      int to, beyond, beyond_slot;
    };
    std::map<int, Edge> border;  // by the corner that the edge starts from
    for (std::size_t i = 0; i < visible.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const int other = faces_[visible[i]].neighbour[k];
        if (faces_[other].removed) continue;
        if (height(faces_[other], apex) > 0) {
          faces_[other].removed = true;
          visible.push_back(other);
        }
      }
    }
    std::vector<int> loose;
    for (const int f : visible) {
      for (int k = 0; k < 3; ++k) {
        const int other = faces_[f].neighbour[k];
        if (faces_[other].removed) continue;
        const int from = faces_[f].corner[k], to = faces_[f].corner[(k + 1) % 3];
        int slot = 0;
        while (faces_[other].corner[slot] != to) ++slot;  // there the edge runs the other way
        border[from] = {to, other, slot};
      }
    }
    for (const int f : visible) {
      loose.insert(loose.end(), faces_[f].above.begin(), faces_[f].above.end());
      faces_[f].above = {};
    }
    // A fan of new faces from the border to the point.
    std::vector<int> fan;
    const int first = border.begin()->first;
    int from = first;
    do {
      const Edge edge = border.at(from);
      const int f = add_face(from, edge.to, apex);
      faces_[f].neighbour[0] = edge.beyond;
      faces_[edge.beyond].neighbour[edge.beyond_slot] = f;
      fan.push_back(f);
      from = edge.to;
    } while (from != first);
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const int next = fan[(i + 1) % fan.size()];
      faces_[fan[i]].neighbour[1] = next;
      faces_[next].neighbour[2] = fan[i];
    }
    distribute(loose, fan);
  }

  const std::vector<GridPoint>& points_;
  std::vector<Face> faces_;
};

/// Both sides of the outline of points in one plane, as two fans of triangles.
std::vector<Face> flat_hull(const std::vector<GridPoint>& points, const std::array<int, 3>& triangle) {
  const GridPoint normal = (points[triangle[1]] - points[triangle[0]]).cross(points[triangle[2]] - points[triangle[0]]);
  int drop = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[drop])) drop = k;
  const int x = (drop + 1) % 3, y = (drop + 2) % 3;
  const auto turn = [&](int a, int b, int c) {
    const GridPoint ab = points[b] - points[a], ac = points[c] - points[a];
    return ab[x] * ac[y] - ab[y] * ac[x];
  };
  std::vector<int> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(points[a][x], points[a][y]) < std::pair(points[b][x], points[b][y]);
  });
  const std::vector<int> outline = convex_outline(std::move(order), turn);
  // Triangles 0 to n-3 are the one side, n-2 to 2n-5 the other, in the same order with two corners exchanged.
  std::vector<Face> faces;
  const int count = static_cast<int>(outline.size()) - 2;
  for (int i = 0; i < count; ++i) {
    Face face;
    face.corner = {outline[0], outline[i + 1], outline[i + 2]};
    face.neighbour = {i == 0 ? count : i - 1, count + i, i == count - 1 ? 2 * count - 1 : i + 1};
    faces.push_back(face);
  }
  for (int i = 0; i < count; ++i) {
    Face face;
    face.corner = {outline[0], outline[i + 2], outline[i + 1]};
    face.neighbour = {i == count - 1 ? count - 1 : count + i + 1, i, i == 0 ? 0 : count + i - 1};
    faces.push_back(face);
  }
  return faces;
}

}  // namespace

ConvexHull convex_hull(std::span<const Eigen::Vector3f> points_mm) {
  const GridPoints grid = on_grid(points_mm);
  Quickhull quickhull(grid.points);
  ConvexHull hull;
  hull.flat = !quickhull.run();
  const std::vector<Face> faces = hull.flat ? flat_hull(grid.points, quickhull.first_triangle()) : quickhull.faces();

  std::vector<int> new_vertex(grid.points.size(), -1), new_face(faces.size(), -1);
  int kept = 0;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (!faces[f].removed) new_face[f] = kept++;
  for (const auto& face : faces) {
    if (face.removed) continue;
    std::array<int, 3> corner, neighbour;
    for (int k = 0; k < 3; ++k) {
      int& vertex = new_vertex[face.corner[k]];
      if (vertex < 0) {
        vertex = static_cast<int>(hull.vertices.size());
        hull.original.push_back(grid.original[face.corner[k]]);
        hull.vertices.push_back(points_mm[hull.original.back()].cast<double>());
      }
      corner[k] = vertex;
      neighbour[k] = new_face[face.neighbour[k]];
    }
    hull.triangles.push_back(corner);
    hull.neighbours.push_back(neighbour);
  }
  return hull;
}

double ConvexHull::volume_mm3() const {
  double sum = 0;
  for (const auto& [a, b, c] : triangles)
    sum += (vertices[a] - vertices[0]).dot((vertices[b] - vertices[0]).cross(vertices[c] - vertices[0]));
  return flat ? 0 : sum / 6;
}

Eigen::Vector3d ConvexHull::centroid() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0;
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3d va = vertices[a] - vertices[0], vb = vertices[b] - vertices[0],
                          vc = vertices[c] - vertices[0];
    const double w = flat ? (vb - va).cross(vc - va).norm() : va.dot(vb.cross(vc));
    sum += w * (va + vb + vc) / (flat ? 3.0 : 4.0);
    weight += w;
  }
  return vertices[0] + sum / weight;
}

std::vector<int> convex_outline(std::span<const Eigen::Vector2d> points) {
  std::vector<int> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::tuple(points[a].x(), points[a].y(), a) < std::tuple(points[b].x(), points[b].y(), b);
  });
  return convex_outline(std::move(order), [&](int a, int b, int c) {
    const Eigen::Vector2d ab = points[b] - points[a], ac = points[c] - points[a];
    return ab.x() * ac.y() - ab.y() * ac.x();
  });
}

}  // namespace partpose
