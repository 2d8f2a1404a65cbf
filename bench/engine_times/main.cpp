// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// Times the Engine on full frames of the stereo model, one frame after the other: everything after PNG decoding.
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/engine/engine.hpp"
#include "partpose/evaluation/plot.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/synthesis/bop_scenes.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <utility>

namespace partpose {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> models;
  std::size_t parts = 0;
  std::size_t frames = 100, rounds = 1;
  int threads = 1;
  int width = 640, height = 480;
  std::filesystem::path usable;
};

/// kB of a line of /proc/self/status.
double status_kb(const std::string& key) {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind(key + ":", 0) == 0) return std::stod(line.substr(key.size() + 1));
  throw Error("/proc/self/status: has no {}", key);
}

/// The same field of view at any size.
SceneDatasetOptions scenes_of(const Arguments& arguments) {
  SceneDatasetOptions options;
  const double scale = arguments.height / 480.0;
  options.scene.camera.intrinsics = {arguments.width,
                                     arguments.height,
                                     615 * scale,
                                     615 * scale,
                                     0.5 * (arguments.width - 1),
                                     0.5 * (arguments.height - 1)};
  options.scene.seed = 4011;
  return options;
}

/// Of up to 50 parts, spread evenly over the catalogue.
std::vector<DepthImage> frames_of(const std::vector<NamedMesh>& parts, const SceneDatasetOptions& options,
                                  std::size_t count) {
  std::vector<ScenePart> shown;
  const std::size_t most = std::min<std::size_t>(parts.size(), 50);
  for (std::size_t i = 0; i < most; ++i) {
    const NamedMesh& part = parts[i * parts.size() / most];
    shown.push_back({part.name, part.mesh});
  }
  const SceneGenerator generator(std::move(shown), {}, options.scene);
  const SceneSensor sensor = make_scene_sensor(options.sensor);
  std::vector<DepthImage> frames(count);
  parallel_for(count, [&](std::size_t i) { frames[i] = sensor(generator.generate(i), options.scene.seed); });
  return frames;
}

void run(const Arguments& arguments) {
  Json line;
  if (!arguments.usable.empty()) {
    // From the file to an engine that recognizes it, the fastest of three.
    double best_ms = 1e300;
    std::size_t triangles = 0;
    for (int i = 0; i < 3; ++i) {
      const Stopwatch watch;
      const auto part = read_meshes(arguments.usable);
      const Engine engine(part);
      best_ms = std::min(best_ms, watch.elapsed_ms());
      triangles = part[0].mesh.triangles.size();
    }
    line["stl"] = arguments.usable.filename().string();
    line["triangles"] = triangles;
    line["usable_ms"] = best_ms;
    fmt::print("{}\n", json_line(line));
    return;
  }
  auto parts = read_meshes(arguments.models);
  if (arguments.parts > 0) {
    if (parts.size() < arguments.parts) throw Error("--parts {}: there are {} only", arguments.parts, parts.size());
    parts.resize(arguments.parts);
  }
  const SceneDatasetOptions options = scenes_of(arguments);
  const auto frames = frames_of(parts, options, arguments.frames);

  malloc_trim(0);  // or the engine would be put where the scene generator was
  const double before_kb = status_kb("VmRSS");
  const Stopwatch setup;
  const Engine engine(parts);
  const double setup_ms = setup.elapsed_ms();
  const double after_kb = status_kb("VmRSS");
  std::size_t stated_bytes = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) stated_bytes += engine.memory_bytes(static_cast<int>(i));

  const ThreadLimit limit(arguments.threads);
  std::vector<double> times_ms;
  std::map<std::string, std::vector<double>> stages_ms;
  int recognized = 0;
  const std::size_t warm_up = std::min<std::size_t>(frames.size(), 5);
  for (std::size_t i = 0; i < arguments.rounds * frames.size() + warm_up; ++i) {
    const Stopwatch watch;
    const auto found = engine.recognize(frames[i % frames.size()], options.scene.camera.intrinsics);
    if (i < warm_up) continue;
    times_ms.push_back(watch.elapsed_ms());
    recognized += found.accepted >= 0;
    for (const auto& stage : found.stages) stages_ms[stage.tag].push_back(stage.measure_ms);
  }
  line["parts"] = parts.size();
  line["width"] = arguments.width;
  line["height"] = arguments.height;
  line["threads"] = arguments.threads;
  line["frames"] = times_ms.size();
  line["recognized"] = recognized;
  line["median_ms"] = quantile(times_ms, 0.5);
  line["p99_ms"] = quantile(times_ms, 0.99);
  // Of the frames that come to a stage: many do not come to the searches.
  for (auto& [tag, of_stage] : stages_ms)
    line["stages"][tag] = {{"frames", of_stage.size()}, {"median_ms", quantile(of_stage, 0.5)}};
  line["setup_ms_a_part"] = setup_ms / static_cast<double>(parts.size());
  line["memory_mb_a_part"] = (after_kb - before_kb) / 1000 / static_cast<double>(parts.size());
  line["memory_stated_mb_a_part"] = static_cast<double>(stated_bytes) / 1e6 / static_cast<double>(parts.size());
  line["peak_memory_mb"] = status_kb("VmHWM") / 1000;
  fmt::print("{}\n", json_line(line));
}

}  // namespace
}  // namespace partpose

int main(int argc, char** argv) {
  partpose::Arguments arguments;
  CLI::App app("Times the Engine; prints one JSON line");
  app.add_option("-m,--models", arguments.models, "Model files or folders of the catalogue");
  app.add_option("--parts", arguments.parts, "The first so many of them; 0: all");
  app.add_option("-n,--frames", arguments.frames, "Timed frames")->check(CLI::Range(1, 100000));
  app.add_option("--rounds", arguments.rounds, "So often all of them")->check(CLI::Range(1, 100000));
  app.add_option("--threads", arguments.threads, "Threads while recognizing")->check(CLI::Range(1, 1024));
  app.add_option("--width", arguments.width, "Image width [px]");
  app.add_option("--height", arguments.height, "Image height [px]");
  app.add_option("--usable", arguments.usable, "Instead: time from this model file to an engine that recognizes it");
  CLI11_PARSE(app, argc, argv);
  try {
    if (arguments.models.empty() && arguments.usable.empty()) throw partpose::Error("give --models or --usable");
    partpose::run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "bench_engine_times: " << error.what() << "\n";
    return 2;
  }
  return 0;
}
