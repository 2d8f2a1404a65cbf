// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// Draws a frame on its way through the Engine, six pictures in two rows:
//   1 what was measured          2 its pieces                       3 the object's template and the best view's
//   4 outlines of the starts     5 of the hypotheses, refined       6 what was recognized, with its deviations
#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/descriptor/crh.hpp"
#include "partpose/engine/engine.hpp"
#include "partpose/engine/hypothesis.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/io/png.hpp"
#include "partpose/pipeline/picture.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace partpose {
namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr int panel_width = 400, panel_height = 300, gap = 6;

/// A part of the frame as a camera of the panel's size.
Intrinsics cut(const Intrinsics& camera, double u0, double v0, double u1, double v1) {
  const double scale = std::max((u1 - u0) / panel_width, (v1 - v0) / panel_height);
  Intrinsics out{panel_width, panel_height, camera.fx / scale, camera.fy / scale, 0, 0};
  out.cx = (camera.cx - (u0 + u1) / 2) / scale + 0.5 * (panel_width - 1);
  out.cy = (camera.cy - (v0 + v1) / 2) / scale + 0.5 * (panel_height - 1);
  return out;
}

/// Index of the frame's pixel that a panel's pixel shows; -1 beyond the frame.
int source_of(int u, int v, const Intrinsics& panel, const Intrinsics& frame) {
  const auto x = std::lround((u - panel.cx) / panel.fx * frame.fx + frame.cx);
  const auto y = std::lround((v - panel.cy) / panel.fy * frame.fy + frame.cy);
  return x < 0 || y < 0 || x >= frame.width || y >= frame.height ? -1 : static_cast<int>(y * frame.width + x);
}

ColourImage relief(const DepthImage& depth, const Intrinsics& frame, const Intrinsics& panel) {
  DepthImage shown(panel_width, panel_height);
  for (int v = 0; v < panel_height; ++v)
    for (int u = 0; u < panel_width; ++u)
      if (const int p = source_of(u, v, panel, frame); p >= 0) shown.at(u, v) = depth.z_mm[p];
  return draw_overlay(shown, panel);
}

void draw_outline(ColourImage& image, const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                  const Intrinsics& camera, const Colour& colour) {
  const DepthImage depth = render_depth(mesh, camera_from_model, camera);
  for (int v = 1; v + 1 < camera.height; ++v)
    for (int u = 1; u + 1 < camera.width; ++u)
      if (depth.at(u, v) > 0 &&
          !(depth.at(u - 1, v) > 0 && depth.at(u + 1, v) > 0 && depth.at(u, v - 1) > 0 && depth.at(u, v + 1) > 0))
        image.pixels[static_cast<std::size_t>(v) * camera.width + u] = colour;
}

void draw_template(ColourImage& image, const DepthTemplate& cells, int u0, int side_px) {
  const int cell_px = side_px / DepthTemplate::side, v0 = (panel_height - side_px) / 2;
  for (int v = 0; v < cell_px * DepthTemplate::side; ++v)
    for (int u = 0; u < cell_px * DepthTemplate::side; ++u) {
      const std::uint8_t value = cells.cell[v / cell_px * DepthTemplate::side + u / cell_px];
      const auto grey = static_cast<std::uint8_t>(std::clamp(230 - 2 * (value - 70), 40, 230));
      image.pixels[static_cast<std::size_t>(v0 + v) * panel_width + u0 + u] =
          value == DepthTemplate::background ? Colour{20, 40, 80} : Colour{grey, grey, grey};
    }
}

/// Blue: the part lies behind what was measured, red: before it, both by two deviations; white: they agree.
void draw_deviations(ColourImage& image, const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                     const DepthImage& depth, const Intrinsics& frame, const Intrinsics& panel, double noise_mm) {
  const DepthImage rendered = render_depth(mesh, camera_from_model, panel);
  for (int v = 0; v < panel_height; ++v)
    for (int u = 0; u < panel_width; ++u) {
      const int p = source_of(u, v, panel, frame);
      if (!(rendered.at(u, v) > 0) || p < 0 || !(depth.z_mm[p] > 0)) continue;
      const double share = std::clamp((rendered.at(u, v) - depth.z_mm[p]) / (2 * noise_mm), -1.0, 1.0);
      const auto less = static_cast<std::uint8_t>(255 * (1 - std::abs(share)));
      image.pixels[static_cast<std::size_t>(v) * panel_width + u] =
          share > 0 ? Colour{less, less, 255} : Colour{255, less, less};
    }
}

void run(const std::filesystem::path& scene_file, const std::vector<std::filesystem::path>& models,
         const std::filesystem::path& output) {
  const Scene scene = read_scene(scene_file);
  if (!scene.depth) throw Error("{}: a depth image is needed", scene_file.string());
  const DepthImage& depth = *scene.depth;
  const Intrinsics& camera = *scene.intrinsics;
  const auto parts = read_meshes(models);
  const Engine engine(parts);
  const Recognition recognition = engine.recognize(depth, camera);
  if (recognition.detections.empty()) throw Error("{}: {}", scene_file.string(), recognition.reason);
  const Detection& detection = recognition.detections[0];

  std::vector<PartModel> part_models;
  FramePiecesOptions options{.largest_part_mm = 0, .smallest_part_mm = 1e6f};
  for (const auto& part : parts) {
    part_models.emplace_back(part.mesh);
    const auto size_mm = static_cast<float>(part_models.back().diameter_mm);
    options.largest_part_mm = std::max(options.largest_part_mm, size_mm);
    options.smallest_part_mm = std::min(options.smallest_part_mm, size_mm);
  }
  std::vector<const PartModel*> of;
  for (const auto& model : part_models) of.push_back(&model);
  const FramePieces pieces = split_frame(depth, camera, options);
  // The object that the detection is of: in its middle.
  const PartModel& found = part_models[detection.part];
  const Eigen::Vector2d middle = camera.project(detection.camera_from_model * found.middle_mm);
  const FrameObject* object = &pieces.objects.at(0);
  for (const auto& other : pieces.objects)
    if (!other.whole_frame && other.u0 <= middle.x() && middle.x() <= other.u1 && other.v0 <= middle.y() &&
        middle.y() <= other.v1) {
      object = &other;
      break;
    }
  const ObjectView view(pieces, *object);
  auto hypotheses = shortlist(of, view, {});
  const auto starts = hypotheses;
  refine(hypotheses, of, view, view.few, 6);
  hypotheses = best_of(std::move(hypotheses), 24, 2);
  refine(hypotheses, of, view, view.many, 8);
  hypotheses = best_of(distinct(std::move(hypotheses), of), 6, 1);

  const Intrinsics whole = cut(camera, 0, 0, camera.width, camera.height);
  const double margin = 0.15 * std::max(object->u1 - object->u0, object->v1 - object->v0) + 4;
  const Intrinsics near =
      cut(camera, object->u0 - margin, object->v0 - margin, object->u1 + margin, object->v1 + margin);
  std::vector<ColourImage> panels(6, relief(depth, camera, near));
  panels[0] = panels[1] = relief(depth, camera, whole);
  const std::array<Colour, 6> palette = {Colour{230, 120, 30}, {60, 160, 230}, {90, 190, 90},
                                         {210, 90, 190},       {230, 210, 60}, {120, 220, 220}};
  for (int v = 0; v < panel_height; ++v)
    for (int u = 0; u < panel_width; ++u) {
      const int p = source_of(u, v, whole, camera);
      if (p < 0 || pieces.label[p] < FramePieces::first_piece) continue;
      Colour& pixel = panels[1].pixels[static_cast<std::size_t>(v) * panel_width + u];
      const Colour& of_piece = palette[(pieces.label[p] - FramePieces::first_piece) % palette.size()];
      for (int k = 0; k < 3; ++k) pixel[k] = static_cast<std::uint8_t>((pixel[k] + of_piece[k]) / 2);
    }
  const Hypothesis& start = starts.at(0);
  const PartModel& start_model = part_models[start.part];
  std::vector<Eigen::Vector3f> relative;
  const Eigen::Isometry3d sight_from_camera =
      start_model.views[start.view].sight_from_model.cast<double>() * start.start.inverse();
  for (const auto& point : view.points.points_mm) relative.push_back((sight_from_camera.cast<float>() * point));
  const double spacing_mm = view.points.block_px * view.all.centre_mm().norm() / camera.fx;
  panels[2] = {panel_width, panel_height, std::vector<Colour>(panel_width * panel_height, Colour{255, 255, 255})};
  draw_template(panels[2], make_template(relative, 0, spacing_mm, start_model.scale), 4, 192);
  draw_template(panels[2], start_model.templates[start.view], 204, 192);
  for (std::size_t i = 0; i < std::min<std::size_t>(starts.size(), 24); ++i)
    draw_outline(panels[3], part_models[starts[i].part].outline, starts[i].start, near, palette[starts[i].part % 6]);
  for (const auto& h : hypotheses)
    draw_outline(panels[4], part_models[h.part].outline, h.camera_from_model, near, palette[h.part % 6]);
  draw_deviations(panels[5], found.surface, detection.camera_from_model, depth, camera, near, view.noise_mm);

  ColourImage sheet{3 * panel_width + 2 * gap, 2 * panel_height + gap, {}};
  sheet.pixels.assign(static_cast<std::size_t>(sheet.width) * sheet.height, Colour{255, 255, 255});
  for (int k = 0; k < 6; ++k)
    for (int v = 0; v < panel_height; ++v)
      for (int u = 0; u < panel_width; ++u)
        sheet.pixels[static_cast<std::size_t>(k / 3 * (panel_height + gap) + v) * sheet.width +
                     k % 3 * (panel_width + gap) + u] = panels[k].pixels[static_cast<std::size_t>(v) * panel_width + u];
  write_png(output, sheet);
  fmt::print("{}: {} by score {:.2f}\n", output.string(), engine.catalogue().parts[detection.part].name,
             detection.score);
}

}  // namespace
}  // namespace partpose

int main(int argc, char** argv) {
  std::filesystem::path scene, output;
  std::vector<std::filesystem::path> models;
  CLI::App app("Draws a frame on its way through the Engine");
  app.add_option("scene", scene, "Depth image (.png, its camera beside it)")->required();
  app.add_option("-m,--models", models, "Model files or folders of the catalogue")->required();
  app.add_option("-o,--output", output, "The picture (.png)")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    partpose::run(scene, models, output);
  } catch (const std::exception& error) {
    std::cerr << "bench_engine_picture: " << error.what() << '\n';
    return 1;
  }
}
