// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"
#include "terminal.hpp"

#include "partpose/camera/sensor_fit.hpp"
#include "partpose/core/error.hpp"
#include "partpose/io/camera_json.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/png.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct FitArguments {
  std::vector<fs::path> walls;
  fs::path camera, json, output;
  double baseline_mm = 0;
  std::vector<int> region_px;
};

std::string shown(const std::optional<double>& value, const char* unit) {
  return value ? fmt::format("{:.4g}{}", *value, unit) : "not told by these frames";
}

void print_for_people(const StereoSensorFit& fit) {
  fmt::print("wall                 {:.0f} mm away, tilted {:.1f} deg, {} frame{}, {} px\n", fit.distance_mm,
             fit.tilt_deg, fit.frames, fit.frames == 1 ? "" : "s", fit.pixels);
  fmt::print("fill rate            {:.1f} %\n", 100 * fit.fill_rate);
  fmt::print("plane fit RMS        {:.3f} mm\n", fit.plane_rms_mm);
  fmt::print("sub-pixel RMS        {:.4f} px\n", fit.subpixel_rms_px);
  fmt::print("disparity noise      {:.4g} px ({:.3g} mm at this distance)\n", fit.disparity_noise_px,
             fit.disparity_noise_px * fit.mm_per_px);
  fmt::print("  correlation        {:.3g} px\n", fit.correlation_px);
  fmt::print("  white share        {:.3g}\n", fit.white_share);
  fmt::print("  frozen share       {}\n", shown(fit.frozen_share, ""));
  fmt::print("  temporal           {}\n",
             fit.temporal_noise_px
                 ? fmt::format("{:.4g} px ({:.3g} mm)", *fit.temporal_noise_px, *fit.temporal_noise_mm)
                 : "not told by these frames");
  fmt::print("sub-pixel waves      {}\n", shown(fit.subpixel_wave_px, " px"));
  fmt::print("static pattern       {:.3g} % peak to peak\n", fit.static_pattern_percent);
  fmt::print("disparity step       {}\n", shown(fit.disparity_step_px, " px"));
  fmt::print("depth step           {}\n", shown(fit.depth_step_mm, " mm"));
  for (const auto& note : fit.notes) fmt::print("note: {}\n", note);
  fmt::print("\n\"noise\": {}\n", Json{{"model", "stereo"}, {"stereo", to_json(fit.stereo)}}.dump(2));
}

void fit_sensor(const FitArguments& arguments, const Common& common) {
  SensorFitOptions options;
  options.baseline_mm = arguments.baseline_mm;
  if (!arguments.region_px.empty()) std::copy_n(arguments.region_px.begin(), 4, options.region_px.begin());
  std::vector<DepthImage> frames;
  CameraFile camera;
  const Progress progress = terminal_progress(common);
  for (const auto& path : arguments.walls) {
    check_is_file(path);
    const fs::path camera_path = arguments.camera.empty() ? camera_file_of(path) : arguments.camera;
    const CameraFile own = read_camera(camera_path);
    if (frames.empty()) camera = own;
    if (to_json(own) != to_json(camera))
      throw Error("{}: its camera {} differs from the first frame's; all frames must be of one camera", path.string(),
                  camera_path.string());
    frames.push_back(read_depth_png(path, camera.depth_scale_mm));
    if (frames.back().width != camera.intrinsics.width || frames.back().height != camera.intrinsics.height)
      throw Error("{}: is {} x {} px, its camera {} says {} x {} px", path.string(), frames.back().width,
                  frames.back().height, camera_path.string(), camera.intrinsics.width, camera.intrinsics.height);
    progress("reading frames", frames.size(), arguments.walls.size());
  }
  if (options.baseline_mm == 0) options.baseline_mm = camera.baseline_mm.value_or(0);
  if (options.baseline_mm == 0)
    throw Error("sensor fit: no baseline: give --baseline MM (D415: 55), or \"baseline_mm\" in the camera JSON");
  options.depth_unit_mm = camera.depth_scale_mm;
  StereoSensorFit fit;
  try {
    fit = fit_stereo_sensor(frames, camera.intrinsics, options, progress);
  } catch (const Error& error) {
    throw Error("{}: {}", arguments.walls.front().string(), error.what());
  }
  if (!arguments.output.empty()) write_json(arguments.output, fit.stereo);
  if (!arguments.json.empty()) open_for_writing(arguments.json) << to_json(fit).dump(2) << '\n';
  if (arguments.json != "-") print_for_people(fit);
}

}  // namespace

void add_sensor_command(CLI::App& app, const Common& common) {
  auto* sensor = app.add_subcommand("sensor", "Noise figures of a depth camera");
  sensor->require_subcommand(1);
  sensor->footer("Example:\n  partpose sensor fit wall.png --camera camera.json --baseline 55");
  auto arguments = std::make_shared<FitArguments>();
  auto* fit = sensor->add_subcommand("fit", "Estimate a stereo camera's noise from captures of a flat wall");
  fit->add_option("walls", arguments->walls, "16-bit depth PNGs of one flat wall, the camera not moved between them")
      ->required();
  fit->add_option("--camera", arguments->camera,
                  "Camera JSON (default: NAME.camera.json or camera.json beside the PNG)");
  fit->add_option("--baseline", arguments->baseline_mm,
                  "Distance between the imagers in mm (default: \"baseline_mm\" of the camera JSON; D415: 55)")
      ->check(CLI::PositiveNumber);
  fit->add_option("--region", arguments->region_px, "LEFT TOP WIDTH HEIGHT of the wall in the image, px (default: all)")
      ->expected(4);
  fit->add_option("-o,--output", arguments->output, "Write the noise section \"stereo\" to this file");
  fit->add_option("--json", arguments->json, "Write all figures as JSON here (-, or no FILE: standard output)")
      ->type_name("[FILE]")
      ->expected(0, 1)
      ->default_str("-");
  fit->footer(
      "Examples:\n"
      "  partpose sensor fit wall.png --camera camera.json --baseline 55\n"
      "  partpose sensor fit wall_1.png wall_2.png wall_3.png --baseline 55   # tells static from temporal noise\n"
      "  partpose sensor fit table.png --baseline 55 --region 120 60 400 240 --json figures.json --output stereo.json\n"
      "A wall that is textured, fills the picture and is tilted by 10 to 30 deg, from the distance at which parts will "
      "lie,\n"
      "tells most. The printed section goes into \"virtual_depth_camera\" of a dataset configuration; see "
      "docs/sensor.md.");
  fit->callback([arguments, &common] { fit_sensor(*arguments, common); });
}

}  // namespace partpose::apps
