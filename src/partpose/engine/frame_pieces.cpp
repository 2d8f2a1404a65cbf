// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/frame_pieces.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/core/random.hpp"
#include "partpose/registration/row_products.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>

namespace partpose {

namespace {

/// How far a piece may exceed the largest part, for noise and for what sticks to it.
constexpr float size_margin = 1.25f;
constexpr float most_parts_long = 5;  ///< a piece of parts that touch
constexpr int wanted_cells = 80'000;
/// What is so many times as high as the cut stands out for certain.
constexpr float stands_out_cuts = 1.7f;

class UnionFind {
 public:
  explicit UnionFind(std::size_t count = 0) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::size_t size() const { return parent_.size(); }
  int add() {
    parent_.push_back(static_cast<int>(parent_.size()));
    return parent_.back();
  }
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int a, int b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

/// Every n-th pixel of a frame, with its ray.
class Grid {
 public:
  Grid(const DepthImage& depth, const Intrinsics& camera)
      : stride(std::max(1, static_cast<int>(std::ceil(
                               std::sqrt(static_cast<double>(depth.width) * depth.height / wanted_cells) - 0.05)))),
        width((depth.width + stride - 1) / stride),
        height((depth.height + stride - 1) / stride),
        z_mm(static_cast<std::size_t>(width) * height) {
    for (int u = 0; u < width; ++u) ray_x.push_back(static_cast<float>((u * stride - camera.cx) / camera.fx));
    for (int v = 0; v < height; ++v) {
      ray_y.push_back(static_cast<float>((v * stride - camera.cy) / camera.fy));
      const float* row = &depth.z_mm[static_cast<std::size_t>(v) * stride * depth.width];
      for (int u = 0; u < width; ++u) z_mm[static_cast<std::size_t>(v) * width + u] = row[u * stride];
    }
    limit_per_mm = static_cast<float>(3.0 * stride / std::min(camera.fx, camera.fy));
  }

  Eigen::Vector3f ray(int cell) const { return {ray_x[cell % width], ray_y[cell / width], 1}; }
  Eigen::Vector3f point(int cell) const { return z_mm[cell] * ray(cell); }
  /// Depths of neighbouring cells differ by less on one surface: up to about 70 degrees steep it holds together, and
  /// the jump from a part to what is behind it is larger.
  float jump_mm(float z) const { return 2 + limit_per_mm * z; }

  int stride, width, height;
  std::vector<float> z_mm, ray_x, ray_y;
  float limit_per_mm = 0;
};

using Lanes = NumberLanes<float>;
using Cells = std::vector<int>;  ///< indices into a Grid, rising

struct CutPlane {
  FlatSurface plane;
  float cut_mm = 0;  ///< what lies nearer to it belongs to it
  float at_mm = 0;   ///< the distance from the camera that this is meant for: noise grows with its square
};

/// Heights over a surface along one row of an image, all of whose rays have the same y.
class RowHeights {
 public:
  RowHeights(const FlatSurface& surface, float ray_y)
      : along_x_(surface.q.x()),
        along_rest_(surface.q.y() * ray_y + surface.q.z()),
        per_norm_(1 / surface.q.norm()),
        bend_(surface.bend_along_x(ray_y)) {}
  float operator()(float ray_x, float z_mm) const {
    float bent = bend_.back();
    for (int i = FlatSurface::degree - 1; i >= 0; --i) bent = bent * ray_x + bend_[i];
    return (1 - z_mm * (along_x_ * ray_x + along_rest_)) * per_norm_ - bent;
  }
  /// Of several places, side by side.
  void operator()(const float* ray_x, const float* z_mm, float* out, int count) const {
    const RowHeights height = *this;  // which `out` is not a part of
#pragma omp simd
    for (int i = 0; i < count; ++i) out[i] = height(ray_x[i], z_mm[i]);
  }

 private:
  float along_x_, along_rest_, per_norm_;
  std::array<float, FlatSurface::degree + 1> bend_;
};

/// Splits a frame's cells into what may be single objects.
class Splitter {
 public:
  Splitter(const Grid& grid, const Intrinsics& camera, const FramePiecesOptions& options)
      : grid_(grid), camera_(camera), options_(options), height_mm_(grid.z_mm.size()), number_(grid.z_mm.size(), -1) {
    Cells measured(grid.z_mm.size());
    std::size_t count = 0;
    for (int i = 0; i < static_cast<int>(grid.z_mm.size()); ++i) {
      measured[count] = i;
      count += grid.z_mm[i] > 0;
    }
    measured.resize(count);
    min_cells_ = std::max(8, options.min_pixels / (grid.stride * grid.stride));
    table = dominant_plane(measured, 1);
    if (is_plausible(measured)) {
      whole_frame = true;
      if (!table || !stands_on_table(measured)) return;
    }
    if (table) remove_plane_and_split(measured, *table, 0);
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const Piece& a, const Piece& b) { return a.cells.size() > b.cells.size(); });
    if (static_cast<int>(pieces.size()) > options.most_pieces) pieces.resize(options.most_pieces);
  }

  struct Piece {
    Cells cells;
    CutPlane plane;  ///< that was taken away beside it
    bool larger_than_a_part = false;
  };
  std::vector<Piece> pieces;
  bool whole_frame = false;
  std::optional<CutPlane> table;

 private:
  /// Of cells: their rays (x, y, 1), and depths.
  struct Places {
    std::vector<float> ray_x, ray_y, z_mm;
  };

  Places places_of(const Cells& cells) const {
    Places out{std::vector<float>(cells.size()), std::vector<float>(cells.size()), std::vector<float>(cells.size())};
    int row = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      while (cells[i] >= (row + 1) * grid_.width) ++row;
      out.ray_x[i] = grid_.ray_x[cells[i] - row * grid_.width];
      out.ray_y[i] = grid_.ray_y[row];
      out.z_mm[i] = grid_.z_mm[cells[i]];
    }
    return out;
  }

  /// The largest width along 13 directions: the diameter, less some per cent. Of every `step`-th cell.
  float extent_mm(const Cells& cells, std::size_t step = 1) const {
    constexpr int directions = 13, padded = 16;
    struct Directions {
      std::array<float, padded> x{}, y{}, z{};
    };
    static const Directions along = [] {
      Directions out;
      for (int k = 0; k < directions; ++k) {
        const int code = directions + 1 + k;  // one of each pair of opposite directions with entries -1, 0, 1
        const Eigen::Vector3f d = Eigen::Vector3f(code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1).normalized();
        out.x[k] = d.x(), out.y[k] = d.y(), out.z[k] = d.z();
      }
      return out;
    }();
    alignas(32) std::array<float, padded> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < cells.size(); i += step) {
      const Eigen::Vector3f p = grid_.point(cells[i]);
#pragma omp simd
      for (int k = 0; k < padded; ++k) {
        const float width = along.x[k] * p.x() + along.y[k] * p.y() + along.z[k] * p.z();
        low[k] = std::min(low[k], width);
        high[k] = std::max(high[k], width);
      }
    }
    float largest = 0;
    for (int k = 0; k < directions; ++k) largest = std::max(largest, high[k] - low[k]);
    return largest;
  }

  bool is_wider(const Cells& cells, float limit_mm) const {
    constexpr std::size_t few = 16;  // of a table a few cells tell
    return extent_mm(cells, few) > limit_mm || extent_mm(cells) > limit_mm;
  }
  bool is_too_large(const Cells& cells) const { return is_wider(cells, size_margin * options_.largest_part_mm); }

  /// Some parts that touch: larger than one, but not by far.
  bool is_heap(const Cells& cells) const {
    return static_cast<int>(cells.size()) >= min_cells_ && is_too_large(cells) &&
           !is_wider(cells, most_parts_long * options_.largest_part_mm);
  }

  bool is_plausible(const Cells& cells) const {
    if (static_cast<int>(cells.size()) < min_cells_) return false;
    // Whatever covers far more than the largest part could is not looked at point by point.
    const float middle_z = grid_.z_mm[cells[cells.size() / 2]];
    const double cell_mm = grid_.stride * middle_z / std::max(camera_.fx, camera_.fy);
    const double largest_mm = size_margin * options_.largest_part_mm;
    if (static_cast<double>(cells.size()) * cell_mm * cell_mm > 4 * largest_mm * largest_mm) return false;
    if (is_too_large(cells) || extent_mm(cells) < 0.3f * options_.smallest_part_mm) return false;
    // Even a plate seen edge-on covers a few per cent of its diameter's square.
    const double smallest_cells = options_.smallest_part_mm / cell_mm;
    return static_cast<double>(cells.size()) >= 0.02 * smallest_cells * smallest_cells;
  }

  /// By RANSAC (Fischler and Bolles 1981) on inverse depths, refined by least squares on what lies on it. `fewer`: of
  /// so many of the cells that are looked at for a table one.
  std::optional<CutPlane> dominant_plane(const Cells& cells, std::size_t fewer) const {
    constexpr double smallest_share = 0.1;
    if (static_cast<int>(cells.size()) < std::max(min_cells_, 3)) return std::nullopt;
    const auto every_nth = [&](std::size_t count) {
      const double step = std::max(1.0, static_cast<double>(cells.size()) / static_cast<double>(count));
      Cells some(std::min(count, cells.size()));
      for (std::size_t i = 0; i < some.size(); ++i)
        some[i] = cells[static_cast<std::size_t>((static_cast<double>(i) + 0.5) * step)];
      return some;
    };
    const auto [voter_x, voter_y, voter_z] = places_of(every_nth(400));
    std::vector<float> by_z = voter_z;
    std::nth_element(by_z.begin(), by_z.begin() + static_cast<std::ptrdiff_t>(by_z.size() / 2), by_z.end());
    // Wide enough for the waves that a stereo camera sees on a flat table, about 1 % of the distance.
    const float threshold = std::clamp(0.01f * by_z[by_z.size() / 2], 3.0f, 50.0f);

    const std::size_t voters = voter_z.size();
    const auto votes_for = [&, x = voter_x.data(), y = voter_y.data(), z = voter_z.data()](const FlatSurface& plane) {
      const float tolerance = threshold * plane.q.norm();
      const float qx = plane.q.x(), qy = plane.q.y(), qz = plane.q.z();
      int votes = 0;
      for (std::size_t i = 0; i < voters; ++i) votes += std::abs(1 - z[i] * (qx * x[i] + qy * y[i] + qz)) < tolerance;
      return votes;
    };
    Random random(1);
    FlatSurface best;
    int most_votes = 0;
    constexpr int most_draws = 150;
    for (int draw = 0, enough = most_draws; draw < enough; ++draw) {
      Eigen::Matrix3f rays;
      Eigen::Vector3f inverse;
      for (int k = 0; k < 3; ++k) {
        const int cell = cells[random.below(cells.size())];
        rays.row(k) = grid_.ray(cell);
        inverse[k] = 1 / grid_.z_mm[cell];
      }
      if (std::abs(rays.determinant()) < 1e-7f) continue;
      FlatSurface plane;
      plane.q = rays.inverse() * inverse;
      if (!plane.q.allFinite() || !(plane.q.norm() > 0)) continue;
      const int votes = votes_for(plane);
      if (votes <= most_votes) continue;
      most_votes = votes;
      best = plane;
      const double all_on_it = std::pow(static_cast<double>(votes) / static_cast<double>(voters), 3);
      if (all_on_it > 0.999) break;
      enough = std::min<int>(most_draws, static_cast<int>(std::log(1e-6) / std::log(1 - all_on_it)) + 1);
    }
    if (most_votes < smallest_share * static_cast<double>(voters)) return std::nullopt;

    const Places some = places_of(every_nth(6000 / fewer));
    const std::size_t count = some.z_mm.size();
    float squared = 0;
    double fourth_powers = 0;  // of the depths
    int on_it = 0;
    for (int round = 0; round < 3; ++round) {
      const float qx = best.q.x(), qy = best.q.y(), qz = best.q.z(), per_norm = 1 / best.q.norm();
      double xx = 0, xy = 0, yy = 0, x_sum = 0, y_sum = 0;   // of the rays' products
      double x_inverse = 0, y_inverse = 0, inverse_sum = 0;  // of the rays over their depths
      squared = 0;
      fourth_powers = 0;
      on_it = 0;
#pragma omp simd reduction(+ : xx, xy, yy, x_sum, y_sum, x_inverse, y_inverse, inverse_sum) \
    reduction(+ : squared, fourth_powers, on_it)
      for (std::size_t i = 0; i < count; ++i) {
        const float z_mm = some.z_mm[i];
        const float height = (1 - z_mm * (qx * some.ray_x[i] + qy * some.ray_y[i] + qz)) * per_norm;
        const float counts = std::abs(height) < threshold ? 1.0f : 0.0f;
        const double x = some.ray_x[i], y = some.ray_y[i], weight = counts, inverse = weight / z_mm;
        xx += weight * x * x, xy += weight * x * y, yy += weight * y * y;
        x_sum += weight * x, y_sum += weight * y;
        x_inverse += x * inverse, y_inverse += y * inverse, inverse_sum += inverse;
        squared += counts * height * height;
        fourth_powers += static_cast<double>(counts * (z_mm * z_mm)) * (z_mm * z_mm);
        on_it += std::abs(height) < threshold;
      }
      if (on_it < 3) break;
      Eigen::Matrix3d normal;
      normal << xx, xy, x_sum, xy, yy, y_sum, x_sum, y_sum, on_it;
      const Eigen::Vector3d q = normal.ldlt().solve(Eigen::Vector3d(x_inverse, y_inverse, inverse_sum));
      if (!q.allFinite() || !(q.norm() > 0)) break;
      best.q = q.cast<float>();
    }
    if (on_it < smallest_share * static_cast<double>(count)) return std::nullopt;
    best.rms_mm = std::sqrt(squared / static_cast<float>(std::max(on_it, 1)));
    const auto at_mm = static_cast<float>(std::pow(fourth_powers / std::max(on_it, 1), 0.25));
    if (!is_too_large(every_nth(2000 / fewer)))
      return CutPlane{best, std::clamp(3 * best.rms_mm, 1.5f, threshold), at_mm};
    bend(best, every_nth(2500 / fewer), threshold);
    // Cut by the noise that the plane shows, so that the feet of flat parts stay.
    return CutPlane{best, std::clamp(2.7f * best.rms_mm, 1.5f, threshold), at_mm};
  }

  /// Fits the bend to what lies on the plane, robustly: the slow waves of a camera, not the parts on the table.
  void bend(FlatSurface& plane, const Cells& cells, float threshold) const {
    constexpr int terms = FlatSurface::terms, lanes = Lanes::count;
    using Products = RowProducts<float, terms + 1>;
    using Row = std::array<Lanes, terms + 1>;  // eight cells' powers, and their heights
    auto [x, y, z_mm] = places_of(cells);
    std::vector<float> height(x.size());
    const float per_mm = 1 / plane.q.norm();
    std::size_t count = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const float h = (1 - z_mm[i] * (plane.q.x() * x[i] + plane.q.y() * y[i] + plane.q.z())) * per_mm;
      x[count] = x[i], y[count] = y[i], height[count] = h;
      count += std::abs(h) < 1.5f * threshold;
    }
    if (count < 20 * terms) return;
    std::vector<Row> rows((count + lanes - 1) / lanes);
    height.resize(rows.size() * lanes);
    std::fill(height.begin() + static_cast<std::ptrdiff_t>(count), height.end(), FrameWindow::not_table_mm);
    x.resize(height.size()), y.resize(height.size());
    for (std::size_t g = 0; g < rows.size(); ++g) {
      const float *ray_x = &x[g * lanes], *ray_y = &y[g * lanes];
      Lanes power_of_y;  // the powers x^i y^j of a FlatSurface's bend
      std::fill_n(power_of_y.value, lanes, 1.0f);
      for (int j = 0, k = 0; j <= FlatSurface::degree; ++j) {
        Lanes power = power_of_y;
        for (int i = 0; i + j <= FlatSurface::degree; ++i, ++k) {
          rows[g][k] = power;
          for (int lane = 0; lane < lanes; ++lane) power.value[lane] *= ray_x[lane];
        }
        for (int lane = 0; lane < lanes; ++lane) power_of_y.value[lane] *= ray_y[lane];
      }
      std::copy_n(&height[g * lanes], lanes, rows[g][terms].value);
    }
    float scale = threshold;
    Eigen::Matrix<float, terms, 1> solution = Eigen::Matrix<float, terms, 1>::Zero();
    for (int round = 0; round < 4; ++round) {
      Products products;
      Lanes squared{}, weights{};
      for (const Row& row : rows) {
        Lanes bent{}, weight;
        for (int k = 0; k < terms; ++k)
#pragma omp simd
          for (int i = 0; i < lanes; ++i) bent.value[i] += row[k].value[i] * solution[k];
#pragma omp simd
        for (int i = 0; i < lanes; ++i) {
          const float share = (row[terms].value[i] - bent.value[i]) / scale;
          const float inside = std::max(1 - share * share, 0.0f);
          weight.value[i] = inside * inside;
          squared.value[i] += weight.value[i] * share * share;
          weights.value[i] += weight.value[i];
        }
        products.add(row, weight);
      }
      const float weight_sum = weights.sum();
      if (!(weight_sum > 10 * terms)) return;
      if (round > 0) plane.rms_mm = scale * std::sqrt(squared.sum() / weight_sum);
      // A little stiffness where nothing of the plane is seen.
      const Eigen::Matrix<double, terms + 1, terms + 1> total = products.total().template cast<double>();
      Eigen::Matrix<double, terms, terms> normal = total.template topLeftCorner<terms, terms>();
      normal.diagonal().array() += 1e-5 * weight_sum;
      solution = normal.ldlt().solve(total.col(terms).template head<terms>()).template cast<float>();
      if (!solution.allFinite()) return;
      std::copy_n(solution.data(), terms, plane.bend_mm.begin());
      scale = std::clamp(4.7f * (round > 0 ? plane.rms_mm : 0.5f * threshold), 1.5f, threshold);
    }
    // Tukey's weights leave out the tails: of normal noise a seventh of the deviation.
    plane.rms_mm *= 1.15f;
  }

  /// Over the plane: of each of the cells in `height_mm_`.
  void find_heights(const CutPlane& cut, const Cells& cells) {
    for (std::size_t i = 0; i < cells.size();) {
      const int row = cells[i] / grid_.width, first = cells[i], next = (row + 1) * grid_.width;
      const auto from = cells.begin() + i, most = cells.begin() + std::min<std::size_t>(i + next - first, cells.size());
      const auto end = std::lower_bound(from, most, next);
      // All cells from the row's first to its last, side by side: mostly these are all.
      RowHeights(cut.plane, grid_.ray_y[row])(&grid_.ray_x[first - row * grid_.width], &grid_.z_mm[first],
                                              &height_mm_[first], end[-1] - first + 1);
      i += end - from;
    }
  }

  /// In the order of the cells.
  std::vector<float> heights_mm(const CutPlane& cut, const Cells& cells) {
    find_heights(cut, cells);
    std::vector<float> out(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) out[i] = height_mm_[cells[i]];
    return out;
  }

  /// Those of whose `height_mm_` it holds. Without branches: they would be taken at random.
  template <typename Holds>
  Cells selected(const Cells& cells, const Holds& holds) const {
    Cells out(cells.size());
    std::size_t count = 0;
    for (const int cell : cells) {
      out[count] = cell;
      count += holds(height_mm_[cell]);
    }
    out.resize(count);
    return out;
  }
  Cells farther(const Cells& cells, float limit_mm) const {
    return selected(cells, [=](float height_mm) { return std::abs(height_mm) > limit_mm; });
  }

  /// Objects on a table lie on the camera's side of its plane; where the dominant plane is a part's own face, the rest
  /// of the part lies behind it.
  bool stands_on_table(const Cells& cells) {
    int before = 0, behind = 0;
    for (const float height : heights_mm(*table, cells)) {
      before += height > table->cut_mm;
      behind += height < -table->cut_mm;
    }
    return before > 3 * behind;
  }

  /// The plane is the table, the wall or the floor. What is left falls into pieces; those too large to be a part have a
  /// plane of their own taken away.
  void remove_plane_and_split(const Cells& cells, const CutPlane& plane, int level) {
    find_heights(plane, cells);
    Cells remaining = farther(cells, plane.cut_mm);
    const std::size_t on_it = cells.size() - remaining.size();
    if (level == 0) keep_near(remaining, farther(remaining, stands_out_cuts * plane.cut_mm));
    // Taken away wherever it shows, also through a part's holes.
    split(remaining, plane, level);
    if (level == 0 && static_cast<double>(on_it) > 0.6 * static_cast<double>(cells.size())) return;
    // A lesser plane may hold a part's face by chance: once more, and only what is larger than a part is taken away.
    find_heights(plane, cells);
    const Cells on_plane = selected(cells, [&](float height_mm) { return !(std::abs(height_mm) > plane.cut_mm); });
    const std::size_t without_patches = remaining.size();
    for (const auto& patch : connected(on_plane))
      if (!is_too_large(patch)) remaining.insert(remaining.end(), patch.begin(), patch.end());
    if (remaining.size() == without_patches) return;
    std::sort(remaining.begin(), remaining.end());
    split(remaining, plane, level);
  }

  /// Only cells beside others that clearly stand out: what is left of the table's noise is not what hangs on a part.
  void keep_near(Cells& cells, const Cells& high) const {
    constexpr int reach = 3;
    const std::size_t size = grid_.z_mm.size(), width = grid_.width;
    // Along the rows, then across them; some of a row's end counts as the next one's, which does no harm.
    std::vector<std::uint8_t> is_high(size + 2 * reach, 0), along(size + 2 * reach * width, 0), near(size, 0);
    for (const int cell : high) is_high[cell + reach] = 1;
    for (std::size_t shift = 0; shift <= 2 * reach; ++shift)
      for (std::size_t i = 0; i < size; ++i) along[i + reach * width] |= is_high[i + shift];
    for (std::size_t shift = 0; shift <= 2 * reach; ++shift)
      for (std::size_t i = 0; i < size; ++i) near[i] |= along[i + shift * width];
    std::erase_if(cells, [&](int cell) { return !near[cell]; });
  }

  /// What lies in one plane nearly as a whole is another table, not parts that touch: of these one plane holds up to
  /// 86 % by chance, of a floor or a shelf it held 94 % and more.
  bool is_table(const Cells& cells, const CutPlane& plane) {
    constexpr double least_share = 0.9;
    const std::vector<float> height = heights_mm(plane, cells);
    const auto on_it =
        std::count_if(height.begin(), height.end(), [&](float h) { return std::abs(h) <= plane.cut_mm; });
    return static_cast<double>(on_it) > least_share * static_cast<double>(cells.size());
  }

  void split(const Cells& remaining, const CutPlane& plane, int level) {
    constexpr int most_levels = 3;
    for (auto& piece : connected(remaining)) {
      if (static_cast<int>(piece.size()) < min_cells_) continue;
      if (is_plausible(piece)) {
        if (stands_out(piece, plane, level)) add({std::move(piece), plane});
      } else if (is_too_large(piece) && level + 1 < most_levels) {
        const auto next = dominant_plane(piece, 3);
        if (level == 0 && is_heap(piece) && !(next && is_table(piece, *next))) {
          if (stands_out(piece, plane, level)) add({std::move(piece), plane, true});
        } else if (next) {
          remove_plane_and_split(piece, *next, level + 1);
        }
      }
    }
  }

  void add(Piece piece) {
    const bool known =
        std::any_of(pieces.begin(), pieces.end(), [&](const Piece& other) { return other.cells == piece.cells; });
    if (!known) pieces.push_back(std::move(piece));
  }

  /// Not just a wave of the plane that was taken away beside it, and not what is seen beyond a table's edge.
  bool stands_out(const Cells& cells, const CutPlane& plane, int level) {
    std::vector<float> height = heights_mm(plane, cells);
    const auto middle = height.begin() + static_cast<std::ptrdiff_t>(height.size() / 2);
    std::nth_element(height.begin(), middle, height.end());
    if (level == 0 && *middle < 0 && !whole_frame) return false;
    for (float& h : height) h = std::abs(h);
    const auto high = height.begin() + static_cast<std::ptrdiff_t>(height.size() * 9 / 10);
    std::nth_element(height.begin(), high, height.end());
    // By the square law of triangulation: what is left of a table far behind is higher, but no part.
    const float farther = std::max(grid_.z_mm[cells[cells.size() / 2]] / plane.at_mm, 1.0f);
    return *high > stands_out_cuts * plane.cut_mm * farther * farther;
  }

  /// Groups of neighbouring cells that are near in space; holes of one cell are bridged. Each cell takes the number of
  /// the first earlier neighbour that it hangs together with; numbers that meet are joined (Rosenfeld and Pfaltz 1966).
  std::vector<Cells> connected(const Cells& cells) {
    UnionFind numbers;
    const int width = grid_.width;
    int v = 0;
    for (const int cell : cells) {
      while (cell >= (v + 1) * width) ++v;
      const int u = cell - v * width;
      const float z = grid_.z_mm[cell];
      int own = -1;
      const auto look_at = [&](int other, int apart) {
        const int number = number_[other];
        if (number < 0 || number == own) return;
        const float other_z = grid_.z_mm[other];
        const float limit = 2 + (grid_.jump_mm(other_z) - 2) * static_cast<float>(apart);
        if (!(std::abs(z - other_z) <= limit)) return;
        if (own < 0)
          own = number;
        else
          numbers.join(own, number);
      };
      if (u >= 1) look_at(cell - 1, 1);
      if (v >= 1) {
        look_at(cell - width, 1);
        if (u >= 1) look_at(cell - width - 1, 1);
        if (u + 1 < width) look_at(cell - width + 1, 1);
      }
      if (u >= 2 && !(grid_.z_mm[cell - 1] > 0)) look_at(cell - 2, 2);
      if (v >= 2 && !(grid_.z_mm[cell - width] > 0)) look_at(cell - 2 * width, 2);
      number_[cell] = own < 0 ? numbers.add() : own;
    }
    // A group's number is that of its first cell.
    std::vector<int> group_of(numbers.size(), -1);
    std::vector<Cells> out;
    for (const int cell : cells) {
      int& group = group_of[numbers.find(number_[cell])];
      if (group < 0) {
        group = static_cast<int>(out.size());
        out.emplace_back();
      }
      out[group].push_back(cell);
    }
    for (const int cell : cells) number_[cell] = -1;
    return out;
  }

  const Grid& grid_;
  const Intrinsics& camera_;
  const FramePiecesOptions& options_;
  int min_cells_ = 8;
  std::vector<float> height_mm_;  ///< over a plane: of the cells in question
  std::vector<int> number_;       ///< for connected(): of the cells in question, else -1
};

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
  PixelLabels(FramePieces& frame, const Grid& grid, const Splitter& splitter)
      : frame_(frame), grid_(grid), splitter_(splitter), cell_label_(grid.z_mm.size(), 0) {
    for (std::size_t k = 0; k < splitter.pieces.size(); ++k)
      for (const int cell : splitter.pieces[k].cells)
        cell_label_[cell] = static_cast<std::uint8_t>(FramePieces::first_piece + k);
    for (std::size_t k = 0; k < splitter.pieces.size(); ++k) label_piece(k);
  }

 private:
  void label_piece(std::size_t k) {
    const auto& piece = splitter_.pieces[k];
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
  const Grid& grid_;
  const Splitter& splitter_;
  std::vector<std::uint8_t> cell_label_;
};

/// Pairs of pieces that nearly touch in the image and are together no larger than a part, and larger groups of such.
void add_groups(FramePieces& frame, const Splitter& splitter, const Grid& grid, const FramePiecesOptions& options) {
  constexpr int near_px = 8;
  const int reach = std::max(1, near_px / grid.stride);
  const std::size_t count = frame.objects.size();
  std::vector<Eigen::AlignedBox3f> box(count);
  std::vector<std::vector<std::uint8_t>> covered(count);  // in blocks of `reach` cells
  const int columns = grid.width / reach + 1, rows = grid.height / reach + 1;
  for (std::size_t k = 0; k < count; ++k) {
    covered[k].assign(static_cast<std::size_t>(columns) * rows, 0);
    const auto piece = static_cast<std::size_t>(frame.objects[k].labels._Find_first()) - FramePieces::first_piece;
    for (const int cell : splitter.pieces[piece].cells) {
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

  const Grid grid(depth, camera);
  const Splitter splitter(grid, camera, options);
  if (splitter.table) frame.table = splitter.table->plane;
  const PixelLabels labels(frame, grid, splitter);
  if (frame.objects.size() > 1) add_groups(frame, splitter, grid, options);
  if (splitter.whole_frame) {
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

/// Over windows that reach so many pixels to each side.
double local_noise_mm(const FramePieces& frame, const FrameObject& object, int reach) {
  constexpr int most_windows = 150;
  const int side = 2 * reach + 1, pixels = side * side;
  // On a regular grid the best plane's slopes are the moments over fixed sums: each row's of k * k from -reach to
  // reach.
  const auto moment = static_cast<float>(side * reach * (reach + 1) * (2 * reach + 1) / 3);
  const DepthImage& depth = *frame.depth;
  const double box_px = static_cast<double>(object.u1 - object.u0 + 1) * (object.v1 - object.v0 + 1);
  const int step = std::max(1, static_cast<int>(std::sqrt(box_px / most_windows)));
  std::vector<float> deviation;
  for (int v = std::max(object.v0, reach); v <= std::min(object.v1, depth.height - 1 - reach); v += step)
    for (int u = std::max(object.u0, reach); u <= std::min(object.u1, depth.width - 1 - reach); u += step) {
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
      if (!full) continue;
      const float left =
          squared - sum * sum / static_cast<float>(pixels) - (along_u * along_u + along_v * along_v) / moment;
      deviation.push_back(std::sqrt(std::max(left, 0.0f) / static_cast<float>(pixels - 3)));
    }
  if (deviation.empty()) return 0;
  const auto middle = deviation.begin() + static_cast<std::ptrdiff_t>(deviation.size() / 2);
  std::nth_element(deviation.begin(), middle, deviation.end());
  return *middle;
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
  constexpr int reach = 3, side = 2 * reach + 1, most_windows = 150;
  constexpr float least_noise_mm = 0.01f;
  const DepthImage& depth = *frame.depth;
  const double box_px = static_cast<double>(object.u1 - object.u0 + 1) * (object.v1 - object.v0 + 1);
  const int step = std::max(1, static_cast<int>(std::sqrt(box_px / most_windows)));
  std::vector<float> correlation;
  for (int v = std::max(object.v0, reach); v <= std::min(object.v1, depth.height - 1 - reach); v += step)
    for (int u = std::max(object.u0, reach); u <= std::min(object.u1, depth.width - 1 - reach); u += step) {
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
      if (!full) continue;
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
    }
  if (correlation.size() < 3) return std::nullopt;
  const auto middle = correlation.begin() + static_cast<std::ptrdiff_t>(correlation.size() / 2);
  std::nth_element(correlation.begin(), middle, correlation.end());
  return *middle;
}

}  // namespace partpose
