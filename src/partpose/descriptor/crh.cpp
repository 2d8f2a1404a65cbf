// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/crh.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace partpose {

Eigen::Matrix3d sight_frame(const Eigen::Vector3d& centre_mm) {
  return Eigen::Quaterniond::FromTwoVectors(centre_mm, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

CameraRollHistogram camera_roll_histogram(const PointCloud& cloud, const Eigen::Vector3d& centre_mm) {
  if (!cloud.has_normals()) throw Error("the camera roll histogram needs a cloud with normals");
  const Eigen::Matrix3f rotation = sight_frame(centre_mm).cast<float>();
  std::array<double, crh_bins> sums{};
  double total = 0;
  for (const auto& normal : cloud.normals) {
    if (!normal.allFinite()) continue;
    const Eigen::Vector3f n = rotation * normal;
    const double weight = std::hypot(n.x(), n.y());
    const double turn = (std::atan2(n.y(), n.x()) + std::numbers::pi) / (2 * std::numbers::pi);
    sums[static_cast<int>(turn * crh_bins) % crh_bins] += weight;
    total += weight;
  }
  CameraRollHistogram histogram{};
  if (total > 0)
    for (int i = 0; i < crh_bins; ++i) histogram[i] = static_cast<float>(sums[i] / total);
  return histogram;
}

std::array<float, crh_bins> crh_spectrum(const CameraRollHistogram& histogram) {
  std::array<float, crh_bins> spectrum{};
  const auto coefficient = [&](int k) {
    std::complex<double> sum = 0;
    for (int i = 0; i < crh_bins; ++i)
      sum += static_cast<double>(histogram[i]) * std::polar(1.0, -2 * std::numbers::pi * k * i / crh_bins);
    return sum;
  };
  const double constant = coefficient(0).real();
  if (!(constant > 0)) return spectrum;
  spectrum[0] = 1;
  for (int k = 1; k < crh_bins / 2; ++k) {
    const auto c = coefficient(k) / constant;
    spectrum[2 * k - 1] = static_cast<float>(c.real());
    spectrum[2 * k] = static_cast<float>(c.imag());
  }
  spectrum[crh_bins - 1] = static_cast<float>(coefficient(crh_bins / 2).real() / constant);
  return spectrum;
}

std::vector<RollPeak> roll_peaks(const CameraRollHistogram& source, const CameraRollHistogram& target, int max_peaks) {
  // Blurred by one bin, so that noise of a bin's width does not hide a fit.
  const auto prepared = [](const CameraRollHistogram& h) {
    std::array<double, crh_bins> out;
    double mean = 0;
    for (const float value : h) mean += value / crh_bins;
    for (int i = 0; i < crh_bins; ++i)
      out[i] = 0.25 * h[(i + crh_bins - 1) % crh_bins] + 0.5 * h[i] + 0.25 * h[(i + 1) % crh_bins] - mean;
    return out;
  };
  const auto a = prepared(source), b = prepared(target);
  double energy_a = 0, energy_b = 0;
  for (int i = 0; i < crh_bins; ++i) energy_a += a[i] * a[i], energy_b += b[i] * b[i];
  // Far below the energy that a single per cent of the normals in one bin would leave.
  constexpr double no_structure = 1e-12;
  if (!(energy_a > no_structure && energy_b > no_structure)) return {RollPeak{}};
  const double scale = std::sqrt(energy_a * energy_b);

  std::array<double, crh_bins> correlation{};
  for (int shift = 0; shift < crh_bins; ++shift)
    for (int i = 0; i < crh_bins; ++i) correlation[shift] += a[i] * b[(i + shift) % crh_bins] / scale;

  std::vector<RollPeak> peaks;
  for (int shift = 0; shift < crh_bins; ++shift) {
    const double before = correlation[(shift + crh_bins - 1) % crh_bins], here = correlation[shift],
                 after = correlation[(shift + 1) % crh_bins];
    if (!(here >= before && here > after)) continue;
    const double curvature = before - 2 * here + after;
    const double offset = curvature < 0 ? 0.5 * (before - after) / curvature : 0.0;  // vertex of the parabola
    peaks.push_back({2 * std::numbers::pi * (shift + offset) / crh_bins, here});
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const auto& p, const auto& q) { return p.correlation > q.correlation; });
  if (static_cast<int>(peaks.size()) > max_peaks) peaks.resize(max_peaks);
  return peaks;
}

}  // namespace partpose
