// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/vfh.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace partpose {

namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// atan2 to 3e-7 rad, without branches or tables so that loops over it take eight values at a time. The polynomial
/// interpolates atan(x) / x, a function of x^2, at the Chebyshev nodes of [0, 1]. Zero for y = x = 0.
inline float fast_atan2(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float larger = ax > ay ? ax : ay, smaller = ax > ay ? ay : ax;
  const float ratio = smaller / (larger > 1e-30f ? larger : 1e-30f);
  const float z = ratio * ratio;
  float p = 0.00276628346f;
  p = p * z - 0.015731249f;
  p = p * z + 0.0421376228f;
  p = p * z - 0.0745685473f;
  p = p * z + 0.106183708f;
  p = p * z - 0.141977981f;
  p = p * z + 0.199918717f;
  p = p * z - 0.333330363f;
  p = p * z + 1.f;
  float angle = p * ratio;
  angle = ay > ax ? pi / 2 - angle : angle;
  angle = x < 0 ? pi - angle : angle;
  return y < 0 ? -angle : angle;
}

/// The bin of a share of the range; a share beyond its ends, or none (NaN), counts in the first or last.
inline int bin_of(float share, int bins) {
  const float position = share * static_cast<float>(bins);
  const float last = static_cast<float>(bins - 1);
  return static_cast<int>(position > 0 ? (position < last ? position : last) : 0.f);
}

/// An angle's or a cosine's bin: PCL bins all three features over -pi to pi, so that cosines use the middle third
/// alone.
inline int angle_bin(float value) { return bin_of((value + pi) * (0.5f / pi), vfh_feature_bins); }

constexpr int block = 256;                ///< points whose bins are found before they are counted
constexpr int no_bin = vfh_feature_bins;  ///< of a pair that is left out
constexpr float distance_step_mm = 10;    ///< of distances that are not normalized

struct Bins {
  std::array<int, block> alpha, phi, theta, distance, viewpoint;
};

/// What the bins of one histogram have in common.
struct Reference {
  Eigen::Vector3f centre, normal, to_camera;
  float distance_scale;   ///< from a distance in mm to the share of 45 bins
  float distance_offset;  ///< added to the share
};

/// The bins of `count` points from `begin` on. Each point is paired with the centroid: the angles between two oriented
/// points in their Darboux frame (Rusu et al. 2009, eq. 1 to 3), which stands at the point whose normal is nearer to
/// the line between them. A pair is left out when the points coincide or the frame is undefined.
void find_bins(const OrientedPoints& points, std::size_t begin, int count, const Reference& reference, Bins& bins) {
  const float* px = points.x.data() + begin;
  const float* py = points.y.data() + begin;
  const float* pz = points.z.data() + begin;
  const float* pnx = points.normal_x.data() + begin;
  const float* pny = points.normal_y.data() + begin;
  const float* pnz = points.normal_z.data() + begin;
  const float cx = reference.centre.x(), cy = reference.centre.y(), cz = reference.centre.z();
  const float mx = reference.normal.x(), my = reference.normal.y(), mz = reference.normal.z();
  const float ex = reference.to_camera.x(), ey = reference.to_camera.y(), ez = reference.to_camera.z();
  const float scale = reference.distance_scale, offset = reference.distance_offset;
  int* alpha_bin = bins.alpha.data();
  int* phi_bin = bins.phi.data();
  int* theta_bin = bins.theta.data();
  int* distance_bin = bins.distance.data();
  int* viewpoint_bin = bins.viewpoint.data();
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const float nx = pnx[i], ny = pny[i], nz = pnz[i];
    const float dx = px[i] - cx, dy = py[i] - cy, dz = pz[i] - cz;
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    const float along_mean = mx * dx + my * dy + mz * dz, along_normal = nx * dx + ny * dy + nz * dz;
    const bool swapped = std::abs(along_mean) < std::abs(along_normal);
    const float sign = swapped ? -1.f : 1.f;  // of the line from the first point to the other
    const float ux = swapped ? nx : mx, uy = swapped ? ny : my, uz = swapped ? nz : mz;
    const float ox = swapped ? mx : nx, oy = swapped ? my : ny, oz = swapped ? mz : nz;
    const float vx = dy * uz - dz * uy, vy = dz * ux - dx * uz, vz = dx * uy - dy * ux;
    const float length = std::sqrt(vx * vx + vy * vy + vz * vz);
    const bool defined = length > 0;  // and then the distance is not 0 either
    const float over_length = sign / (defined ? length : 1.f);
    const float wx = uy * vz - uz * vy, wy = uz * vx - ux * vz, wz = ux * vy - uy * vx;
    const float phi = (vx * ox + vy * oy + vz * oz) * over_length;
    const float alpha = fast_atan2((wx * ox + wy * oy + wz * oz) * over_length, mx * nx + my * ny + mz * nz);
    const float theta = sign * (swapped ? along_normal : along_mean) / (defined ? distance : 1.f);
    const int a = angle_bin(alpha), p = angle_bin(phi), t = angle_bin(theta);
    const int d = bin_of(distance * scale + offset, vfh_feature_bins);
    alpha_bin[i] = defined ? a : no_bin;
    phi_bin[i] = defined ? p : no_bin;
    theta_bin[i] = defined ? t : no_bin;
    distance_bin[i] = defined ? d : no_bin;
    viewpoint_bin[i] = bin_of((nx * ex + ny * ey + nz * ez + 1) * 0.5f, vfh_viewpoint_bins);
  }
}

float largest_distance(const OrientedPoints& points, const Eigen::Vector3f& centre) {
  const float* px = points.x.data();
  const float* py = points.y.data();
  const float* pz = points.z.data();
  const float cx = centre.x(), cy = centre.y(), cz = centre.z();
  float largest = 0;
#pragma omp simd reduction(max : largest)
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float dx = px[i] - cx, dy = py[i] - cy, dz = pz[i] - cz;
    const float squared = dx * dx + dy * dy + dz * dz;
    largest = squared > largest ? squared : largest;
  }
  return std::sqrt(largest);
}

/// Their means; the normal's is not of unit length, as in PCL.
struct Means {
  Eigen::Vector3d centre_mm, normal;
};

double mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

Means means_of(const OrientedPoints& points) {
  return {{mean(points.x), mean(points.y), mean(points.z)},
          {mean(points.normal_x), mean(points.normal_y), mean(points.normal_z)}};
}

class Vfh final : public GlobalDescriptor {
 public:
  explicit Vfh(const VfhOptions& options) : options_(options) {}
  int bins() const override { return vfh_bins; }
  std::vector<Description> describe(const PointCloud& cloud) const override {
    const OrientedPoints points(cloud);
    if (points.size() == 0) return {};
    const auto means = means_of(points);
    return {{.histogram = vfh_about(means.centre_mm.cast<float>(), means.normal.cast<float>(), points, options_),
             .centroid_mm = means.centre_mm,
             .support = static_cast<int>(points.size())}};
  }

 private:
  VfhOptions options_;
};

}  // namespace

void VfhOptions::check() const { check_neighbours(k_nn); }

std::unique_ptr<GlobalDescriptor> make_descriptor(const VfhOptions& options) { return std::make_unique<Vfh>(options); }

OrientedPoints::OrientedPoints(const PointCloud& cloud) {
  if (cloud.empty()) return;
  if (!cloud.has_normals()) throw Error("the descriptor needs normals: estimate them first");
  for (auto* coordinate : {&x, &y, &z, &normal_x, &normal_y, &normal_z}) coordinate->resize(cloud.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f &p = cloud.points[i], &n = cloud.normals[i];
    x[count] = p.x(), y[count] = p.y(), z[count] = p.z();
    normal_x[count] = n.x(), normal_y[count] = n.y(), normal_z[count] = n.z();
    count += std::isfinite(p.x() + p.y() + p.z() + n.x() + n.y() + n.z()) ? 1 : 0;
  }
  for (auto* coordinate : {&x, &y, &z, &normal_x, &normal_y, &normal_z}) coordinate->resize(count);
}

std::vector<float> vfh(const PointCloud& cloud, const VfhOptions& options) {
  if (!cloud.has_normals()) throw Error("VFH needs a cloud with at least one point, and normals");
  const OrientedPoints points(cloud);
  if (points.size() == 0) throw Error("VFH needs a cloud with at least one point that is finite and has a normal");
  const auto means = means_of(points);
  return vfh_about(means.centre_mm.cast<float>(), means.normal.cast<float>(), points, options);
}

std::vector<float> vfh_about(const Eigen::Vector3f& centre_mm, const Eigen::Vector3f& normal,
                             const OrientedPoints& points, const VfhOptions& options) {
  // PCL's centroid has a fourth coordinate, 1, that two of its lengths take in.
  const float leak = options.leak_as_pcl ? 1 : 0;
  const float centre_length = std::sqrt(centre_mm.squaredNorm() + leak);
  Reference reference{centre_mm, normal, centre_length > 0 ? Eigen::Vector3f(-centre_mm / centre_length) : -centre_mm,
                      0, 0};
  if (options.use_normalized_distances) {
    const float farthest = largest_distance(points, centre_mm);
    const float largest = std::sqrt(farthest * farthest + leak);
    reference.distance_scale = largest > 0 ? 1 / largest : 0;
  } else {
    reference.distance_scale = 1 / (distance_step_mm * vfh_feature_bins);
    reference.distance_offset = 0.5f / vfh_feature_bins;  // round to the nearest step
  }

  // Counted in whole points first: the sums are exact whatever the order of the points.
  std::array<std::array<int, vfh_feature_bins + 1>, 4> counts{};
  std::array<int, vfh_viewpoint_bins> viewpoint_counts{};
  Bins bins;
  for (std::size_t begin = 0; begin < points.size(); begin += block) {
    const int count = static_cast<int>(std::min<std::size_t>(block, points.size() - begin));
    find_bins(points, begin, count, reference, bins);
    for (int i = 0; i < count; ++i) {
      ++counts[0][bins.alpha[i]];
      ++counts[1][bins.phi[i]];
      ++counts[2][bins.theta[i]];
      ++counts[3][bins.distance[i]];
      ++viewpoint_counts[bins.viewpoint[i]];
    }
  }
  if (!options.use_fill_size_component) counts[3].fill(0);

  // The pairs are one fewer than the points in PCL's count, which takes the centroid for one of them.
  const auto n = static_cast<double>(points.size());
  const double per_pair = options.use_normalized_bins ? 100.0 / std::max(n - 1, 1.0) : 1.0;
  const double per_point = options.use_normalized_bins ? 100.0 / n : 1.0;
  std::vector<float> histogram;
  histogram.reserve(vfh_bins);
  for (const auto& part : counts)
    for (int i = 0; i < vfh_feature_bins; ++i) histogram.push_back(static_cast<float>(part[i] * per_pair));
  for (const int c : viewpoint_counts) histogram.push_back(static_cast<float>(c * per_point));
  return histogram;
}

}  // namespace partpose
