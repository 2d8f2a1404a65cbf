// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/template_scan.hpp"

#include "partpose/core/parallel.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <map>

namespace partpose {

namespace {

void keep_lowest(std::vector<Look>& looks, std::size_t count) {
  if (looks.size() <= count) return;
  std::nth_element(looks.begin(), looks.begin() + static_cast<std::ptrdiff_t>(count), looks.end());
  looks.resize(count);
}

/// Of the object's small template at each turn.
struct SceneSets {
  std::array<CellSet, rolls> surface, known;

  explicit SceneSets(const std::vector<SmallTemplate>& small) {
    for (int k = 0; k < rolls; ++k) {
      surface[k] = cells_with_surface(small[k]);
      known[k] = 0;
      for (int i = 0; i < SmallTemplate::cells; ++i)
        known[k] |= CellSet{small[k].cell[i] != SmallTemplate::unknown} << i;
    }
  }

  /// The turns at which no more than so many cells have a surface in one template alone, each of which differs by the
  /// cap: a bit for each.
  std::uint32_t turns_within(CellSet of_view, int most_cells) const {
    std::uint32_t turns = 0;
#pragma GCC unroll 24
    for (int k = 0; k < rolls; ++k)
      turns |= std::uint32_t{std::popcount((of_view ^ surface[k]) & known[k]) <= most_cells} << k;
    return turns;
  }
};

/// The lowest limit up to a first one that so many of the numbers seen do not exceed.
class Limit {
 public:
  Limit(int first, std::size_t most) : limit_(first), most_(most), count_(static_cast<std::size_t>(first) + 1, 0) {}
  int value() const { return limit_; }
  /// Of a number that does not exceed the limit.
  void add(int number) {
    ++count_[number];
    ++seen_;
    while (limit_ > 0 && seen_ - count_[limit_] >= most_) seen_ -= count_[limit_--];
  }

 private:
  int limit_;
  std::size_t most_, seen_ = 0;
  std::vector<std::size_t> count_;  ///< of each number
};

/// The first views of a part are those from the corners of a coarser icosphere: where even of them none is affordable,
/// the others are left out.
constexpr std::size_t coarse_views = 42;

/// A part's, of those that cost no more than `dearest`.
std::vector<Look> looks_of(const PartModel& model, int part, const std::vector<TurnedTemplates>& places,
                           const std::vector<SceneSets>& sets, std::size_t most, float dearest) {
  const int cap = model.scale.cap;
  std::vector<Look> looks;
  for (std::size_t place = 0; place < places.size(); ++place) {
    const TurnedTemplates& turned = places[place];
    const float per_step = 4 * cost_of_step(model.scale) / turned.known;  // a cell covers four
    const float room = (dearest - turned.beyond_mm2) / per_step;
    if (!(room >= 0)) continue;
    Limit limit(static_cast<int>(std::min(room + 1, static_cast<float>(SmallTemplate::cells * cap))), most);
    const std::size_t before = looks.size();
    for (std::size_t v = 0; v < model.views.size(); ++v) {
      if (v == coarse_views && looks.size() == before) break;
      std::uint32_t turns = sets[place].turns_within(model.small_surfaces[v], limit.value() / cap);
      for (; turns != 0; turns &= turns - 1) {
        const int roll = std::countr_zero(turns);
        const int steps = capped_difference(model.small_templates[v], turned.small[roll], cap);
        if (steps > limit.value()) continue;
        limit.add(steps);
        looks.push_back({turned.beyond_mm2 + per_step * static_cast<float>(steps), static_cast<std::int32_t>(part),
                         static_cast<std::int16_t>(v), static_cast<std::int8_t>(roll),
                         static_cast<std::int8_t>(place)});
      }
    }
  }
  keep_lowest(looks, most);
  return looks;
}

}  // namespace

float cost_of_step(const TemplateScale& scale) { return static_cast<float>(scale.cell_mm * scale.cell_mm / scale.cap); }

std::vector<Look> best_looks(std::span<const PartModel* const> models, const TurnedByScale& turned,
                             std::size_t most_per_part, std::size_t most) {
  std::map<double, std::vector<SceneSets>> sets;  // as the templates
  for (const auto& [cell_mm, places] : turned)
    for (const auto& templates : places) sets[cell_mm].emplace_back(templates.small);
  std::vector<Look> best;
  float dearest = std::numeric_limits<float>::infinity();
  // Each round as many parts as all before: what the first cost is soon too dear for most of the others.
  constexpr std::size_t first_round = 8;
  for (std::size_t begin = 0, end; begin < models.size(); begin = end) {
    end = std::min(models.size(), std::max(2 * begin, first_round));
    std::vector<std::vector<Look>> of_part(end - begin);
    parallel_for(of_part.size(), [&](std::size_t i) {
      const PartModel& model = *models[begin + i];
      of_part[i] = looks_of(model, static_cast<int>(begin + i), turned.at(model.scale.cell_mm),
                            sets.at(model.scale.cell_mm), most_per_part, dearest);
    });
    for (const auto& some : of_part) best.insert(best.end(), some.begin(), some.end());
    keep_lowest(best, most);
    if (best.size() == most && most > 0) dearest = std::max_element(best.begin(), best.end())->cost;
  }
  return best;
}

}  // namespace partpose
