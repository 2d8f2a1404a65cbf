// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/comparison.hpp"
#include "partpose/pipeline/recognition.hpp"
#include "partpose/registration/normal_equations.hpp"

#include <optional>
#include <span>
#include <vector>

namespace partpose {

/// What a comparison does not know of a part at its pose.
struct PartInFrame {
  double noise_mm = 1;              ///< standard deviation of a depth
  double local_noise_mm = 1;        ///< of what neighbouring pixels differ by
  double relief_mm = 10;            ///< of what is seen: standard deviation from its best plane
  double extent_mm = 100;           ///< of what is seen
  double diameter_mm = 100;         ///< of the part
  std::optional<double> height_mm;  ///< of its lowest place above the table; below 0 it sinks into that
};

/// Probability that the part is what is seen, by what the comparison counts alone: of poses that are still a little
/// off, to say what needs a closer look. A logistic regression (Cox 1958).
double rough_probability(const DepthComparison& comparison, const PartInFrame& part);

Explanation explanation_of(const DepthComparison& comparison, const PartInFrame& part);

/// Probability that the part is what is seen, about at this pose, by how the two explain each other alone. A logistic
/// regression (Cox 1958), whose constants tools/fit_score.py finds.
double probability_of_part(const Explanation& explanation);

/// Probabilities of poses of which one is right, by their log-odds.
std::vector<double> shares(std::span<const double> log_odds);

/// Whether two renderings are the same to a camera, but for its noise.
bool looks_the_same(const DepthImage& a, const DepthImage& b, const SensorModel& sensor);

/// What is known of the noise of depths: independent from pixel to pixel, and all of it.
struct DepthNoise {
  double local_mm = 1, total_mm = 1;
};

/// What every `stride`-th pixel errs by, as if each erred for itself.
double pixel_variance_mm2(const DepthNoise& noise, int stride);

/// By which poses of one object compete, compared on every `stride`-th pixel: the log-likelihood, once more what
/// deviates from the waves that are in all of them, both worth as many pixels as there are that err for themselves;
/// and that a part lies on the table. Needs `local_deviations`.
double pose_log_odds(const DepthComparison& comparison, const Explanation& explanation, const DepthNoise& noise,
                     int stride);

/// For `refine_projectively` from a pose that is right to about 2 % of the part's size: where every `stride`-th pixel
/// tells less than that, nothing moves. A box of which one side is seen would slide along it by what the waves make up.
double polish_damping(const DepthNoise& noise, int stride, double diameter_mm);

/// Covariance of a pose from the normal equations of its last refinement about `centre_mm`, for every `stride`-th
/// pixel; given about `middle_mm` (both camera frame): rotation vector [rad], then translation [mm]. Directions that
/// the surface leaves free have that of a pose of which nothing is known but the part's size.
Matrix6d pose_covariance(const Matrix6d& hessian, const Eigen::Vector3d& centre_mm, const Eigen::Vector3d& middle_mm,
                         const DepthNoise& noise, int stride, double size_mm);

}  // namespace partpose
