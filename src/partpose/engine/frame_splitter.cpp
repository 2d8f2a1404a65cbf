// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/frame_splitter.hpp"

#include "partpose/core/random.hpp"
#include "partpose/core/union_find.hpp"
#include "partpose/registration/row_products.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace partpose {

namespace {

constexpr float most_parts_long = 5;  ///< a piece of parts that touch
/// What is so many times as high as the cut stands out for certain.
constexpr float stands_out_cuts = 1.7f;

constexpr int wanted_cells = 80'000;

using Lanes = NumberLanes<float>;
/// Splits a frame's cells into what may be single objects.
class Splitter {
 public:
  Splitter(const CellGrid& grid, const Intrinsics& camera, const FramePiecesOptions& options)
      : grid_(grid), camera_(camera), options_(options), height_mm_(grid.z_mm.size()), number_(grid.z_mm.size(), -1) {
    Cells measured(grid.z_mm.size());
    std::size_t count = 0;
    for (int i = 0; i < static_cast<int>(grid.z_mm.size()); ++i) {
      measured[count] = i;
      count += grid.z_mm[i] > 0;
    }
    measured.resize(count);
    min_cells_ = std::max(8, options.min_pixels / (grid.stride * grid.stride));
    auto& [pieces, whole_frame, table] = result;
    table = dominant_plane(measured, 1);
    if (is_plausible(measured)) {
      whole_frame = true;
      if (!table || !stands_on_table(measured)) return;
    }
    if (table) remove_plane_and_split(measured, *table, 0);
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const auto& a, const auto& b) { return a.cells.size() > b.cells.size(); });
    if (static_cast<int>(pieces.size()) > options.most_pieces) pieces.resize(options.most_pieces);
  }

  FrameSplit result;

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
    for (const float height : heights_mm(*result.table, cells)) {
      before += height > result.table->cut_mm;
      behind += height < -result.table->cut_mm;
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

  void add(FrameSplit::Piece piece) {
    auto& pieces = result.pieces;
    const bool known =
        std::any_of(pieces.begin(), pieces.end(), [&](const auto& other) { return other.cells == piece.cells; });
    if (!known) pieces.push_back(std::move(piece));
  }

  /// Not just a wave of the plane that was taken away beside it, and not what is seen beyond a table's edge.
  bool stands_out(const Cells& cells, const CutPlane& plane, int level) {
    std::vector<float> height = heights_mm(plane, cells);
    const auto middle = height.begin() + static_cast<std::ptrdiff_t>(height.size() / 2);
    std::nth_element(height.begin(), middle, height.end());
    if (level == 0 && *middle < 0 && !result.whole_frame) return false;
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

  const CellGrid& grid_;
  const Intrinsics& camera_;
  const FramePiecesOptions& options_;
  int min_cells_ = 8;
  std::vector<float> height_mm_;  ///< over a plane: of the cells in question
  std::vector<int> number_;       ///< for connected(): of the cells in question, else -1
};

}  // namespace

CellGrid::CellGrid(const DepthImage& depth, const Intrinsics& camera)
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

FrameSplit split_cells(const CellGrid& grid, const Intrinsics& camera, const FramePiecesOptions& options) {
  return Splitter(grid, camera, options).result;
}

}  // namespace partpose
