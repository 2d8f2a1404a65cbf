// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/sensor_fit.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/plane.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <set>

namespace partpose {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;
constexpr int fewest_pixels = 2000;

double squared(double x) { return x * x; }

struct Region {
  int left, top, width, height;
};

Region region_of(const std::array<int, 4>& px, const Intrinsics& camera) {
  if (px == std::array<int, 4>{}) return {0, 0, camera.width, camera.height};
  const Region region{px[0], px[1], px[2], px[3]};
  if (region.left < 0 || region.top < 0 || region.width < 1 || region.height < 1 ||
      region.width > camera.width - region.left || region.height > camera.height - region.top)
    throw Error("sensor fit: region {} {} {} {} (left, top, width, height): must lie within the image of {} x {} px",
                px[0], px[1], px[2], px[3], camera.width, camera.height);
  return region;
}

/// Disparities of the region's pixels, row by row, 0: not measured or not on the wall.
struct Wall {
  int width = 0, height = 0;
  std::vector<float> disparity;
  int pixels = 0;
};

/// The plane fit RMS and the sub-pixel RMS of RealSense's depth quality tool (librealsense, tools/depth-quality).
void measure_like_realsense(const PointCloud& cloud, double focal_baseline, StereoSensorFit& fit) {
  const auto plane = fit_plane(cloud, {.distance_threshold_mm = 1e9f, .max_hypotheses = 20})->plane;
  std::vector<Eigen::Vector3f> points = cloud.points;
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.z() < b.z(); });
  const std::size_t dropped = points.size() / 200;
  double distances = 0, disparities = 0;
  for (std::size_t i = dropped; i < points.size() - dropped; ++i) {
    const Eigen::Vector3d point = points[i].cast<double>();
    const double distance = plane.signed_distance_mm(points[i]);
    distances += squared(distance);
    disparities += squared(focal_baseline / point.norm() - focal_baseline / (point - distance * plane.normal).norm());
  }
  const auto count = static_cast<double>(points.size() - 2 * dropped);
  fit.plane_rms_mm = std::sqrt(distances / count);
  fit.subpixel_rms_px = std::sqrt(disparities / count);
}

/// A slow surface over the region: a plane and the products of cosines of at most `order` half periods together.
class SmoothBasis {
 public:
  SmoothBasis(int width, int height, int order) : size_(3) {
    for (int u = 0; u < width; ++u) along_u_.push_back(cosines(u, width, order));
    for (int v = 0; v < height; ++v) along_v_.push_back(cosines(v, height, order));
    for (int i = 0; i <= order; ++i)
      for (int j = 0; i + j <= order; ++j)
        if (i + j > 1) modes_.push_back({i, j});
    size_ += static_cast<int>(modes_.size());
  }
  int size() const { return size_; }
  template <typename Row>
  void fill(int u, int v, Row&& row) const {
    row[0] = 1;
    row[1] = 2.0 * (u + 0.5) / static_cast<double>(along_u_.size()) - 1;
    row[2] = 2.0 * (v + 0.5) / static_cast<double>(along_v_.size()) - 1;
    for (std::size_t m = 0; m < modes_.size(); ++m)
      row[3 + static_cast<int>(m)] = along_u_[u][modes_[m].first] * along_v_[v][modes_[m].second];
  }

 private:
  static std::vector<double> cosines(int i, int count, int order) {
    std::vector<double> values;
    for (int k = 0; k <= order; ++k) values.push_back(std::cos(std::numbers::pi * k * (i + 0.5) / count));
    return values;
  }
  int size_;
  std::vector<std::vector<double>> along_u_, along_v_;
  std::vector<std::pair<int, int>> modes_;
};

/// The slow part of the wall's disparity, and the waves that repeat with each pixel of disparity.
struct SlowPart {
  std::vector<float> smooth;      ///< px, every pixel of the region
  std::vector<float> with_waves;  ///< px
  std::optional<double> wave_px;  ///< amplitude; none: too slow over the region to be told from the smooth part
  int parameters = 0;
};

class SlowPartFit {
 public:
  SlowPartFit(const Wall& wall, int order) : wall_(wall), basis_(wall.width, wall.height, order) {
    const int stride = std::max(1, static_cast<int>(std::sqrt(wall.pixels / 60000.0)));
    for (int v = 0; v < wall.height; v += stride)
      for (int u = 0; u < wall.width; u += stride)
        if (wall.disparity[static_cast<std::size_t>(v) * wall.width + u] > 0) sample_.push_back({u, v});
  }

  SlowPart fit() const {
    SlowPart part;
    Eigen::VectorXd solution = solve(nullptr, nullptr);
    part.smooth = evaluate(solution);
    for (int round = 0; round < 4; ++round) {
      double separable = 0;
      solution = solve(&part.smooth, &separable);
      if (separable < 0.5) {
        part.with_waves = part.smooth;
        part.parameters = basis_.size();
        return part;
      }
      const auto argument = part.smooth;
      part.smooth = evaluate(solution);
      const double a = solution[basis_.size()], b = solution[basis_.size() + 1];
      part.wave_px = std::hypot(a, b);
      part.with_waves = part.smooth;
      for (std::size_t p = 0; p < argument.size(); ++p)
        part.with_waves[p] +=
            static_cast<float>(a * std::sin(two_pi * argument[p]) + b * std::cos(two_pi * argument[p]));
    }
    part.parameters = basis_.size() + 2;
    return part;
  }

 private:
  /// Least squares of the disparity by the basis and, with `argument`, by sine and cosine of 2 pi times it. `separable`
  /// is the smaller share of those two that the basis cannot imitate.
  Eigen::VectorXd solve(const std::vector<float>* argument, double* separable) const {
    const int n = basis_.size() + (argument ? 2 : 0);
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    constexpr int chunk = 256;
    Eigen::MatrixXd rows(n, chunk);
    Eigen::VectorXd values(chunk);
    for (std::size_t begin = 0; begin < sample_.size(); begin += chunk) {
      const int count = static_cast<int>(std::min<std::size_t>(chunk, sample_.size() - begin));
      for (int i = 0; i < count; ++i) {
        const auto [u, v] = sample_[begin + i];
        const std::size_t p = static_cast<std::size_t>(v) * wall_.width + u;
        basis_.fill(u, v, rows.col(i));
        values[i] = wall_.disparity[p];
        if (argument) {
          rows(n - 2, i) = std::sin(two_pi * (*argument)[p]);
          rows(n - 1, i) = std::cos(two_pi * (*argument)[p]);
        }
      }
      products.noalias() += rows.leftCols(count) * rows.leftCols(count).transpose();
      right.noalias() += rows.leftCols(count) * values.head(count);
    }
    products.diagonal().array() += 1e-9 * static_cast<double>(sample_.size());
    if (separable) {
      const int m = basis_.size();
      const Eigen::MatrixXd across = products.topRightCorner(m, 2);
      const Eigen::Matrix2d rest =
          products.bottomRightCorner(2, 2) - across.transpose() * products.topLeftCorner(m, m).ldlt().solve(across);
      *separable = std::min(rest(0, 0) / products(m, m), rest(1, 1) / products(m + 1, m + 1));
    }
    return products.ldlt().solve(right);
  }

  std::vector<float> evaluate(const Eigen::VectorXd& solution) const {
    std::vector<float> out(wall_.disparity.size());
    Eigen::VectorXd row(basis_.size());
    for (int v = 0; v < wall_.height; ++v)
      for (int u = 0; u < wall_.width; ++u) {
        basis_.fill(u, v, row);
        out[static_cast<std::size_t>(v) * wall_.width + u] = static_cast<float>(row.dot(solution.head(basis_.size())));
      }
    return out;
  }

  const Wall& wall_;
  SmoothBasis basis_;
  std::vector<std::pair<int, int>> sample_;
};

/// Mean products of values `lag` pixels apart along rows and columns; NaN values do not count.
std::vector<double> autocovariance(const std::vector<std::vector<float>>& images, int width, int height, int lags) {
  std::vector<double> out;
  for (int lag = 0; lag < lags; ++lag) {
    double sum = 0, count = 0;
    for (const auto& image : images)
      for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u) {
          const std::size_t p = static_cast<std::size_t>(v) * width + u;
          if (std::isnan(image[p])) continue;
          const auto take = [&](std::size_t q) {
            if (std::isnan(image[q])) return;
            sum += static_cast<double>(image[p]) * image[q];
            ++count;
          };
          if (u + lag < width) take(p + lag);
          if (lag > 0 && v + lag < height) take(p + static_cast<std::size_t>(lag) * width);
        }
    out.push_back(count > 0 ? sum / count : 0);
  }
  return out;
}

struct Correlation {
  double variance = 0;   ///< of the correlated part
  double length_px = 0;  ///< C(r) = variance exp(-r^2 / length^2) for r > 0
};

/// Straight line through ln C against the squared lag, over the lags where it stands clear of its error.
Correlation fit_correlation(std::vector<double> covariance, double removed_modes_per_pixel, double pixels) {
  Correlation out;
  const double error = 4 * covariance[0] / std::sqrt(pixels);
  if (!(covariance[1] > std::max(error, 0.02 * covariance[0]))) return out;
  const std::vector<double> measured = covariance;
  for (int round = 0; round < 3; ++round) {
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int lag = 1; lag < static_cast<int>(covariance.size()); ++lag) {
      const double c = covariance[lag];
      if (lag > 2 && c < 0.3 * covariance[1]) break;
      if (!(c > 0)) break;
      const double weight = c * c, r2 = static_cast<double>(lag) * lag, log_c = std::log(c);
      w += weight;
      x += weight * r2;
      y += weight * log_c;
      xx += weight * r2 * r2;
      xy += weight * r2 * log_c;
    }
    const double spread = w * xx - x * x;
    const double slope = spread > 1e-12 * w * xx ? (w * xy - x * y) / spread : 0;
    if (!(slope < 0)) {
      // One lag alone, or no decay in sight: as long as the lags looked at, or as short as a pixel.
      out = {covariance[1], covariance[2] > 0 ? static_cast<double>(covariance.size()) : 1.0};
      return out;
    }
    out.length_px = std::sqrt(-1 / slope);
    out.variance = std::exp((y - slope * x) / w);
    // The slow part took its share of the correlated noise with it: pi length^2 variance per parameter and area.
    const double taken = out.variance * std::numbers::pi * squared(out.length_px) * removed_modes_per_pixel;
    for (std::size_t lag = 0; lag < covariance.size(); ++lag) covariance[lag] = measured[lag] + taken;
  }
  return out;
}

/// Greatest common divisor of all depths, in mm. Fewer than five different depths say nothing about the step.
std::optional<double> depth_step(std::span<const DepthImage> frames, const Region& region, double unit_mm) {
  if (!(unit_mm > 0)) return std::nullopt;
  std::int64_t divisor = 0;
  std::set<std::int64_t> different;
  constexpr std::size_t enough = 5;
  for (const auto& frame : frames)
    for (int v = region.top; v < region.top + region.height; ++v)
      for (int u = region.left; u < region.left + region.width; ++u) {
        const auto units = static_cast<std::int64_t>(std::llround(frame.at(u, v) / unit_mm));
        divisor = std::gcd(divisor, units);
        if (units > 0 && different.size() < enough) different.insert(units);
      }
  if (different.size() < enough) return std::nullopt;
  return static_cast<double>(divisor) * unit_mm;
}

/// The coarsest power of two of which all disparities are multiples, up to the depth's own step.
std::optional<double> disparity_step(const Wall& wall, double depth_step_mm, double focal_baseline) {
  std::vector<float> values;
  for (const float d : wall.disparity)
    if (d > 0) values.push_back(d);
  std::sort(values.begin(), values.end());
  const double range = values[values.size() * 95 / 100] - values[values.size() * 5 / 100];
  const double rounding_px = depth_step_mm * squared(values[values.size() / 2]) / focal_baseline / std::sqrt(12);
  for (double step = 0.5; step > 1.0 / 300; step /= 2) {
    const double expected = std::exp(-0.5 * squared(two_pi * rounding_px / step));
    if (range < 2 * step) continue;
    if (expected < 0.3) break;
    std::complex<double> sum = 0;
    for (const float d : values) sum += std::polar(1.0, two_pi * std::remainder(d / step, 1.0));
    if (std::abs(sum) / static_cast<double>(values.size()) > 0.6 * expected) return step;
  }
  return std::nullopt;
}

/// Peak to peak of the slow part's relative depth error, per cent: what is left of it after a plane.
double pattern_percent(const Wall& wall, const std::vector<float>& smooth, double error_px) {
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const auto row = [&](std::size_t p) {
    return Eigen::Vector3d(1, 2.0 * static_cast<double>(p % wall.width) / wall.width - 1,
                           2.0 * static_cast<double>(p / wall.width) / wall.height - 1);
  };
  for (std::size_t p = 0; p < smooth.size(); ++p) {
    if (!(wall.disparity[p] > 0)) continue;
    products += row(p) * row(p).transpose();
    right += static_cast<double>(smooth[p]) * row(p);
  }
  const Eigen::Vector3d plane = products.ldlt().solve(right);
  std::vector<float> error;
  double mean = 0;
  for (std::size_t p = 0; p < smooth.size(); ++p)
    if (wall.disparity[p] > 0) {
      error.push_back(static_cast<float>(plane.dot(row(p)) / smooth[p] - 1));
      mean += smooth[p];
    }
  mean /= static_cast<double>(error.size());
  std::sort(error.begin(), error.end());
  const std::size_t trimmed = error.size() / 2000;
  const double peak_to_peak = error[error.size() - 1 - trimmed] - error[trimmed];
  // Noise alone spreads over about five standard errors.
  return 100 * std::sqrt(std::max(0.0, squared(peak_to_peak) - squared(5 * error_px / mean)));
}

double rounded(double value, int digits = 3) {
  if (value == 0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10, digits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

}  // namespace

StereoSensorFit fit_stereo_sensor(std::span<const DepthImage> frames, const Intrinsics& camera,
                                  const SensorFitOptions& options, const Progress& progress) {
  camera.check();
  if (!(options.baseline_mm > 0) || !std::isfinite(options.baseline_mm))
    throw Error("sensor fit: no baseline: give the distance between the camera's imagers in mm (D415: 55)");
  if (!(options.plane_percent > 0))
    throw Error("sensor fit: plane_percent {}: must be positive", options.plane_percent);
  if (frames.empty()) throw Error("sensor fit: no frame given");
  for (const auto& frame : frames) {
    if (frame.width != camera.width || frame.height != camera.height ||
        frame.z_mm.size() != static_cast<std::size_t>(camera.width) * camera.height)
      throw Error("sensor fit: a frame is {} x {} px, the camera {} x {} px: must be the same", frame.width,
                  frame.height, camera.width, camera.height);
    for (const float z : frame.z_mm)
      if (!(z >= 0) || !std::isfinite(z)) throw Error("sensor fit: a depth of {} mm: must be 0 (missing) or more", z);
  }

  StereoSensorFit fit;
  fit.frames = static_cast<int>(frames.size());
  // The wall in each frame, then its slow part, the residuals' correlation and, of several frames, their changes'.
  const std::size_t steps = frames.size() + (frames.size() > 1 ? 3 : 2);
  std::size_t step = 0;
  const auto step_done = [&] {
    if (progress) progress("fitting the wall", ++step, steps);
  };
  const Region region = region_of(options.region_px, camera);
  const double focal_baseline = camera.fx * options.baseline_mm;
  const auto region_pixels = static_cast<double>(region.width) * region.height;

  // The wall, by the first frame.
  PointCloud cloud;
  std::vector<float> depths;
  for (int v = region.top; v < region.top + region.height; ++v)
    for (int u = region.left; u < region.left + region.width; ++u)
      if (const float z = frames[0].at(u, v); z > 0) {
        cloud.points.push_back(camera.unproject(u, v, z));
        depths.push_back(z);
      }
  if (depths.size() < fewest_pixels)
    throw Error("sensor fit: only {} measured pixels: needs a wall of at least {} px", depths.size(), fewest_pixels);
  std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
  fit.distance_mm = depths[depths.size() / 2];
  const double tolerance_mm = options.plane_percent / 100 * fit.distance_mm;
  const auto found = fit_plane(cloud, {.distance_threshold_mm = static_cast<float>(tolerance_mm)});
  const double on_plane = found ? static_cast<double>(found->inliers.size()) / static_cast<double>(cloud.size()) : 0;
  if (on_plane < 0.8)
    throw Error(
        "sensor fit: not a plane: {:.0f} % of the pixels lie within {:.1f} mm of one; capture a flat wall that fills "
        "the picture, or give the wall's region",
        100 * on_plane, tolerance_mm);
  fit.tilt_deg = degrees(std::acos(std::clamp(std::abs(found->plane.normal.z()), 0.0, 1.0)));
  measure_like_realsense(cloud, focal_baseline, fit);

  std::vector<Wall> walls;
  double measured = 0;
  for (const auto& frame : frames) {
    Wall wall{region.width, region.height, {}, 0};
    for (int v = region.top; v < region.top + region.height; ++v)
      for (int u = region.left; u < region.left + region.width; ++u) {
        const float z = frame.at(u, v);
        measured += z > 0;
        const bool on_wall =
            z > 0 && std::abs(found->plane.signed_distance_mm(camera.unproject(u, v, z))) <= tolerance_mm;
        wall.disparity.push_back(on_wall ? static_cast<float>(focal_baseline / z) : 0.0f);
        wall.pixels += on_wall;
      }
    if (wall.pixels < fewest_pixels)
      throw Error("sensor fit: frame {} does not show the wall of the first one: the camera must not move",
                  walls.size() + 1);
    walls.push_back(std::move(wall));
    step_done();
  }
  fit.pixels = walls[0].pixels;
  fit.fill_rate = measured / (region_pixels * fit.frames);

  Wall mean = walls[0];
  mean.pixels = 0;
  for (std::size_t p = 0; p < mean.disparity.size(); ++p) {
    double sum = 0;
    int count = 0;
    for (const auto& wall : walls) {
      sum += wall.disparity[p];
      count += wall.disparity[p] > 0;
    }
    mean.disparity[p] = count > 0 ? static_cast<float>(sum / count) : 0.0f;
    mean.pixels += count > 0;
  }

  // A slow surface for each 40 px or so, at most what the static pattern needs.
  const int order = std::clamp(std::min(region.width, region.height) / 40, 1, 8);
  const SlowPart slow = SlowPartFit(mean, order).fit();
  step_done();

  const float missing = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::vector<float>> residuals;
  for (const auto& wall : walls) {
    std::vector<float> residual(wall.disparity.size(), missing), sizes;
    for (std::size_t p = 0; p < residual.size(); ++p)
      if (wall.disparity[p] > 0) {
        residual[p] = wall.disparity[p] - slow.with_waves[p];
        sizes.push_back(std::abs(residual[p]));
      }
    std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
    const float limit =
        6 * 1.4826f * std::max(sizes[sizes.size() / 2], 1e-4f);  // six standard deviations by the median
    for (float& e : residual)
      if (std::abs(e) > limit) e = missing;
    residuals.push_back(std::move(residual));
  }

  fit.depth_step_mm = depth_step(frames, region, options.depth_unit_mm);
  fit.disparity_step_px = disparity_step(walls[0], fit.depth_step_mm.value_or(0), focal_baseline);
  const double px_per_mm = focal_baseline / squared(fit.distance_mm);
  fit.mm_per_px = rounded(1 / px_per_mm);
  const double rounding_variance =
      (squared(fit.depth_step_mm.value_or(0) * px_per_mm) + squared(fit.disparity_step_px.value_or(0))) / 12;

  constexpr int lags = 25;
  const auto covariance = autocovariance(residuals, region.width, region.height, lags);
  step_done();
  const double pixels = fit.pixels;
  const Correlation correlation = fit_correlation(covariance, slow.parameters / pixels, pixels);
  const double white = std::max(0.0, covariance[0] - correlation.variance - rounding_variance);
  const double variance = correlation.variance + white;
  fit.disparity_noise_px = rounded(std::sqrt(variance));
  fit.correlation_px = rounded(correlation.length_px);
  fit.white_share = variance > 0 ? rounded(white / variance) : 0;
  fit.static_pattern_percent = rounded(pattern_percent(
      mean, slow.smooth,
      std::sqrt(correlation.variance * std::numbers::pi * squared(correlation.length_px) * slow.parameters / pixels)));
  if (slow.wave_px) fit.subpixel_wave_px = rounded(*slow.wave_px);

  if (fit.frames > 1) {
    std::vector<std::vector<float>> changes;
    for (std::size_t f = 1; f < residuals.size(); ++f) {
      auto& change = changes.emplace_back(residuals[f]);
      for (std::size_t p = 0; p < change.size(); ++p)
        change[p] = (change[p] - residuals[f - 1][p]) / std::numbers::sqrt2_v<float>;
    }
    const auto temporal = autocovariance(changes, region.width, region.height, lags);
    step_done();
    const Correlation changing = fit_correlation(temporal, 0, pixels);
    const double temporal_px = std::sqrt(std::max(0.0, temporal[0] - rounding_variance));
    fit.temporal_noise_px = rounded(temporal_px);
    fit.temporal_noise_mm = rounded(temporal_px / px_per_mm);
    fit.frozen_share =
        correlation.variance > 0 ? rounded(std::clamp(1 - changing.variance / correlation.variance, 0.0, 1.0)) : 0;
  }

  if (!slow.wave_px)
    fit.notes.emplace_back("sub-pixel waves: the wall's disparity changes too little; tilt the wall by 10 to 30 deg");
  if (!fit.disparity_step_px)
    fit.notes.emplace_back("disparity step: hidden by the noise or the depth's step; use a finer depth unit (0.1 mm)");
  if (fit.depth_step_mm && variance < squared(0.5 * *fit.depth_step_mm * px_per_mm))
    fit.notes.emplace_back(
        "noise: below half the depth's step, so poorly known; use a finer depth unit or a farther wall");
  if (fit.frames == 1) fit.notes.emplace_back("static or temporal: give several frames of the same wall");
  if (fit.static_pattern_percent > 5)
    fit.notes.emplace_back("static pattern: more than 5 % of the depth; is the wall flat, and the baseline right?");
  if (order < 4) fit.notes.emplace_back("static pattern: the region is too small to show it");

  auto& stereo = fit.stereo;
  stereo.baseline_mm = options.baseline_mm;
  stereo.disparity_noise_px = fit.disparity_noise_px;
  stereo.correlation_px = std::min(fit.correlation_px, 64.0);
  stereo.white_share = fit.white_share;
  stereo.static_pattern_percent = std::min(fit.static_pattern_percent, 20.0);
  if (fit.subpixel_wave_px) stereo.subpixel_wave_px = std::min(*fit.subpixel_wave_px, 0.5);
  if (fit.disparity_step_px) stereo.disparity_step_px = *fit.disparity_step_px;
  if (fit.depth_step_mm) stereo.depth_step_mm = *fit.depth_step_mm;
  if (fit.frozen_share) stereo.frozen_share = *fit.frozen_share;
  return fit;
}

}  // namespace partpose
