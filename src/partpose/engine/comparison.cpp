// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/comparison.hpp"

#include "partpose/camera/rasterizer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace partpose {

namespace {

/// The smallest difference in depth to a pixel or its neighbours that `counts`; infinite when none does. A neighbour's
/// difference is enlarged by one deviation: a better match is right there.
struct Smallest {
  double here = std::numeric_limits<double>::infinity();
  double near = std::numeric_limits<double>::infinity();
};

template <typename Counts>
Smallest smallest_difference(float z_mm, int u, int v, const DepthImage& other, const Counts& counts) {
  Smallest out;
  for (int vv = std::max(v - 1, 0); vv <= std::min(v + 1, other.height - 1); ++vv) {
    for (int uu = std::max(u - 1, 0); uu <= std::min(u + 1, other.width - 1); ++uu) {
      if (!counts(static_cast<std::size_t>(vv) * other.width + uu)) continue;
      const double difference = std::abs(z_mm - other.at(uu, vv));
      if (uu == u && vv == v) out.here = difference;
      out.near = std::min(out.near, difference);
    }
  }
  return out;
}

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

  // Log-densities against the hypothesis that a depth is anywhere within the part's size.
  const double peak =
      sensor.size_mm / (std::sqrt(2 * std::numbers::pi) * sensor.noise_mm);  // of the noise, in units of that density
  const double match = (1 - sensor.hole - sensor.hidden);
  const auto log_density = [&](double difference_mm) {
    const double t = difference_mm / sensor.noise_mm;
    return std::log((1 - sensor.outlier) * peak * std::exp(-0.5 * t * t) + sensor.outlier);
  };
  constexpr double log_edge = -1;  // a depth that only a neighbour explains: an outline moved by a pixel
  const double log_outlier = std::log(sensor.outlier);
  const double log_hole = std::log(sensor.hole), log_hidden = std::log(sensor.hidden), log_match = std::log(match);
  const auto agreement = [&](double difference_mm) {
    const double t = difference_mm / (3 * sensor.noise_mm);
    return std::max(0.0, 1 - t * t);
  };

  DepthComparison out;
  for (int v = 0; v < rendered.height; ++v) {
    for (int u = 0; u < rendered.width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * rendered.width + u;
      const float model_z = rendered.z_mm[p], measured_z = frame.depth.z_mm[p];
      const bool object = is_object(p), model = is_model(p);
      if (model) {
        ++out.model;
        const Smallest difference = smallest_difference(model_z, u, v, frame.depth, is_object);
        double agree = agreement(difference.near);
        out.explained += agree > 0;
        if (!object) {
          const double by_neighbour = difference.near < 3 * sensor.noise_mm ? log_edge : -100.0;
          if (frame.label[p] == PixelLabel::nothing) {
            ++out.nothing;
            agree = std::max(agree, 0.4);
            out.log_likelihood += std::max(log_hole, by_neighbour);
          } else if (model_z < measured_z - 6 * sensor.noise_mm) {
            ++out.free_space;
            out.log_likelihood += std::max(log_outlier, by_neighbour);
          } else if (model_z < measured_z + 6 * sensor.noise_mm) {
            // Measured, but cut off from the object, as what lies low on a table is.
            agree = std::max(agree, 0.7 * agreement(0.5 * (model_z - measured_z)));
            out.log_likelihood += std::max(std::min(0.0, log_density(0.5 * (model_z - measured_z))), by_neighbour);
          } else {
            ++out.hidden;
            agree = std::max(agree, 0.35);
            out.log_likelihood += std::max(log_hidden, by_neighbour);
          }
        }
        out.soft += agree;
      }
      if (object) {
        ++out.object;
        const Smallest difference = smallest_difference(measured_z, u, v, rendered, is_model);
        const double agree = agreement(difference.near);
        out.unexplained += agree <= 0;
        out.soft += agree;
        out.log_likelihood +=
            model ? log_match + std::max(log_density(difference.here), log_edge + log_density(difference.near))
                  : std::max(log_outlier, log_edge + std::min(0.0, log_density(difference.near)));
        out.best_log_likelihood += log_match + log_density(0);
      }
    }
  }
  return out;
}

}  // namespace partpose
