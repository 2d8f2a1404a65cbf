// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/template_scan.hpp"

#include "partpose/core/parallel.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace partpose {

namespace {

void keep_lowest(std::vector<Look>& looks, std::size_t count) {
  if (looks.size() <= count) return;
  std::nth_element(looks.begin(), looks.begin() + static_cast<std::ptrdiff_t>(count), looks.end());
  looks.resize(count);
}

constexpr int most_steps = 64 * 255;  // of two small templates

/// The lowest number that at least `count` of the differences do not exceed.
int limit_for(const std::vector<std::uint16_t>& differences, std::size_t count) {
  std::array<int, 256> of_high{}, of_low{};
  for (const std::uint16_t d : differences) ++of_high[d >> 8];
  int high = 0;
  std::size_t below = 0;
  while (high < 255 && below + of_high[high] < count) below += of_high[high++];
  for (const std::uint16_t d : differences) of_low[d & 255] += d >> 8 == high;
  int low = 0;
  while (low < 255 && below + of_low[low] < count) below += of_low[low++];
  return high << 8 | low;
}

/// A part's, of those that cost no more than `dearest`.
std::vector<Look> looks_of(const PartModel& model, int part, const std::vector<TurnedTemplates>& places,
                           std::size_t most, float dearest) {
  std::vector<Look> looks;
  std::vector<std::uint16_t> differences(model.views.size() * rolls);
  for (std::size_t place = 0; place < places.size(); ++place) {
    const TurnedTemplates& turned = places[place];
    const float per_step = 4 * cost_of_step(model.scale) / turned.known;  // a cell covers four
    const float room = (dearest - turned.beyond_mm2) / per_step;
    if (!(room >= 0)) continue;
    for (std::size_t v = 0; v < model.views.size(); ++v)
      capped_differences(model.small_templates[v], turned.small, model.scale.cap, &differences[v * rolls]);
    int limit = static_cast<int>(std::min(room + 1, static_cast<float>(most_steps)));
    std::size_t near = 0;
    for (const std::uint16_t d : differences) near += d <= limit;
    if (near > most) limit = std::min(limit, limit_for(differences, most));
    for (std::size_t i = 0; i < differences.size(); ++i)
      if (differences[i] <= limit)
        looks.push_back({turned.beyond_mm2 + per_step * static_cast<float>(differences[i]),
                         static_cast<std::int32_t>(part), static_cast<std::int16_t>(i / rolls),
                         static_cast<std::int8_t>(i % rolls), static_cast<std::int8_t>(place)});
  }
  keep_lowest(looks, most);
  return looks;
}

}  // namespace

float cost_of_step(const TemplateScale& scale) { return static_cast<float>(scale.cell_mm * scale.cell_mm / scale.cap); }

std::vector<Look> best_looks(std::span<const PartModel* const> models, const TurnedByScale& turned,
                             std::size_t most_per_part, std::size_t most) {
  std::vector<Look> best;
  float dearest = std::numeric_limits<float>::infinity();
  // Each round as many parts as all before: what the first cost is soon too dear for most of the others.
  constexpr std::size_t first_round = 8;
  for (std::size_t begin = 0, end; begin < models.size(); begin = end) {
    end = std::min(models.size(), std::max(2 * begin, first_round));
    std::vector<std::vector<Look>> of_part(end - begin);
    parallel_for(of_part.size(), [&](std::size_t i) {
      const PartModel& model = *models[begin + i];
      of_part[i] = looks_of(model, static_cast<int>(begin + i), turned.at(model.scale.cell_mm), most_per_part, dearest);
    });
    for (const auto& some : of_part) best.insert(best.end(), some.begin(), some.end());
    keep_lowest(best, most);
    if (best.size() == most && most > 0) dearest = std::max_element(best.begin(), best.end())->cost;
  }
  return best;
}

}  // namespace partpose
