// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/synthesis/scene_picture.hpp"

#include <algorithm>
#include <array>

namespace partpose {

namespace {

Eigen::Vector3f colour_of(const SyntheticScene& scene, int piece) {
  static const std::array<Eigen::Vector3f, 6> bright = {
      Eigen::Vector3f{230, 90, 70}, {80, 160, 230}, {100, 200, 100}, {230, 200, 80}, {170, 120, 60}, {90, 210, 210}};
  switch (scene.pieces[piece].kind) {
    case ScenePiece::Kind::part:
      return bright[piece % bright.size()];
    case ScenePiece::Kind::unknown_part:
      return {255, 80, 255};
    case ScenePiece::Kind::clutter:
      return {120, 110, 90};
    case ScenePiece::Kind::occluder:
      return {70, 70, 70};
    case ScenePiece::Kind::table:
      return {200, 195, 185};
    case ScenePiece::Kind::floor:
      return {110, 115, 130};
  }
  return {255, 255, 255};
}

}  // namespace

ColourImage picture_of(const SyntheticScene& scene) {
  const DepthImage& depth = scene.depth;
  ColourImage out{depth.width, depth.height, {}};
  out.pixels.assign(depth.z_mm.size(), {20, 20, 30});
  const Eigen::Vector3f up = scene.camera_from_table.linear().col(2).cast<float>();
  const Eigen::Vector3f lamp = Eigen::Vector3f(0.6f, -0.3f, -0.74f).normalized();  // beside the camera
  for (int v = 0; v + 1 < depth.height; ++v)
    for (int u = 0; u + 1 < depth.width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * depth.width + u;
      const int piece = scene.piece_at[p];
      if (piece < 0 || depth.at(u + 1, v) <= 0 || depth.at(u, v + 1) <= 0) continue;
      const auto at = [&](int x, int y) { return scene.intrinsics.unproject(x, y, depth.at(x, y)); };
      Eigen::Vector3f normal = (at(u + 1, v) - at(u, v)).cross(at(u, v + 1) - at(u, v)).normalized();
      if (normal.z() > 0) normal = -normal;
      const float light = 0.35f + 0.4f * std::max(0.0f, normal.dot(up)) + 0.25f * std::max(0.0f, normal.dot(lamp));
      const Eigen::Vector3f colour = light * colour_of(scene, piece);
      for (int k = 0; k < 3; ++k) out.pixels[p][k] = static_cast<std::uint8_t>(std::clamp(colour[k], 0.0f, 255.0f));
    }
  return out;
}

}  // namespace partpose
