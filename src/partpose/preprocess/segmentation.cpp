// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/preprocess/segmentation.hpp"

#include "partpose/core/union_find.hpp"
#include "partpose/geometry/kd_tree.hpp"
#include "partpose/geometry/plane.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

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

/// Groups of neighbouring pixels that are near in space; holes of one pixel are bridged.
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
      const int other = pixels[i] + dv * depth.width + du, between = pixels[i] + dv / 2 * depth.width + du / 2;
      if (slot[other] < 0 || (between != pixels[i] && depth.z_mm[between] > 0)) continue;
      // Surfaces up to about 70 degrees steep hold together; the jump from a part to what is behind it does not.
      const double limit = 2.0 + 3.0 * z * pixel_rad * std::max(std::abs(du), std::abs(dv));
      if (std::abs(depth.z_mm[other] - z) <= limit) groups.join(static_cast<int>(i), slot[other]);
    }
  }
  std::map<int, std::vector<int>> members;
  for (std::size_t i = 0; i < pixels.size(); ++i) members[groups.find(static_cast<int>(i))].push_back(pixels[i]);
  std::vector<std::vector<int>> out;
  for (auto& [root, group] : members) out.push_back(std::move(group));
  return out;
}

/// Splits a frame's pixels into what may be single objects.
class Splitter {
  struct CutPlane {
    Plane plane;
    double cut_mm = 0;
  };

 public:
  Splitter(const DepthImage& depth, const Intrinsics& camera, const SegmentationOptions& options)
      : depth_(depth), camera_(camera), options_(options), points_(depth.z_mm.size(), Eigen::Vector3f::Zero()) {
    std::vector<int> measured;
    for (int i = 0; i < static_cast<int>(depth.z_mm.size()); ++i) {
      if (!(depth.z_mm[i] > 0)) continue;
      points_[i] = camera.unproject(i % depth.width, i / depth.width, depth.z_mm[i]);
      measured.push_back(i);
    }
    if (is_plausible(measured)) {
      segments_.push_back({measured, true});
      if (!stands_on_table(measured)) return;
    }
    remove_plane_and_split(measured, 0);
    add_pieces_together();
  }

  std::vector<Segment> take() {
    std::stable_sort(segments_.begin(), segments_.end(),
                     [](const auto& a, const auto& b) { return a.pixels.size() > b.pixels.size(); });
    if (static_cast<int>(segments_.size()) > options_.most_segments) segments_.resize(options_.most_segments);
    return std::move(segments_);
  }

 private:
  bool is_plausible(const std::vector<int>& pixels) const {
    if (static_cast<int>(pixels.size()) < options_.min_pixels) return false;
    const float extent = extent_mm(points_, pixels);
    if (extent > size_margin * options_.largest_part_mm || extent < 0.3f * options_.smallest_part_mm) return false;
    // Even a plate seen edge-on covers a few per cent of its diameter's square.
    const double smallest_px = options_.smallest_part_mm * camera_.fx / points_[pixels[pixels.size() / 2]].z();
    return static_cast<double>(pixels.size()) >= 0.02 * smallest_px * smallest_px;
  }

  /// The dominant plane is the table, the wall or the floor, unless everything is no larger than a part. What is left
  /// falls into pieces; those too large to be a part have a plane of their own taken away.
  void remove_plane_and_split(const std::vector<int>& pixels, int level) {
    constexpr int most_levels = 3;
    if (level == most_levels || static_cast<int>(pixels.size()) < options_.min_pixels) return;
    const auto plane = dominant_plane(pixels);
    if (!plane) return;
    std::vector<int> remaining, on_plane;
    for (const int i : pixels)
      (std::abs(plane->plane.signed_distance_mm(points_[i])) > plane->cut_mm ? remaining : on_plane).push_back(i);
    // Taken away wherever it shows, also through a part's holes.
    split(remaining, *plane, level);
    if (level == 0) return;
    // A lesser plane may hold a part's face by chance: once more, and only what is larger than a part is taken away.
    const std::size_t without_patches = remaining.size();
    for (const auto& patch : connected_pixels(on_plane, depth_, camera_))
      if (extent_mm(points_, patch) <= size_margin * options_.largest_part_mm)
        remaining.insert(remaining.end(), patch.begin(), patch.end());
    if (remaining.size() == without_patches) return;
    std::sort(remaining.begin(), remaining.end());
    split(remaining, *plane, level);
  }

  void split(const std::vector<int>& remaining, const CutPlane& plane, int level) {
    for (auto& piece : connected_pixels(remaining, depth_, camera_)) {
      if (is_plausible(piece)) {
        if (stands_out(piece, plane)) add({std::move(piece), false});
      } else if (extent_mm(points_, piece) > size_margin * options_.largest_part_mm) {
        remove_plane_and_split(piece, level + 1);
      }
    }
  }

  void add(Segment segment) {
    const bool known = std::any_of(segments_.begin(), segments_.end(),
                                   [&](const Segment& other) { return other.pixels == segment.pixels; });
    if (!known) segments_.push_back(std::move(segment));
  }

  std::optional<CutPlane> dominant_plane(const std::vector<int>& pixels) const {
    constexpr double smallest_share = 0.1;
    PointCloud cloud;
    std::vector<float> z;
    for (const int i : pixels) {
      cloud.points.push_back(points_[i]);
      z.push_back(points_[i].z());
    }
    const auto middle = z.begin() + static_cast<std::ptrdiff_t>(z.size() / 2);
    std::nth_element(z.begin(), middle, z.end());
    // Wide enough for the waves that a stereo camera sees on a flat table, about 1 % of the distance.
    const float threshold = std::clamp(0.01f * *middle, 3.0f, 50.0f);
    const auto fit = fit_plane(cloud, {.distance_threshold_mm = threshold});
    if (!fit || static_cast<double>(fit->inliers.size()) < smallest_share * static_cast<double>(pixels.size()))
      return std::nullopt;
    // Cut by the noise that the plane shows, so that the feet of flat parts stay.
    return CutPlane{fit->plane, std::clamp(3 * fit->rms_mm, 1.5, static_cast<double>(threshold))};
  }

  /// Objects on a table lie on the camera's side of its plane; where the dominant plane is a part's own face, the rest
  /// of the part lies behind it.
  bool stands_on_table(const std::vector<int>& pixels) const {
    const auto plane = dominant_plane(pixels);
    if (!plane) return false;
    int before = 0, behind = 0;
    for (const int i : pixels) {
      const double distance = plane->plane.signed_distance_mm(points_[i]);
      before += distance > plane->cut_mm;
      behind += distance < -plane->cut_mm;
    }
    return before > 3 * behind;
  }

  /// Not just a wave of the plane that was taken away beside it.
  bool stands_out(const std::vector<int>& pixels, const CutPlane& plane) const {
    std::vector<double> distance;
    for (const int i : pixels) distance.push_back(std::abs(plane.plane.signed_distance_mm(points_[i])));
    const auto high = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() * 9 / 10);
    std::nth_element(distance.begin(), high, distance.end());
    return *high > 1.7 * plane.cut_mm;
  }

  /// A part that the camera sees in several pieces: those near the largest one.
  void add_pieces_together() {
    const Segment* largest = nullptr;
    for (const auto& segment : segments_)
      if (!segment.whole_frame && (!largest || segment.pixels.size() > largest->pixels.size())) largest = &segment;
    if (!largest) return;
    std::vector<int> together = largest->pixels;
    for (const auto& segment : segments_) {
      if (segment.whole_frame || &segment == largest) continue;
      std::vector<int> larger = together;
      larger.insert(larger.end(), segment.pixels.begin(), segment.pixels.end());
      if (is_plausible(larger)) together = std::move(larger);
    }
    if (together.size() == largest->pixels.size()) return;
    std::sort(together.begin(), together.end());
    segments_.push_back({std::move(together), false});
  }

  const DepthImage& depth_;
  const Intrinsics& camera_;
  const SegmentationOptions& options_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<Segment> segments_;
};

}  // namespace

std::optional<double> angular_spacing_rad(const PointCloud& cloud) {
  std::vector<Eigen::Vector3f> directions;
  for (const auto& p : cloud.points)
    if (p.allFinite() && p.z() > 0) directions.emplace_back(p.x() / p.z(), p.y() / p.z(), 0.f);
  // Points that are there twice say nothing about the spacing.
  const auto before = [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
  };
  std::sort(directions.begin(), directions.end(), before);
  directions.erase(std::unique(directions.begin(), directions.end()), directions.end());
  if (directions.size() < 2) return std::nullopt;
  const KdTree tree(directions);
  const std::size_t step = std::max<std::size_t>(directions.size() / 500, 1);
  std::vector<float> spacing;
  for (std::size_t i = 0; i < directions.size(); i += step) {
    const auto found = tree.nearest_k(directions[i], 2);
    if (found.size() == 2 && found[1].squared_distance > 0) spacing.push_back(std::sqrt(found[1].squared_distance));
  }
  if (spacing.empty()) return std::nullopt;
  std::nth_element(spacing.begin(), spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2), spacing.end());
  return spacing[spacing.size() / 2];
}

namespace {

/// Evenly spaced values: `first` and every `step` from it.
struct Comb {
  double first = 0, step = 0;
  int count = 0;
};

/// The comb whose teeth the values lie on; nothing when they lie between as well.
std::optional<Comb> comb_of(std::vector<float> values) {
  constexpr double least_gap_share = 0.3;  // of the step: values nearer than that are the same tooth
  constexpr double off_share = 0.08, most_off = 0.02;
  constexpr int most_teeth = 4000, least_teeth = 8;
  std::sort(values.begin(), values.end());
  // Teeth are dense and far apart: of all gaps the small ones are rounding.
  std::vector<float> gaps;
  const float extent = values.back() - values.front();
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] - values[i - 1] > extent / most_teeth) gaps.push_back(values[i] - values[i - 1]);
  if (gaps.size() + 1 < least_teeth) return std::nullopt;
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 4), gaps.end());
  double step = gaps[gaps.size() / 4];
  // The means of the teeth against their numbers, by least squares.
  double n = 0, sum_k = 0, sum_x = 0, sum_kk = 0, sum_kx = 0;
  int tooth = 0;
  for (std::size_t begin = 0; begin < values.size();) {
    std::size_t end = begin + 1;
    double mean = values[begin];
    while (end < values.size() && values[end] - values[end - 1] < least_gap_share * step) mean += values[end++];
    mean /= static_cast<double>(end - begin);
    if (n > 0) {
      const double slope = n > 4 ? (n * sum_kx - sum_k * sum_x) / (n * sum_kk - sum_k * sum_k) : step;
      const double first = n > 4 ? (sum_x - slope * sum_k) / n : sum_x / n - slope * sum_k / n;
      if (!(slope > 0.5 * step && slope < 2 * step)) return std::nullopt;
      tooth = static_cast<int>(std::lround((mean - first) / slope));
    }
    n += 1, sum_k += tooth, sum_x += mean, sum_kk += double(tooth) * tooth, sum_kx += tooth * mean;
    begin = end;
  }
  if (n < least_teeth) return std::nullopt;
  Comb comb;
  comb.step = (n * sum_kx - sum_k * sum_x) / (n * sum_kk - sum_k * sum_k);
  comb.first = (sum_x - comb.step * sum_k) / n;
  if (!(comb.step > 0)) return std::nullopt;
  comb.count = static_cast<int>(std::lround((values.back() - comb.first) / comb.step)) + 1;
  std::size_t off = 0;
  for (const float value : values) {
    const double at = (value - comb.first) / comb.step;
    off += std::abs(at - std::round(at)) > off_share;
  }
  if (static_cast<double>(off) > most_off * static_cast<double>(values.size()) || comb.count > most_teeth)
    return std::nullopt;
  return comb;
}

}  // namespace

std::optional<Intrinsics> pixel_grid_of(const PointCloud& cloud, int margin_px) {
  std::vector<float> x, y;
  for (const auto& p : cloud.points) {
    if (!p.allFinite() || !(p.z() > 0)) continue;
    x.push_back(p.x() / p.z());
    y.push_back(p.y() / p.z());
  }
  if (x.size() < 50) return std::nullopt;
  const auto columns = comb_of(std::move(x)), rows = comb_of(std::move(y));
  if (!columns || !rows) return std::nullopt;
  Intrinsics camera;
  camera.width = columns->count + 2 * margin_px;
  camera.height = rows->count + 2 * margin_px;
  camera.fx = 1 / columns->step;
  camera.fy = 1 / rows->step;
  camera.cx = margin_px - columns->first / columns->step;
  camera.cy = margin_px - rows->first / rows->step;
  return camera;
}

std::optional<Intrinsics> intrinsics_of(const PointCloud& cloud, int margin_px) {
  const auto spacing = angular_spacing_rad(cloud);
  if (!spacing) return std::nullopt;
  return intrinsics_covering(cloud, 1.5 * *spacing, margin_px);
}

std::vector<Segment> segment(const DepthImage& depth, const Intrinsics& camera, const SegmentationOptions& options) {
  return Splitter(depth, camera, options).take();
}

std::string why_nothing_stands_out(const DepthImage& depth) {
  if (std::none_of(depth.z_mm.begin(), depth.z_mm.end(), [](float z) { return z > 0; }))
    return "no pixel of it has a depth";
  return "nothing of a part's size stands out from the table or the background" + hint_of_unit(depth);
}

std::string hint_of_unit(const DepthImage& depth) { return hint_of_unit(depth.z_mm); }

std::string hint_of_unit(std::vector<float> z_mm) {
  std::erase_if(z_mm, [](float z) { return !(z > 0); });
  if (z_mm.empty()) return {};
  const auto middle = z_mm.begin() + static_cast<std::ptrdiff_t>(z_mm.size() / 2);
  std::nth_element(z_mm.begin(), middle, z_mm.end());
  constexpr float nearest_if_mm = 20, nearest_mm = 100, farthest_mm = 5'000;  // of a depth camera's scenes
  if (*middle < nearest_mm)
    return fmt::format("; half of it is less than {:.3g} mm away: is it in {}?", *middle,
                       *middle < nearest_if_mm ? "metres" : "another unit than stated");
  if (*middle > farthest_mm)
    return fmt::format("; half of it is more than {:.3g} m away: is it in another unit than stated?", *middle / 1000);
  return {};
}

double share_of_neighbours(const DepthImage& depth) {
  int neighbours = 0, measured = 0;
  for (int v = 1; v + 1 < depth.height; ++v)
    for (int u = 1; u + 1 < depth.width; ++u) {
      if (!(depth.at(u, v) > 0)) continue;
      neighbours += 4;
      for (const auto& [du, dv] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) measured += depth.at(u + du, v + dv) > 0;
    }
  return neighbours > 0 ? static_cast<double>(measured) / neighbours : 0;
}

std::string hint_of_thinning(const DepthImage& cloud_in_pixels) {
  constexpr double whole_share = 0.8;  // of a camera's cloud about 0.95; of every second point of it 0.5
  if (share_of_neighbours(cloud_in_pixels) >= whole_share) return {};
  return "; the cloud seems to be thinned: give all points that the camera measured, or its depth image";
}

}  // namespace partpose
