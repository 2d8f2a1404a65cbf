// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/frame_pieces.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/core/union_find.hpp"
#include "partpose/engine/frame_splitter.hpp"
#include "partpose/engine/object_points.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>

namespace partpose {

namespace {

FrameObject together(const FrameObject& a, const FrameObject& b) {
  FrameObject out;
  out.labels = a.labels | b.labels;
  out.u0 = std::min(a.u0, b.u0), out.v0 = std::min(a.v0, b.v0);
  out.u1 = std::max(a.u1, b.u1), out.v1 = std::max(a.v1, b.v1);
  out.pixels = a.pixels + b.pixels;
  return out;
}

/// Labels the pixels by the cells: as the cell beside a pixel, where their depths are near and the pixel is off the
/// plane.
class PixelLabels {
 public:
  PixelLabels(FramePieces& frame, const CellGrid& grid, const FrameSplit& split)
      : frame_(frame), grid_(grid), split_(split), cell_label_(grid.z_mm.size(), 0) {
    for (std::size_t k = 0; k < split.pieces.size(); ++k)
      for (const int cell : split.pieces[k].cells)
        cell_label_[cell] = static_cast<std::uint8_t>(FramePieces::first_piece + k);
    for (std::size_t k = 0; k < split.pieces.size(); ++k) label_piece(k);
  }

 private:
  void label_piece(std::size_t k) {
    const auto& piece = split_.pieces[k];
    int cu0 = grid_.width, cu1 = -1, cv0 = grid_.height, cv1 = -1;
    for (const int cell : piece.cells) {
      cu0 = std::min(cu0, cell % grid_.width), cu1 = std::max(cu1, cell % grid_.width);
      cv0 = std::min(cv0, cell / grid_.width), cv1 = std::max(cv1, cell / grid_.width);
    }
    const int s = grid_.stride;
    const auto label = static_cast<std::uint8_t>(FramePieces::first_piece + k);
    FrameObject object;
    object.labels.set(label);
    const DepthImage& depth = *frame_.depth;
    object.u0 = depth.width, object.v0 = depth.height;
    const int u0 = std::max(0, (cu0 - 1) * s + 1), u1 = std::min(depth.width, (cu1 + 1) * s);
    const int v0 = std::max(0, (cv0 - 1) * s + 1), v1 = std::min(depth.height, (cv1 + 1) * s);
    std::mutex one_at_a_time;
    constexpr int rows_at_once = 32;
    parallel_ranges(
        static_cast<std::size_t>(std::max(v1 - v0, 0)),
        [&](std::size_t begin, std::size_t end) {
          const int first = v0 + static_cast<int>(begin), last = v0 + static_cast<int>(end);
          const FrameObject some = label_rows(label, piece.plane, first, last, u0, u1);
          const std::lock_guard lock(one_at_a_time);
          object = together(object, some);
        },
        rows_at_once);
    object.larger_than_a_part = piece.larger_than_a_part;
    if (object.pixels > 0) frame_.objects.push_back(object);
  }

  /// Of the rows [v0, v1), the columns [u0, u1): what of them is the piece's.
  FrameObject label_rows(std::uint8_t label, const CutPlane& cut, int v0, int v1, int u0, int u1) {
    const DepthImage& depth = *frame_.depth;
    const int s = grid_.stride;
    const auto fx = static_cast<float>(1 / frame_.camera.fx), fy = static_cast<float>(1 / frame_.camera.fy);
    const auto cx = static_cast<float>(frame_.camera.cx), cy = static_cast<float>(frame_.camera.cy);
    FrameObject object;
    object.u0 = depth.width, object.v0 = depth.height;
    for (int v = v0; v < v1; ++v) {
      const RowHeights height(cut.plane, (static_cast<float>(v) - cy) * fy);
      const std::size_t row = static_cast<std::size_t>(v) * depth.width;
      // The cells before and behind a pixel, above and below it; the same one twice where the pixel is a cell.
      const std::size_t above = static_cast<std::size_t>(v / s) * grid_.width;
      const std::size_t below = v % s != 0 && v / s + 1 < grid_.height ? above + grid_.width : above;
      for (int u = u0, cu = u0 / s, off = u0 % s; u < u1; ++u) {
        const int beside = off != 0 && cu + 1 < grid_.width ? cu + 1 : cu;
        const float z = depth.z_mm[row + u];
        const auto is_near = [&](std::size_t cell) {
          return cell_label_[cell] == label && std::abs(grid_.z_mm[cell] - z) <= grid_.jump_mm(z);
        };
        if (z > 0 && frame_.label[row + u] == FramePieces::background &&
            (is_near(above + cu) || is_near(above + beside) || is_near(below + cu) || is_near(below + beside)) &&
            std::abs(height((static_cast<float>(u) - cx) * fx, z)) > cut.cut_mm) {
          frame_.label[row + u] = label;
          ++object.pixels;
          object.u0 = std::min(object.u0, u), object.u1 = std::max(object.u1, u);
          object.v0 = std::min(object.v0, v), object.v1 = std::max(object.v1, v);
        }
        if (++off == s) off = 0, ++cu;
      }
    }
    return object;
  }

  FramePieces& frame_;
  const CellGrid& grid_;
  const FrameSplit& split_;
  std::vector<std::uint8_t> cell_label_;
};

/// Pairs of pieces that nearly touch in the image and are together no larger than a part, and larger groups of such.
void add_groups(FramePieces& frame, const FrameSplit& split, const CellGrid& grid, const FramePiecesOptions& options) {
  constexpr int near_px = 8;
  const int reach = std::max(1, near_px / grid.stride);
  const std::size_t count = frame.objects.size();
  std::vector<Eigen::AlignedBox3f> box(count);
  std::vector<std::vector<std::uint8_t>> covered(count);  // in blocks of `reach` cells
  const int columns = grid.width / reach + 1, rows = grid.height / reach + 1;
  for (std::size_t k = 0; k < count; ++k) {
    covered[k].assign(static_cast<std::size_t>(columns) * rows, 0);
    const auto piece = static_cast<std::size_t>(frame.objects[k].labels._Find_first()) - FramePieces::first_piece;
    for (const int cell : split.pieces[piece].cells) {
      box[k].extend(grid.point(cell));
      covered[k][static_cast<std::size_t>(cell / grid.width / reach) * columns + cell % grid.width / reach] = 1;
    }
  }
  const auto touch = [&](std::size_t a, std::size_t b) {
    for (int v = 0; v < rows; ++v)
      for (int u = 0; u < columns; ++u) {
        if (!covered[a][static_cast<std::size_t>(v) * columns + u]) continue;
        for (int vv = std::max(v - 1, 0); vv <= std::min(v + 1, rows - 1); ++vv)
          for (int uu = std::max(u - 1, 0); uu <= std::min(u + 1, columns - 1); ++uu)
            if (covered[b][static_cast<std::size_t>(vv) * columns + uu]) return true;
      }
    return false;
  };
  const auto fits = [&](std::size_t a, std::size_t b) {
    return box[a].merged(box[b]).sizes().maxCoeff() <= options.largest_part_mm;
  };
  std::vector<FrameObject> pairs;
  UnionFind groups(count);
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b) {
      if (!fits(a, b) || !touch(a, b)) continue;
      pairs.push_back(together(frame.objects[a], frame.objects[b]));
      groups.join(static_cast<int>(a), static_cast<int>(b));
    }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const FrameObject& a, const FrameObject& b) { return a.pixels > b.pixels; });
  if (static_cast<int>(pairs.size()) > options.most_pairs) pairs.resize(options.most_pairs);
  // All that hangs together, where it may be one part.
  std::map<int, std::vector<std::size_t>> members;
  for (std::size_t k = 0; k < count; ++k) members[groups.find(static_cast<int>(k))].push_back(k);
  for (const auto& [root, group] : members) {
    if (group.size() < 3) continue;
    FrameObject all = frame.objects[group[0]];
    Eigen::AlignedBox3f all_box = box[group[0]];
    for (const std::size_t k : group) {
      if (k != group[0]) all = together(all, frame.objects[k]);
      all_box.extend(box[k]);
    }
    if (all_box.sizes().maxCoeff() <= size_margin * options.largest_part_mm) pairs.push_back(all);
  }
  frame.objects.insert(frame.objects.end(), pairs.begin(), pairs.end());
}

}  // namespace

std::array<float, FlatSurface::degree + 1> FlatSurface::bend_along_x(float ray_y) const {
  std::array<float, degree + 1> out{};
  float y = 1;
  for (int j = 0, k = 0; j <= degree; ++j, y *= ray_y)
    for (int i = 0; i + j <= degree; ++i) out[i] += y * bend_mm[k++];
  return out;
}

float FlatSurface::most_bend_mm(const Intrinsics& camera) const {
  const double x = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double y = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  FlatSurface all_up = *this;
  for (float& term : all_up.bend_mm) term = std::abs(term);
  return all_up.bend_mm_at(static_cast<float>(x), static_cast<float>(y));
}

float FlatSurface::height_mm(const Eigen::Vector3f& ray, float z_mm) const {
  return (1 - z_mm * q.dot(ray)) / q.norm() - bend_mm_at(ray.x(), ray.y());
}

FramePieces split_frame(const DepthImage& depth, const Intrinsics& camera, const FramePiecesOptions& options) {
  FramePieces frame;
  frame.depth = &depth;
  frame.camera = camera;
  frame.label.resize(depth.z_mm.size());
  static_assert(FramePieces::not_measured == 0 && FramePieces::background == 1);
  std::atomic<int> measured_pixels = 0;
  parallel_ranges(
      depth.z_mm.size(),
      [&](std::size_t begin, std::size_t end) {
        const float* z_mm = depth.z_mm.data();
        std::uint8_t* label = frame.label.data();
        int measured = 0;
#pragma omp simd reduction(+ : measured)
        for (std::size_t p = begin; p < end; ++p) {
          label[p] = z_mm[p] > 0;
          measured += z_mm[p] > 0;
        }
        measured_pixels += measured;
      },
      100'000);
  frame.measured_pixels = measured_pixels;
  if (depth.z_mm.empty()) return frame;

  const CellGrid grid(depth, camera);
  const FrameSplit split = split_cells(grid, camera, options);
  if (split.table) frame.table = split.table->plane;
  const PixelLabels labels(frame, grid, split);
  if (frame.objects.size() > 1) add_groups(frame, split, grid, options);
  if (split.whole_frame) {
    FrameObject whole;
    whole.whole_frame = true;
    for (int k = FramePieces::background; k < 256; ++k) whole.labels.set(k);
    whole.u0 = depth.width, whole.v0 = depth.height;
    for (int v = 0; v < depth.height; ++v)
      for (int u = 0; u < depth.width; ++u) {
        if (!(depth.at(u, v) > 0)) continue;
        ++whole.pixels;
        whole.u0 = std::min(whole.u0, u), whole.u1 = std::max(whole.u1, u);
        whole.v0 = std::min(whole.v0, v), whole.v1 = std::max(whole.v1, v);
      }
    frame.objects.push_back(whole);
  }
  std::stable_sort(frame.objects.begin(), frame.objects.end(),
                   [](const FrameObject& a, const FrameObject& b) { return a.pixels > b.pixels; });
  constexpr double independent = 0.06, stereo_growth_px = 3;
  if (!frame.objects.empty())
    frame.foreground_growth_px =
        neighbour_correlation(frame, frame.objects[0]).value_or(1) > independent ? stereo_growth_px : 0;
  return frame;
}

bool is_on_table(const FramePieces& frame, std::int32_t pixel) {
  constexpr float near_table_mm = 8;
  if (!frame.table || frame.label[pixel] != FramePieces::background) return false;
  const int u = pixel % frame.depth->width, v = pixel / frame.depth->width;
  const Eigen::Vector3d ray((u - frame.camera.cx) / frame.camera.fx, (v - frame.camera.cy) / frame.camera.fy, 1);
  return frame.table->height_mm(ray.cast<float>(), frame.depth->z_mm[pixel]) < near_table_mm;
}

void find_shadows(FramePieces& frame) {
  constexpr int window_px = 8;   // so much more is lost beside an edge, since windows are matched
  constexpr double wider = 1.5;  // some cameras' imagers are farther apart
  constexpr float least_step_mm = 8;
  const DepthImage& depth = *frame.depth;
  frame.shadow_of.assign(frame.label.size(), -1);
  for (int v = 0; v < depth.height; ++v) {
    const std::int32_t row = v * depth.width;
    for (int u = 0; u < depth.width; ++u) {
      if (frame.label[row + u] != FramePieces::not_measured) continue;
      const int from = u;
      while (u < depth.width && frame.label[row + u] == FramePieces::not_measured) ++u;
      if (from == 0 || u == depth.width) {
        // What one imager sees beyond the other's field of view.
        constexpr int widest_px = 60;
        if (frame.table && u > from && u - from <= widest_px)
          std::fill(frame.shadow_of.begin() + row + from, frame.shadow_of.begin() + row + u, row + from);
        continue;
      }
      const std::int32_t left = row + from - 1, right = row + u;
      const float step = depth.z_mm[right] - depth.z_mm[left];
      if (std::abs(step) < least_step_mm || is_on_table(frame, step > 0 ? left : right)) continue;
      // As wide as the disparity jumps.
      const double widest_px = frame.camera.fx * FramePieces::baseline_mm *
                               std::abs(1 / double(depth.z_mm[left]) - 1 / double(depth.z_mm[right]));
      if (u - from > wider * widest_px + window_px) continue;
      std::fill(frame.shadow_of.begin() + row + from, frame.shadow_of.begin() + row + u, step > 0 ? left : right);
    }
  }
}

namespace {
constexpr float hides_all_mm = 1;
}

FrameWindow window(const FramePieces& frame, const FrameObject& object, int u0, int v0, int u1, int v1, int stride) {
  const DepthImage& depth = *frame.depth;
  FrameWindow out;
  out.camera.width = std::max(0, (u1 - u0) / stride + 1);
  out.camera.height = std::max(0, (v1 - v0) / stride + 1);
  out.camera.fx = frame.camera.fx / stride;
  out.camera.fy = frame.camera.fy / stride;
  out.camera.cx = (frame.camera.cx - u0) / stride;
  out.camera.cy = (frame.camera.cy - v0) / stride;
  out.depth = DepthImage(out.camera.width, out.camera.height);
  out.label.assign(out.depth.z_mm.size(), PixelLabel::nothing);
  std::array<PixelLabel, 256> meaning;
  for (int k = 0; k < 256; ++k)
    meaning[k] = k == FramePieces::not_measured ? PixelLabel::nothing
                 : object.labels.test(k)        ? PixelLabel::object
                                                : PixelLabel::background;
  if (!frame.shadow_of.empty()) {  // beyond the frame all is hidden
    std::fill(out.depth.z_mm.begin(), out.depth.z_mm.end(), hides_all_mm);
    std::fill(out.label.begin(), out.label.end(), PixelLabel::background);
  }
  if (frame.table) out.before_table_mm.assign(out.depth.z_mm.size(), FrameWindow::not_table_mm);
  std::array<float, FlatSurface::degree + 1> bend{};
  const int first = u0 < 0 ? (-u0 + stride - 1) / stride : 0;
  for (int v = 0; v < out.depth.height; ++v) {
    const int frame_v = v0 + v * stride;
    if (frame_v < 0 || frame_v >= depth.height) continue;
    const std::size_t row = static_cast<std::size_t>(frame_v) * depth.width;
    const auto ray_y = static_cast<float>((frame_v - frame.camera.cy) / frame.camera.fy);
    if (frame.table) bend = frame.table->bend_along_x(ray_y);
    for (int u = first; u < out.depth.width && u0 + u * stride < depth.width; ++u) {
      const std::size_t from = row + u0 + u * stride, to = static_cast<std::size_t>(v) * out.depth.width + u;
      out.depth.z_mm[to] = std::max(depth.z_mm[from], 0.0f);
      out.label[to] = meaning[frame.label[from]];
      if (!frame.shadow_of.empty() && frame.shadow_of[from] >= 0) {
        const std::int32_t by = frame.shadow_of[from];
        if (!object.labels.test(frame.label[by])) {
          out.depth.z_mm[to] = std::max(depth.z_mm[by], hides_all_mm);
          out.label[to] = PixelLabel::background;
        }
        continue;
      }
      if (frame.table && frame.label[from] == FramePieces::background) {
        const Eigen::Vector3f& q = frame.table->q;
        const auto ray_x = static_cast<float>((u0 + u * stride - frame.camera.cx) / frame.camera.fx);
        float bent = bend.back();
        for (int i = FlatSurface::degree - 1; i >= 0; --i) bent = bent * ray_x + bend[i];
        // A height is so many depths as the line of sight is steep.
        const float along = q.x() * ray_x + q.y() * ray_y + q.z();
        out.before_table_mm[to] = (1 - depth.z_mm[from] * along - bent * q.norm()) / std::max(along, 1e-6f);
      }
    }
  }
  return out;
}

}  // namespace partpose
