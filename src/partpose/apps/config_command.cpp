// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands.hpp"
#include "config_keys.hpp"
#include "output.hpp"
#include "recognizer_choice.hpp"

#include "partpose/camera/stereo_sensor.hpp"
#include "partpose/core/error.hpp"
#include "partpose/evaluation/experiment.hpp"
#include "partpose/io/camera_json.hpp"
#include "partpose/io/file.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/synthesis/bop_scenes.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct Texts {
  std::string commented, plain;
};

/// A kind of configuration file: what is known of it comes from its struct alone.
struct Kind {
  const char* name;
  const char* read_by;
  std::function<std::vector<ConfigKey>()> keys;
  /// The file's values, or the defaults, with the overrides.
  std::function<Texts(const fs::path& file, const std::vector<std::string>& overrides)> write;
};

template <typename T>
Kind kind(const char* name, const char* read_by) {
  const auto write = [](const fs::path& file, const std::vector<std::string>& overrides) {
    T config = file.empty() ? T{} : read_json<T>(file);
    // The defaults of an experiment are to be filled in: no configuration yet that can be checked.
    constexpr bool complete = !std::same_as<T, ExperimentSpec>;
    if (complete || !file.empty())
      apply_overrides(config, overrides);
    else
      set_keys(config, overrides);
    return Texts{commented_json(config), to_json(config).dump(2, ' ', false, Json::error_handler_t::replace) + "\n"};
  };
  return {name, read_by, [] { return keys_of<T>(); }, write};
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      kind<GlobalPipelineConfig>("pipeline", "recognize, view, index and evaluate --config"),
      kind<DatasetPreparationConfig>("dataset", "dataset --config"),
      kind<SceneDatasetOptions>("scenes", "scenes --config"),
      kind<ExperimentSpec>("experiment", "experiment"),
      kind<StereoSensorOptions>("sensor", "the section \"stereo\" of the noise of dataset and scenes"),
      kind<CameraFile>("camera", "--camera"),
  };
  return all;
}

struct ConfigArguments {
  std::string kind;
  fs::path config, output;
  std::vector<std::string> overrides;
  std::string explain;
  bool json = false, markdown = false, keys = false;
};

const Kind& kind_of(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& k : kinds()) {
    if (k.name == name) return k;
    names.emplace_back(k.name);
  }
  throw Error("config: there is no kind of configuration \"{}\"; did you mean \"{}\"? There are {}", name,
              nearest_word(name, names), fmt::join(names, ", "));
}

struct Found {
  const Kind* kind;
  ConfigKey key;
};

/// The kinds asked for: one, or all.
std::vector<const Kind*> asked_kinds(const ConfigArguments& arguments) {
  std::vector<const Kind*> asked;
  if (!arguments.kind.empty()) return {&kind_of(arguments.kind)};
  for (const auto& k : kinds()) asked.push_back(&k);
  return asked;
}

/// The keys of that path; without one, the keys whose path ends in it. What is in a section follows it.
std::vector<Found> keys_meant(const std::string& name, const std::vector<const Kind*>& asked) {
  const auto matching = [&](bool ending) {
    std::vector<Found> found;
    for (const Kind* k : asked) {
      const auto keys = k->keys();
      for (const auto& key : keys) {
        if (key.path != name && !(ending && key.path.ends_with(fmt::format(".{}", name)))) continue;
        found.push_back({k, key});
        for (const auto& inner : keys)
          if (inner.path.starts_with(key.path + ".") || inner.path.starts_with(key.path + "[]."))
            found.push_back({k, inner});
      }
    }
    return found;
  };
  auto found = matching(false);
  if (found.empty()) found = matching(true);
  if (!found.empty()) return found;
  std::vector<ConfigKey> all;
  for (const Kind* k : asked)
    for (const auto& key : k->keys()) all.push_back(key);
  config_detail::unknown_key(name, all);
}

std::string default_of(const ConfigKey& key) {
  if (key.required) return "required";
  if (key.standard.is_null()) return key.optional ? "absent" : "";
  return json_line(key.standard);
}

void print_markdown(const std::vector<Found>& found) {
  fmt::print("| key | type | default | meaning |\n|---|---|---|---|\n");
  for (const auto& [kind, key] : found) {
    std::string help = key.help;
    for (std::size_t at = 0; (at = help.find('|', at)) != std::string::npos; at += 2) help.insert(at, 1, '\\');
    const std::string standard = default_of(key);
    const bool code = !standard.empty() && !key.standard.is_null() && !key.required;
    fmt::print("| `{}` | {} | {} | {} |\n", key.path, key.type, code ? fmt::format("`{}`", standard) : standard, help);
  }
}

void explain(const std::vector<Found>& found, bool json) {
  if (json) {
    Json all = Json::array();
    for (const auto& [kind, key] : found) {
      Json one = {{"config", kind->name}, {"key", key.path}, {"type", key.type}};
      if (!key.section && !key.required) one["default"] = key.standard;
      one["optional"] = key.optional;
      one["required"] = key.required;
      one["meaning"] = key.help;
      all.push_back(std::move(one));
    }
    print_json(all);
    return;
  }
  for (const auto& [kind, key] : found) {
    const std::string standard = default_of(key);
    fmt::print("{}: {}  ({}{})\n    {}\n", kind->name, key.path, key.type,
               standard.empty() ? ""
               : key.required   ? ", required"
                                : fmt::format(", default: {}", standard),
               key.help);
  }
}

void run(const ConfigArguments& arguments) {
  if (arguments.keys) {
    for (const Kind* k : asked_kinds(arguments))
      for (const auto& key : k->keys()) fmt::print("{}\n", key.path);
    return;
  }
  if (!arguments.explain.empty() || arguments.markdown) {
    std::vector<Found> found;
    if (!arguments.explain.empty())
      found = keys_meant(arguments.explain, asked_kinds(arguments));
    else
      for (const Kind* k : asked_kinds(arguments))
        for (auto& key : k->keys()) found.push_back({k, std::move(key)});
    if (arguments.markdown)
      print_markdown(found);
    else
      explain(found, arguments.json);
    return;
  }
  const Kind& kind = arguments.kind.empty() ? kinds()[0] : kind_of(arguments.kind);
  const Texts texts = kind.write(arguments.config, arguments.overrides);
  const std::string text =
      arguments.json
          ? texts.plain
          : fmt::format("// Configuration \"{}\" of partpose, read by: {}.\n// {}.\n{}", kind.name, kind.read_by,
                        kind.keys()[0].required ? "All keys are needed, but those that may be absent"
                                                : "Keys that are left out have their defaults",
                        texts.commented);
  if (arguments.output.empty() || arguments.output == "-")
    fmt::print("{}", text);
  else
    write_file_atomically(arguments.output, text);
}

}  // namespace

void add_config_command(CLI::App& app) {
  auto arguments = std::make_shared<ConfigArguments>();
  auto* config = app.add_subcommand("config", "Write a configuration with every key explained, or explain a key");
  std::vector<std::string> names;
  for (const auto& k : kinds()) names.emplace_back(k.name);
  config->add_option("kind", arguments->kind,
                     fmt::format("{}; default: pipeline, and with --explain all of them", fmt::join(names, ", ")));
  config->add_option("-c,--config", arguments->config, "Start from this file's values, not from the defaults");
  add_set_option(*config, arguments->overrides);
  config->add_option("-o,--output", arguments->output, "File to write (default: standard output)");
  config->add_option("--explain", arguments->explain, "Explain a key, or a section and all that is in it")
      ->type_name("KEY");
  config->add_flag("--json", arguments->json, "Without comments; with --explain: as JSON");
  config->add_flag("--markdown", arguments->markdown, "The table of the keys, as in docs/configuration.md");
  config->add_flag("--keys", arguments->keys, "Only list the keys");
  config->footer(
      "Examples:\n"
      "  partpose config --output pipeline.json                # every key with its default, explained in comments\n"
      "  partpose config dataset --set virtual_views_icosahedron.subdivide=2 >dataset.json\n"
      "  partpose config pipeline --config mine.json           # what a file comes to, defaults filled in\n"
      "  partpose config --explain voxel_size\n"
      "The files may be given to the other commands as they are: comments (// and /* */) are read over.");
  config->callback([arguments] { run(*arguments); });
}

}  // namespace partpose::apps
