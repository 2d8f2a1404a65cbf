// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/comparison.hpp"

#include "partpose/camera/rasterizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
        const float near = smallest_near(model_z, u, v, reach, frame.depth, is_object);
        if (std::isfinite(near)) {
          ++out.model_outline;
          out.explained += near < 3 * noise_mm;
          soft += outline_weight * agreement(near);
          judged += outline_weight;
          log_likelihood += near < 3 * noise_mm ? log_outline : log_outlier;
        } else if (frame.label[p] == PixelLabel::nothing) {
          ++out.nothing;
          judged += nothing_weight;
          log_likelihood += log_hole;
        } else if (model_z < measured_z - 4 * noise_mm) {
          ++out.free_space;
          judged += 1;
          log_likelihood += log_outlier;
        } else if (model_z < measured_z + 4 * noise_mm) {
          // Measured, but taken for the table, as what lies low on it is: the likelier of the two.
          const float t_part = (model_z - measured_z) / noise_mm;
          const float t_table = frame.before_table_mm.empty() ? 0 : frame.before_table_mm[p] / noise_mm;
          const float gain = 0.5f * (std::min(t_table * t_table, 16.0f) - t_part * t_part);
          soft += 0.7f * agreement(0.5f * std::abs(model_z - measured_z));
          judged += 1;
          log_likelihood += std::clamp(gain, log_outlier, 3.0f);
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
        const float near = smallest_near(measured_z, u, v, reach, rendered, is_model);
        if (std::isfinite(near)) {
          ++out.object_outline;
          soft += outline_weight * agreement(near);
          judged += outline_weight;
          log_likelihood += near < 3 * noise_mm ? log_outline : log_outlier;
        } else {
          ++out.unexplained;
          judged += 1;
          log_likelihood += log_outlier;
        }
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
