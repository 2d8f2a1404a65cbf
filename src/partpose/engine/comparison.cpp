// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/comparison.hpp"

#include "partpose/camera/matched_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace partpose {

namespace {

constexpr float nowhere_mm = std::numeric_limits<float>::infinity();

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

/// A rendering as a camera that matches windows sees it.
DepthImage as_matched(DepthImage rendered, const SensorModel& sensor) {
  const int reach = static_cast<int>(std::lround(sensor.growth_px));
  if (reach < 1) return rendered;
  const int width = rendered.width, height = rendered.height;
  MatchedRow matched(width, reach, static_cast<float>(sensor.edge_mm));
  DepthImage along_rows(width, height);
  for (int v = 0; v < height; ++v) matched.along(&rendered.at(0, v), &along_rows.at(0, v));
  for (int v = 0; v < height; ++v)
    matched.across(&along_rows.at(0, v), &rendered.at(0, v), std::min(v, height - 1 - v));
  return rendered;
}

/// Sums over the pixels of an image within `reach` of each.
std::vector<float> box_sums(const std::vector<float>& values, int width, int height, int reach) {
  std::vector<float> columns(width + 2 * reach, 0.0f), out(values.size(), 0.0f);
  const auto add_row = [&](int v, float sign) {
    if (v < 0 || v >= height) return;
    const float* from = &values[static_cast<std::size_t>(v) * width];
#pragma omp simd
    for (int u = 0; u < width; ++u) columns[u + reach] += sign * from[u];
  };
  for (int v = 0; v < reach; ++v) add_row(v, 1);
  for (int v = 0; v < height; ++v) {
    add_row(v + reach, 1);
    add_row(v - reach - 1, -1);
    float* to = &out[static_cast<std::size_t>(v) * width];
    for (int k = 0; k <= 2 * reach; ++k)
#pragma omp simd
      for (int u = 0; u < width; ++u) to[u] += columns[u + k];
  }
  return out;
}

/// Values of an image as they differ from their mean within some pixels. Infinite ones are none.
class LocalMeans {
 public:
  /// For images that have the same pixels as this one. Nothing is known where fewer than `least_share` of those within
  /// `reach` are any.
  LocalMeans(const std::vector<float>& like, int width, int height, int reach, float least_share)
      : width_(width),
        height_(height),
        reach_(reach),
        least_(least_share * static_cast<float>((2 * reach + 1) * (2 * reach + 1))) {
    std::vector<float> known(like.size());
    for (std::size_t p = 0; p < like.size(); ++p) known[p] = like[p] < nowhere_mm ? 1.0f : 0.0f;
    counts_ = box_sums(known, width, height, reach);
  }
  std::vector<float> differences(const std::vector<float>& values) const {
    std::vector<float> known(values.size());
    for (std::size_t p = 0; p < values.size(); ++p) known[p] = values[p] < nowhere_mm ? values[p] : 0.0f;
    std::vector<float> out = box_sums(known, width_, height_, reach_);
    for (std::size_t p = 0; p < values.size(); ++p)
      out[p] = counts_[p] >= least_ ? values[p] - out[p] / counts_[p] : nowhere_mm;
    return out;
  }

 private:
  int width_, height_, reach_;
  float least_;
  std::vector<float> counts_;
};

/// Sum of the squares of deviations from their mean within `reach`, each at most nine.
double local_deviations(const std::vector<float>& deviation, int width, int height, int reach) {
  constexpr float least_share = 0.1f, most = 9;
  double sum = 0;
  for (const float local : LocalMeans(deviation, width, height, reach, least_share).differences(deviation))
    if (local < nowhere_mm) sum += std::min(local * local, most);
  return sum;
}

/// Of depths in standard deviations of the noise, infinite where they are not of both.
FineShape fine_shape_of(const std::vector<float>& measured, const std::vector<float>& part, int width, int height,
                        int reach) {
  constexpr float least_share = 0.6f;
  const LocalMeans means(measured, width, height, reach, least_share);
  const std::vector<float> of_measured = means.differences(measured), of_part = means.differences(part);
  FineShape out;
  for (std::size_t p = 0; p < of_part.size(); ++p) {
    if (!(of_part[p] < nowhere_mm)) continue;
    ++out.pixels;
    out.measured += of_measured[p] * of_measured[p];
    out.part += of_part[p] * of_part[p];
    out.common += of_measured[p] * of_part[p];
  }
  return out;
}

/// Pixels of the box of this size at (u0, v0) whose depth and that of the right or lower neighbour differ so much.
std::vector<std::uint8_t> jumps_of(const PaddedDepth& depth, int u0, int v0, int width, int height, float least_mm) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(width) * height);
  const auto jump = [&](float a, float b) {
    const float difference_mm = std::abs(a - b);  // to nothing: infinite
    return static_cast<std::uint8_t>((difference_mm > least_mm) & (difference_mm < nowhere_mm));
  };
  for (int v = 0; v < height; ++v) {
    const float *row = depth.row(v0 + v) + u0, *below = depth.row(v0 + v + 1) + u0;
    for (int u = 0; u < width; ++u)
      out[static_cast<std::size_t>(v) * width + u] = jump(row[u], row[u + 1]) | jump(row[u], below[u]);
  }
  return out;
}

}  // namespace

double FineShape::correlation() const {
  const double most = std::sqrt(measured * part);
  return most > 0 ? common / most : 0;
}

double FineShape::gain() const {
  constexpr double no_shape = 0.1;  // of a pixel
  return pixels > 0 ? std::clamp(common / (part + no_shape * pixels), -1.0, 1.5) : 0;
}

PaddedDepth::PaddedDepth(int width, int height, int reach)
    : reach_(reach),
      row_length_(width + 2 * reach + Lanes::count),
      z_mm_(static_cast<std::size_t>(row_length_) * (height + 2 * reach), nowhere_mm),
      beyond_((2 * reach + Lanes::count) / Lanes::count) {
  for (int i = 0; i < static_cast<int>(beyond_.size()) * Lanes::count; ++i)
    beyond_[i / Lanes::count].value[i % Lanes::count] = i <= 2 * reach ? 0 : nowhere_mm;
}

float PaddedDepth::smallest_difference(float z_mm, int u, int v) const {
  float smallest_mm = nowhere_mm;
  for (std::size_t k = 0; k < beyond_.size(); ++k) {
    const float* from = row(v - reach_) + u - reach_ + k * Lanes::count;
    Lanes smallest;
    std::fill_n(smallest.value, Lanes::count, nowhere_mm);
    for (int dv = -reach_; dv <= reach_; ++dv, from += row_length_)
#pragma omp simd
      for (int i = 0; i < Lanes::count; ++i) {
        const float difference = std::abs(z_mm - from[i]);
        smallest.value[i] = difference < smallest.value[i] ? difference : smallest.value[i];
      }
    for (int i = 0; i < Lanes::count; ++i) smallest.value[i] += beyond_[k].value[i];
    for (int half = Lanes::count / 2; half > 0; half /= 2)
      for (int i = 0; i < half; ++i) smallest.value[i] = std::min(smallest.value[i], smallest.value[i + half]);
    smallest_mm = std::min(smallest_mm, smallest.value[0]);
  }
  return smallest_mm;
}

DepthComparer::DepthComparer(const FrameWindow& frame, const SensorModel& sensor)
    : frame_(frame),
      sensor_(sensor),
      object_(frame.depth.width, frame.depth.height, std::max(sensor.outline_px, 1)),
      near_object_(frame.depth.z_mm.size(), 0),
      steps_per_mm_(static_cast<float>(steps / sensor.noise_mm)) {
  const int width = frame.depth.width, height = frame.depth.height, reach = std::max(sensor.outline_px, 1);
  for (int v = 0; v < height; ++v) {
    int near_to = 0;  // so far this row's pixels are marked in near_object_
    for (int u = 0; u < width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * width + u;
      if (frame.label[p] != PixelLabel::object) continue;
      object_.row(v)[u] = frame.depth.z_mm[p];
      object_box_.extend(Eigen::Vector2i(u, v));
      const int from = std::max(near_to, u - reach), to = std::min(u + reach + 1, width);
      for (int vv = std::max(v - reach, 0); vv <= std::min(v + reach, height - 1); ++vv)
        for (int uu = from; uu < to; ++uu) near_object_[static_cast<std::size_t>(vv) * width + uu] = 1;
      near_to = to;
    }
  }
  const double peak = sensor.size_mm / (std::sqrt(2 * std::numbers::pi) * sensor.noise_mm);
  for (int i = 0; i <= entries; ++i) {
    const double t = static_cast<double>(i) / steps;
    log_density_[i] =
        static_cast<float>(std::log((1 - sensor.outlier) * peak * std::exp(-0.5 * t * t) + sensor.outlier));
  }
}

void DepthComparer::count_jumps(const PaddedDepth& part, int u0, int v0, int width, int height,
                                DepthComparison& out) const {
  constexpr double share = 0.6;  // of what is an edge
  const auto least_mm = static_cast<float>(share * sensor_.edge_mm);
  const int reach = std::max(sensor_.outline_px, 1);
  const auto of_object = jumps_of(object_, u0, v0, width, height, least_mm);
  const auto of_part = jumps_of(part, 0, 0, width, height, least_mm);
  const auto any_near = [&](const std::vector<std::uint8_t>& jumps, int u, int v) {
    for (int vv = std::max(v - reach, 0); vv <= std::min(v + reach, height - 1); ++vv)
      for (int uu = std::max(u - reach, 0); uu <= std::min(u + reach, width - 1); ++uu)
        if (jumps[static_cast<std::size_t>(vv) * width + uu]) return true;
    return false;
  };
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * width + u;
      if ((!of_object[p] && !of_part[p]) || !(part.row(v)[u] < nowhere_mm && object_.row(v0 + v)[u0 + u] < nowhere_mm))
        continue;
      out.jumps += of_object[p] + of_part[p];
      out.common_jumps += (of_object[p] && any_near(of_part, u, v)) + (of_part[p] && any_near(of_object, u, v));
    }
}

DepthComparison DepthComparer::operator()(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                          const Eigen::AlignedBox2d& covered, Faces faces) const {
  const SensorModel& sensor = sensor_;
  // Only where the object or the part may be.
  Eigen::AlignedBox2i box = object_box_;
  const Eigen::Vector2d last(frame_.depth.width - 1, frame_.depth.height - 1);
  const Eigen::AlignedBox2d inside = covered.intersection(Eigen::AlignedBox2d(Eigen::Vector2d::Zero(), last));
  const int reach = std::max(sensor.outline_px, 1);
  if (!inside.isEmpty()) {
    const Eigen::AlignedBox2i part((inside.min().array().floor() - reach).cast<int>().matrix(),
                                   (inside.max().array().ceil() + reach).cast<int>().matrix());
    box.extend(part.intersection(Eigen::AlignedBox2i(Eigen::Vector2i::Zero(), last.cast<int>())));
  }
  DepthComparison out;
  if (box.isEmpty()) return out;
  const int u0 = box.min().x(), v0 = box.min().y();
  Intrinsics camera = frame_.camera;
  camera.cx -= u0, camera.cy -= v0;
  camera.width = box.sizes().x() + 1, camera.height = box.sizes().y() + 1;
  const DepthImage rendered = as_matched(render_depth(mesh, camera_from_model, camera, faces), sensor);
  PaddedDepth part(camera.width, camera.height, reach);
  for (int v = 0; v < camera.height; ++v) {
    const float* from = &rendered.z_mm[static_cast<std::size_t>(v) * camera.width];
    float* to = part.row(v);
    for (int u = 0; u < camera.width; ++u) to[u] = from[u] > 0 ? from[u] : nowhere_mm;
  }

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

  const auto is_table = [&](std::size_t p) {
    return !frame_.before_table_mm.empty() && std::abs(frame_.before_table_mm[p]) < 4 * noise_mm;
  };
  const auto edge_mm = static_cast<float>(sensor.edge_mm);
  const auto hides = [&](float model_z, std::size_t p) {
    return frame_.depth.z_mm[p] < model_z - edge_mm && !is_table(p);
  };

  // Of what lies so low that it was taken for the table the camera's waves decide whether it agrees.
  constexpr float outline_weight = 0.25f, nothing_weight = 0.5f, low_weight = 0.6f, low_agreement = 0.5f;
  const auto log_outline = static_cast<float>(std::log(0.5));
  const Outline outline(sensor);
  const std::vector<Beside> beside = beside_part(rendered, std::min(reach, Outline::most));

  constexpr float most_deviations = 6;
  const bool closer = sensor.waves_px > 0;
  std::vector<float> deviation(closer ? rendered.z_mm.size() : 0, nowhere_mm);
  std::vector<float> measured_shape = deviation, part_shape = deviation;
  float reference_mm = nowhere_mm;  // of the shapes, so that their numbers are small
  double log_likelihood = 0, soft = 0, judged = 0, near_deviations = 0;
  for (int v = 0; v < camera.height; ++v) {
    const float* part_row = part.row(v);
    const float* object_row = object_.row(v0 + v) + u0;
    for (int u = 0; u < camera.width; ++u) {
      const float model_z = part_row[u], object_z = object_row[u];
      const bool object = object_z < nowhere_mm, model = model_z < nowhere_mm;
      if (object) ++out.object;
      if (model) ++out.model;
      if (model && object) {
        const float here = std::abs(model_z - object_z);
        // Beside an edge the foreground may have won. Where the depths agree at once, the neighbours are not asked.
        const bool sure = here <= noise_mm;
        const float near = sure ? here : part.smallest_difference(object_z, u, v);
        const float agree = agreement(near);
        out.explained += agree > 0;
        out.unexplained += agree <= 0;
        soft += 2 * agree;
        judged += 2;
        if (here < most_deviations * noise_mm) {
          const float off = (object_z - model_z) / noise_mm;
          ++out.near;
          near_deviations += off * off;
          if (closer) {
            const std::size_t p = static_cast<std::size_t>(v) * camera.width + u;
            deviation[p] = off;
            if (reference_mm == nowhere_mm) reference_mm = model_z;
            measured_shape[p] = (object_z - reference_mm) / noise_mm;
            part_shape[p] = (model_z - reference_mm) / noise_mm;
          }
        }
        log_likelihood +=
            log_match + (sure ? log_density(here) : std::max(log_density(here), log_edge + log_density(near)));
      } else if (model) {
        const std::size_t p = static_cast<std::size_t>(v0 + v) * frame_.depth.width + u0 + u;
        const float measured_z = frame_.depth.z_mm[p];
        const bool measured = frame_.label[p] != PixelLabel::nothing;
        const float near = near_object_[p] ? object_.smallest_difference(model_z, u0 + u, v0 + v) : nowhere_mm;
        if (measured && std::abs(model_z - measured_z) < 4 * noise_mm) {
          // Measured, but taken for the table, as what lies low on it is: the likelier of the two.
          const float t_part = (model_z - measured_z) / noise_mm;
          const float t_table = frame_.before_table_mm.empty() ? 0 : frame_.before_table_mm[p] / noise_mm;
          const float gain = 0.5f * (std::min(t_table * t_table, 16.0f) - t_part * t_part);
          soft += low_agreement * agreement(0.5f * std::abs(model_z - measured_z));
          judged += low_weight;
          log_likelihood += std::clamp(gain, log_outlier, 3.0f);
        } else if (std::isfinite(near) && !(measured && hides(model_z, p))) {
          ++out.model_outline;
          out.narrower += measured;
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
        } else if (is_table(p)) {
          ++out.below_table;
          judged += 1;
          log_likelihood += log_outlier;
        } else {
          ++out.hidden;
          log_likelihood += log_hidden;
        }
      } else if (object) {
        const int distance = beside[static_cast<std::size_t>(v) * camera.width + u].distance;
        if (distance > 0) {
          const float near = part.smallest_difference(object_z, u, v);
          ++out.object_outline;
          soft += outline_weight * agreement(near);
          judged += outline_weight;
          log_likelihood += std::max(log_outlier, outline.log_covered(distance) + log_density(near));
        } else {
          ++out.unexplained;
          judged += 1;
          log_likelihood += log_outlier;
        }
      } else if (const Beside& near = beside[static_cast<std::size_t>(v) * camera.width + u]; near.distance > 0) {
        const float behind_mm =
            frame_.depth.z_mm[static_cast<std::size_t>(v0 + v) * frame_.depth.width + u0 + u] - near.z_mm;
        if (behind_mm < edge_mm) continue;
        log_likelihood += outline.log_free(near.distance);
      }
    }
  }
  out.soft = soft;
  out.judged = judged;
  out.near_deviations = near_deviations;
  if (closer) {
    const auto pixels = [](double px) { return std::max(1, static_cast<int>(std::lround(px))); };
    constexpr double fine = 0.375;  // of the waves
    out.local_deviations = local_deviations(deviation, camera.width, camera.height, pixels(sensor.waves_px));
    out.fine_shape =
        fine_shape_of(measured_shape, part_shape, camera.width, camera.height, pixels(fine * sensor.waves_px));
    count_jumps(part, u0, v0, camera.width, camera.height, out);
  }
  out.log_likelihood = log_likelihood;
  out.best_log_likelihood = out.object * (log_match + log_density(0));
  return out;
}

}  // namespace partpose
