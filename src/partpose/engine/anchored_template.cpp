// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/anchored_template.hpp"

#include "partpose/descriptor/crh.hpp"

#include <algorithm>
#include <bit>
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
    anchors.push_back({(sight_from_camera * camera_from_model).cast<float>(), static_cast<std::int16_t>(view),
                       cells_with_surface(templates.back())});
  }
}

SceneCells::SceneCells(const SmallTemplate& scene, int cap) {
  for (int i = 0; i < SmallTemplate::cells; ++i) {
    const int y = scene.cell[i];
    const bool is_unknown = y == SmallTemplate::unknown;
    lower[i] = static_cast<std::uint8_t>(is_unknown ? 0 : y);
    upper[i] = static_cast<std::uint8_t>(is_unknown ? 0 : std::min(y + cap, 255));
  }
}

void explained_steps(const SmallTemplate& model, std::span<const SceneCells> scenes, std::uint32_t wanted, int cap,
                     std::int16_t* out) {
  constexpr int cells = SmallTemplate::cells;
  // Where the model has no surface, no scene is farther than `lower`, nor nearer than `upper`.
  static_assert(SmallTemplate::background == 255);
#ifdef __AVX2__
  static_assert(cells == 64);
  const __m256i limit = _mm256_set1_epi8(static_cast<char>(cap)), zero = _mm256_setzero_si256();
  const __m256i background = _mm256_set1_epi8(static_cast<char>(SmallTemplate::background));
  const auto half = [](const std::array<std::uint8_t, cells>& of, int k) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(&of[32 * k]));
  };
  const __m256i lower_0 = half(model.cell, 0), lower_1 = half(model.cell, 1);
  const __m256i empty_0 = _mm256_cmpeq_epi8(lower_0, background), empty_1 = _mm256_cmpeq_epi8(lower_1, background);
  const __m256i upper_0 = _mm256_andnot_si256(empty_0, _mm256_adds_epu8(lower_0, limit));
  const __m256i upper_1 = _mm256_andnot_si256(empty_1, _mm256_adds_epu8(lower_1, limit));
  const auto count = [](const __m256i& mask) {
    return std::popcount(static_cast<std::uint32_t>(_mm256_movemask_epi8(mask)));
  };
  const int most = cap * (cells - count(empty_0) - count(empty_1));
  const auto capped = [&](const __m256i& a, const __m256i& b) {
    return _mm256_min_epu8(_mm256_subs_epu8(a, b), limit);
  };
  /// Four sums, each in the low 16 bits of 64.
  const auto costs = [&](const SceneCells& scene) {
    const __m256i farther =
        _mm256_add_epi8(capped(half(scene.lower, 0), lower_0), capped(half(scene.lower, 1), lower_1));
    const __m256i nearer =
        _mm256_add_epi8(capped(upper_0, half(scene.upper, 0)), capped(upper_1, half(scene.upper, 1)));
    return _mm256_sad_epu8(_mm256_add_epi8(nearer, _mm256_add_epi8(farther, farther)), zero);
  };
  std::size_t i = 0;
  for (; i + 4 <= scenes.size(); i += 4) {
    if ((wanted >> i & 15) == 0) continue;
    const __m256i first = _mm256_or_si256(costs(scenes[i]), _mm256_slli_epi64(costs(scenes[i + 1]), 16));
    const __m256i second = _mm256_or_si256(costs(scenes[i + 2]), _mm256_slli_epi64(costs(scenes[i + 3]), 16));
    const __m256i four = _mm256_or_si256(first, _mm256_slli_epi64(second, 32));
    const __m128i halves = _mm_add_epi16(_mm256_castsi256_si128(four), _mm256_extracti128_si256(four, 1));
    const __m128i cost = _mm_add_epi16(halves, _mm_unpackhi_epi64(halves, halves));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(out + i),
                     _mm_sub_epi16(_mm_set1_epi16(static_cast<short>(most)), cost));
  }
  for (; i < scenes.size(); ++i) {
    const __m256i four = costs(scenes[i]);
    const __m128i halves = _mm_add_epi16(_mm256_castsi256_si128(four), _mm256_extracti128_si256(four, 1));
    out[i] =
        static_cast<std::int16_t>(most - _mm_cvtsi128_si32(_mm_add_epi16(halves, _mm_unpackhi_epi64(halves, halves))));
  }
#else
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    if ((wanted >> k & 1) == 0) continue;
    int steps = 0;
    for (int i = 0; i < cells; ++i) {
      const bool is_surface = model.cell[i] != SmallTemplate::background;
      const int lower = model.cell[i], upper = is_surface ? lower + cap : 0;
      steps += (is_surface ? cap : 0) - 2 * std::clamp(scenes[k].lower[i] - lower, 0, cap) -
               std::clamp(upper - scenes[k].upper[i], 0, cap);
    }
    out[k] = static_cast<std::int16_t>(steps);
  }
#endif
}

int explained_steps(const SmallTemplate& model, const SmallTemplate& scene, int cap) {
  const SceneCells cells(scene, cap);
  std::int16_t steps = 0;
  explained_steps(model, {&cells, 1}, 1, cap, &steps);
  return steps;
}

}  // namespace partpose
