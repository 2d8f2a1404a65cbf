// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/part_outline.hpp"

#include "partpose/camera/rasterizer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace partpose {

FrameObject object_of(const FramePieces& frame, const std::bitset<256>& labels) {
  FrameObject out;
  out.labels = labels;
  out.u0 = frame.depth->width, out.v0 = frame.depth->height;
  for (int v = 0; v < frame.depth->height; ++v)
    for (int u = 0; u < frame.depth->width; ++u) {
      if (!labels.test(frame.label[static_cast<std::size_t>(v) * frame.depth->width + u])) continue;
      ++out.pixels;
      out.u0 = std::min(out.u0, u), out.u1 = std::max(out.u1, u);
      out.v0 = std::min(out.v0, v), out.v1 = std::max(out.v1, v);
    }
  return out;
}

PartWindow part_window(const FramePieces& frame, const FrameObject& rest, const PartModel& model,
                       const Eigen::Isometry3d& camera_from_model, int wanted, int margin_px) {
  const Intrinsics& camera = frame.camera;
  const Eigen::AlignedBox2d box = model.covered(camera, camera_from_model);
  const auto pixel = [&](double x, int most) { return static_cast<int>(std::clamp<double>(x, 0, most - 1)); };
  PartWindow out;
  out.u0 = pixel(box.min().x() - margin_px, camera.width), out.v0 = pixel(box.min().y() - margin_px, camera.height);
  const int last_u = pixel(box.max().x() + margin_px, camera.width);
  const int last_v = pixel(box.max().y() + margin_px, camera.height);
  // A part covers about half of its box.
  const double covered = 0.5 * (last_u - out.u0 + 1) * (last_v - out.v0 + 1);
  out.stride = wanted > 0 ? std::max(1, static_cast<int>(std::lround(std::sqrt(covered / wanted)))) : 1;
  out.frame = window(frame, rest, out.u0, out.v0, last_u, last_v, out.stride);
  return out;
}

BeyondOutline beyond_outline(const DepthImage& rendered, int reach_px, int stride) {
  constexpr int edge_px = 6;
  // The slope is that between two places some pixels within the outline.
  const int near_px = std::max(1, 2 / stride), slope_px = std::max(1, 6 / stride);
  const int within_px = near_px + std::max(1, edge_px / stride);
  const int width = rendered.width;
  BeyondOutline out{DepthImage(width, rendered.height), DepthImage(width, rendered.height),
                    std::vector<std::uint8_t>(rendered.z_mm.size(), 0)};
  std::vector<int> nearest(rendered.z_mm.size(), -1), front, next;
  for (int p = 0; p < static_cast<int>(nearest.size()); ++p)
    if (rendered.z_mm[p] > 0) {
      nearest[p] = p;
      front.push_back(p);
    }
  for (int step = 1; step <= reach_px / stride + 1; ++step, front.swap(next)) {
    next.clear();
    for (const int from : front)
      for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int u = from % width + du, v = from / width + dv;
        if (u < 0 || v < 0 || u >= width || v >= rendered.height) continue;
        const int p = v * width + u;
        if (nearest[p] >= 0) continue;
        const int edge = nearest[p] = nearest[from];
        next.push_back(p);
        const int edge_u = edge % width, edge_v = edge / width;
        const int across = u - edge_u, down = v - edge_v;
        const auto distance = static_cast<float>(std::sqrt(double(across * across + down * down)));
        const auto inverse_within = [&](int px) {
          const int uu = edge_u + static_cast<int>(std::lround(-px * across / distance));
          const int vv = edge_v + static_cast<int>(std::lround(-px * down / distance));
          return uu >= 0 && vv >= 0 && uu < width && vv < rendered.height && rendered.at(uu, vv) > 0
                     ? 1 / rendered.at(uu, vv)
                     : 0.0f;
        };
        const auto straight_on = [&](int from_px) {
          const float near = inverse_within(from_px), far = inverse_within(from_px + slope_px);
          if (!(near > 0) || !(far > 0)) return 0.0f;
          const float inverse =
              near + (near - far) * (distance + static_cast<float>(from_px)) / static_cast<float>(slope_px);
          return inverse > 0 ? 1 / inverse : 0.0f;
        };
        out.depth.z_mm[p] = straight_on(near_px);
        out.within_edge.z_mm[p] = straight_on(within_px);
        if (out.depth.z_mm[p] > 0) out.step[p] = static_cast<std::uint8_t>(step);
      }
  }
  return out;
}

std::vector<std::uint8_t> near_rendered(const DepthImage& rendered, int reach) {
  const int width = rendered.width, height = rendered.height;
  std::vector<std::uint8_t> along(rendered.z_mm.size(), 0), near(rendered.z_mm.size(), 0);
  for (int v = 0; v < height; ++v) {
    const float* row = &rendered.z_mm[static_cast<std::size_t>(v) * width];
    std::uint8_t* out = &along[static_cast<std::size_t>(v) * width];
    for (int shift = -reach; shift <= reach; ++shift)
      for (int u = std::max(-shift, 0); u < std::min(width - shift, width); ++u) out[u] |= row[u + shift] > 0;
  }
  for (int v = 0; v < height; ++v) {
    std::uint8_t* out = &near[static_cast<std::size_t>(v) * width];
    for (int from = std::max(v - reach, 0); from <= std::min(v + reach, height - 1); ++from)
      for (int u = 0; u < width; ++u) out[u] |= along[static_cast<std::size_t>(from) * width + u];
  }
  return near;
}

std::vector<std::size_t> explained_pixels(const PartModel& model, const Eigen::Isometry3d& camera_from_model,
                                          const FramePieces& frame, const std::bitset<256>& labels, double noise_mm) {
  FrameObject rest;
  rest.labels = labels;
  const PartWindow window = part_window(frame, rest, model, camera_from_model, 0, outline_px + 1);
  const DepthImage rendered = render_depth(model.surface, camera_from_model, window.frame.camera, model.surface.faces);
  const auto limit_mm = static_cast<float>(4 * noise_mm);
  std::vector<std::size_t> out;
  for (int v = 0; v < rendered.height; ++v)
    for (int u = 0; u < rendered.width; ++u) {
      if (window.frame.label[static_cast<std::size_t>(v) * rendered.width + u] != PixelLabel::object) continue;
      const float z = window.frame.depth.at(u, v);
      const auto agrees = [&](int uu, int vv) {
        return rendered.at(uu, vv) > 0 && std::abs(rendered.at(uu, vv) - z) < limit_mm;
      };
      bool explained = agrees(u, v);
      for (int vv = std::max(v - outline_px, 0); !explained && vv <= std::min(v + outline_px, rendered.height - 1);
           ++vv)
        for (int uu = std::max(u - outline_px, 0); uu <= std::min(u + outline_px, rendered.width - 1); ++uu)
          explained |= agrees(uu, vv);
      if (explained) out.push_back(static_cast<std::size_t>(window.v0 + v) * frame.depth->width + window.u0 + u);
    }
  return out;
}

int largest_left_px(const FramePieces& frame, const std::bitset<256>& labels, const Hypothesis* explained,
                    std::span<const PartModel* const> models, double noise_mm) {
  const FrameObject object = object_of(frame, labels);
  const int width = object.u1 - object.u0 + 1, height = object.v1 - object.v0 + 1, frame_width = frame.depth->width;
  if (object.pixels == 0) return 0;
  std::vector<std::uint8_t> left(static_cast<std::size_t>(width) * height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      left[static_cast<std::size_t>(v) * width + u] =
          labels.test(frame.label[static_cast<std::size_t>(object.v0 + v) * frame_width + object.u0 + u]);
  if (explained)
    for (const std::size_t p :
         explained_pixels(*models[explained->part], explained->camera_from_model, frame, labels, noise_mm))
      left[(p / frame_width - object.v0) * width + p % frame_width - object.u0] = 0;
  // Strips along outlines are nothing.
  constexpr int margin = 2;
  const auto thinned = [](const std::vector<std::uint8_t>& from, int step, int length) {
    std::vector<std::uint8_t> out(from.size(), 0);
    for (std::size_t p = 0; p < from.size(); ++p) {
      const int at = static_cast<int>(p) / step % length;
      out[p] = from[p];
      for (int k = 1; k <= margin && out[p]; ++k)
        out[p] = at >= k && at + k < length && from[p - k * step] && from[p + k * step];
    }
    return out;
  };
  left = thinned(thinned(left, 1, width), width, height);
  int largest = 0;
  std::vector<std::size_t> open;
  for (std::size_t start = 0; start < left.size(); ++start) {
    if (!left[start]) continue;
    int pixels = 0;
    open.assign(1, start);
    left[start] = 0;
    while (!open.empty()) {
      const std::size_t p = open.back();
      open.pop_back();
      ++pixels;
      const int u = static_cast<int>(p) % width, v = static_cast<int>(p) / width;
      const auto visit = [&](bool inside, std::size_t q) {
        if (inside && left[q]) left[q] = 0, open.push_back(q);
      };
      visit(u > 0, p - 1), visit(u + 1 < width, p + 1), visit(v > 0, p - width), visit(v + 1 < height, p + width);
    }
    largest = std::max(largest, pixels);
  }
  return largest;
}

}  // namespace partpose
