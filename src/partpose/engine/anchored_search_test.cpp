// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/anchored_search.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/random.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace partpose {
namespace {

TEST(AnchoredHypotheses, TheTruePoseIsAmongTheFirst) {
  const PartModel model(shapes::l_bracket());
  const std::vector<const PartModel*> models = {&model};
  const Intrinsics camera{.width = 320, .height = 240, .fx = 500, .fy = 500, .cx = 159.5, .cy = 119.5};
  Random random(9);
  int right = 0;
  constexpr int frames = 8;
  for (int k = 0; k < frames; ++k) {
    const Eigen::Isometry3d truth = shapes::random_pose(random, {0, 0, 500});
    DepthImage depth = render(shapes::l_bracket(), truth, camera).depth;
    // A wall hides a third or so of it; behind the part there is another.
    for (int v = 0; v < depth.height; ++v)
      for (int u = 0; u < depth.width; ++u) {
        float& z = depth.z_mm[v * depth.width + u];
        z = u < 140 ? 300.0f : z > 0 ? z : 900.0f;
      }
    FramePiecesOptions options;
    options.largest_part_mm = options.smallest_part_mm = static_cast<float>(model.diameter_mm);
    FramePieces frame = split_frame(depth, camera, options);
    FrameObject rest;
    for (std::size_t p = 0; p < depth.z_mm.size(); ++p)
      if (depth.z_mm[p] > 301 && depth.z_mm[p] < 899) {
        frame.label[p] = 200;
        ++rest.pixels;
      }
    rest.labels.set(200);
    rest.u1 = depth.width - 1, rest.v1 = depth.height - 1;
    const auto hypotheses = anchored_hypotheses(models, frame, rest);
    for (std::size_t i = 0; i < std::min<std::size_t>(hypotheses.size(), 10); ++i) {
      const Eigen::Isometry3d off = truth.inverse() * hypotheses[i].camera_from_model;
      double farthest = 0;
      for (const auto& v : shapes::l_bracket().vertices)
        farthest = std::max(farthest, shapes::distance_to_mesh(off * v.cast<double>(), shapes::l_bracket()));
      if (farthest > 5) continue;
      ++right;
      break;
    }
  }
  EXPECT_GE(right, frames - 2);  // what is left may be one flat face
}

}  // namespace
}  // namespace partpose
