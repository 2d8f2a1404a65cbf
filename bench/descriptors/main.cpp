// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// Times the global descriptors against PCL 1.13's on the same rendered views, one thread each, in turns.
#include "pcl_peers.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/dataset/dataset.hpp"
#include "partpose/descriptor/descriptors.hpp"
#include "partpose/evaluation/plot.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/preprocess/preprocess.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>

namespace partpose {
namespace {

struct Arguments {
  std::filesystem::path parts = "parts";
  std::filesystem::path pipeline_config = "configs/pipeline_virtual.json";
  std::filesystem::path dataset_config = "configs/dataset_ground_truth.json";
  std::filesystem::path output;
  std::filesystem::path plot;
  int views = 100;
  int repeats = 3;
  std::vector<std::string> descriptors = descriptor_names();
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// At least `count` views, spread evenly over the parts and over the sphere of cameras, as the pipeline would describe
/// them.
std::vector<PointCloud> rendered_views(const Arguments& arguments, const GlobalPipelineConfig& config) {
  const auto dataset = read_dataset_config(arguments.dataset_config);
  const auto cameras = icosahedron_views(dataset.virtual_views_icosahedron);
  const auto models = model_files(arguments.parts);
  const std::size_t of_each = (arguments.views + models.size() - 1) / models.size();
  std::vector<PointCloud> clouds;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const auto mesh = read_stl(models[m]);
    for (std::size_t v = 0; v < of_each; ++v) {
      const auto& camera = cameras[v * cameras.size() / of_each];
      const auto view = capture(mesh, camera.T2 * centred_from_model(mesh), dataset.virtual_depth_camera, false,
                                m * cameras.size() + camera.id);
      auto cloud = with_normals(preprocess(view, config.preprocessing).cloud, config.normal_estimation);
      if (!cloud.empty()) clouds.push_back(std::move(cloud));
    }
  }
  return clouds;
}

template <typename Run>
double milliseconds(const Run& run) {
  const Stopwatch stopwatch;
  run();
  return stopwatch.elapsed_ms();
}

struct Times {
  std::vector<double> ours_ms, pcl_ms, ratio;
  int histograms = 0, pcl_histograms = 0;
};

Times time_descriptor(const std::string& name, const GlobalDescriptor& descriptor,
                      const std::vector<PointCloud>& clouds, const std::vector<PclPeers>& peers,
                      const PeerOptions& options, int repeats) {
  Times times;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    std::vector<double> ours, theirs;
    for (int r = 0; r < repeats; ++r) {
      ours.push_back(milliseconds([&] {
        const auto descriptions = descriptor.describe(clouds[i]);
        if (r == 0) times.histograms += static_cast<int>(descriptions.size());
      }));
      if (!PclPeers::has(name)) continue;
      theirs.push_back(milliseconds([&] {
        const int histograms = peers[i].run(name, options);
        if (r == 0) times.pcl_histograms += histograms;
      }));
    }
    times.ours_ms.push_back(median(ours));
    if (theirs.empty()) continue;
    times.pcl_ms.push_back(median(theirs));
    times.ratio.push_back(times.pcl_ms.back() / times.ours_ms.back());
  }
  return times;
}

template <typename Options>
PeerOptions peer_options(const Options& options) {
  return {options.min_points, options.cluster_tolerance_distance,
          static_cast<float>(radians(options.eps_angle_threshold_deg)), options.radius_normals,
          options.curvature_threshold};
}

void run(const Arguments& arguments) {
  const ThreadLimit one_thread(1);
  const auto config = read_pipeline_config(arguments.pipeline_config);
  const auto clouds = rendered_views(arguments, config);
  if (clouds.empty()) throw Error("{}: no view has any points", arguments.parts.string());
  std::vector<PclPeers> peers;
  std::vector<double> points;
  for (const auto& cloud : clouds) {
    peers.emplace_back(cloud.points[0].data(), cloud.normals[0].data(), cloud.curvatures.data(), cloud.size());
    points.push_back(static_cast<double>(cloud.size()));
  }
  const auto [fewest, most] = std::minmax_element(points.begin(), points.end());

  Json json = {{"views", clouds.size()}, {"points_median", median(points)}, {"repeats", arguments.repeats}};
  fmt::print(
      "{} views of {:.0f} to {:.0f} points (median {:.0f}), one thread, median over the views of the median of {} "
      "runs\n\n",
      clouds.size(), *fewest, *most, median(points), arguments.repeats);
  fmt::print(
      "| descriptor | partpose, ms | PCL 1.13, ms | PCL / partpose | smallest, largest ratio | histograms, PCL's |\n");
  fmt::print("|---|---|---|---|---|---|\n");
  std::vector<BoxSeries> ratios;
  for (const auto& name : arguments.descriptors) {
    std::unique_ptr<GlobalDescriptor> descriptor;
    try {
      descriptor = make_global_descriptor(name, config.descriptors);
    } catch (const Error& error) {
      fmt::print("| {} | {} | | | | |\n", name, error.what());
      continue;
    }
    const PeerOptions options =
        name == "ourcvfh" ? peer_options(config.descriptors.ourcvfh) : peer_options(config.descriptors.cvfh);
    const auto times = time_descriptor(name, *descriptor, clouds, peers, options, arguments.repeats);
    Json& entry = json["descriptors"][name];
    entry = {{"partpose_ms", times.ours_ms},
             {"partpose_median_ms", median(times.ours_ms)},
             {"histograms", times.histograms}};
    if (times.ratio.empty()) {
      fmt::print("| {} | {:.3f} | - | - | - | {} |\n", name, median(times.ours_ms), times.histograms);
      continue;
    }
    const auto [least, best] = std::minmax_element(times.ratio.begin(), times.ratio.end());
    fmt::print("| {} | {:.3f} | {:.3f} | {:.1f} | {:.1f}, {:.1f} | {}, {} |\n", name, median(times.ours_ms),
               median(times.pcl_ms), median(times.ratio), *least, *best, times.histograms, times.pcl_histograms);
    ratios.push_back({name, times.ratio});
    entry["pcl_ms"] = times.pcl_ms;
    entry["pcl_median_ms"] = median(times.pcl_ms);
    entry["ratio_median"] = median(times.ratio);
    entry["pcl_histograms"] = times.pcl_histograms;
  }
  if (!arguments.output.empty()) write_json_file(arguments.output, json);
  if (!arguments.plot.empty())
    write_file_atomically(arguments.plot,
                          box_plot_svg("Time of PCL 1.13 over time of partpose, each view", "times faster", ratios));
}

}  // namespace
}  // namespace partpose

int main(int argc, char** argv) {
  partpose::Arguments arguments;
  CLI::App app("Times the global descriptors against PCL 1.13's, one thread each, in turns on the same views.");
  app.add_option("--parts", arguments.parts, "folder of the parts' STL files")->capture_default_str();
  app.add_option("--pipeline-config", arguments.pipeline_config, "voxel, normals and options")->capture_default_str();
  app.add_option("--dataset-config", arguments.dataset_config, "virtual camera and its noise")->capture_default_str();
  app.add_option("--views", arguments.views, "at least so many, spread over the parts")->check(CLI::Range(1, 100000));
  app.add_option("--repeats", arguments.repeats, "runs of each descriptor on each view")->check(CLI::Range(1, 1000));
  app.add_option("--descriptors", arguments.descriptors, "names as in the configuration");
  app.add_option("--output", arguments.output, "JSON file with all times");
  app.add_option("--plot", arguments.plot, "SVG file with the ratios of all views");
  CLI11_PARSE(app, argc, argv);
  try {
    partpose::run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "bench_descriptors: " << error.what() << '\n';
    return 1;
  }
}
