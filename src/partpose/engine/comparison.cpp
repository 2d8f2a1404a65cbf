// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/comparison.hpp"

#include "partpose/camera/rasterizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace partpose {

namespace {

/// The smallest difference in depth to the pixels within `reach` that `count`; infinite when none does.
template <typename Counts>
float smallest_near(float z_mm, int u, int v, int reach, const DepthImage& other, const Counts& counts) {
  float smallest = std::numeric_limits<float>::infinity();
  for (int vv = std::max(v - reach, 0); vv <= std::min(v + reach, other.height - 1); ++vv)
    for (int uu = std::max(u - reach, 0); uu <= std::min(u + reach, other.width - 1); ++uu)
      if (counts(static_cast<std::size_t>(vv) * other.width + uu))
        smallest = std::min(smallest, std::abs(z_mm - other.at(uu, vv)));
  return smallest;
}

/// Log-density of a depth's difference against the hypothesis that a depth is anywhere within the part's size.
class LogDensity {
 public:
  explicit LogDensity(const SensorModel& sensor) : per_noise_(static_cast<float>(1 / sensor.noise_mm)) {
    const double peak = sensor.size_mm / (std::sqrt(2 * std::numbers::pi) * sensor.noise_mm);
    for (int i = 0; i <= entries; ++i) {
      const double t = static_cast<double>(i) / steps;
      table_[i] = static_cast<float>(std::log((1 - sensor.outlier) * peak * std::exp(-0.5 * t * t) + sensor.outlier));
    }
  }
  float operator()(float difference_mm) const {
    return table_[static_cast<int>(std::min(difference_mm * per_noise_ * steps, static_cast<float>(entries)))];
  }

 private:
  static constexpr int steps = 32, entries = 6 * steps;  // beyond six deviations it is an outlier
  float per_noise_;
  std::array<float, entries + 1> table_;
};

/// What a camera makes of a part's outline: by how many pixels it grows over what is behind it.
class Outline {
 public:
  explicit Outline(const SensorModel& sensor) {
    constexpr double deviation_px = 1.2;  // along an outline, and of the rendering
    const double deviation = std::max(0.6, sensor.growth_px > 0 ? deviation_px * sensor.outline_px / 3.0 : 0);
    for (int distance = 0; distance <= most; ++distance) {
      const double away = (distance - 0.5 - sensor.growth_px) / deviation;
      const double covered = std::clamp(0.5 * std::erfc(away / std::numbers::sqrt2), 0.02, 0.98);
      log_covered_[distance] = static_cast<float>(std::log(covered));
      log_free_[distance] = static_cast<float>(std::log(1 - covered));
    }
    log_narrower_ = static_cast<float>(std::log(sensor.growth_px > 0 ? 0.05 : 0.3));
  }
  static constexpr int most = 6;
  /// So many pixels beyond the part: that it shows there, and that it does not.
  float log_covered(int distance) const { return log_covered_[distance]; }
  float log_free(int distance) const { return log_free_[distance]; }
  /// Within the part's outline something farther shows.
  float log_narrower() const { return log_narrower_; }

 private:
  std::array<float, most + 1> log_covered_, log_free_;
  float log_narrower_;
};

/// Of pixels beside the part: how far it is to the part's outline (its pixels are 1 apart), and how far away the part
/// is there.
struct Beside {
  std::uint8_t distance = 0;  ///< 0: not beside it
  float z_mm = 0;
};

std::vector<Beside> beside_part(const DepthImage& rendered, int reach) {
  std::vector<Beside> beside(rendered.z_mm.size());
  const int width = rendered.width, height = rendered.height;
  const auto is_model = [&](int u, int v) {
    return u >= 0 && v >= 0 && u < width && v < height && rendered.at(u, v) > 0;
  };
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const float z = rendered.at(u, v);
      if (!(z > 0) || (is_model(u - 1, v) && is_model(u + 1, v) && is_model(u, v - 1) && is_model(u, v + 1))) continue;
      for (int vv = std::max(v - reach, 0); vv <= std::min(v + reach, height - 1); ++vv)
        for (int uu = std::max(u - reach, 0); uu <= std::min(u + reach, width - 1); ++uu) {
          const std::size_t p = static_cast<std::size_t>(vv) * width + uu;
          if (rendered.z_mm[p] > 0) continue;
          const auto distance = static_cast<std::uint8_t>(std::max(std::abs(uu - u), std::abs(vv - v)));
          if (beside[p].distance == 0 || distance < beside[p].distance) beside[p] = {distance, z};
        }
    }
  return beside;
}

}  // namespace

DepthComparison compare_depth(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                              const FrameWindow& frame, const SensorModel& sensor) {
  const DepthImage rendered = render(mesh, camera_from_model, frame.camera).depth;
  const auto is_object = [&](std::size_t p) { return frame.label[p] == PixelLabel::object; };
  const auto is_model = [&](std::size_t p) { return rendered.z_mm[p] > 0; };

  const LogDensity log_density(sensor);
  const auto noise_mm = static_cast<float>(sensor.noise_mm);
  constexpr float log_edge = -1;  // a depth that only a neighbour explains: an outline moved by a pixel
  const auto log_outlier = static_cast<float>(std::log(sensor.outlier));
  const auto log_hole = static_cast<float>(std::log(sensor.hole));
  const auto log_hidden = static_cast<float>(std::log(sensor.hidden));
  const auto log_match = static_cast<float>(std::log(1 - sensor.hole));
  const auto agreement = [&](float difference_mm) {
    const float t = difference_mm / (3 * noise_mm);
    return std::max(0.0f, 1 - t * t);
  };

  constexpr float outline_weight = 0.25f, nothing_weight = 0.5f, hidden_weight = 0.15f;
  const auto log_outline = static_cast<float>(std::log(0.5));
  const int reach = std::max(sensor.outline_px, 1);
  const Outline outline(sensor);
  const int beside_reach = std::min(reach + (sensor.growth_px > 0 ? 1 : 0), Outline::most);
  const std::vector<Beside> beside = beside_part(rendered, beside_reach);

  DepthComparison out;
  double log_likelihood = 0, soft = 0, judged = 0, squared = 0;
  for (int v = 0; v < rendered.height; ++v) {
    for (int u = 0; u < rendered.width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * rendered.width + u;
      const float model_z = rendered.z_mm[p], measured_z = frame.depth.z_mm[p];
      const bool object = is_object(p), model = is_model(p);
      if (object) ++out.object;
      if (model) ++out.model;
      if (model && object) {
        const float here = std::abs(model_z - measured_z);
        // Beside an edge the foreground may have won. Where the depths agree at once, the neighbours are not asked.
        const bool sure = here <= noise_mm;
        const float near = sure ? here : smallest_near(measured_z, u, v, reach, rendered, is_model);
        const float agree = agreement(near);
        out.explained += agree > 0;
        out.unexplained += agree <= 0;
        soft += 2 * agree;
        judged += 2;
        const float t = here / noise_mm;
        squared += std::min(t * t, 9.0f);
        ++out.compared;
        log_likelihood += log_match + std::max(log_density(here), log_edge + log_density(near));
      } else if (model) {
        const bool measured = frame.label[p] != PixelLabel::nothing;
        const float near = smallest_near(model_z, u, v, reach, frame.depth, is_object);
        if (measured && std::abs(model_z - measured_z) < 4 * noise_mm) {
          // Measured, but taken for the table, as what lies low on it is: the likelier of the two.
          const float t_part = (model_z - measured_z) / noise_mm;
          const float t_table = frame.before_table_mm.empty() ? 0 : frame.before_table_mm[p] / noise_mm;
          const float gain = 0.5f * (std::min(t_table * t_table, 16.0f) - t_part * t_part);
          soft += 0.7f * agreement(0.5f * std::abs(model_z - measured_z));
          judged += 1;
          log_likelihood += std::clamp(gain, log_outlier, 3.0f);
        } else if (std::isfinite(near)) {
          ++out.model_outline;
          out.explained += near < 3 * noise_mm;
          soft += outline_weight * agreement(near);
          judged += outline_weight;
          log_likelihood += near >= 3 * noise_mm ? log_outlier : measured ? outline.log_narrower() : log_outline;
        } else if (!measured) {
          ++out.nothing;
          judged += nothing_weight;
          log_likelihood += log_hole;
        } else if (model_z < measured_z) {
          ++out.free_space;
          judged += 1;
          log_likelihood += log_outlier;
        } else if (!frame.before_table_mm.empty() && frame.label[p] == PixelLabel::background &&
                   std::abs(frame.before_table_mm[p]) < 4 * noise_mm) {
          ++out.below_table;
          judged += 1;
          log_likelihood += log_outlier;
        } else {
          ++out.hidden;
          judged += hidden_weight;
          log_likelihood += log_hidden;
        }
      } else if (object) {
        const int distance = beside[p].distance;
        if (distance > 0) {
          const float near = smallest_near(measured_z, u, v, distance, rendered, is_model);
          ++out.object_outline;
          soft += outline_weight * agreement(near);
          judged += outline_weight;
          log_likelihood += std::max(log_outlier, outline.log_covered(distance) + log_density(near));
        } else {
          ++out.unexplained;
          judged += 1;
          log_likelihood += log_outlier;
        }
      } else if (const int distance = beside[p].distance;
                 distance > 0 && measured_z > beside[p].z_mm + static_cast<float>(sensor.edge_mm)) {
        out.missing_outline += distance <= sensor.growth_px;
        log_likelihood += outline.log_free(distance);
      }
    }
  }
  out.soft = soft;
  out.judged = judged;
  out.squared_deviations = squared;
  out.log_likelihood = log_likelihood;
  out.best_log_likelihood = out.object * (log_match + log_density(0));
  return out;
}

}  // namespace partpose
