// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/template_scan.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace partpose {
namespace {

TEST(TemplateScan, FindsTheSameAsAllComparedWithAll) {
  // More parts than are looked at in the first two rounds, of two sizes, about two places.
  Random random(2);
  std::vector<PartModel> parts;
  for (int i = 0; i < 19; ++i)
    parts.emplace_back(shapes::box(Eigen::Vector3f(i % 2 ? 90 : 40, 12 + static_cast<float>(i), 20)));
  TurnedByScale turned;
  for (const auto& part : parts) {
    auto& places = turned[part.scale.cell_mm];
    if (!places.empty()) continue;
    for (int place = 0; place < 2; ++place) {
      TurnedTemplates templates;
      templates.known = place == 1 ? 0.9f : 1;
      templates.beyond_mm2 = static_cast<float>(10 * place);
      for (int k = 0; k < rolls; ++k) {
        templates.small.push_back(parts[3].small_templates[5 * k + place]);
        if (place == 1) templates.small.back().cell[random.below(64)] = SmallTemplate::unknown;
      }
      places.push_back(templates);
    }
  }
  std::vector<const PartModel*> models;
  for (const auto& part : parts) models.push_back(&part);
  constexpr std::size_t of_each = 40, most = 150;
  std::vector<Look> expected;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const PartModel& model = parts[part];
    std::vector<Look> looks;
    const auto& places = turned.at(model.scale.cell_mm);
    for (std::size_t place = 0; place < places.size(); ++place)
      for (std::size_t v = 0; v < model.views.size(); ++v)
        for (int k = 0; k < rolls; ++k) {
          const int steps = capped_difference(model.small_templates[v], places[place].small[k], model.scale.cap);
          const float per_step = 4 * cost_of_step(model.scale) / places[place].known;
          looks.push_back({places[place].beyond_mm2 + per_step * static_cast<float>(steps),
                           static_cast<std::int32_t>(part), static_cast<std::int16_t>(v), static_cast<std::int8_t>(k),
                           static_cast<std::int8_t>(place)});
        }
    std::sort(looks.begin(), looks.end());
    expected.insert(expected.end(), looks.begin(), looks.begin() + of_each);
  }
  std::sort(expected.begin(), expected.end());
  expected.resize(most);
  std::vector<Look> found = best_looks(models, turned, of_each, most);
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found.size(), most);
  for (std::size_t i = 0; i < most; ++i) EXPECT_FALSE(found[i] < expected[i] || expected[i] < found[i]) << i;
}

}  // namespace
}  // namespace partpose
