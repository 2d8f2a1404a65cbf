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

/// The smallest difference in depth to a pixel's neighbours that `counts`; infinite when none does.
template <typename Counts>
float smallest_near(float z_mm, int u, int v, const DepthImage& other, const Counts& counts) {
  float smallest = std::numeric_limits<float>::infinity();
  for (int vv = std::max(v - 1, 0); vv <= std::min(v + 1, other.height - 1); ++vv)
    for (int uu = std::max(u - 1, 0); uu <= std::min(u + 1, other.width - 1); ++uu)
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
      table_[i] =
          static_cast<float>(std::log((1 - sensor.outlier) * peak * std::exp(-0.5 * t * t) + sensor.outlier));
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

double DepthComparison::score() const {
  const int judged = model + object;
  return judged > 0 ? soft / judged : 0.0;
}

DepthComparison compare_depth(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                              const LabelledDepth& frame, const SensorModel& sensor) {
  const DepthImage rendered = render(mesh, camera_from_model, frame.camera).depth;
  const auto is_object = [&](std::size_t p) { return frame.label[p] == PixelLabel::object; };
  const auto is_model = [&](std::size_t p) { return rendered.z_mm[p] > 0; };

  const LogDensity log_density(sensor);
  const auto noise_mm = static_cast<float>(sensor.noise_mm);
  constexpr float log_edge = -1;  // a depth that only a neighbour explains: an outline moved by a pixel
  constexpr float never = -100;
  const auto log_outlier = static_cast<float>(std::log(sensor.outlier));
  const auto log_hole = static_cast<float>(std::log(sensor.hole));
  const auto log_hidden = static_cast<float>(std::log(sensor.hidden));
  const auto log_match = static_cast<float>(std::log(1 - sensor.hole - sensor.hidden));
  const auto agreement = [&](float difference_mm) {
    const float t = difference_mm / (3 * noise_mm);
    return std::max(0.0f, 1 - t * t);
  };

  DepthComparison out;
  double log_likelihood = 0, soft = 0;
  for (int v = 0; v < rendered.height; ++v) {
    for (int u = 0; u < rendered.width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * rendered.width + u;
      const float model_z = rendered.z_mm[p], measured_z = frame.depth.z_mm[p];
      const bool object = is_object(p), model = is_model(p);
      if (object) ++out.object;
      if (model) ++out.model;
      if (model && object) {
        const float here = std::abs(model_z - measured_z);
        // Where the depths agree at once, the neighbours are not asked.
        const bool sure = here <= noise_mm;
        const float measured_near = sure ? here : smallest_near(model_z, u, v, frame.depth, is_object);
        const float model_near = sure ? here : smallest_near(measured_z, u, v, rendered, is_model);
        const float agree = agreement(measured_near), agree_back = agreement(model_near);
        out.explained += agree > 0;
        out.unexplained += agree_back <= 0;
        soft += agree + agree_back;
        log_likelihood += log_match + std::max(log_density(here), log_edge + log_density(model_near));
      } else if (model) {
        const float near = smallest_near(model_z, u, v, frame.depth, is_object);
        const float by_neighbour = near < 3 * noise_mm ? log_edge : never;
        float agree = agreement(near);
        out.explained += agree > 0;
        if (frame.label[p] == PixelLabel::nothing) {
          ++out.nothing;
          agree = std::max(agree, 0.4f);
          log_likelihood += std::max(log_hole, by_neighbour);
        } else if (model_z < measured_z - 6 * noise_mm) {
          ++out.free_space;
          log_likelihood += std::max(log_outlier, by_neighbour);
        } else if (model_z < measured_z + 6 * noise_mm) {
          // Measured, but cut off from the object, as what lies low on a table is.
          const float half = 0.5f * std::abs(model_z - measured_z);
          agree = std::max(agree, 0.7f * agreement(half));
          log_likelihood += std::max(std::min(0.0f, log_density(half)), by_neighbour);
        } else {
          ++out.hidden;
          agree = std::max(agree, 0.35f);
          log_likelihood += std::max(log_hidden, by_neighbour);
        }
        soft += agree;
      } else if (object) {
        const float near = smallest_near(measured_z, u, v, rendered, is_model);
        const float agree = agreement(near);
        out.unexplained += agree <= 0;
        soft += agree;
        log_likelihood += std::max(log_outlier, log_edge + std::min(0.0f, log_density(near)));
      }
    }
  }
  out.soft = soft;
  out.log_likelihood = log_likelihood;
  out.best_log_likelihood = out.object * (log_match + log_density(0));
  return out;
}

}  // namespace partpose
