// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/picture.hpp"

#include "partpose/camera/rasterizer.hpp"

#include <algorithm>
#include <cmath>

namespace partpose {

namespace {

using Colour = std::array<std::uint8_t, 3>;

Colour scaled(const Eigen::Vector3f& rgb, float brightness) {
  const Eigen::Vector3f c = (rgb * brightness).cwiseMax(0.f).cwiseMin(255.f);
  return {static_cast<std::uint8_t>(c.x()), static_cast<std::uint8_t>(c.y()), static_cast<std::uint8_t>(c.z())};
}

/// How brightly a surface shows, lit from the camera, by the depths of the pixels two away; flat where one is missing.
float relief(const DepthImage& depth, const Intrinsics& camera, int u, int v) {
  const auto z_at = [&](int uu, int vv) {
    return depth.at(std::clamp(uu, 0, depth.width - 1), std::clamp(vv, 0, depth.height - 1));
  };
  constexpr int reach = 2;
  const float left = z_at(u - reach, v), right = z_at(u + reach, v), up = z_at(u, v - reach), down = z_at(u, v + reach);
  if (!(left > 0 && right > 0 && up > 0 && down > 0)) return 0.5f;
  const Eigen::Vector3f along_u = camera.unproject(u + reach, v, right) - camera.unproject(u - reach, v, left);
  const Eigen::Vector3f along_v = camera.unproject(u, v + reach, down) - camera.unproject(u, v - reach, up);
  const Eigen::Vector3f normal = along_u.cross(along_v).normalized();
  return 0.25f + 0.75f * std::abs(normal.dot(Eigen::Vector3f(0.3f, 0.4f, 0.87f)));
}

DepthImage enlarged(const DepthImage& depth, int factor) {
  DepthImage out(depth.width * factor, depth.height * factor);
  for (int v = 0; v < out.height; ++v)
    for (int u = 0; u < out.width; ++u) out.at(u, v) = depth.at(u / factor, v / factor);
  return out;
}

Intrinsics enlarged(const Intrinsics& camera, int factor) {
  Intrinsics out{camera.width * factor, camera.height * factor, camera.fx * factor, camera.fy * factor, 0, 0};
  out.cx = (camera.cx + 0.5) * factor - 0.5;
  out.cy = (camera.cy + 0.5) * factor - 0.5;
  return out;
}

/// So that the longer side has about 480 px.
int enlargement(const Intrinsics& camera) { return std::clamp(480 / std::max({camera.width, camera.height, 1}), 1, 6); }

void draw_scene(ColourImage& image, const DepthImage& depth, const Intrinsics& camera) {
  for (int v = 0; v < depth.height; ++v)
    for (int u = 0; u < depth.width; ++u)
      if (depth.at(u, v) > 0)
        image.pixels[static_cast<std::size_t>(v) * depth.width + u] =
            scaled({200, 205, 215}, relief(depth, camera, u, v));
}

/// Over `scene`, where no part that was drawn before is nearer: `nearest` has those.
void draw_part(ColourImage& image, DepthImage& nearest, const ColourImage& scene, const DepthImage& depth,
               const Intrinsics& camera, const PlacedMesh& part) {
  constexpr float differs_mm = 5;
  const Rendering rendering = render(part.mesh, part.camera_from_model, camera);
  const auto covered = [&](int u, int v) {
    return u >= 0 && v >= 0 && u < depth.width && v < depth.height && rendering.depth.at(u, v) > 0;
  };
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * depth.width + u;
      if (!covered(u, v) || (nearest.z_mm[p] > 0 && nearest.z_mm[p] <= rendering.depth.z_mm[p])) continue;
      nearest.z_mm[p] = rendering.depth.z_mm[p];
      if (!covered(u - 1, v) || !covered(u + 1, v) || !covered(u, v - 1) || !covered(u, v + 1)) {
        image.pixels[p] = {255, 240, 90};
        continue;
      }
      const Eigen::Vector3f normal =
          part.camera_from_model.linear().cast<float>() * part.mesh.face_normal(rendering.triangle[p]);
      const float brightness = 0.35f + 0.65f * std::abs(normal.dot(Eigen::Vector3f(0.3f, 0.4f, 0.87f)));
      Eigen::Vector3f colour(255, 140, 30);
      if (depth.at(u, v) > 0 && rendering.depth.at(u, v) < depth.at(u, v) - differs_mm) colour = {235, 40, 40};
      if (depth.at(u, v) > 0 && rendering.depth.at(u, v) > depth.at(u, v) + differs_mm) colour = {60, 110, 255};
      const auto over = scaled(colour, brightness);
      for (int c = 0; c < 3; ++c)
        image.pixels[p][c] = static_cast<std::uint8_t>(0.4 * scene.pixels[p][c] + 0.6 * over[c]);
    }
  }
}

}  // namespace

ColourImage draw_overlay(const DepthImage& depth, const Intrinsics& camera, const std::vector<PlacedMesh>& parts) {
  const int factor = enlargement(camera);
  const DepthImage large = enlarged(depth, factor);
  const Intrinsics large_camera = enlarged(camera, factor);
  ColourImage scene{large.width, large.height, {}};
  scene.pixels.assign(large.z_mm.size(), Colour{12, 12, 16});
  draw_scene(scene, large, large_camera);
  ColourImage image = scene;
  DepthImage nearest(large.width, large.height);
  for (const auto& part : parts) draw_part(image, nearest, scene, large, large_camera, part);
  return image;
}

ColourImage draw_normals(const PointCloud& cloud, const Intrinsics& camera) {
  const int factor = enlargement(camera);
  ColourImage image{camera.width * factor, camera.height * factor, {}};
  image.pixels.assign(static_cast<std::size_t>(image.width) * image.height, Colour{0, 0, 0});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector2d pixel = camera.project(cloud.points[i].cast<double>());
    const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
    if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
    const Eigen::Vector3f turned(cloud.normals[i].x(), cloud.normals[i].y(), -cloud.normals[i].z());
    const Colour colour = scaled((turned + Eigen::Vector3f::Ones()) * 127.5f, 1);
    for (int dv = 0; dv < factor; ++dv)
      for (int du = 0; du < factor; ++du)
        image.pixels[static_cast<std::size_t>(v * factor + dv) * image.width + u * factor + du] = colour;
  }
  return image;
}

ColourImage tile(const std::vector<ColourImage>& pictures, int columns) {
  ColourImage out;
  if (pictures.empty()) return out;
  const int count = static_cast<int>(pictures.size()), width = pictures[0].width, height = pictures[0].height;
  out.width = width * std::min(columns, count);
  out.height = height * ((count + columns - 1) / columns);
  out.pixels.assign(static_cast<std::size_t>(out.width) * out.height, Colour{12, 12, 16});
  for (int i = 0; i < count; ++i)
    for (int v = 0; v < height; ++v)
      std::copy_n(
          pictures[i].pixels.begin() + static_cast<std::ptrdiff_t>(v) * width, width,
          out.pixels.begin() + static_cast<std::ptrdiff_t>(i / columns * height + v) * out.width + i % columns * width);
  return out;
}

}  // namespace partpose
