// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/part_outline.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(LargestLeft, WhatThePartLeavesInOnePiece) {
  const PartModel model(shapes::l_bracket());
  const std::vector<const PartModel*> models = {&model};
  Hypothesis part;
  part.part = 0;
  part.camera_from_model = Eigen::Translation3d(0, 0, 500) * Eigen::Isometry3d::Identity();
  FramePieces frame;
  frame.camera = {.width = 320, .height = 240, .fx = 500, .fy = 500, .cx = 159.5, .cy = 119.5};
  DepthImage depth = render(shapes::l_bracket(), part.camera_from_model, frame.camera).depth;
  frame.depth = &depth;
  frame.label.assign(depth.z_mm.size(), FramePieces::background);
  for (std::size_t p = 0; p < depth.z_mm.size(); ++p)
    if (depth.z_mm[p] > 0) frame.label[p] = FramePieces::first_piece;
  const auto add = [&](int u0, int v0, int width, int height) {
    for (int v = v0; v < v0 + height; ++v)
      for (int u = u0; u < u0 + width; ++u) {
        depth.at(u, v) = 480;
        frame.label[static_cast<std::size_t>(v) * depth.width + u] = FramePieces::first_piece;
      }
  };
  std::bitset<256> labels;
  labels.set(FramePieces::first_piece);
  EXPECT_EQ(largest_left_px(frame, labels, &part, models, 0.5), 0);
  add(5, 5, 4, 100);  // no wider than an outline
  EXPECT_EQ(largest_left_px(frame, labels, &part, models, 0.5), 0);
  add(280, 10, 20, 30);
  add(280, 100, 20, 20);
  EXPECT_EQ(largest_left_px(frame, labels, &part, models, 0.5), 16 * 26);
  EXPECT_GT(largest_left_px(frame, labels, nullptr, {}, 0.5), 16 * 26);
}

}  // namespace
}  // namespace partpose
