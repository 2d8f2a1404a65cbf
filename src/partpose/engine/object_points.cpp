// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/object_points.hpp"

#include "partpose/core/median.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace partpose {

namespace {

/// Which pixels of a box lie so near to a jump away from the camera that they may have grown over what is behind them:
/// row by row.
std::vector<std::uint8_t> may_be_grown(const FramePieces& frame, const FrameObject& object) {
  constexpr int widest_gap_px = 8;  // beside an edge a stereo camera sees nothing for some pixels
  const DepthImage& depth = *frame.depth;
  const int width = object.u1 - object.u0 + 1, height = object.v1 - object.v0 + 1;
  const int reach = static_cast<int>(std::lround(frame.foreground_growth_px));
  std::vector<std::uint8_t> grown(static_cast<std::size_t>(std::max(width, 0)) * std::max(height, 0), 0);
  if (reach == 0) return grown;
  // Along a row or a column: `at(i)` is the depth at i, which goes from -margin to count + margin.
  const auto mark = [&](int count, int first, int last, const auto& depth_at, const auto& flag_at) {
    int previous = -1000;
    float previous_z = 0;
    for (int i = first; i <= last; ++i) {
      const float z = depth_at(i);
      if (!(z > 0)) continue;
      if (i - previous <= widest_gap_px) {
        const auto edge_mm = static_cast<float>(frame.edge_mm(std::min(z, previous_z)));
        if (z - previous_z > edge_mm)
          for (int k = std::max(previous - reach + 1, 0); k <= std::min(previous, count - 1); ++k) flag_at(k) = 1;
        if (previous_z - z > edge_mm)
          for (int k = std::max(i, 0); k <= std::min(i + reach - 1, count - 1); ++k) flag_at(k) = 1;
      }
      previous = i;
      previous_z = z;
    }
  };
  const int margin = widest_gap_px;
  for (int v = 0; v < height; ++v) {
    const float* row = &depth.z_mm[static_cast<std::size_t>(object.v0 + v) * depth.width + object.u0];
    mark(
        width, std::max(-margin, -object.u0), std::min(width + margin, depth.width - object.u0) - 1,
        [&](int i) { return row[i]; },
        [&](int i) -> std::uint8_t& { return grown[static_cast<std::size_t>(v) * width + i]; });
  }
  for (int u = 0; u < width; ++u)
    mark(
        height, std::max(-margin, -object.v0), std::min(height + margin, depth.height - object.v0) - 1,
        [&](int i) { return depth.at(object.u0 + u, object.v0 + i); },
        [&](int i) -> std::uint8_t& { return grown[static_cast<std::size_t>(i) * width + u]; });
  return grown;
}

/// Without the pixels of the box that `left_out` marks, row by row.
ObjectPoints points_of_blocks(const FramePieces& frame, const FrameObject& object, int block_px,
                              const std::vector<std::uint8_t>& left_out) {
  const DepthImage& depth = *frame.depth;
  const int width = object.u1 - object.u0 + 1;
  ObjectPoints out;
  out.block_px = block_px;
  const int block = block_px, least = std::max(1, block * block / 3);
  for (int bv = object.v0; bv <= object.v1; bv += block)
    for (int bu = object.u0; bu <= object.u1; bu += block) {
      float first_z = 0, z_sum = 0;
      int count = 0, u_sum = 0, v_sum = 0;
      for (int v = bv; v < std::min(bv + block, object.v1 + 1); ++v)
        for (int u = bu; u < std::min(bu + block, object.u1 + 1); ++u) {
          const std::size_t p = static_cast<std::size_t>(v) * depth.width + u;
          if (!(depth.z_mm[p] > 0) || !object.labels.test(frame.label[p])) continue;
          if (left_out[static_cast<std::size_t>(v - object.v0) * width + u - object.u0]) continue;
          const float z = depth.z_mm[p];
          if (count == 0) first_z = z;
          const auto jump = static_cast<float>(2 + 3 * block * z / frame.camera.fx);
          if (std::abs(z - first_z) > jump) continue;
          z_sum += z;
          u_sum += u;
          v_sum += v;
          ++count;
        }
      if (count < least) continue;
      out.points_mm.push_back(frame.camera.unproject(
          static_cast<double>(u_sum) / count, static_cast<double>(v_sum) / count, z_sum / static_cast<float>(count)));
    }
  return out;
}

/// Calls `look(u, v)` for the centres of about 150 windows, spread over the object's box, that reach so many pixels to
/// each side and are within the image.
template <typename Look>
void for_some_windows(const FramePieces& frame, const FrameObject& object, int reach, const Look& look) {
  constexpr int most_windows = 150;
  const double box_px = static_cast<double>(object.u1 - object.u0 + 1) * (object.v1 - object.v0 + 1);
  const int step = std::max(1, static_cast<int>(std::sqrt(box_px / most_windows)));
  for (int v = std::max(object.v0, reach); v <= std::min(object.v1, frame.depth->height - 1 - reach); v += step)
    for (int u = std::max(object.u0, reach); u <= std::min(object.u1, frame.depth->width - 1 - reach); u += step)
      look(u, v);
}

/// Over windows that reach so many pixels to each side.
double local_noise_mm(const FramePieces& frame, const FrameObject& object, int reach) {
  const int side = 2 * reach + 1, pixels = side * side;
  // On a regular grid the best plane's slopes are the moments over fixed sums: each row's of k * k from -reach to
  // reach.
  const auto moment = static_cast<float>(side * reach * (reach + 1) * (2 * reach + 1) / 3);
  const DepthImage& depth = *frame.depth;
  std::vector<float> deviation;
  for_some_windows(frame, object, reach, [&](int u, int v) {
    const float centre_z = depth.at(u, v);
    float sum = 0, squared = 0, along_u = 0, along_v = 0;
    bool full = true;
    for (int dv = -reach; dv <= reach && full; ++dv)
      for (int du = -reach; du <= reach; ++du) {
        const std::size_t p = static_cast<std::size_t>(v + dv) * depth.width + u + du;
        if (!object.labels.test(frame.label[p]) || !(depth.z_mm[p] > 0)) {
          full = false;
          break;
        }
        const float z = depth.z_mm[p] - centre_z;
        sum += z;
        squared += z * z;
        along_u += static_cast<float>(du) * z;
        along_v += static_cast<float>(dv) * z;
      }
    if (!full) return;
    const float left =
        squared - sum * sum / static_cast<float>(pixels) - (along_u * along_u + along_v * along_v) / moment;
    deviation.push_back(std::sqrt(std::max(left, 0.0f) / static_cast<float>(pixels - 3)));
  });
  return deviation.empty() ? 0 : upper_median(std::move(deviation));
}

}  // namespace

ObjectPoints object_points(const FramePieces& frame, const FrameObject& object, int wanted) {
  const int block_px =
      std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(object.pixels) / wanted))));
  std::vector<std::uint8_t> grown = may_be_grown(frame, object);
  ObjectPoints out = points_of_blocks(frame, object, block_px, grown);
  // Of what is hardly wider than an outline all counts.
  constexpr double least_share = 0.4;
  if (static_cast<double>(out.points_mm.size()) * block_px * block_px < least_share * object.pixels) {
    std::fill(grown.begin(), grown.end(), 0);
    out = points_of_blocks(frame, object, block_px, grown);
  }
  return out;
}

double local_noise_mm(const FramePieces& frame, const FrameObject& object) {
  const double noise_mm = local_noise_mm(frame, object, 2);
  return noise_mm > 0 ? noise_mm : local_noise_mm(frame, object, 1);
}

std::optional<double> neighbour_correlation(const FramePieces& frame, const FrameObject& object) {
  constexpr int reach = 3, side = 2 * reach + 1;
  constexpr float least_noise_mm = 0.01f;
  const DepthImage& depth = *frame.depth;
  std::vector<float> correlation;
  for_some_windows(frame, object, reach, [&](int u, int v) {
    std::array<float, side * side> z;
    float sum = 0, along_u = 0, along_v = 0;
    bool full = true;
    for (int i = 0; i < side * side && full; ++i) {
      const int du = i % side - reach, dv = i / side - reach;
      const std::size_t p = static_cast<std::size_t>(v + dv) * depth.width + u + du;
      full = object.labels.test(frame.label[p]) && depth.z_mm[p] > 0;
      z[i] = depth.z_mm[p] - depth.at(u, v);
      sum += z[i];
      along_u += static_cast<float>(du) * z[i];
      along_v += static_cast<float>(dv) * z[i];
    }
    if (!full) return;
    constexpr float moment = side * 2 * (9 + 4 + 1);
    float squared = 0, products = 0;
    for (int i = 0; i < side * side; ++i)
      z[i] -=
          sum / (side * side) +
          (static_cast<float>(i % side - reach) * along_u + static_cast<float>(i / side - reach) * along_v) / moment;
    for (int i = 0; i < side * side; ++i) {
      squared += z[i] * z[i];
      if (i % side + 1 < side) products += z[i] * z[i + 1];
      if (i + side < side * side) products += z[i] * z[i + side];
    }
    const bool noisy = squared > side * side * least_noise_mm * least_noise_mm;
    correlation.push_back(noisy ? products / (2 * side * (side - 1)) / (squared / (side * side)) : 0);
  });
  if (correlation.size() < 3) return std::nullopt;
  return upper_median(std::move(correlation));
}

}  // namespace partpose
