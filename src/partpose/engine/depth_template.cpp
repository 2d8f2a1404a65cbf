// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/depth_template.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace partpose {

TemplateScale template_scale(double diameter_mm) {
  const double size_mm = std::exp2(std::round(2 * std::log2(std::max(diameter_mm, 1e-3))) / 2);
  // 16 cells span 1.33 diameters: the centroid of what is visible may lie off the part's middle.
  TemplateScale scale;
  scale.cell_mm = size_mm / 12;
  scale.depth_unit_mm = size_mm / 160;
  scale.cap = 24;  // 15 % of the size
  return scale;
}

DepthTemplate make_template(std::span<const Eigen::Vector3f> points_mm, double roll_rad, double point_spacing_mm,
                            const TemplateScale& scale) {
  constexpr int side = DepthTemplate::side;
  constexpr float least_share = 0.35f;  // of a cell that is covered by points
  std::array<float, DepthTemplate::cells> depth_sum{};
  std::array<int, DepthTemplate::cells> count{};
  const auto per_cell = static_cast<float>(1 / scale.cell_mm);
  const float c = static_cast<float>(std::cos(roll_rad)) * per_cell;
  const float s = static_cast<float>(std::sin(roll_rad)) * per_cell;
  for (const auto& p : points_mm) {
    const int u = static_cast<int>(std::floor(c * p.x() - s * p.y())) + side / 2;
    const int v = static_cast<int>(std::floor(s * p.x() + c * p.y())) + side / 2;
    if (u < 0 || u >= side || v < 0 || v >= side) continue;
    depth_sum[v * side + u] += p.z();
    ++count[v * side + u];
  }
  const double points_per_cell = std::pow(scale.cell_mm / point_spacing_mm, 2);
  const int least = std::max(1, static_cast<int>(std::lround(least_share * points_per_cell)));
  const auto per_unit = static_cast<float>(1 / scale.depth_unit_mm);
  DepthTemplate out;
  for (int i = 0; i < DepthTemplate::cells; ++i) {
    if (count[i] < least) {
      out.cell[i] = DepthTemplate::background;
      continue;
    }
    const float steps = depth_sum[i] / static_cast<float>(count[i]) * per_unit + DepthTemplate::middle;
    out.cell[i] = static_cast<std::uint8_t>(
        std::clamp(std::round(steps), float{DepthTemplate::nearest}, float{DepthTemplate::farthest}));
  }
  return out;
}

SmallTemplate halved(const DepthTemplate& full) {
  SmallTemplate out;
  for (int v = 0; v < SmallTemplate::side; ++v)
    for (int u = 0; u < SmallTemplate::side; ++u) {
      int sum = 0, seen = 0, unknown = 0;
      for (const auto& [du, dv] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        const std::uint8_t cell = full.cell[(2 * v + dv) * DepthTemplate::side + 2 * u + du];
        unknown += cell == DepthTemplate::unknown;
        if (cell >= DepthTemplate::unknown) continue;
        sum += cell;
        ++seen;
      }
      out.cell[v * SmallTemplate::side + u] = unknown >= 2 ? SmallTemplate::unknown
                                              : seen < 2   ? SmallTemplate::background
                                                           : static_cast<std::uint8_t>((sum + seen / 2) / seen);
    }
  return out;
}

CellSet cells_with_surface(const SmallTemplate& cells) {
  static_assert(SmallTemplate::cells == 64);
  CellSet set = 0;
  for (int i = 0; i < SmallTemplate::cells; ++i) set |= CellSet{cells.cell[i] < SmallTemplate::unknown} << i;
  return set;
}

template <int side>
int capped_difference(const CellDepths<side>& a, const CellDepths<side>& b, int cap) {
#ifdef __AVX2__
  const __m256i limit = _mm256_set1_epi8(static_cast<char>(cap));
  const __m256i unknown = _mm256_set1_epi8(static_cast<char>(DepthTemplate::unknown));
  __m256i sum = _mm256_setzero_si256();
  for (int i = 0; i < CellDepths<side>::cells; i += 32) {
    const __m256i x = _mm256_load_si256(reinterpret_cast<const __m256i*>(&a.cell[i]));
    const __m256i y = _mm256_load_si256(reinterpret_cast<const __m256i*>(&b.cell[i]));
    const __m256i difference = _mm256_or_si256(_mm256_subs_epu8(x, y), _mm256_subs_epu8(y, x));
    const __m256i counted = _mm256_andnot_si256(_mm256_cmpeq_epi8(y, unknown), _mm256_min_epu8(difference, limit));
    sum = _mm256_add_epi64(sum, _mm256_sad_epu8(counted, _mm256_setzero_si256()));
  }
  const __m128i halves = _mm_add_epi64(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1));
  return static_cast<int>(_mm_cvtsi128_si64(_mm_add_epi64(halves, _mm_unpackhi_epi64(halves, halves))));
#else
  int sum = 0;
  for (int i = 0; i < CellDepths<side>::cells; ++i)
    if (b.cell[i] != DepthTemplate::unknown) sum += std::min(std::abs(int{a.cell[i]} - int{b.cell[i]}), cap);
  return sum;
#endif
}

template int capped_difference(const DepthTemplate&, const DepthTemplate&, int);
template int capped_difference(const SmallTemplate&, const SmallTemplate&, int);

}  // namespace partpose
