// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "parts.hpp"

#include "output.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"

#include <CLI/CLI.hpp>

namespace partpose::apps {

void add_reading_options(CLI::App& command, MeshReadOptions& options) {
  command
      .add_option("--chord-tolerance", options.chord_tolerance_mm,
                  "STEP: how far triangles may be from the surface they stand for [mm]")
      ->capture_default_str();
  command
      .add_option("--angle-tolerance", options.angle_tolerance_deg,
                  "STEP: largest angle between neighbouring facets of a curved surface [deg]")
      ->capture_default_str();
  command
      .add_option("--split", options.split,
                  "What is a part: each \"product\" of an assembly, each \"solid\", or the \"whole\" file")
      ->capture_default_str();
}

std::string plural_of_unit(const std::string& unit) { return unit + (unit == "inch" ? "es" : "s"); }

std::vector<NamedMesh> read_parts(const std::vector<std::filesystem::path>& files_and_folders,
                                  const MeshReadOptions& options, const Common& common) {
  auto parts = read_meshes(files_and_folders, options, [&](const std::filesystem::path&, const std::string& message) {
    ++common.failures;
    complain(message);
  });
  for (const auto& part : parts) {
    if (const std::string doubt = doubt_about_unit(part); !doubt.empty()) complain(doubt);
    note(common,
         fmt::format("{}: {}, {}{}", part.file.string(), part.name, counted(part.mesh.triangles.size(), "triangle"),
                     part.unit.empty() ? "" : ", file in " + part.unit));
  }
  return parts;
}

}  // namespace partpose::apps
