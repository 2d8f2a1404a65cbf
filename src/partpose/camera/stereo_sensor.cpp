// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/stereo_sensor.hpp"

#include "partpose/camera/matched_window.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/random.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace partpose {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

void check_range(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high)) throw Error("{} {}: must be {} to {}", name, value, low, high);
}

// One independent stream of random numbers for each purpose.
enum Stream : std::uint64_t { temporal_stream = 1, frozen_stream, white_stream, edge_stream, pattern_stream };

std::uint64_t stream_seed(std::uint64_t seed, Stream stream) { return Random(seed, stream).next(); }

/// Weights of a Gaussian blur of standard deviation correlation / 2, which gives white noise the autocorrelation
/// exp(-r^2 / correlation^2), scaled so that it keeps its variance.
std::vector<float> blur_weights(double correlation_px) {
  const double sigma = 0.5 * correlation_px;
  const int reach = static_cast<int>(std::ceil(3.5 * sigma));
  std::vector<float> weights;
  double squares = 0;
  for (int i = -reach; i <= reach; ++i) {
    const double weight = reach == 0 ? 1 : std::exp(-0.5 * i * i / (sigma * sigma));
    weights.push_back(static_cast<float>(weight));
    squares += weight * weight;
  }
  for (float& weight : weights) weight /= static_cast<float>(std::sqrt(squares));
  return weights;
}

/// Two independent images of standard normal noise with the autocorrelation exp(-r^2 / correlation^2).
std::array<std::vector<float>, 2> correlated_noise(int width, int height, double correlation_px, std::uint64_t seed) {
  const std::vector<float> weights = blur_weights(correlation_px);
  const int taps = static_cast<int>(weights.size()), reach = taps / 2;
  const int padded_width = width + 2 * reach, padded_height = height + 2 * reach;
  std::array<std::vector<float>, 2> rows, out;
  for (int k = 0; k < 2; ++k) {
    rows[k].resize(static_cast<std::size_t>(width) * padded_height);
    out[k].resize(static_cast<std::size_t>(width) * height);
  }
  const auto add_scaled = [width](float* to, const float* from, float weight) {
#pragma omp simd
    for (int u = 0; u < width; ++u) to[u] += weight * from[u];
  };
  parallel_ranges(
      padded_height,
      [&](std::size_t begin, std::size_t end) {
        std::array<std::vector<float>, 2> white{std::vector<float>(padded_width), std::vector<float>(padded_width)};
        for (std::size_t v = begin; v < end; ++v) {
          Random random(seed, v);
          for (int u = 0; u < padded_width; ++u) {
            const auto [a, b] = random.normal_pair();
            white[0][u] = static_cast<float>(a);
            white[1][u] = static_cast<float>(b);
          }
          for (int k = 0; k < 2; ++k)
            for (int i = 0; i < taps; ++i) add_scaled(&rows[k][v * width], &white[k][i], weights[i]);
        }
      },
      8);
  parallel_for(
      height,
      [&](std::size_t v) {
        for (int k = 0; k < 2; ++k)
          for (int i = 0; i < taps; ++i) add_scaled(&out[k][v * width], &rows[k][(v + i) * width], weights[i]);
      },
      8);
  return out;
}

/// The disparities that the two imagers' geometry alone gives, and whether both see the surface.
class Matching {
 public:
  Matching(const DepthImage& left, const DepthImage& right, const Intrinsics& camera,
           const StereoSensorOptions& options)
      : width_(left.width), height_(left.height), options_(options) {
    const auto focal_baseline = static_cast<float>(camera.fx * options.baseline_mm);
    disparity_.resize(left.z_mm.size());
    seen_.resize(left.z_mm.size());
    source_.resize(left.z_mm.size());
    parallel_for(
        height_,
        [&](std::size_t v) {
          for (int u = 0; u < width_; ++u) {
            const std::size_t p = v * width_ + u;
            const float z = left.z_mm[p];
            disparity_[p] = z > 0 ? focal_baseline / z : 0.0f;
            source_[p] = static_cast<int>(p);
            seen_[p] = z > 0 && !(options.occlusion_shadow && !right.z_mm.empty() &&
                                  hidden(disparity_[p], u, &right.z_mm[v * width_], focal_baseline));
          }
        },
        16);
  }

  const std::vector<float>& disparity() const { return disparity_; }
  const std::vector<int>& source() const { return source_; }
  /// Whether the surface measured at `p` is one that both imagers see there.
  bool matched(std::size_t p) const {
    const float d = disparity_[p];
    return seen_[source_[p]] && d > 0 && d <= options_.max_disparity_px &&
           !(options_.invalid_band && static_cast<float>(p % width_) < d);
  }

  /// The window's mean over pairs of pixels that lie opposite each other on one surface: a plane stays as it is.
  void average_surfaces() {
    std::vector<float> rows(disparity_.size());
    parallel_for(
        height_,
        [&](std::size_t v) {
          for (int u = 0; u < width_; ++u)
            rows[v * width_ + u] = pair_mean(&disparity_[v * width_ + u], 1, std::min(u, width_ - 1 - u));
        },
        16);
    parallel_for(
        height_,
        [&](std::size_t v) {
          const int room = std::min(static_cast<int>(v), height_ - 1 - static_cast<int>(v));
          for (int u = 0; u < width_; ++u) disparity_[v * width_ + u] = pair_mean(&rows[v * width_ + u], width_, room);
        },
        16);
  }

  /// A window that holds some foreground matches at the foreground's disparity: it grows over the background by
  /// `fattening_px`, more or less by `unevenness` (standard normal), first along rows, then along columns.
  void fatten(const std::vector<float>& unevenness) {
    const auto reach_of = [&](std::size_t p) {
      return static_cast<int>(std::lround(options_.fattening_px + options_.fattening_jitter_px * unevenness[p]));
    };
    std::vector<float> before = disparity_;
    std::vector<int> source_before = source_;
    parallel_for(
        height_,
        [&](std::size_t v) {
          std::vector<int> steps(width_, far_away);
          for (int u = 0; u + 1 < width_; ++u)
            grow_pair(v * width_ + u, 1, u, width_, &steps[0], 1, u, before, source_before, reach_of);
        },
        16);
    before = disparity_;
    source_before = source_;
    parallel_ranges(
        width_,
        [&](std::size_t begin, std::size_t end) {
          const std::size_t columns = end - begin;
          std::vector<int> steps(columns * height_, far_away);
          for (int v = 0; v + 1 < height_; ++v)
            for (std::size_t u = begin; u < end; ++u)
              grow_pair(static_cast<std::size_t>(v) * width_ + u, width_, v, height_, &steps[u - begin],
                        static_cast<std::ptrdiff_t>(columns), v, before, source_before, reach_of);
        },
        64);
  }

  /// Whether a neighbour across an edge, and which (the one with the largest jump); -1: none.
  std::ptrdiff_t across_edge(std::size_t p) const {
    const int u = static_cast<int>(p % width_), v = static_cast<int>(p / width_);
    std::ptrdiff_t found = -1;
    float largest = static_cast<float>(options_.edge_jump_px);
    const auto look = [&](bool inside, std::ptrdiff_t offset) {
      if (!inside) return;
      const float jump = std::abs(disparity_[p + offset] - disparity_[p]);
      if (jump > largest) {
        largest = jump;
        found = static_cast<std::ptrdiff_t>(p) + offset;
      }
    };
    look(u > 0, -1);
    look(u + 1 < width_, 1);
    look(v > 0, -width_);
    look(v + 1 < height_, width_);
    return found;
  }

  /// 1 for the pixels of the background up to `edge_loss_px` from an edge, along the row or the column.
  std::vector<std::uint8_t> background_beside_edges() const {
    std::vector<std::uint8_t> beside(disparity_.size(), 0);
    const auto mark_pair = [&](std::size_t p, std::ptrdiff_t stride, int index, int count) {
      const float jump = disparity_[p] - disparity_[p + stride];
      if (std::abs(jump) <= static_cast<float>(options_.edge_jump_px)) return;
      const bool forwards = jump > 0;
      const int room = std::min(forwards ? count - 1 - index : index + 1, options_.edge_loss_px);
      for (int k = 1; k <= room; ++k) beside[forwards ? p + k * stride : p + (1 - k) * stride] = 1;
    };
    parallel_for(
        height_,
        [&](std::size_t v) {
          for (int u = 0; u + 1 < width_; ++u) mark_pair(v * width_ + u, 1, u, width_);
        },
        16);
    parallel_ranges(
        width_,
        [&](std::size_t begin, std::size_t end) {
          for (int v = 0; v + 1 < height_; ++v)
            for (std::size_t u = begin; u < end; ++u)
              mark_pair(static_cast<std::size_t>(v) * width_ + u, width_, v, height_);
        },
        64);
    return beside;
  }

  /// Angle between the line of sight and the surface normal [rad], from the slope of the inverse depth, in which a
  /// plane is affine; the gentler of the two sides, so that an edge is no slope.
  double incidence(std::size_t p, const Intrinsics& camera) const {
    const int u = static_cast<int>(p % width_), v = static_cast<int>(p / width_);
    const double slope_u = gentler_slope(p, 1, u, width_) * camera.fx;
    const double slope_v = gentler_slope(p, width_, v, height_) * camera.fy;
    const double x = (u - camera.cx) / camera.fx, y = (v - camera.cy) / camera.fy;
    const Eigen::Vector3d normal(slope_u, slope_v, disparity_[p] - slope_u * x - slope_v * y), ray(x, y, 1);
    return std::atan2(normal.cross(ray).norm(), std::abs(normal.dot(ray)));
  }

 private:
  static constexpr int far_away = 1 << 20;

  /// Whether something nearer stands before the right imager where a surface of this disparity should be.
  bool hidden(float disparity, int u, const float* right_row_z_mm, float focal_baseline) const {
    constexpr float slack_px = 0.25f;
    const float x = static_cast<float>(u) - disparity;
    if (x < 0) return false;
    const int i = static_cast<int>(x), j = std::min(i + 1, width_ - 1);
    const auto in_front = [&](float z) { return z > 0 && focal_baseline / z > disparity + slack_px; };
    return in_front(right_row_z_mm[i]) && in_front(right_row_z_mm[j]);
  }

  float pair_mean(const float* centre, std::ptrdiff_t stride, int room) const {
    return matched_mean(centre, stride, room, options_.smoothing_px, static_cast<float>(options_.edge_jump_px));
  }

  /// Grows the nearer of pixels p and p + stride over the other's side, when they are an edge.
  template <typename ReachOf>
  void grow_pair(std::size_t p, std::ptrdiff_t stride, int index, int count, int* steps, std::ptrdiff_t steps_stride,
                 int steps_index, const std::vector<float>& before, const std::vector<int>& source_before,
                 const ReachOf& reach_of) {
    const auto jump = static_cast<float>(options_.edge_jump_px);
    const float here = before[p], next = before[p + stride];
    if (std::abs(here - next) <= jump) return;
    const int direction = here > next ? 1 : -1;
    const std::size_t front = here > next ? p : p + stride;
    const int front_index = here > next ? index : index + 1;
    const int start = steps_index + front_index - index;
    for (int k = 1; k <= longest_reach_px; ++k) {
      const int i = front_index + k * direction;
      if (i < 0 || i >= count) break;
      const std::size_t q = front + static_cast<std::ptrdiff_t>(k * direction) * stride;
      if (!(before[front] > before[q] + jump)) break;
      int& steps_to_q = steps[static_cast<std::ptrdiff_t>(start + k * direction) * steps_stride];
      if (k > reach_of(q) || k > steps_to_q || (k == steps_to_q && disparity_[q] >= before[front])) continue;
      steps_to_q = k;
      disparity_[q] = before[front];
      source_[q] = source_before[front];
    }
  }

  double gentler_slope(std::size_t p, std::ptrdiff_t stride, int index, int count) const {
    const float d = disparity_[p];
    double best = 1e300;
    const auto look = [&](bool inside, std::ptrdiff_t offset, double sign) {
      if (!inside || !(disparity_[p + offset] > 0)) return;
      const double slope = sign * (disparity_[p + offset] - d);
      if (std::abs(slope) < std::abs(best)) best = slope;
    };
    look(index > 0, -stride, -1);
    look(index + 1 < count, stride, 1);
    return best == 1e300 ? 0 : best;
  }

  static constexpr int longest_reach_px = 32;

  int width_, height_;
  const StereoSensorOptions& options_;
  std::vector<float> disparity_;
  std::vector<std::uint8_t> seen_;
  std::vector<int> source_;
};

double to_step(double value, double step) { return step > 0 ? step * std::round(value / step) : value; }

double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

}  // namespace

void StereoSensorOptions::check() const {
  if (!(baseline_mm > 0) || !std::isfinite(baseline_mm)) throw Error("baseline_mm {}: must be positive", baseline_mm);
  check_range("disparity_noise_px", disparity_noise_px, 0, 10);
  check_range("correlation_px", correlation_px, 0, 64);
  check_range("white_share", white_share, 0, 1);
  check_range("frozen_share", frozen_share, 0, 1);
  check_range("subpixel_wave_px", subpixel_wave_px, 0, 0.5);
  check_range("static_pattern_percent", static_pattern_percent, 0, 20);
  check_range("smoothing_px", smoothing_px, 0, 16);
  check_range("fattening_px", fattening_px, 0, 16);
  check_range("fattening_jitter_px", fattening_jitter_px, 0, 4);
  if (!(edge_jump_px > 0) || !std::isfinite(edge_jump_px))
    throw Error("edge_jump_px {}: must be positive", edge_jump_px);
  check_range("mixed_pixel_probability", mixed_pixel_probability, 0, 1);
  check_range("edge_loss_px", edge_loss_px, 0, 16);
  check_range("edge_loss_probability", edge_loss_probability, 0, 1);
  check_range("hole_share", hole_share, 0, 1);
  for (const double angle : grazing_drop_deg) check_range("grazing_drop_deg", angle, 0, 90);
  if (grazing_drop_deg[0] > grazing_drop_deg[1])
    throw Error("grazing_drop_deg [{}, {}]: the first must not be the larger", grazing_drop_deg[0],
                grazing_drop_deg[1]);
  if (!(max_disparity_px > 0) || !std::isfinite(max_disparity_px))
    throw Error("max_disparity_px {}: must be positive", max_disparity_px);
  check_range("disparity_step_px", disparity_step_px, 0, 1);
  check_range("depth_step_mm", depth_step_mm, 0, 100);
}

Eigen::Isometry3d right_from_left(const StereoSensorOptions& options) {
  return Eigen::Isometry3d(Eigen::Translation3d(-options.baseline_mm, 0, 0));
}

double predicted_depth_noise_mm(const StereoSensorOptions& options, const Intrinsics& camera, double z_mm) {
  const double mm_per_px = z_mm * z_mm / (camera.fx * options.baseline_mm);
  const auto squared = [](double x) { return x * x; };
  const double disparity_variance = squared(options.disparity_noise_px) + squared(options.subpixel_wave_px) / 2 +
                                    squared(options.disparity_step_px) / 12;
  return std::sqrt(squared(mm_per_px) * disparity_variance + squared(options.depth_step_mm) / 12);
}

std::vector<float> static_pattern(int width, int height, const StereoSensorOptions& options) {
  constexpr int node_spacing_px = 8;
  const std::size_t pixels = static_cast<std::size_t>(width) * height;
  if (!(options.static_pattern_percent > 0)) return std::vector<float>(pixels, 0.0f);

  // Rings about a place near the middle, and a few slow waves; lengths in half diagonals of the image.
  Random random(options.pattern_seed, pattern_stream);
  const auto between = [&random](double low, double high) { return low + (high - low) * random.uniform(); };
  struct Ring {
    double amplitude, cycles, phase;
  };
  struct Wave {
    double amplitude, along_x, along_y, phase;
  };
  const double centre_x = between(-0.15, 0.15), centre_y = between(-0.15, 0.15);
  std::array<Ring, 2> rings;
  for (auto& ring : rings) ring = {between(0.5, 1), between(0.7, 1.5), between(0, two_pi)};
  std::array<Wave, 3> waves;
  for (auto& wave : waves) wave = {between(0.1, 0.4), between(-0.6, 0.6), between(-0.6, 0.6), between(0, two_pi)};

  const int columns = std::max(2, (width - 1) / node_spacing_px + 1),
            rows = std::max(2, (height - 1) / node_spacing_px + 1);
  const double half_diagonal = 0.5 * std::hypot(width, height);
  const auto x_of = [&](int c) { return (static_cast<double>(c) / (columns - 1) - 0.5) * (width - 1) / half_diagonal; };
  const auto y_of = [&](int r) { return (static_cast<double>(r) / (rows - 1) - 0.5) * (height - 1) / half_diagonal; };
  Eigen::VectorXd node(columns * rows);
  Eigen::MatrixXd affine(columns * rows, 3);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const double x = x_of(c), y = y_of(r), radius = std::hypot(x - centre_x, y - centre_y);
      double value = 0;
      for (const auto& ring : rings) value += ring.amplitude * std::cos(two_pi * ring.cycles * radius + ring.phase);
      for (const auto& wave : waves)
        value += wave.amplitude * std::cos(two_pi * (wave.along_x * x + wave.along_y * y) + wave.phase);
      node[r * columns + c] = value;
      affine.row(r * columns + c) << 1, x, y;
    }
  }
  // What a calibration would see as another baseline or a turned imager is no part of it.
  if (width > 1 && height > 1) node -= affine * (affine.transpose() * affine).ldlt().solve(affine.transpose() * node);
  const double spread = node.maxCoeff() - node.minCoeff();
  node *= spread > 0 ? options.static_pattern_percent / 100 / spread : 0.0;

  std::vector<float> pattern(pixels);
  for (int v = 0; v < height; ++v) {
    const double y = height > 1 ? static_cast<double>(v) * (rows - 1) / (height - 1) : 0;
    const int r = std::min(static_cast<int>(y), rows - 2);
    for (int u = 0; u < width; ++u) {
      const double x = width > 1 ? static_cast<double>(u) * (columns - 1) / (width - 1) : 0;
      const int c = std::min(static_cast<int>(x), columns - 2);
      const double* corner = &node[r * columns + c];
      const double above = corner[0] + (x - c) * (corner[1] - corner[0]);
      const double below = corner[columns] + (x - c) * (corner[columns + 1] - corner[columns]);
      pattern[static_cast<std::size_t>(v) * width + u] = static_cast<float>(above + (y - r) * (below - above));
    }
  }
  return pattern;
}

StereoCapture stereo_capture(const DepthImage& left, const DepthImage& right, const Intrinsics& camera,
                             const StereoSensorOptions& options, std::uint64_t seed) {
  options.check();
  camera.check();
  const auto has_camera_size = [&](const DepthImage& image) {
    return image.width == camera.width && image.height == camera.height &&
           image.z_mm.size() == static_cast<std::size_t>(camera.width) * camera.height;
  };
  if (!has_camera_size(left) || !(right.z_mm.empty() || has_camera_size(right)))
    throw Error("stereo sensor: the images are {} x {} and {} x {} px, the camera {} x {} px: must be the same",
                left.width, left.height, right.width, right.height, camera.width, camera.height);
  for (const auto* image : {&left, &right})
    for (const float z : image->z_mm)
      if (!(z >= 0) || !std::isfinite(z))
        throw Error("stereo sensor: a depth of {} mm: must be 0 (nothing) or more", z);

  const auto temporal =
      correlated_noise(camera.width, camera.height, options.correlation_px, stream_seed(seed, temporal_stream));
  const std::vector<float>& noise = temporal[0];
  const std::vector<float>& texture = temporal[1];  // how well the surface can be matched: evenness of edges, holes
  std::vector<float> frozen;
  if (options.frozen_share > 0)
    frozen = correlated_noise(camera.width, camera.height, options.correlation_px,
                              stream_seed(options.pattern_seed, frozen_stream))[0];
  const std::vector<float> pattern = static_pattern(camera.width, camera.height, options);

  const Matching ideal(left, right, camera, options);
  Matching matching = ideal;
  matching.average_surfaces();
  matching.fatten(texture);

  const std::vector<std::uint8_t> beside_edge = matching.background_beside_edges();

  const double correlated_px = options.disparity_noise_px * std::sqrt(1 - options.white_share);
  const double frozen_px = correlated_px * std::sqrt(options.frozen_share);
  const double temporal_px = correlated_px * std::sqrt(1 - options.frozen_share);
  const double white_px = options.disparity_noise_px * std::sqrt(options.white_share);
  const double focal_baseline = camera.fx * options.baseline_mm;
  const double drop_from = radians(options.grazing_drop_deg[0]), drop_all = radians(options.grazing_drop_deg[1]);

  StereoCapture out{DepthImage(camera.width, camera.height), std::vector<int>(left.z_mm.size(), -1)};
  parallel_for(
      camera.height,
      [&](std::size_t v) {
        Random white(stream_seed(seed, white_stream), v);
        std::pair<double, double> pair;
        for (int u = 0; u < camera.width; ++u) {
          if (u % 2 == 0 && white_px > 0) pair = white.normal_pair();
          const std::size_t p = v * camera.width + u;
          if (!matching.matched(p)) continue;

          double kept = 1 - options.hole_share;
          const double incidence = ideal.incidence(matching.source()[p], camera);
          if (incidence >= drop_all) continue;
          if (incidence > drop_from) kept *= (drop_all - incidence) / (drop_all - drop_from);

          double d = matching.disparity()[p];
          if (beside_edge[p]) kept *= 1 - options.edge_loss_probability;
          if (const auto other = matching.across_edge(p); other >= 0) {
            Random at_edge(stream_seed(seed, edge_stream), p);
            const bool mixed = at_edge.uniform() < options.mixed_pixel_probability;
            if (mixed && matching.matched(other)) d += at_edge.uniform() * (matching.disparity()[other] - d);
          }
          if (kept < 1 && normal_distribution(texture[p]) >= kept) continue;

          d /= 1 + pattern[p];
          d += options.subpixel_wave_px * std::sin(two_pi * d);
          d += temporal_px * noise[p] + white_px * (u % 2 == 0 ? pair.first : pair.second);
          if (!frozen.empty()) d += frozen_px * frozen[p];
          d = to_step(d, options.disparity_step_px);
          if (!(d > 0)) continue;
          const auto z = static_cast<float>(to_step(focal_baseline / d, options.depth_step_mm));
          if (!(z > 0) || !std::isfinite(z)) continue;
          out.depth.z_mm[p] = z;
          out.surface_pixel[p] = matching.source()[p];
        }
      },
      8);
  return out;
}

StereoCapture stereo_capture(const DepthRenderer& render, const Intrinsics& camera, const StereoSensorOptions& options,
                             std::uint64_t seed) {
  options.check();
  return stereo_capture(render(Eigen::Isometry3d::Identity()),
                        options.occlusion_shadow ? render(right_from_left(options)) : DepthImage{}, camera, options,
                        seed);
}

}  // namespace partpose
