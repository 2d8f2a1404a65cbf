// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/anchored_template.hpp"

#include "partpose/descriptor/crh.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace partpose {

std::vector<int> spread_places(std::span<const Eigen::Vector3f> points, int count) {
  constexpr std::size_t enough = 240;
  constexpr int rounds = 4;
  std::vector<int> some;
  const double step = std::max(1.0, static_cast<double>(points.size()) / enough);
  for (double i = 0.5 * step; i < static_cast<double>(points.size()); i += step) some.push_back(static_cast<int>(i));
  const int groups = std::min<int>(count, static_cast<int>(some.size()));
  if (groups == 0) return {};
  std::vector<Eigen::Vector3f> middle;
  for (int k = 0; k < groups; ++k) middle.push_back(points[some[(2 * k + 1) * some.size() / (2 * groups)]]);
  for (int round = 0; round < rounds; ++round) {
    std::vector<Eigen::Vector3f> sum(groups, Eigen::Vector3f::Zero());
    std::vector<int> members(groups, 0);
    for (const int i : some) {
      int nearest = 0;
      for (int k = 1; k < groups; ++k)
        if ((points[i] - middle[k]).squaredNorm() < (points[i] - middle[nearest]).squaredNorm()) nearest = k;
      sum[nearest] += points[i];
      ++members[nearest];
    }
    for (int k = 0; k < groups; ++k)
      if (members[k] > 0) middle[k] = sum[k] / static_cast<float>(members[k]);
  }
  std::vector<int> places;
  for (const auto& m : middle)
    places.push_back(*std::min_element(some.begin(), some.end(), [&](int a, int b) {
      return (points[a] - m).squaredNorm() < (points[b] - m).squaredNorm();
    }));
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

Eigen::Vector3d local_mean(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& place, double reach_mm) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int near = 0;
  for (const auto& p : points) {
    if ((p - place).squaredNorm() > reach_mm * reach_mm) continue;
    sum += p.cast<double>();
    ++near;
  }
  return near > 0 ? Eigen::Vector3d(sum / near) : place.cast<double>();
}

void AnchoredViews::add(int view, const PointCloud& seen, const Eigen::Isometry3d& camera_from_model, double spacing_mm,
                        const TemplateScale& scale) {
  std::vector<Eigen::Vector3f> relative(seen.size());
  for (const int place : spread_places(seen.points, per_view)) {
    const Eigen::Vector3d centre = local_mean(seen.points, seen.points[place], scale.cell_mm);
    Eigen::Isometry3d sight_from_camera = Eigen::Isometry3d::Identity();
    sight_from_camera.linear() = sight_frame(centre);
    sight_from_camera.translation() = -sight_from_camera.linear() * centre;
    const Eigen::Isometry3f turn = sight_from_camera.cast<float>();
    for (std::size_t i = 0; i < seen.size(); ++i) relative[i] = turn * seen.points[i];
    templates.push_back(halved(make_template(relative, 0, spacing_mm, scale)));
    anchors.push_back({(sight_from_camera * camera_from_model).cast<float>(), static_cast<std::int16_t>(view)});
  }
}

void explained_steps(const SmallTemplate& model, std::span<const SmallTemplate> scenes, int cap, int* out) {
#ifdef __AVX2__
  static_assert(SmallTemplate::cells == 64);
  const __m256i limit = _mm256_set1_epi8(static_cast<char>(cap)), zero = _mm256_setzero_si256();
  const __m256i unknown = _mm256_set1_epi8(static_cast<char>(SmallTemplate::unknown));
  const __m256i background = _mm256_set1_epi8(static_cast<char>(SmallTemplate::background));
  constexpr int bias = 128;  // what is signed is summed as if it were not
  const __m256i biased = _mm256_set1_epi8(static_cast<char>(bias));
  const auto half = [](const SmallTemplate& of, int k) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(&of.cell[32 * k]));
  };
  const auto gains = [&](const __m256i& x, const __m256i& is_background, const __m256i& y) {
    const __m256i farther = _mm256_min_epu8(_mm256_subs_epu8(y, x), limit);
    const __m256i nearer = _mm256_min_epu8(_mm256_subs_epu8(x, y), limit);
    const __m256i cost = _mm256_add_epi8(nearer, _mm256_add_epi8(farther, farther));
    const __m256i silent = _mm256_or_si256(is_background, _mm256_cmpeq_epi8(y, unknown));
    return _mm256_andnot_si256(silent, _mm256_sub_epi8(limit, cost));
  };
  const __m256i first = half(model, 0), second = half(model, 1);
  const __m256i first_background = _mm256_cmpeq_epi8(first, background);
  const __m256i second_background = _mm256_cmpeq_epi8(second, background);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const __m256i both = _mm256_add_epi8(gains(first, first_background, half(scenes[i], 0)),
                                         gains(second, second_background, half(scenes[i], 1)));
    const __m256i sum = _mm256_sad_epu8(_mm256_xor_si256(both, biased), zero);
    const __m128i halves = _mm_add_epi64(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1));
    out[i] = _mm_cvtsi128_si32(_mm_add_epi64(halves, _mm_unpackhi_epi64(halves, halves))) - 32 * bias;
  }
#else
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    int sum = 0;
    for (int i = 0; i < SmallTemplate::cells; ++i) {
      const int x = model.cell[i], y = scenes[k].cell[i];
      if (x == SmallTemplate::background || y == SmallTemplate::unknown) continue;
      sum += cap - std::min(std::max(x - y, 0), cap) - 2 * std::min(std::max(y - x, 0), cap);
    }
    out[k] = sum;
  }
#endif
}

int explained_steps(const SmallTemplate& model, const SmallTemplate& scene, int cap) {
  int steps = 0;
  explained_steps(model, {&scene, 1}, cap, &steps);
  return steps;
}

}  // namespace partpose
