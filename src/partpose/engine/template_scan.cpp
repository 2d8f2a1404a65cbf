// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/template_scan.hpp"

#include "partpose/core/parallel.hpp"

#include <algorithm>
#include <limits>

namespace partpose {

namespace {

void keep_lowest(std::vector<Look>& looks, std::size_t count) {
  if (looks.size() <= count) return;
  std::nth_element(looks.begin(), looks.begin() + static_cast<std::ptrdiff_t>(count), looks.end());
  looks.resize(count);
}

constexpr int most_steps = SmallTemplate::cells * 255;  // of two small templates

/// How many do not exceed a limit; counted in 16 bits, as many as the numbers have, so that they are side by side.
std::size_t count_up_to(std::uint16_t limit, std::span<const std::uint16_t> numbers) {
  std::uint16_t count = 0;
  for (const std::uint16_t number : numbers) count = static_cast<std::uint16_t>(count + (number <= limit));
  return count;
}

/// The lowest limit up to `limit` that at least `count` of the numbers do not exceed, if that many do not exceed it.
std::uint16_t lowest_limit(std::uint16_t limit, std::span<const std::uint16_t> numbers, std::size_t count) {
  if (count_up_to(limit, numbers) <= count) return limit;
  std::uint16_t low = 0;
  while (low < limit) {
    const auto middle = static_cast<std::uint16_t>((low + limit) / 2);
    if (count_up_to(middle, numbers) >= count)
      limit = middle;
    else
      low = static_cast<std::uint16_t>(middle + 1);
  }
  return limit;
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
    const auto affordable = static_cast<std::uint16_t>(std::min(room + 1, static_cast<float>(most_steps)));
    const std::uint16_t limit = lowest_limit(affordable, differences, most);
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
