// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/segment_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace partpose {

LabelledDepth neighbourhood(const DepthImage& depth, const Intrinsics& camera, const Segment& segment, double margin_mm,
                            int wanted_pixels) {
  LabelledDepth out;
  if (segment.pixels.empty()) return out;
  double z_sum = 0;
  int u0 = depth.width, u1 = -1, v0 = depth.height, v1 = -1;
  for (const int p : segment.pixels) {
    z_sum += depth.z_mm[p];
    u0 = std::min(u0, p % depth.width), u1 = std::max(u1, p % depth.width);
    v0 = std::min(v0, p / depth.width), v1 = std::max(v1, p / depth.width);
  }
  const double pixels_per_mm = std::max(camera.fx, camera.fy) * static_cast<double>(segment.pixels.size()) / z_sum;
  const int margin = 3 + static_cast<int>(std::min(margin_mm * pixels_per_mm, 2.0 * (depth.width + depth.height)));
  u0 -= margin, v0 -= margin, u1 += margin, v1 += margin;  // beyond the frame nothing is known, as in a hole
  const int stride = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(segment.pixels.size()) /
                                                                        std::max(wanted_pixels, 1)))));
  out.camera.width = (u1 - u0) / stride + 1;
  out.camera.height = (v1 - v0) / stride + 1;
  out.camera.fx = camera.fx / stride;
  out.camera.fy = camera.fy / stride;
  out.camera.cx = (camera.cx - u0) / stride;
  out.camera.cy = (camera.cy - v0) / stride;
  out.depth = DepthImage(out.camera.width, out.camera.height);
  out.label.assign(out.depth.z_mm.size(), PixelLabel::nothing);
  for (int v = 0; v < out.depth.height; ++v) {
    for (int u = 0; u < out.depth.width; ++u) {
      const int full_u = u0 + u * stride, full_v = v0 + v * stride;
      if (full_u < 0 || full_v < 0 || full_u >= depth.width || full_v >= depth.height) continue;
      const float z = depth.at(full_u, full_v);
      if (!(z > 0)) continue;
      out.depth.at(u, v) = z;
      out.label[static_cast<std::size_t>(v) * out.depth.width + u] = PixelLabel::background;
    }
  }
  for (const int p : segment.pixels) {
    const int du = p % depth.width - u0, dv = p / depth.width - v0;
    if (du % stride == 0 && dv % stride == 0)
      out.label[static_cast<std::size_t>(dv / stride) * out.depth.width + du / stride] = PixelLabel::object;
  }
  return out;
}

std::vector<Segment> with_pairs(std::vector<Segment> segments, const DepthImage& depth, const Intrinsics& camera,
                                double largest_mm, int most) {
  constexpr int block_px = 4;  // pieces nearly touch where they are in the same block of pixels or in neighbouring ones
  const int columns = depth.width / block_px + 3;
  std::vector<std::vector<int>> blocks;  // of each segment, rising
  std::vector<Eigen::AlignedBox3f> boxes;
  for (const auto& segment : segments) {
    std::vector<int> own;
    Eigen::AlignedBox3f box;
    for (const int p : segment.pixels) {
      const int u = p % depth.width, v = p / depth.width;
      own.push_back((v / block_px + 1) * columns + u / block_px + 1);
      box.extend(camera.unproject(u, v, depth.z_mm[p]));
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    blocks.push_back(std::move(own));
    boxes.push_back(box);
  }
  const auto touch = [&](std::size_t a, std::size_t b) {
    std::size_t shared = 0, near = 0;
    for (const int block : blocks[a])
      for (int dv = -1; dv <= 1; ++dv)
        for (int du = -1; du <= 1; ++du) {
          const bool there = std::binary_search(blocks[b].begin(), blocks[b].end(), block + dv * columns + du);
          near += there;
          shared += there && du == 0 && dv == 0;
        }
    // Not where one holds the other already.
    return near > 0 && 2 * shared < std::min(blocks[a].size(), blocks[b].size());
  };
  std::vector<Segment> pairs;
  for (std::size_t a = 0; a < segments.size(); ++a)
    for (std::size_t b = a + 1; b < segments.size(); ++b) {
      if (segments[a].whole_frame || segments[b].whole_frame) continue;
      if (boxes[a].merged(boxes[b]).sizes().maxCoeff() > largest_mm || !touch(a, b)) continue;
      Segment pair;
      std::set_union(segments[a].pixels.begin(), segments[a].pixels.end(), segments[b].pixels.begin(),
                     segments[b].pixels.end(), std::back_inserter(pair.pixels));
      const auto same = [&](const Segment& other) { return other.pixels == pair.pixels; };
      if (std::none_of(segments.begin(), segments.end(), same)) pairs.push_back(std::move(pair));
    }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Segment& a, const Segment& b) { return a.pixels.size() > b.pixels.size(); });
  if (static_cast<int>(pairs.size()) > most) pairs.resize(most);
  for (auto& pair : pairs) segments.push_back(std::move(pair));
  return segments;
}

std::vector<Eigen::Vector3f> object_points(const LabelledDepth& frame) {
  std::vector<Eigen::Vector3f> points;
  for (int v = 0; v < frame.depth.height; ++v)
    for (int u = 0; u < frame.depth.width; ++u)
      if (frame.label[static_cast<std::size_t>(v) * frame.depth.width + u] == PixelLabel::object)
        points.push_back(frame.camera.unproject(u, v, frame.depth.at(u, v)));
  return points;
}

double local_noise_mm(const DepthImage& depth, const Segment& segment) {
  constexpr int reach = 2, most_windows = 300;
  std::vector<std::uint8_t> is_object(depth.z_mm.size(), 0);
  for (const int p : segment.pixels) is_object[p] = 1;
  std::vector<double> deviation;
  const std::size_t step = std::max<std::size_t>(1, segment.pixels.size() / most_windows);
  for (std::size_t i = 0; i < segment.pixels.size(); i += step) {
    const int u = segment.pixels[i] % depth.width, v = segment.pixels[i] / depth.width;
    if (u < reach || v < reach || u + reach >= depth.width || v + reach >= depth.height) continue;
    // Least squares of z = a + b du + c dv over a full window: its sums are orthogonal.
    double sum = 0, sum_u = 0, sum_v = 0, squared = 0;
    bool full = true;
    const double z0 = depth.at(u, v);
    for (int dv = -reach; dv <= reach && full; ++dv)
      for (int du = -reach; du <= reach; ++du) {
        full = full && is_object[static_cast<std::size_t>(v + dv) * depth.width + u + du];
        const double z = depth.at(u + du, v + dv) - z0;
        sum += z, sum_u += du * z, sum_v += dv * z, squared += z * z;
      }
    if (!full) continue;
    constexpr double count = 25, moment = 50;  // of 5 x 5 pixels: sum of du^2
    const double rest = squared - sum * sum / count - (sum_u * sum_u + sum_v * sum_v) / moment;
    deviation.push_back(std::sqrt(std::max(rest, 0.0) / (count - 3)));
  }
  if (deviation.empty()) return 0;
  const auto middle = deviation.begin() + static_cast<std::ptrdiff_t>(deviation.size() / 2);
  std::nth_element(deviation.begin(), middle, deviation.end());
  return *middle;
}

LabelledDepth cropped(const LabelledDepth& frame, int u0, int v0, int u1, int v1) {
  u0 = std::max(u0, 0), v0 = std::max(v0, 0);
  u1 = std::min(u1, frame.depth.width - 1), v1 = std::min(v1, frame.depth.height - 1);
  LabelledDepth out;
  out.camera = frame.camera;
  out.camera.width = std::max(u1 - u0 + 1, 0);
  out.camera.height = std::max(v1 - v0 + 1, 0);
  out.camera.cx -= u0;
  out.camera.cy -= v0;
  out.depth = DepthImage(out.camera.width, out.camera.height);
  out.label.resize(out.depth.z_mm.size());
  for (int v = 0; v < out.depth.height; ++v) {
    const std::size_t from = static_cast<std::size_t>(v0 + v) * frame.depth.width + u0;
    const std::size_t to = static_cast<std::size_t>(v) * out.depth.width;
    std::copy_n(frame.depth.z_mm.begin() + static_cast<std::ptrdiff_t>(from), out.depth.width,
                out.depth.z_mm.begin() + static_cast<std::ptrdiff_t>(to));
    std::copy_n(frame.label.begin() + static_cast<std::ptrdiff_t>(from), out.depth.width,
                out.label.begin() + static_cast<std::ptrdiff_t>(to));
  }
  return out;
}

}  // namespace partpose
