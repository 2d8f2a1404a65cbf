// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/report/packet.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/bytes.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

namespace partpose {

namespace {

constexpr double levels = 65535;
using Cell = std::array<std::uint16_t, 3>;

/// A box and its division into 65536 levels a side.
struct Quantised {
  Eigen::Vector3d lo = Eigen::Vector3d::Zero(), size = Eigen::Vector3d::Zero();
  std::vector<Cell> cells;

  explicit Quantised(const std::vector<Eigen::Vector3f>& points) {
    Eigen::AlignedBox3d box;
    for (const auto& p : points) box.extend(p.cast<double>());
    if (points.empty()) return;
    lo = box.min();
    size = box.sizes();
    for (const auto& p : points) {
      Cell cell;
      for (int a = 0; a < 3; ++a)
        cell[a] = size[a] > 0 ? static_cast<std::uint16_t>(std::lround((p[a] - lo[a]) / size[a] * levels)) : 0;
      cells.push_back(cell);
    }
  }
};

/// Z-order: the bits of the three coordinates in turns.
std::uint64_t z_order(const Cell& cell) {
  std::uint64_t key = 0;
  for (int bit = 15; bit >= 0; --bit)
    for (const auto coordinate : cell) key = (key << 1) | ((coordinate >> bit) & 1u);
  return key;
}

void append_planes(std::string& bytes, const std::vector<std::uint16_t>& values) {
  for (const auto value : values) bytes.push_back(static_cast<char>(value >> 8));
  for (const auto value : values) bytes.push_back(static_cast<char>(value & 255));
}

void append_differences(std::string& bytes, const std::vector<Cell>& cells) {
  std::vector<std::uint16_t> differences(cells.size());
  for (int a = 0; a < 3; ++a) {
    std::uint16_t last = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      differences[i] = static_cast<std::uint16_t>(cells[i][a] - last);
      last = cells[i][a];
    }
    append_planes(bytes, differences);
  }
}

/// A unit vector on the unfolded octahedron, each coordinate 0 to 255.
std::array<std::uint8_t, 2> octahedral(const Eigen::Vector3f& normal) {
  const float sum = normal.cwiseAbs().sum();
  if (!(sum > 0)) return {128, 128};
  Eigen::Vector2f p = normal.head<2>() / sum;
  if (normal.z() < 0) {
    const Eigen::Vector2f folded = Eigen::Vector2f::Ones() - p.cwiseAbs().reverse();
    p = {std::copysign(folded.x(), p.x()), std::copysign(folded.y(), p.y())};
  }
  const auto level = [](float x) { return static_cast<std::uint8_t>(std::lround((x + 1) * 127.5f)); };
  return {level(p.x()), level(p.y())};
}

Json numbers(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

}  // namespace

std::string deflated(std::string_view bytes, int level) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                level) != Z_OK)
    throw Error("the report's data could not be compressed: out of memory?");
  out.resize(size);
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  const auto at = [&](std::size_t i) { return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0u; };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned three = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
    for (int k = 0; k < 4; ++k) out.push_back(i + k > bytes.size() ? '=' : letters[three >> (18 - 6 * k) & 63]);
  }
  return out;
}

Json Packet::add(const PointCloud& cloud, std::size_t most_points) {
  const PointCloud finite = without_missing(cloud);
  const Quantised all(finite.points);
  std::vector<std::size_t> order(finite.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::uint64_t> key(finite.size());
  for (std::size_t i = 0; i < key.size(); ++i) key[i] = z_order(all.cells[i]);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  const std::size_t count = std::min(most_points, finite.size());
  std::vector<Cell> cells(count);
  std::string normals[2];
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t source = order[i * finite.size() / count];
    cells[i] = all.cells[source];
    if (!finite.has_normals()) continue;
    const auto coordinates = octahedral(finite.normals[source]);
    normals[0].push_back(static_cast<char>(coordinates[0]));
    normals[1].push_back(static_cast<char>(coordinates[1]));
  }
  Json section{{"offset", sections_.size()}, {"count", count},
               {"of", finite.size()},        {"lo", numbers(all.lo)},
               {"size", numbers(all.size)},  {"normals", finite.has_normals()}};
  append_differences(sections_, cells);
  sections_ += normals[0] + normals[1];
  return section;
}

Json Packet::add(const DepthImage& depth, double unit_mm) {
  std::vector<std::uint16_t> units(depth.z_mm.size()), residuals(depth.z_mm.size());
  for (std::size_t i = 0; i < units.size(); ++i)
    units[i] = static_cast<std::uint16_t>(std::lround(std::clamp(depth.z_mm[i] / unit_mm, 0.0, levels)));
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * depth.width + u;
      const int left = u > 0 ? units[i - 1] : 0, above = v > 0 ? units[i - depth.width] : 0;
      const int corner = u > 0 && v > 0 ? units[i - depth.width - 1] : 0;
      const int predicted = corner >= std::max(left, above)   ? std::min(left, above)
                            : corner <= std::min(left, above) ? std::max(left, above)
                                                              : left + above - corner;
      residuals[i] = static_cast<std::uint16_t>(units[i] - predicted);
    }
  }
  Json section{{"offset", sections_.size()}, {"width", depth.width}, {"height", depth.height}, {"unit_mm", unit_mm}};
  append_planes(sections_, residuals);
  return section;
}

Json Packet::add(const TriangleMesh& mesh) {
  const Quantised vertices(mesh.vertices);
  Json section{{"offset", sections_.size()},
               {"vertices", mesh.vertices.size()},
               {"triangles", mesh.triangles.size()},
               {"lo", numbers(vertices.lo)},
               {"size", numbers(vertices.size)}};
  append_differences(sections_, vertices.cells);
  std::vector<std::uint16_t> high, low;
  std::uint32_t last = 0;
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) {
      const std::uint32_t difference = static_cast<std::uint32_t>(index) - last;
      high.push_back(static_cast<std::uint16_t>(difference >> 16));
      low.push_back(static_cast<std::uint16_t>(difference & 0xFFFF));
      last = static_cast<std::uint32_t>(index);
    }
  }
  append_planes(sections_, high);
  append_planes(sections_, low);
  return section;
}

std::string Packet::bytes() const {
  const std::string text = json_line(header);
  std::string out;
  store(out, static_cast<std::uint32_t>(text.size()));
  return out + text + sections_;
}

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t most_triangles) {
  TriangleMesh out = mesh;
  const auto box = bounding_box(mesh);
  for (double cells = 512; out.triangles.size() > most_triangles && cells >= 4; cells *= 0.75) {
    const double cell_mm = box.sizes().maxCoeff() / cells;
    std::unordered_map<std::uint64_t, int> vertex_of_cell;
    std::vector<int> new_index(mesh.vertices.size());
    std::vector<std::pair<Eigen::Vector3d, int>> sums;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const Eigen::Vector3d at = (mesh.vertices[i].cast<double>() - box.min()) / cell_mm;
      std::uint64_t key = 0;
      for (int a = 0; a < 3; ++a) key = key << 20 | static_cast<std::uint64_t>(at[a]);
      const auto [it, is_new] = vertex_of_cell.try_emplace(key, static_cast<int>(sums.size()));
      if (is_new) sums.push_back({Eigen::Vector3d::Zero(), 0});
      sums[it->second].first += mesh.vertices[i].cast<double>();
      ++sums[it->second].second;
      new_index[i] = it->second;
    }
    out = {};
    for (const auto& [sum, count] : sums) out.vertices.push_back((sum / count).cast<float>());
    for (const auto& t : mesh.triangles) {
      const std::array<int, 3> moved{new_index[t[0]], new_index[t[1]], new_index[t[2]]};
      if (moved[0] != moved[1] && moved[1] != moved[2] && moved[2] != moved[0]) out.triangles.push_back(moved);
    }
  }
  return out;
}

ReducedDepth reduced(const DepthImage& depth, const Intrinsics& camera, int u, int v, int width, int height,
                     int factor) {
  ReducedDepth out;
  out.depth = DepthImage(std::max(width / factor, 1), std::max(height / factor, 1));
  for (int y = 0; y < out.depth.height; ++y) {
    for (int x = 0; x < out.depth.width; ++x) {
      float nearest = 0;
      for (int dy = 0; dy < factor; ++dy) {
        for (int dx = 0; dx < factor; ++dx) {
          const int su = u + x * factor + dx, sv = v + y * factor + dy;
          const float z = su < depth.width && sv < depth.height ? depth.at(su, sv) : 0;
          if (z > 0 && (nearest == 0 || z < nearest)) nearest = z;
        }
      }
      out.depth.at(x, y) = nearest;
    }
  }
  const double half = 0.5 * (factor - 1);
  out.camera = {out.depth.width,
                out.depth.height,
                camera.fx / factor,
                camera.fy / factor,
                (camera.cx - u - half) / factor,
                (camera.cy - v - half) / factor};
  return out;
}

}  // namespace partpose
