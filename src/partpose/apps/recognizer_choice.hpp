// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.hpp"
#include "parts.hpp"

#include "partpose/core/progress.hpp"
#include "partpose/pipeline/config.hpp"
#include "partpose/pipeline/recognition.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class Option;
}

namespace partpose::apps {

/// What recognizes parts where nothing is configured and nothing else is asked for: "recognizer" or "engine".
inline constexpr const char* default_recognizer = "engine";

/// --recognizer.
CLI::Option* add_recognizer_option(CLI::App& command, std::string& name);
/// --min-score.
CLI::Option* add_min_score_option(CLI::App& command, std::optional<float>& min_score);

/// By its name. Without `min_score` the recognizer's own.
std::unique_ptr<PartRecognizer> make_recognizer(const std::string& name, Catalogue catalogue,
                                                std::optional<float> min_score = {});
/// The score below which it does not believe a candidate, when nothing else is said.
float default_min_score(const std::string& name);

/// How `recognize` and `view` are told of the parts, and of what recognizes them.
struct RecognizerArguments {
  std::vector<std::filesystem::path> models;
  MeshReadOptions reading;
  std::filesystem::path dataset, config, cache;
  std::vector<std::string> overrides;
  std::string recognizer = default_recognizer;
  std::optional<float> min_score;
};

/// --models, --dataset, --config, --set, --recognizer, --min-score, --cache and those of add_reading_options.
void add_recognizer_arguments(CLI::App& command, RecognizerArguments& arguments);

/// A recognizer, and the configuration that its output is written by.
struct ChosenRecognizer {
  std::unique_ptr<PartRecognizer> recognizer;
  GlobalPipelineConfig config;

  /// The scene as the recognizer sees it: the configuration may scale it.
  Scene in_mm(const Scene& scene) const;
};

/// Throws Error, with the command's name, unless the arguments go together.
ChosenRecognizer choose_recognizer(const std::string& command, const RecognizerArguments& arguments,
                                   const Common& common);

/// A pipeline configuration; an empty path is the default one.
GlobalPipelineConfig pipeline_config(const std::filesystem::path& path, const std::vector<std::string>& overrides);

/// The catalogue that a recognizer needs of parts without a configuration: of the Engine their meshes, of the
/// Recognizer also views, which are made on first use and kept.
Catalogue catalogue_for(const std::string& recognizer, const std::vector<NamedMesh>& parts,
                        const std::filesystem::path& cache, const Common& common);

}  // namespace partpose::apps
