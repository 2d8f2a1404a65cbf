// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/experiment.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/hash.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/engine/engine.hpp"
#include "partpose/evaluation/accuracy.hpp"
#include "partpose/evaluation/captured_set.hpp"
#include "partpose/evaluation/experiment_tables.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/pipeline/global_pipeline.hpp"
#include "partpose/pipeline/iteration_output.hpp"
#include "partpose/pipeline/recognizer.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <set>

namespace partpose {

namespace {

namespace fs = std::filesystem;

/// Letters, digits and dashes: what any file system takes.
std::string file_name_of(const std::string& name) {
  std::string out;
  for (const char c : name) out += std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
  return out;
}

std::string with_environment(const std::string& text) {
  const auto begin = text.find("${");
  if (begin == std::string::npos) return text;
  const auto end = text.find('}', begin);
  if (end == std::string::npos) throw Error("\"{}\": \"${{\" without \"}}\"", text);
  const std::string name = text.substr(begin + 2, end - begin - 2);
  const char* value = std::getenv(name.c_str());
  if (!value || !*value) throw Error("\"{}\": the environment variable {} is not set", text, name);
  return text.substr(0, begin) + value + with_environment(text.substr(end + 1));
}

std::string resolved(const std::string& path, const fs::path& base) {
  return path.empty() ? path : fs::weakly_canonical(base / with_environment(path)).string();
}

/// With absolute paths.
ExperimentSpec read_spec(const fs::path& path) {
  ExperimentSpec spec = read_json<ExperimentSpec>(path);
  const fs::path base = fs::absolute(path).parent_path();
  try {
    for (auto& group : spec.groups)
      for (auto& part : group.parts) part = resolved(part, base);
    for (auto& protocol : spec.protocols) {
      protocol.views = resolved(protocol.views, base);
      protocol.captured = resolved(protocol.captured, base);
    }
    spec.database = resolved(spec.database, base);
    for (auto& configuration : spec.configurations) configuration.pipeline = resolved(configuration.pipeline, base);
  } catch (const Error& error) {
    throw Error("{}: {}", path.string(), error.what());
  }
  return spec;
}

std::vector<fs::path> stl_files(const PartGroup& group) {
  std::vector<fs::path> paths;
  for (const auto& part : group.parts) {
    const auto found = model_files(part);
    paths.insert(paths.end(), found.begin(), found.end());
  }
  return paths;
}

/// A scene that can be read when its turn comes, and what it shows.
struct TestScene {
  std::string name;
  std::function<Scene()> read;
  GroundTruth truth;
  std::vector<Eigen::Isometry3d> equivalent;  ///< further poses that are as right as the truth's
};

class Experiment {
 public:
  Experiment(ExperimentSpec spec, fs::path output, Progress progress)
      : spec_(std::move(spec)), output_(std::move(output)), progress_(std::move(progress)) {}

  void run();

 private:
  Dataset dataset(const PartGroup& group, const std::string& config_file) const;
  std::vector<TestScene> scenes(const PartGroup& group, const ExperimentProtocol& protocol) const;
  void run(const PartGroup& group, const ExperimentProtocol& protocol, const ExperimentConfiguration& configuration,
           const std::string& descriptor);
  FrameRecord recognize(const TestScene& scene, const PartRecognizer& recognizer, const GlobalPipelineConfig& config,
                        FrameRecord record) const;
  void keep(const FrameRecord& record);

  ExperimentSpec spec_;
  fs::path output_;
  Progress progress_;
  std::set<std::pair<std::string, std::string>> finished_;  ///< run and frame
  std::ofstream log_;
  std::mutex log_mutex_;
  std::size_t done_ = 0, total_ = 0;
};

Dataset Experiment::dataset(const PartGroup& group, const std::string& config_file) const {
  const auto config = config_file.empty() ? DatasetPreparationConfig{} : read_dataset_config(config_file);
  std::string content = to_json(config).dump();
  const auto paths = stl_files(group);
  for (const auto& path : paths) content += path.stem().string() + "\n" + content_hash(read_file(path)) + "\n";
  const fs::path folder = output_ / "datasets" / (file_name_of(group.name) + "-" + content_hash(content).substr(0, 12));
  try {
    return open_dataset(folder);
  } catch (const Error&) {
    fs::create_directories(folder.parent_path());
    return create_dataset(config, paths, folder, progress_);
  }
}

std::vector<TestScene> Experiment::scenes(const PartGroup& group, const ExperimentProtocol& protocol) const {
  std::vector<TestScene> scenes;
  if (!protocol.captured.empty()) {
    const CapturedSet set = read_captured_set(protocol.captured);
    std::set<std::string> names;
    for (const auto& path : stl_files(group)) names.insert(path.stem().string());
    for (const auto& scene : set.scenes) {
      const bool wanted = protocol.kinds.empty() ||
                          std::find(protocol.kinds.begin(), protocol.kinds.end(), scene.kind) != protocol.kinds.end();
      if (!wanted || !(scene.model_name.empty() || names.count(scene.model_name))) continue;
      GroundTruth truth{.model_name = scene.model_name};
      if (!scene.camera_from_model.empty()) truth.camera_from_model = scene.camera_from_model[0];
      scenes.push_back({scene.path.filename().string(), [path = scene.path] { return read_scene(path); }, truth,
                        scene.camera_from_model});
    }
    return scenes;
  }
  const Dataset test = dataset(group, protocol.views);
  for (std::size_t m = 0; m < test.out.models.size(); ++m) {
    for (std::size_t v = 0; v < test.out.views.size(); ++v) {
      const auto& model = test.out.models[m];
      const int view_id = test.out.views[v].id;
      const fs::path path = test.view_path(model.id, view_id);
      scenes.push_back({fmt::format("{}_view_{}", model.name, view_id),
                        [path] {
                          Scene scene;
                          scene.path = path;
                          scene.cloud = read_pcd(path);
                          return scene;
                        },
                        {model.name, test.camera_from_model(m, v), model.id, view_id},
                        {}});
    }
  }
  return scenes;
}

/// The spec's descriptors; the Recognizer has its own.
std::vector<std::string> descriptors_of(const ExperimentSpec& spec, const ExperimentConfiguration& configuration) {
  return configuration.pipeline.empty() ? std::vector<std::string>{"-"} : spec.descriptors;
}

void Experiment::run() {
  for (const auto& record : read_frame_records(output_)) finished_.emplace(record.run, record.frame);
  // A line that was cut off by a kill is ended, so that the next one starts anew.
  bool ends_in_a_line = true;
  if (std::ifstream in(output_ / "frames.jsonl", std::ios::binary | std::ios::ate); in && in.tellg() > 0) {
    in.seekg(-1, std::ios::end);
    ends_in_a_line = in.get() == '\n';
  }
  log_.open(output_ / "frames.jsonl", std::ios::app);
  if (!log_) throw Error("{}: cannot be written", (output_ / "frames.jsonl").string());
  if (!ends_in_a_line) log_ << '\n';

  for (const auto& group : spec_.groups) {
    std::size_t runs = 0;
    for (const auto& configuration : spec_.configurations) runs += descriptors_of(spec_, configuration).size();
    for (const auto& protocol : spec_.protocols) total_ += runs * scenes(group, protocol).size();
  }
  for (const auto& group : spec_.groups)
    for (const auto& configuration : spec_.configurations)
      for (const auto& descriptor : descriptors_of(spec_, configuration))
        for (const auto& protocol : spec_.protocols) run(group, protocol, configuration, descriptor);
}

void Experiment::run(const PartGroup& group, const ExperimentProtocol& protocol,
                     const ExperimentConfiguration& configuration, const std::string& descriptor) {
  FrameRecord blank;
  blank.run = fmt::format("{} / {} / {} / {}", group.name, protocol.name, configuration.name, descriptor);
  blank.group = group.name;
  blank.protocol = protocol.name;
  blank.configuration = configuration.name;
  blank.descriptor = descriptor;
  blank.left_out = protocol.left_out;

  std::vector<TestScene> left;
  for (auto& scene : scenes(group, protocol)) {
    if (finished_.count({blank.run, scene.name}))
      ++done_;
    else
      left.push_back(std::move(scene));
  }
  if (left.empty()) return;

  GlobalPipelineConfig config = Recognizer::catalogue_config();
  if (!configuration.pipeline.empty()) {
    config = read_pipeline_config(configuration.pipeline);
    config.global_descriptor = descriptor;
    config.check();
  }
  const auto make = [&](Catalogue catalogue) -> std::unique_ptr<PartRecognizer> {
    if (configuration.pipeline.empty() && configuration.recognizer == "engine")
      return std::make_unique<Engine>(std::move(catalogue));
    if (configuration.pipeline.empty()) return std::make_unique<Recognizer>(std::move(catalogue));
    return std::make_unique<GlobalPipeline>(std::move(catalogue), config);
  };
  const Catalogue all = load_catalogue(dataset(group, spec_.database), config, progress_);

  // One recognizer for all scenes, or one without the part for the scenes of each part.
  std::stable_sort(left.begin(), left.end(),
                   [](const auto& a, const auto& b) { return a.truth.model_name < b.truth.model_name; });
  for (auto begin = left.begin(); begin != left.end();) {
    const std::string& part = begin->truth.model_name;
    const auto end = !protocol.left_out ? left.end() : std::find_if(begin, left.end(), [&](const auto& scene) {
      return scene.truth.model_name != part;
    });
    const auto recognizer = make(protocol.left_out && !part.empty() ? without_part(all, part) : all);
    const auto one = [&](std::size_t i) {
      keep(recognize(begin[static_cast<std::ptrdiff_t>(i)], *recognizer, config, blank));
    };
    const auto count = static_cast<std::size_t>(end - begin);
    if (spec_.parallel_frames)
      parallel_for(count, one);
    else
      for (std::size_t i = 0; i < count; ++i) one(i);
    begin = end;
  }
}

FrameRecord Experiment::recognize(const TestScene& test, const PartRecognizer& recognizer,
                                  const GlobalPipelineConfig& config, FrameRecord record) const {
  const Scene scene = test.read();
  const Recognition recognition = recognizer.recognize(scene);
  record.frame = test.name;
  record.result = recognition.result;
  record.evaluation = evaluate(recognition.result, test.truth);
  for (const auto& pose : test.equivalent) {
    GroundTruth other = test.truth;
    other.camera_from_model = pose;
    const Evaluation evaluation = evaluate(recognition.result, other);
    if (evaluation.translation_error_mm + evaluation.rotation_error_deg <
        record.evaluation.translation_error_mm + record.evaluation.rotation_error_deg)
      record.evaluation = evaluation;
  }
  if (record.left_out) record.evaluation.recognized_correctly = recognition.accepted < 0;
  for (const auto& candidate : recognition.candidates) {
    if (candidate.score <= record.score) continue;
    record.score = candidate.score;
    const Catalogue& catalogue = recognizer.catalogue();
    record.best_is_right = catalogue.parts[catalogue.views[candidate.view_row].part].name == test.truth.model_name;
  }
  record.reason = recognition.reason;
  record.stages = recognition.stages;
  record.time_ms = recognition.total_ms();

  const bool pose_right = record.evaluation.ground_truth_model_name.empty() || record.left_out ||
                          (record.evaluation.rotation_error_deg < spec_.limit_deg &&
                           record.evaluation.translation_error_mm < spec_.limit_mm);
  const bool is_failure = !record.evaluation.recognized_correctly || !pose_right;
  if (spec_.save_frames == "all" || (spec_.save_frames == "failures" && is_failure)) {
    const fs::path folder = output_ / "frames" / file_name_of(record.run);
    GlobalPipelineConfig saved = config;
    saved.debug.save_extras_json = saved.debug.save_point_clouds = true;
    const fs::path iteration = write_iteration(folder, recognition, scene.cloud, recognizer.catalogue(), saved);
    write_json(iteration / "evaluation.json", record.evaluation);
    record.folder = fs::relative(iteration, output_).string();
  }
  return record;
}

void Experiment::keep(const FrameRecord& record) {
  const std::lock_guard lock(log_mutex_);
  log_ << json_line(to_json(record)) << std::endl;
  if (!log_) throw Error("{}: could not be written: is the disk full?", (output_ / "frames.jsonl").string());
  ++done_;
  if (progress_) progress_("recognizing", done_, total_);
}

template <typename Items>
void check_names(const Items& items, const char* key) {
  if (items.empty()) throw Error("{}: give at least one", key);
  std::set<std::string> names;
  for (const auto& item : items)
    if (!names.insert(item.name).second) throw Error("{}: the name \"{}\" is there twice", key, item.name);
}

}  // namespace

void PartGroup::check() const {
  if (name.empty()) throw Error("name: must not be empty");
  if (parts.empty()) throw Error("parts: give at least one STL file or folder");
}

void ExperimentProtocol::check() const {
  if (name.empty()) throw Error("name: must not be empty");
  if (views.empty() == captured.empty()) throw Error("give either \"views\" or \"captured\"");
}

void ExperimentConfiguration::check() const {
  if (name.empty()) throw Error("name: must not be empty");
  if (recognizer != "recognizer" && recognizer != "engine")
    throw Error("recognizer \"{}\": must be \"recognizer\" or \"engine\"", recognizer);
}

void ExperimentSpec::check() const {
  check_names(groups, "groups");
  check_names(protocols, "protocols");
  check_names(configurations, "configurations");
  if (descriptors.empty()) throw Error("descriptors: give at least one");
  for (const auto& descriptor : descriptors) make_global_descriptor(descriptor, {});
  if (!(limit_deg > 0)) throw Error("limit_deg {}: must be positive", limit_deg);
  if (!(limit_mm > 0)) throw Error("limit_mm {}: must be positive", limit_mm);
  if (save_frames != "none" && save_frames != "failures" && save_frames != "all")
    throw Error("save_frames \"{}\": must be \"none\", \"failures\" or \"all\"", save_frames);
}

std::vector<FrameRecord> run_experiment(const fs::path& spec_file, const fs::path& output, const Progress& progress) {
  const ExperimentSpec spec = read_spec(spec_file);
  const fs::path own_spec = output / "experiment.json";
  if (fs::exists(own_spec)) {
    if (read_json_file(own_spec) != to_json(spec))
      throw Error("{}: holds another experiment than {}; give another output folder, or remove this one",
                  output.string(), spec_file.string());
  } else {
    if (fs::exists(output) && !fs::is_empty(output))
      throw Error("{}: is there and is no experiment's folder; give another one", output.string());
    fs::create_directories(output);
    write_json(own_spec, spec);
  }
  Experiment(spec, output, progress).run();
  auto records = read_frame_records(output);
  write_tables(records, spec, output);
  return records;
}

std::vector<FrameRecord> read_frame_records(const fs::path& output) {
  std::vector<FrameRecord> records;
  std::ifstream in(output / "frames.jsonl");
  std::string line;
  while (std::getline(in, line)) {
    const Json json = Json::parse(line, nullptr, false);
    if (json.is_discarded()) continue;  // cut off when the run was killed
    try {
      records.push_back(from_json<FrameRecord>(json));
    } catch (const Error& error) {
      throw Error("{}: line {}: {}", (output / "frames.jsonl").string(), records.size() + 1, error.what());
    }
  }
  return records;
}

}  // namespace partpose
