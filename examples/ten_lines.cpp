// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include <partpose/partpose.hpp>

#include <iostream>

int main() {
  using namespace partpose;
  const Recognizer recognizer(
      cached_catalogue(model_files("parts"), {}, Recognizer::catalogue_config(), default_cache_folder()));
  const Scene scene = read_scene("scenes/bracket.png");  // or your own: a DepthImage and its Intrinsics
  const Recognition found = recognizer.recognize(*scene.depth, *scene.intrinsics);
  if (found.accepted < 0) return std::cout << "nothing recognized: " << found.reason << '\n', 0;
  const Candidate& best = found.candidates[found.accepted];
  const auto& model = recognizer.catalogue().dataset.out.models[recognizer.catalogue().views[best.view_row].part];
  std::cout << model.name << ", score " << best.score << ", "
            << symmetry_transformations(model.symmetries.symmetries(), 0.1).size() << " equivalent pose(s)\n"
            << best.camera_from_model.matrix() << '\n';
}
