// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include <partpose/partpose.hpp>

#include <iostream>

int main() {
  using namespace partpose;
  const Engine engine(read_meshes("parts"));
  const Scene scene = read_scene("scenes/bracket.png");  // or your own: a DepthImage and its Intrinsics
  const Recognition found = engine.recognize(*scene.depth, *scene.intrinsics);
  if (found.accepted < 0) return std::cout << "nothing recognized: " << found.reason << '\n', 0;
  const Detection& best = found.detections[0];
  std::cout << engine.catalogue().parts[best.part].name << ", score " << best.score << ", confidence "
            << best.confidence << ", " << best.alternatives.size() << " other pose(s) that it may be\n"
            << best.camera_from_model.matrix() << '\n';
}
