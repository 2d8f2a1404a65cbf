// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"
#include "parts.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/dataset/dataset.hpp"
#include "partpose/evaluation/ambiguity.hpp"
#include "partpose/geometry/mesh_inspection.hpp"
#include "partpose/geometry/symmetry_search.hpp"
#include "partpose/io/camera_json.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/stl.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct InspectArguments {
  std::vector<fs::path> models;
  MeshReadOptions reading;
  fs::path repair, camera;
  std::string unit;
  bool json = false;
  std::optional<bool> views;  ///< by itself: a few views of a few parts, as that takes a second for each
  IcosahedronOptions icosahedron;
};

/// Parts of which views are compared without being asked to.
constexpr std::size_t few_parts = 4;

/// What is known of one part.
struct PartReport {
  MeshInspection mesh;
  std::optional<StlNormals> stored_normals;  ///< of STL files
  bool repairable = false;                   ///< not watertight, and repair makes it so
  std::optional<SymmetrySearch> symmetry;
  std::string symmetry_failure;
  std::optional<std::vector<int>> ambiguous_views;
  int views = 0;
  std::vector<std::string> warnings;
};

/// Parts of metres given as millimetres and the like, mended.
void convert(TriangleMesh& mesh, const std::string& unit) {
  static const std::vector<std::pair<std::string, double>> units = {
      {"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}, {"um", 1e-3}};
  for (const auto& [name, mm] : units)
    if (unit == name)
      for (auto& v : mesh.vertices) v = (v.cast<double>() * mm).cast<float>();
}

std::vector<std::string> warnings_of(const NamedMesh& part, const PartReport& report) {
  std::vector<std::string> out;
  const auto& mesh = report.mesh;
  if (!mesh.unit_guess.empty() && part.unit.empty()) {
    const double factor = mm_per_unit(mesh.unit_guess);
    const char* option = mesh.unit_guess == "metre" ? "m" : mesh.unit_guess == "inch" ? "in" : "um";
    out.push_back(
        fmt::format("{:.4g} mm across: is it in {}? Then it is {:.4g} mm; convert with --unit {} --repair OUT.stl",
                    mesh.diagonal_mm, plural_of_unit(mesh.unit_guess), mesh.diagonal_mm * factor, option));
  } else if (!mesh.unit_guess.empty()) {
    out.push_back(fmt::format("{:.4g} mm across by the unit that the file states ({}): is that right?",
                              mesh.diagonal_mm, part.unit));
  }
  if (!mesh.watertight)
    out.push_back(fmt::format("not watertight: {}{}", counted(mesh.open_edges, "open edge"),
                              report.repairable ? " (cracks: --repair welds them)" : ""));
  if (mesh.non_manifold_edges > 0)
    out.push_back(fmt::format("{} of more than two triangles", counted(mesh.non_manifold_edges, "edge")));
  if (mesh.flipped_triangles > 0)
    out.push_back(fmt::format(
        "{} inwards (--repair turns them)",
        mesh.flipped_triangles == 1 ? "1 triangle faces" : fmt::format("{} triangles face", mesh.flipped_triangles)));
  if (mesh.degenerate_triangles > 0)
    out.push_back(fmt::format("{} without area", counted(mesh.degenerate_triangles, "triangle")));
  if (mesh.duplicate_triangles > 0)
    out.push_back(fmt::format("{} twice (--repair removes copies)",
                              mesh.duplicate_triangles == 1
                                  ? "1 triangle is there"
                                  : fmt::format("{} triangles are there", mesh.duplicate_triangles)));
  if (report.stored_normals && report.stored_normals->missing > 0)
    out.push_back(fmt::format("{} stored without a normal (partpose uses the winding)",
                              counted(report.stored_normals->missing, "triangle")));
  if (report.stored_normals && report.stored_normals->against > 0)
    out.push_back(fmt::format("{} against the winding (partpose uses the winding)",
                              counted(report.stored_normals->against, "stored normal")));
  return out;
}

std::string text_of(const SymmetrySearch& search) {
  const auto count = [](const MeasuredSymmetries& list) {
    std::string text;
    if (const auto axes = list.symmetries.continuous.size(); axes >= 3)
      text = "a sphere's";
    else if (axes > 0)
      text = "round about an axis";
    if (const auto turns = list.symmetries.discrete.size(); turns > 0)
      text += fmt::format("{}{} turn{}", text.empty() ? "" : " and ", turns, turns == 1 ? "" : "s");
    return text;
  };
  std::string text = count(search.found);
  if (text.empty()) text = "none";
  if (const std::string near = count(search.near); !near.empty()) text += fmt::format("; but for a detail: {}", near);
  return text;
}

/// The camera for --views when none is given: a D415's at 640 x 480.
Intrinsics default_camera() {
  Intrinsics camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 615;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

void find_ambiguous_views(const NamedMesh& part, const InspectArguments& arguments, const Common& common,
                          PartReport& report) {
  const Intrinsics camera = arguments.camera.empty() ? default_camera() : read_camera(arguments.camera).intrinsics;
  const Symmetries symmetries = report.symmetry ? report.symmetry->found.symmetries : Symmetries{};
  const AmbiguitySearch search({{part.name, part.mesh, symmetries}}, camera);
  IcosahedronOptions icosahedron = arguments.icosahedron;
  if (!arguments.views) icosahedron.subdivide = 0;
  const auto views = icosahedron_views(icosahedron);
  const Progress progress = terminal_progress(common);
  std::vector<char> is_ambiguous(views.size(), 0);
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(views.size(), [&](std::size_t v) {
    is_ambiguous[v] = !search.at(0, views[v].T2 * centred_from_model(part.mesh)).empty();
    const std::lock_guard lock(mutex);
    if (progress) progress("comparing views", ++done, views.size());
  });
  report.views = static_cast<int>(views.size());
  report.ambiguous_views.emplace();
  for (std::size_t v = 0; v < views.size(); ++v)
    if (is_ambiguous[v]) report.ambiguous_views->push_back(views[v].id);
}

PartReport inspect(const NamedMesh& part, const InspectArguments& arguments, bool with_views, const Common& common) {
  PartReport report;
  report.mesh = inspect_mesh(part.mesh);
  if (lower_case_ending(part.file) == ".stl") report.stored_normals = stl_normals(part.file);
  if (!report.mesh.watertight) report.repairable = inspect_mesh(repair_mesh(part.mesh).mesh).watertight;
  try {
    report.symmetry = search_symmetries(part.mesh);
  } catch (const Error& error) {
    report.symmetry_failure = error.what();
  }
  if (with_views) find_ambiguous_views(part, arguments, common, report);
  report.warnings = warnings_of(part, report);
  return report;
}

void print(const NamedMesh& part, const PartReport& report) {
  const auto& mesh = report.mesh;
  fmt::print("  {}: {:.2f} x {:.2f} x {:.2f} mm{}, {}, {}, {}\n", part.name, mesh.size_mm[0], mesh.size_mm[1],
             mesh.size_mm[2], part.unit.empty() ? "" : fmt::format(" (file in {})", part.unit),
             counted(mesh.triangles, "triangle"), mesh.watertight ? "watertight" : "open",
             counted(mesh.shells, "shell"));
  if (mesh.volume_mm3) fmt::print("    volume     {:.6g} cm^3\n", *mesh.volume_mm3 / 1000);
  fmt::print("    symmetry   {}\n", report.symmetry ? text_of(*report.symmetry) : report.symmetry_failure);
  if (report.ambiguous_views) {
    const auto& ids = *report.ambiguous_views;
    fmt::print("    ambiguous  {} of {} views do not tell the pose{}{}\n", ids.size(), report.views,
               ids.empty() ? "" : ": ", fmt::join(ids, " "));
  } else {
    fmt::print("    ambiguous  not looked for: --views\n");
  }
  for (const auto& warning : report.warnings)
    fmt::print("    {} {}\n", coloured(stdout, Colour::yellow, "warning:"), warning);
}

Json json_of(const NamedMesh& part, const PartReport& report) {
  Json json;
  json["file"] = part.file.string();
  json["name"] = part.name;
  json["unit"] = part.unit.empty() ? Json() : Json(part.unit);
  json["mesh"] = to_json(report.mesh);
  if (report.stored_normals) json["stored_normals"] = to_json(*report.stored_normals);
  if (report.symmetry)
    json["symmetry"] = {{"found", to_json(ModelSymmetries::of(report.symmetry->found.symmetries))},
                        {"but_for_a_detail", to_json(ModelSymmetries::of(report.symmetry->near.symmetries))},
                        {"tolerance_mm", report.symmetry->tolerance_mm}};
  if (report.ambiguous_views) {
    json["views"] = report.views;
    json["ambiguous_views"] = *report.ambiguous_views;
  }
  json["warnings"] = report.warnings;
  return json;
}

void repair(const NamedMesh& part, const fs::path& file, const InspectArguments& arguments, const Common& common) {
  const MeshRepair repair = repair_mesh(part.mesh);
  write_stl(file, repair.mesh);
  if (common.quiet || arguments.json) return;
  std::vector<std::string> done;
  if (!arguments.unit.empty()) done.push_back(fmt::format("converted from {}", arguments.unit));
  if (repair.welded_vertices > 0)
    done.push_back(fmt::format("{} vertices welded within {:.2g} mm", repair.welded_vertices, repair.weld_distance_mm));
  if (repair.removed_degenerate > 0)
    done.push_back(fmt::format("{} without area removed", counted(repair.removed_degenerate, "triangle")));
  if (repair.removed_duplicates > 0) done.push_back(fmt::format("{} copies removed", repair.removed_duplicates));
  if (repair.turned_triangles > 0)
    done.push_back(fmt::format("{} turned outwards", counted(repair.turned_triangles, "triangle")));
  const auto left = inspect_mesh(repair.mesh);
  fmt::print("{}: {}; {}\n", file.string(),
             done.empty() ? "nothing to repair" : fmt::format("{}", fmt::join(done, ", ")),
             left.sound()      ? "sound"
             : left.watertight ? "watertight"
                               : fmt::format("{} open edges are left", left.open_edges));
}

/// One part into the file that --repair names, or all of them into that folder.
void repair_all(const std::vector<NamedMesh>& parts, const InspectArguments& arguments, const Common& common) {
  const fs::path& given = arguments.repair;
  if (given.has_filename() && !fs::is_directory(given)) {
    if (parts.size() != 1)
      throw Error(
          "inspect: --repair {} writes one part, there are {}; give a folder ({}/), or one file (and --split whole)",
          given.string(), parts.size(), given.string());
    repair(parts[0], given, arguments, common);
    return;
  }
  std::map<std::string, fs::path> file_of;
  for (const auto& part : parts)
    if (const auto [other, is_new] = file_of.emplace(part.name, part.file); !is_new)
      throw Error("{}: another part is already named \"{}\": {}; repair one of the two by itself", part.file.string(),
                  part.name, other->second.string());
  fs::create_directories(given);
  for (const auto& part : parts) {
    std::string name = part.name;
    std::replace(name.begin(), name.end(), '/', '_');  // a CAD program lets a part be called anything
    const fs::path file = given / (name + ".stl");
    std::error_code ignored;
    if (fs::equivalent(file, part.file, ignored))
      throw Error("{}: --repair would write over the file itself; give another folder", file.string());
    repair(part, file, arguments, common);
  }
}

void inspect_all(const InspectArguments& arguments, const Common& common) {
  arguments.icosahedron.check();
  arguments.reading.check();
  Json all = {{"parts", Json::array()}, {"broken", Json::array()}};
  std::size_t good_parts = 0, good_files = 0;
  std::vector<NamedMesh> repairable;
  std::vector<fs::path> files;
  for (const auto& given : arguments.models) {
    // What is no file at all is one of the broken ones here: the others are looked at all the same.
    try {
      const auto found = model_files(given);
      files.insert(files.end(), found.begin(), found.end());
    } catch (const Error&) {
      if (fs::is_directory(given)) throw;
      files.push_back(given);
    }
  }
  for (const auto& file : files) {
    try {
      auto parts = read_mesh_file(file, arguments.reading);
      if (!arguments.json) fmt::print("{}: {} part{}\n", file.string(), parts.size(), parts.size() == 1 ? "" : "s");
      for (auto& part : parts) {
        convert(part.mesh, arguments.unit);
        const bool few = files.size() + parts.size() - 1 <= few_parts;
        const PartReport report = inspect(part, arguments, arguments.views.value_or(few), common);
        if (arguments.json)
          all["parts"].push_back(json_of(part, report));
        else
          print(part, report);
        ++good_parts;
        if (!arguments.repair.empty()) repairable.push_back(std::move(part));
      }
      ++good_files;
    } catch (const Error& error) {
      ++common.failures;
      const std::string message = std::string(error.what()).starts_with(file.string())
                                      ? error.what()
                                      : fmt::format("{}: {}", file.string(), error.what());
      if (arguments.json) all["broken"].push_back({{"file", file.string()}, {"error", message}});
      complain(message);
    }
  }
  if (!arguments.repair.empty()) repair_all(repairable, arguments, common);
  if (arguments.json)
    print_json(all);
  else if (!common.quiet && files.size() > 1)
    fmt::print("{}: {} good with {}, {} broken\n", counted(files.size(), "file"), good_files,
               counted(good_parts, "part"), files.size() - good_files);
}

}  // namespace

void add_inspect_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<InspectArguments>();
  auto* inspect = app.add_subcommand("inspect", "Say what to know before trusting a model: size, unit, gaps, symmetry");
  inspect->add_option("models", arguments->models, part_files_help)->required();
  inspect->add_option(
      "--repair", arguments->repair,
      "Write the part, repaired as far as its shape stays, as STL here; into a folder (FOLDER/) all parts");
  inspect->add_option("--unit", arguments->unit, "Take the coordinates read for this unit: mm, cm, m, in or um")
      ->check(CLI::IsMember({"mm", "cm", "m", "in", "um"}));
  auto* views = inspect->add_flag_callback(
      "--views", [arguments] { arguments->views = true; },
      fmt::format("Find the views that do not tell the pose, some seconds a part (by itself: of {} parts at most, 12 "
                  "views each)",
                  few_parts));
  inspect
      ->add_flag_callback(
          "--no-views", [arguments] { arguments->views = false; }, "Do not look for them")
      ->excludes(views);
  inspect->add_option("--camera", arguments->camera,
                      "Camera JSON for --views (default: 640 x 480, focal length 615 px)");
  inspect->add_option("--distance", arguments->icosahedron.capture_distance_mm, "From the camera for --views [mm]")
      ->capture_default_str();
  inspect->add_option("--subdivide", arguments->icosahedron.subdivide, "12, 42, 162, ... views for 0, 1, 2, ...")
      ->capture_default_str();
  inspect->add_flag("--json", arguments->json, "Print it all as JSON");
  add_reading_options(*inspect, arguments->reading);
  inspect->footer(
      "Examples:\n"
      "  partpose inspect parts/flange.stl\n"
      "  partpose inspect parts/ --views                       # also the views that do not tell the pose, of all "
      "parts\n"
      "  partpose inspect motor.step --split solid --chord-tolerance 0.02\n"
      "  partpose inspect part_in_inches.stl --unit in --repair part.stl\n"
      "  partpose inspect parts/ --repair repaired/\n"
      "Exit codes: 0 all files can be used (warnings or not), 2 a file cannot be read, or bad usage. The good files "
      "are\n"
      "inspected in any case.");
  inspect->callback([arguments, &common] { inspect_all(*arguments, common); });
}

}  // namespace partpose::apps
