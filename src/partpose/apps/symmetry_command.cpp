// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"
#include "parts.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/dataset/model_info.hpp"
#include "partpose/io/json.hpp"

#include <CLI/CLI.hpp>

#include <memory>
#include <optional>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct SymmetryArguments {
  std::vector<fs::path> models;
  MeshReadOptions reading;
  std::optional<double> tolerance_mm;
  bool json = false;
};

std::string text_of(const Eigen::Vector3d& v, int digits) {
  const Eigen::Vector3d shown = v.unaryExpr([](double x) { return std::abs(x) < 5e-5 ? 0.0 : x; });
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", shown.x(), digits, shown.y(), digits, shown.z(), digits);
}

void print(const char* heading, const MeasuredSymmetries& list) {
  if (list.symmetries.empty()) return;
  fmt::print("  {}\n", heading);
  for (std::size_t i = 0; i < list.symmetries.continuous.size(); ++i) {
    const auto& [axis, offset_mm] = list.symmetries.continuous[i];
    fmt::print("    any turn  about {} through {} mm, off by {:.3f} mm\n", text_of(axis, 4), text_of(offset_mm, 2),
               list.continuous_deviation_mm[i]);
  }
  for (std::size_t i = 0; i < list.symmetries.discrete.size(); ++i) {
    const Eigen::Isometry3d& motion = list.symmetries.discrete[i];
    Eigen::AngleAxisd turn(motion.linear());
    // The same turn seen from the other side, so that the largest component of the axis is positive.
    int largest = 0;
    turn.axis().cwiseAbs().maxCoeff(&largest);
    if (turn.axis()[largest] < 0) turn = {-turn.angle(), -turn.axis()};
    const Eigen::Vector3d a = turn.axis();
    const Eigen::Vector3d across = motion.translation() - a * a.dot(motion.translation());
    const Eigen::Vector3d point =
        (Eigen::Matrix3d::Identity() - motion.linear() + a * a.transpose()).partialPivLu().solve(across);
    fmt::print("    {:6.1f} deg about {} through {} mm, off by {:.3f} mm\n", degrees(turn.angle()), text_of(a, 4),
               text_of(point, 2), list.discrete_deviation_mm[i]);
  }
}

void find(const SymmetryArguments& arguments, const Common& common) {
  Json all = Json::object();
  for (const auto& [name, mesh, path, unit] : read_parts(arguments.models, arguments.reading, common)) {
    const Stopwatch watch;
    SymmetrySearch search;
    try {
      search = search_symmetries(mesh, arguments.tolerance_mm);
    } catch (const Error& error) {
      throw Error("{}: {}", path.string(), error.what());
    }
    const double ms = watch.elapsed_ms();
    if (arguments.json) {
      all[name] = to_json(ModelInfo::of(name, mesh, ModelSymmetries::of(search)));
      continue;
    }
    const auto& [found, near, tolerance_mm, diameter_mm] = search;
    fmt::print("{}: {}, tolerance {:.2f} mm (diameter {:.1f} mm)", name,
               found.symmetries.empty() ? "no symmetry" : "symmetric", tolerance_mm, diameter_mm);
    if (!common.quiet) fmt::print(", {:.0f} ms", ms);
    fmt::print("\n");
    print("symmetries", found);
    print("but for a detail", near);
  }
  if (arguments.json) print_json(all);
}

}  // namespace

void add_symmetry_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<SymmetryArguments>();
  auto* symmetry = app.add_subcommand("symmetry", "Find the rotations that map a part onto itself");
  symmetry->add_option("models", arguments->models, part_files_help)->required();
  add_reading_options(*symmetry, arguments->reading);
  symmetry->add_option(
      "-t,--tolerance", arguments->tolerance_mm,
      "Largest distance between the surface and its turned copy [mm] (default: 0.5 mm, or 0.5 % of the diameter)");
  symmetry->add_flag("--json", arguments->json, "Print them in the form of BOP's models_info.json, by the part's name");
  symmetry->footer(
      "Examples:\n"
      "  partpose symmetry parts/flange.stl\n"
      "  partpose symmetry parts/ --tolerance 0.1 --json > symmetries.json");
  symmetry->callback([arguments, &common] { find(*arguments, common); });
}

}  // namespace partpose::apps
