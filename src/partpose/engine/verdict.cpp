// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/verdict.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace partpose {

namespace {

/// So many pixels of a stereo camera's depth err together: about the area within its correlation length.
constexpr double alike_px = 200;

/// How high its lowest place lies above the table, in diameters; 0 where there is none, or it stands on something else.
double height_of(const PartInFrame& part) {
  constexpr double on_something_else = 2;  // in diameters
  const double height = part.height_mm.value_or(0) / part.diameter_mm;
  return height < on_something_else ? height : 0;
}

/// A part neither hangs in the air nor sinks into the table.
double height_log_odds(const Explanation& e) {
  constexpr double highest = 0.3, most_deviations = 10;
  return -22.27 * std::clamp(e.height, 0.0, highest) - 0.58 * std::clamp(e.height_deviations, 0.0, most_deviations) -
         19.87 * std::clamp(-e.height, 0.0, highest);
}

double share(int part, int whole) { return whole > 0 ? static_cast<double>(part) / whole : 0; }

}  // namespace

double rough_probability(const DepthComparison& c, const PartInFrame& part) {
  if (c.explained == 0) return 0;
  constexpr double highest = 0.3;
  const int visible = std::max(c.model - c.hidden, 1);
  const double gain = c.best_log_likelihood > 0 ? std::min(c.log_likelihood / c.best_log_likelihood, 1.0) : 0;
  const double logit = -17.8 + 1.4 * gain + 22.6 * c.score() - 14.3 * share(c.unexplained, c.object) -
                       39.8 * share(c.free_space + c.below_table, visible) - 12.5 * share(c.nothing, visible) -
                       10 * share(c.model_outline, visible) - 35.2 * part.noise_mm / part.diameter_mm -
                       24.3 * std::clamp(height_of(part), 0.0, highest);
  return 1 / (1 + std::exp(-logit));
}

Explanation explanation_of(const DepthComparison& c, const PartInFrame& part) {
  Explanation out;
  out.explained_pixels = c.explained;
  out.agreement = c.score();
  out.deviation = c.near > 0 ? std::sqrt(c.near_deviations / c.near) : 0;
  out.roughness = c.near > 0 ? std::sqrt(c.local_deviations / c.near) * part.noise_mm / part.local_noise_mm : 0;
  out.unexplained = share(c.unexplained, c.object);
  const int visible = std::max(c.model - c.hidden, 1);
  out.free_space = share(c.free_space + c.below_table, visible);
  out.not_measured = share(c.nothing, visible);
  out.beside = share(c.model_outline, visible);
  out.narrower = share(c.narrower, visible);
  out.size_ratio = share(c.shown(), c.object);
  constexpr int few_jumps = 5;  // of noise
  out.edges = share(c.common_jumps, c.jumps + few_jumps);
  out.fine_shape = c.fine_shape.correlation();
  out.fine_gain = c.fine_shape.gain();
  out.noise = part.noise_mm / std::max(part.extent_mm, 1.0);
  out.local_noise = part.local_noise_mm / part.noise_mm;
  out.relief = part.relief_mm / part.noise_mm;
  out.height = height_of(part);
  out.height_deviations = out.height * part.diameter_mm / part.noise_mm;
  return out;
}

double probability_of_part(const Explanation& e) {
  if (e.explained_pixels == 0) return 0;
  constexpr double least_noise = 0.008, least_relief = 0.5, least_pixels = 30, many_pixels = 2000, most_beside = 0.25;
  const double log_disagreement = std::log(1.02 - e.agreement);
  // Beyond that it is the camera's, not the part's.
  const double roughness = std::clamp(e.roughness, 0.2, 3.0);
  // Cameras move outlines: of few pixels that says more, of many only where it is more than any camera does.
  const double log_few = std::log(std::clamp(e.explained_pixels / many_pixels, least_pixels / many_pixels, 1.0));
  const double beside_log_odds = 1.72 * e.beside * log_few - 30 * std::max(e.beside - most_beside, 0.0);
  // What explains hardly more than half of an object is not what is seen, whatever the rest looks like.
  constexpr double most_unexplained = 0.3;
  const double unexplained_log_odds =
      -9.03 * std::sqrt(e.unexplained) - 30 * std::max(e.unexplained - most_unexplained, 0.0);
  // Neighbouring depths that err together look like shape and like edges; where each errs for itself, more is known.
  constexpr double least_local = 0.05, most_not_measured = 0.3, most_noise = 0.15, some_narrower = 0.003,
                   most_larger = 3;
  const double log_local = std::log(std::clamp(e.local_noise, least_local, 1.0));
  const double log_noise = std::log(std::max(e.noise, least_noise));
  const double log_relief = std::log(std::max(e.relief, least_relief));
  const double log_larger = std::log(std::clamp(e.size_ratio, 1.0, most_larger));
  const double logit = -2.72 - 1.29 * log_disagreement - 1.65 * e.deviation - 1.06 * std::log(roughness) +
                       unexplained_log_odds + 31.81 * std::min(e.free_space, 0.1) * log_disagreement -
                       44.88 * e.not_measured - 0.53 * log_noise - 0.87 * log_relief - 3.87 * e.edges * log_local +
                       1.70 * e.edges * log_few + 2.18 * log_larger * log_relief + 8.02 * e.fine_shape +
                       0.97 * e.fine_gain * log_noise - 0.57 * std::log(e.narrower + some_narrower) +
                       15.35 * std::min(e.not_measured, most_not_measured) * log_relief +
                       85.65 * std::min(e.noise, most_noise) * log_local + beside_log_odds + height_log_odds(e);
  return 1 / (1 + std::exp(-logit));
}

double pose_log_odds(const DepthComparison& c, const Explanation& explanation, const DepthNoise& noise, int stride) {
  const double log_evidence = c.log_likelihood - c.local_deviations;
  // Some tenths of a deviation above the table are nothing: Huber's (1964) loss.
  constexpr double deviation = 1.5, most = 5;
  const double off = std::min(std::abs(explanation.height_deviations) / deviation, most);
  const double height_loss = off < 1 ? 0.5 * off * off : off - 0.5;
  // Pixels that err together are as one.
  return log_evidence * noise.total_mm * noise.total_mm / pixel_variance_mm2(noise, stride) - height_loss;
}

std::vector<double> shares(std::span<const double> log_odds) {
  std::vector<double> out;
  if (log_odds.empty()) return out;
  const double best = *std::max_element(log_odds.begin(), log_odds.end());
  double sum = 0;
  for (const double value : log_odds) {
    out.push_back(std::exp(value - best));
    sum += out.back();
  }
  for (double& value : out) value /= sum;
  return out;
}

bool looks_the_same(const DepthImage& a, const DepthImage& b, const SensorModel& sensor) {
  constexpr double most_differing = 0.01;
  const auto limit_mm = static_cast<float>(3 * sensor.noise_mm);
  const auto found_near = [&](float z_mm, int u, int v, const DepthImage& other) {
    for (int vv = std::max(v - sensor.outline_px, 0); vv <= std::min(v + sensor.outline_px, other.height - 1); ++vv)
      for (int uu = std::max(u - sensor.outline_px, 0); uu <= std::min(u + sensor.outline_px, other.width - 1); ++uu)
        if (other.at(uu, vv) > 0 && std::abs(other.at(uu, vv) - z_mm) < limit_mm) return true;
    return false;
  };
  int seen = 0, differing = 0;
  double squared = 0;
  for (int v = 0; v < a.height; ++v)
    for (int u = 0; u < a.width; ++u) {
      const float z_a = a.at(u, v), z_b = b.at(u, v);
      if (!(z_a > 0) && !(z_b > 0)) continue;
      ++seen;
      if (z_a > 0 && z_b > 0 && std::abs(z_a - z_b) < limit_mm) {
        squared += (z_a - z_b) * (z_a - z_b);
        continue;
      }
      differing += (z_a > 0 && !found_near(z_a, u, v, b)) || (z_b > 0 && !found_near(z_b, u, v, a));
    }
  return differing <= most_differing * seen && squared <= sensor.noise_mm * sensor.noise_mm * seen;
}

double pixel_variance_mm2(const DepthNoise& noise, int stride) {
  const double slow_mm2 = std::max(noise.total_mm * noise.total_mm - noise.local_mm * noise.local_mm, 0.0);
  return noise.local_mm * noise.local_mm + slow_mm2 * std::max(alike_px / (stride * stride), 1.0);
}

double polish_damping(const DepthNoise& noise, int stride, double diameter_mm) {
  constexpr double known_share = 0.02;
  return pixel_variance_mm2(noise, stride) / std::pow(known_share * diameter_mm, 2);
}

Matrix6d pose_covariance(const Matrix6d& hessian, const Eigen::Vector3d& centre_mm, const Eigen::Vector3d& middle_mm,
                         const DepthNoise& noise, int stride, double size_mm) {
  Matrix6d information = hessian / pixel_variance_mm2(noise, stride);
  information.diagonal().head<3>().array() += 1 / (std::numbers::pi * std::numbers::pi);
  information.diagonal().tail<3>().array() += 1 / (size_mm * size_mm);
  const Matrix6d about_centre = information.ldlt().solve(Matrix6d::Identity());
  // The middle moves by v + omega x (middle - centre).
  const Eigen::Vector3d arm = middle_mm - centre_mm;
  Matrix6d moved = Matrix6d::Identity();
  moved.bottomLeftCorner<3, 3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return moved * about_centre * moved.transpose();
}

}  // namespace partpose
