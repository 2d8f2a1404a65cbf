// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/matched_window.hpp"

#include "partpose/core/depth_image.hpp"
#include "partpose/core/random.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

TEST(MatchedWindow, KeepsAPlane) {
  const float plane[] = {500, 503, 506, 509, 512};
  EXPECT_FLOAT_EQ(matched_mean(&plane[2], 1, 2, 2, 10), 506);
}

TEST(MatchedWindow, RoundsWhatBendsAndEndsAtAnEdge) {
  const float ridge[] = {506, 503, 500, 503, 506};
  EXPECT_FLOAT_EQ(matched_mean(&ridge[2], 1, 2, 2, 100), 500 + (6.0f + 12.0f) / 5);
  const float before_an_edge[] = {500, 500, 500, 500, 600};
  EXPECT_FLOAT_EQ(matched_mean(&before_an_edge[2], 1, 2, 2, 10), 500);
  EXPECT_EQ(matched_mean(&before_an_edge[0], 1, 0, 2, 10), 500);  // no room
}

TEST(MatchedRow, IsTheMeanOfEachPixel) {
  constexpr float edge_mm = 12;
  Random random(5);
  DepthImage image(37, 9);
  for (float& z : image.z_mm) z = random.uniform() < 0.1 ? 0 : static_cast<float>(500 + 10 * random.uniform());
  for (const int reach : {1, 3}) {
    MatchedRow matched(image.width, reach, edge_mm);
    std::vector<float> along(image.width), across(image.width);
    for (int v = 0; v < image.height; ++v) {
      const int room = std::min(v, image.height - 1 - v);
      matched.along(&image.at(0, v), along.data());
      matched.across(&image.at(0, v), across.data(), room);
      for (int u = 0; u < image.width; ++u) {
        const float* pixel = &image.at(u, v);
        const int room_along = std::min(u, image.width - 1 - u);
        EXPECT_FLOAT_EQ(along[u], matched_mean(pixel, 1, room_along, reach, edge_mm)) << u << ", " << v;
        EXPECT_FLOAT_EQ(across[u], matched_mean(pixel, image.width, room, reach, edge_mm)) << u << ", " << v;
      }
    }
  }
}

}  // namespace
}  // namespace partpose
