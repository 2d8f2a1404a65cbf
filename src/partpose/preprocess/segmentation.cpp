// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/preprocess/segmentation.hpp"

#include "partpose/core/error.hpp"
#include "partpose/geometry/kd_tree.hpp"
#include "partpose/geometry/plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace partpose {

namespace {

/// How far a segment may exceed the largest part, for noise and for what sticks to it.
constexpr float size_margin = 1.25f;

/// The largest width of the points along 13 directions: their diameter, less some per cent.
float extent_mm(const std::vector<Eigen::Vector3f>& points, const std::vector<int>& indices) {
  float largest = 0;
  for (int code = 14; code < 27; ++code) {  // one of each pair of opposite directions with entries -1, 0, 1
    const Eigen::Vector3f direction = Eigen::Vector3f(code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1).normalized();
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const int i : indices) {
      const float along = direction.dot(points[i]);
      low = std::min(low, along);
      high = std::max(high, along);
    }
    if (!indices.empty()) largest = std::max(largest, high - low);
  }
  return largest;
}

class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int a, int b) { parent_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

 private:
  std::vector<int> parent_;
};

/// Groups of pixels whose neighbours (up to two pixels away, to bridge holes) are near in space.
std::vector<std::vector<int>> connected_pixels(const std::vector<int>& pixels, const DepthImage& depth,
                                               const Intrinsics& camera) {
  std::vector<int> slot(depth.z_mm.size(), -1);
  for (std::size_t i = 0; i < pixels.size(); ++i) slot[pixels[i]] = static_cast<int>(i);
  UnionFind groups(pixels.size());
  const double pixel_rad = 1.0 / std::min(camera.fx, camera.fy);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int u = pixels[i] % depth.width, v = pixels[i] / depth.width;
    const float z = depth.z_mm[pixels[i]];
    for (const auto& [du, dv] : {std::pair{1, 0}, {0, 1}, {1, 1}, {-1, 1}, {2, 0}, {0, 2}}) {
      if (u + du < 0 || u + du >= depth.width || v + dv >= depth.height) continue;
      const int other = pixels[i] + dv * depth.width + du;
      if (slot[other] < 0) continue;
      // Surfaces up to about 75 degrees steep hold together; the jump from a part to what is behind it does not.
      const double limit = 3.0 + 4.0 * z * pixel_rad * std::max(std::abs(du), std::abs(dv));
      if (std::abs(depth.z_mm[other] - z) <= limit) groups.join(static_cast<int>(i), slot[other]);
    }
  }
  std::map<int, std::vector<int>> members;
  for (std::size_t i = 0; i < pixels.size(); ++i) members[groups.find(static_cast<int>(i))].push_back(pixels[i]);
  std::vector<std::vector<int>> out;
  for (auto& [root, group] : members) out.push_back(std::move(group));
  return out;
}

/// Takes the points of planes away from `remaining`: of the dominant one, which is the table if there is one, and of
/// others that are too large to be a part's face.
void remove_planes(const std::vector<Eigen::Vector3f>& points, std::vector<int>& remaining, float largest_part_mm) {
  constexpr int most_planes = 4;
  constexpr double smallest_share = 0.12;
  const std::size_t measured = remaining.size();
  for (int round = 0; round < most_planes && remaining.size() >= 3; ++round) {
    PointCloud cloud;
    for (const int i : remaining) cloud.points.push_back(points[i]);
    std::vector<float> z;
    for (const auto& p : cloud.points) z.push_back(p.z());
    std::nth_element(z.begin(), z.begin() + static_cast<std::ptrdiff_t>(z.size() / 2), z.end());
    // Wide enough for the waves that a stereo camera sees on a flat table, about 1 % of the distance.
    const float threshold = std::clamp(0.01f * z[z.size() / 2], 3.0f, 8.0f);
    const auto fit = fit_plane(cloud, {.distance_threshold_mm = threshold});
    if (!fit || static_cast<double>(fit->inliers.size()) < smallest_share * static_cast<double>(measured)) return;
    std::vector<int> inliers;
    for (const int i : fit->inliers) inliers.push_back(remaining[i]);
    if (round > 0 && extent_mm(points, inliers) < size_margin * largest_part_mm) return;

    // Cut by the noise that the plane shows, so that the feet of flat parts stay.
    const double cut = std::clamp(3 * fit->rms_mm, 1.5, static_cast<double>(threshold));
    std::erase_if(remaining, [&](int i) { return std::abs(fit->plane.signed_distance_mm(points[i])) <= cut; });
  }
}

}  // namespace

double angular_spacing_rad(const PointCloud& cloud) {
  std::vector<Eigen::Vector3f> directions;
  for (const auto& p : cloud.points)
    if (p.allFinite() && p.z() > 0) directions.emplace_back(p.x() / p.z(), p.y() / p.z(), 0.f);
  if (directions.size() < 2) throw Error("the cloud has fewer than two points before the camera (z > 0)");
  const KdTree tree(directions);
  const std::size_t step = std::max<std::size_t>(directions.size() / 500, 1);
  std::vector<float> spacing;
  for (std::size_t i = 0; i < directions.size(); i += step) {
    const auto found = tree.nearest_k(directions[i], 2);
    if (found.size() == 2 && found[1].squared_distance > 0) spacing.push_back(std::sqrt(found[1].squared_distance));
  }
  if (spacing.empty()) throw Error("all points of the cloud lie in one direction");
  std::nth_element(spacing.begin(), spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2), spacing.end());
  return spacing[spacing.size() / 2];
}

std::vector<Segment> segment(const DepthImage& depth, const Intrinsics& camera, const SegmentationOptions& options) {
  std::vector<Eigen::Vector3f> points(depth.z_mm.size(), Eigen::Vector3f::Zero());
  std::vector<int> measured;
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const int i = v * depth.width + u;
      if (!(depth.z_mm[i] > 0)) continue;
      points[i] = camera.unproject(u, v, depth.z_mm[i]);
      measured.push_back(i);
    }
  }
  const auto plausible = [&](const std::vector<int>& pixels) {
    if (static_cast<int>(pixels.size()) < options.min_pixels) return false;
    const float extent = extent_mm(points, pixels);
    return extent <= size_margin * options.largest_part_mm && extent >= 0.25f * options.smallest_part_mm;
  };

  std::vector<Segment> segments;
  if (plausible(measured)) segments.push_back({measured, true});
  std::vector<int> remaining = measured;
  remove_planes(points, remaining, options.largest_part_mm);
  std::vector<int> all_plausible;
  int pieces = 0;
  for (auto& group : connected_pixels(remaining, depth, camera)) {
    if (!plausible(group)) continue;
    ++pieces;
    all_plausible.insert(all_plausible.end(), group.begin(), group.end());
    segments.push_back({std::move(group), false});
  }
  // A part that the camera sees in several pieces.
  if (pieces > 1 && plausible(all_plausible)) {
    std::sort(all_plausible.begin(), all_plausible.end());
    segments.push_back({std::move(all_plausible), false});
  }
  return segments;
}

}  // namespace partpose
