// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"
#include "parts.hpp"
#include "terminal.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/dataset/dataset.hpp"
#include "partpose/evaluation/ambiguity.hpp"
#include "partpose/geometry/symmetry_search.hpp"
#include "partpose/io/camera_json.hpp"

#include <CLI/CLI.hpp>

#include <map>
#include <memory>
#include <mutex>
#include <optional>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct AmbiguityArguments {
  std::vector<fs::path> models;
  MeshReadOptions reading;
  fs::path camera, jsonl;
  bool json = false;
  IcosahedronOptions views;
  AmbiguitySearch::Options options;
};

void list(const AmbiguityArguments& arguments, const Common& common) {
  arguments.views.check();
  check_file_can_be_written(arguments.jsonl);
  std::vector<AmbiguityPart> parts;
  for (auto& part : read_parts(arguments.models, arguments.reading, common))
    parts.push_back({part.name, part.mesh, search_symmetries(part.mesh).found.symmetries});
  const AmbiguitySearch search(parts, read_camera(arguments.camera).intrinsics, arguments.options);
  const auto views = icosahedron_views(arguments.views);
  std::vector<std::vector<AmbiguousPose>> found(parts.size() * views.size());
  const auto pose_of = [&](std::size_t part, std::size_t view) {
    return Eigen::Isometry3d(views[view].T2 * centred_from_model(parts[part].mesh));
  };
  const Progress progress = terminal_progress(common);
  std::mutex progress_mutex;
  std::size_t done = 0;
  parallel_for(found.size(), [&](std::size_t i) {
    found[i] = search.at(static_cast<int>(i / views.size()), pose_of(i / views.size(), i % views.size()));
    const std::lock_guard lock(progress_mutex);
    if (progress) progress("comparing views", ++done, found.size());
  });

  std::optional<std::ofstream> jsonl;
  if (!arguments.jsonl.empty()) jsonl.emplace(open_for_writing(arguments.jsonl));
  Json all = Json::object();
  std::FILE* out = is_standard_output(arguments.jsonl) ? stderr : stdout;
  if (!arguments.json)
    fmt::print(out, "{:<24} {:>6} {:>15} {:>11}  {}\n", "part", "views", "pose ambiguous", "most poses",
               "views like another part");
  for (std::size_t p = 0; p < parts.size(); ++p) {
    int ambiguous = 0, most = 0;
    std::map<std::string, int> others;
    for (std::size_t v = 0; v < views.size(); ++v) {
      int own = 0;
      std::map<std::string, int> here;
      for (const auto& pose : found[p * views.size() + v]) {
        pose.part == static_cast<int>(p) ? void(++own) : void(here[parts[pose.part].name] = 1);
        if (!jsonl) continue;
        Json line;
        line["model_name"] = parts[p].name;
        line["view_id"] = views[v].id;
        line["T"] = to_json(pose_of(p, v));
        line["other_model_name"] = parts[pose.part].name;
        line["other_T"] = to_json(pose.camera_from_model);
        line["differing_share"] = pose.difference.share();
        line["rms_sigmas"] = pose.difference.rms_sigmas;
        if (pose.part == static_cast<int>(p)) line["displacement_mm"] = pose.displacement_mm;
        *jsonl << json_line(line) << '\n';
      }
      ambiguous += own > 0;
      most = std::max(most, own);
      for (const auto& [name, one] : here) others[name] += one;
    }
    if (arguments.json) {
      all[parts[p].name] = {{"views", views.size()},
                            {"pose_ambiguous", ambiguous},
                            {"most_poses", most},
                            {"views_like_another_part", others}};
      continue;
    }
    std::string text;
    for (const auto& [name, count] : others) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
    fmt::print(out, "{:<24} {:>6} {:>8} ({:3.0f} %) {:>11}  {}\n", parts[p].name, views.size(), ambiguous,
               100.0 * ambiguous / static_cast<double>(views.size()), most, text);
  }
  if (arguments.json) print_json(all);
}

}  // namespace

void add_ambiguity_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<AmbiguityArguments>();
  auto* ambiguity =
      app.add_subcommand("ambiguity", "Find the views of parts that do not tell the pose, or the part, to a camera");
  ambiguity->add_option("models", arguments->models, part_files_help)->required();
  add_reading_options(*ambiguity, arguments->reading);
  ambiguity->add_option("--camera", arguments->camera, "Camera JSON")->required();
  ambiguity->add_option("--distance", arguments->views.capture_distance_mm, "From the camera to the part's centre [mm]")
      ->capture_default_str();
  ambiguity->add_option("--subdivide", arguments->views.subdivide, "12, 42, 162, ... views for 0, 1, 2, ...")
      ->capture_default_str();
  auto& noise = arguments->options.difference;
  ambiguity->add_option("--disparity-noise", noise.disparity_sigma_px, "Standard deviation of the disparity [px]")
      ->capture_default_str();
  ambiguity->add_option("--baseline", noise.baseline_mm, "Of the stereo camera [mm]")->capture_default_str();
  ambiguity->add_option("--noise-floor", noise.floor_mm, "Standard deviation of the depth at any distance [mm]")
      ->capture_default_str();
  ambiguity->add_flag("--json", arguments->json, "Print the table as JSON");
  ambiguity->add_option("--jsonl", arguments->jsonl, "Write each pose found as a line of JSON (-: standard output)");
  ambiguity->footer(
      "Example:\n  partpose ambiguity parts/keyed_shaft.stl parts/link.stl --camera scenes/link.camera.json");
  ambiguity->callback([arguments, &common] { list(*arguments, common); });
}

}  // namespace partpose::apps
