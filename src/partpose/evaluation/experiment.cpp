// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/experiment.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/hash.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/engine/engine.hpp"
#include "partpose/evaluation/accuracy.hpp"
#include "partpose/evaluation/captured_set.hpp"
#include "partpose/evaluation/cramer_rao.hpp"
#include "partpose/evaluation/experiment_tables.hpp"
#include "partpose/evaluation/failures.hpp"
#include "partpose/evaluation/pose_judge.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/pipeline/global_pipeline.hpp"
#include "partpose/pipeline/iteration_output.hpp"
#include "partpose/pipeline/picture.hpp"
#include "partpose/pipeline/recognizer.hpp"
#include "partpose/preprocess/segmentation.hpp"
#include "partpose/synthesis/bop_scenes.hpp"

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
ExperimentSpec read_spec(const fs::path& path, const std::function<void(ExperimentSpec&)>& adjust) {
  ExperimentSpec spec = read_json<ExperimentSpec>(path);
  if (adjust) adjust(spec);
  const fs::path base = fs::absolute(path).parent_path();
  try {
    for (auto& group : spec.groups)
      for (auto& part : group.parts) part = resolved(part, base);
    for (auto& protocol : spec.protocols) {
      protocol.views = resolved(protocol.views, base);
      protocol.captured = resolved(protocol.captured, base);
      protocol.scenes = resolved(protocol.scenes, base);
    }
    spec.database = resolved(spec.database, base);
    for (auto& configuration : spec.configurations) configuration.pipeline = resolved(configuration.pipeline, base);
  } catch (const Error& error) {
    throw Error("{}: {}", path.string(), error.what());
  }
  return spec;
}

std::vector<NamedMesh> parts_of(const PartGroup& group) {
  return read_meshes(std::vector<fs::path>(group.parts.begin(), group.parts.end()));
}

/// A scene that can be read when its turn comes, and what it shows.
struct TestScene {
  std::string name;
  std::function<Scene()> read;
  std::vector<GroundTruth> truths;   ///< any of them is right; the first names the frame's part
  std::optional<Intrinsics> camera;  ///< of a cloud, where it is known
  AmbiguityOptions noise;            ///< of the sensor
  std::vector<ObjectTruth> objects;  ///< all parts of the catalogue that the frame shows
  double range_noise_mm = 0;         ///< independent along each line of sight; 0: another noise, or unknown
};

/// One object, of which any of the poses is right.
std::vector<ObjectTruth> one_object(const std::vector<GroundTruth>& truths) {
  if (truths[0].model_name.empty()) return {};
  ObjectTruth object{truths[0].model_name, {}};
  for (const auto& truth : truths) object.camera_from_model.push_back(truth.camera_from_model);
  return {object};
}

/// What a pose is judged with; nothing when there is nothing that a camera could see.
std::optional<JudgedFrame> judged_frame(const TestScene& test, const Scene& scene) {
  if (scene.depth) return JudgedFrame{*scene.intrinsics, *scene.depth, test.noise};
  const auto camera = test.camera ? test.camera : intrinsics_of(before_camera(scene.cloud));
  if (!camera) return std::nullopt;
  return JudgedFrame{*camera, to_depth_image(scene.cloud, *camera), test.noise};
}

/// By the truth that the result comes nearest to.
Evaluation best_evaluation(const Result& result, const TestScene& test, const std::optional<JudgedFrame>& frame,
                           const PoseJudge& judge) {
  if (!frame) return evaluate(result, test.truths[0]);
  const auto rank = [](const Evaluation& e) {
    return std::tuple(!e.recognized_correctly, e.mssd_mm.value_or(0), e.translation_error_mm + e.rotation_error_deg);
  };
  Evaluation best = judge.judge(result, test.truths[0], *frame);
  for (std::size_t i = 1; i < test.truths.size(); ++i) {
    const Evaluation other = judge.judge(result, test.truths[i], *frame);
    if (rank(other) < rank(best)) best = other;
  }
  return best;
}

/// Of a frame whose part is right.
BoundRecord bound_of(const Result& result, const TestScene& test, const PoseJudge& judge) {
  const GroundTruth& truth = test.truths[0];
  const TriangleMesh& mesh = judge.mesh(truth.model_name);
  BoundRecord out;
  if (judge.is_continuous(truth.model_name)) return out;
  const PoseBound bound = pose_bound(mesh, truth.camera_from_model, *test.camera, test.range_noise_mm);
  out.determined = bound.determined;
  if (!out.determined) return out;
  out.rotation_deg = bound.rotation_deg();
  out.translation_mm = bound.translation_mm();
  const Eigen::Isometry3d nearest = judge.nearest_equivalent(truth.model_name, result.T_final, truth.camera_from_model);
  const Eigen::Vector3d middle = bounding_box(mesh).center();
  out.rotation_error_deg = rotation_error_deg(result.T_final, nearest);
  out.translation_error_mm = (result.T_final * middle - nearest * middle).norm();
  return out;
}

class Experiment {
 public:
  Experiment(ExperimentSpec spec, fs::path output, Progress progress)
      : spec_(std::move(spec)), output_(std::move(output)), progress_(std::move(progress)) {}

  void run();

 private:
  Dataset dataset(const PartGroup& group, const std::string& config_file) const;
  /// Where data made of the group's parts and `content` is kept.
  fs::path data_folder(const PartGroup& group, const std::string& content) const;
  /// As many of the protocol's as are asked for.
  std::vector<TestScene> scenes(const PartGroup& group, const ExperimentProtocol& protocol) const;
  std::vector<TestScene> all_scenes(const PartGroup& group, const ExperimentProtocol& protocol) const;
  std::vector<TestScene> captured_scenes(const PartGroup& group, const ExperimentProtocol& protocol) const;
  std::vector<TestScene> drawn_scenes(const PartGroup& group, const ExperimentProtocol& protocol) const;
  void run(const PartGroup& group, const ExperimentProtocol& protocol, const ExperimentConfiguration& configuration,
           const std::string& descriptor);
  FrameRecord recognize(const TestScene& scene, const PartRecognizer& recognizer, const PoseJudge& judge,
                        const GlobalPipelineConfig& config, FrameRecord record) const;
  void keep(const FrameRecord& record);
  /// One page of pictures for the failing frames of a run, sorted by what went wrong, and a list of them.
  void draw_failures(const std::string& run, const std::vector<TestScene>& scenes, const PoseJudge& judge) const;
  /// The output of frames that were killed before their line was written: they are recognized again.
  void remove_unfinished_folders(const std::set<fs::path>& kept) const;

  ExperimentSpec spec_;
  fs::path output_;
  Progress progress_;
  std::set<std::pair<std::string, std::string>> finished_;  ///< run and frame
  std::ofstream log_;
  std::mutex log_mutex_;
  std::size_t done_ = 0, total_ = 0;
};

fs::path Experiment::data_folder(const PartGroup& group, const std::string& content) const {
  std::string all = content;
  for (const auto& part : parts_of(group)) all += part.name + "\n" + content_hash(part.mesh) + "\n";
  return output_ / "datasets" / (file_name_of(group.name) + "-" + content_hash(all).substr(0, 12));
}

Dataset Experiment::dataset(const PartGroup& group, const std::string& config_file) const {
  const auto config = config_file.empty() ? DatasetPreparationConfig{} : read_dataset_config(config_file);
  const fs::path folder = data_folder(group, to_json(config).dump());
  try {
    return open_dataset(folder);
  } catch (const Error&) {
    fs::create_directories(folder.parent_path());
    return create_dataset(config, parts_of(group), folder, progress_);
  }
}

std::vector<TestScene> Experiment::scenes(const PartGroup& group, const ExperimentProtocol& protocol) const {
  auto all = all_scenes(group, protocol);
  const auto most = static_cast<std::size_t>(spec_.most_frames);
  if (most == 0 || all.size() <= most) return all;
  std::vector<TestScene> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(std::move(all[i * all.size() / most]));
  return some;
}

std::vector<TestScene> Experiment::all_scenes(const PartGroup& group, const ExperimentProtocol& protocol) const {
  if (protocol.left_out && parts_of(group).size() < 2) return {};  // the catalogue would be empty
  if (!protocol.captured.empty()) return captured_scenes(group, protocol);
  if (!protocol.scenes.empty()) return drawn_scenes(group, protocol);
  const Dataset test = dataset(group, protocol.views);
  const auto& camera = test.out.dataset_preparation_config.virtual_depth_camera;
  std::vector<TestScene> scenes;
  for (std::size_t m = 0; m < test.out.models.size(); ++m) {
    for (std::size_t v = 0; v < test.out.views.size(); ++v) {
      const auto& model = test.out.models[m];
      const int view_id = test.out.views[v].id;
      const auto read = [path = test.view_path(model.id, view_id)] {
        Scene scene;
        scene.path = path;
        scene.cloud = read_pcd(path);
        return scene;
      };
      scenes.push_back({fmt::format("{}_view_{}", model.name, view_id),
                        read,
                        {{model.name, test.camera_from_model(m, v), model.id, view_id}},
                        camera.intrinsics(),
                        AmbiguityOptions::of(camera.noise),
                        {},
                        camera.noise.model == "gaussianray" ? camera.noise.standard_deviation_mm : 0.0});
      scenes.back().objects = one_object(scenes.back().truths);
    }
  }
  return scenes;
}

std::vector<TestScene> Experiment::captured_scenes(const PartGroup& group, const ExperimentProtocol& protocol) const {
  const CapturedSet set = read_captured_set(protocol.captured);
  std::set<std::string> names;
  for (const auto& part : parts_of(group)) names.insert(part.name);
  const bool shows_the_group = std::any_of(set.scenes.begin(), set.scenes.end(),
                                           [&](const auto& scene) { return names.count(scene.model_name) > 0; });
  std::vector<TestScene> scenes;
  if (!shows_the_group) return scenes;
  for (const auto& scene : set.scenes) {
    const bool wanted = protocol.kinds.empty() ||
                        std::find(protocol.kinds.begin(), protocol.kinds.end(), scene.kind) != protocol.kinds.end();
    if (!wanted || !(scene.model_name.empty() || names.count(scene.model_name))) continue;
    std::vector<GroundTruth> truths;
    for (const auto& pose : scene.camera_from_model) truths.push_back({scene.model_name, pose});
    if (truths.empty()) truths.push_back({});
    scenes.push_back({scene.path.filename().string(),
                      [path = scene.path] { return read_scene(path); },
                      truths,
                      {},
                      {},
                      one_object(truths)});
  }
  return scenes;
}

std::vector<TestScene> Experiment::drawn_scenes(const PartGroup& group, const ExperimentProtocol& protocol) const {
  const auto options = read_json<SceneDatasetOptions>(protocol.scenes);
  if (protocol.left_out && options.scene.parts[1] > 1)
    throw Error("{}: scene.parts: for \"left_out\" a frame must show one part at most, or the others are rightly found",
                protocol.scenes);
  const int frames = spec_.most_frames > 0 ? std::min(protocol.frames, spec_.most_frames) : protocol.frames;
  const fs::path folder = data_folder(group, fmt::format("{} frames of {}", frames, to_json(options).dump()));
  if (!fs::exists(folder)) {
    std::vector<ScenePart> parts;
    for (const auto& part : parts_of(group)) parts.push_back({part.name, part.mesh});
    fs::create_directories(folder.parent_path());
    write_scene_dataset(std::move(parts), {}, options, static_cast<std::size_t>(frames), folder, {}, progress_);
  }
  const SceneDataset drawn = read_scene_dataset(folder);
  const auto noise = AmbiguityOptions::of(
      NoiseOptions{.model = options.sensor.model,
                   .standard_deviation_mm = static_cast<float>(options.sensor.standard_deviation_mm),
                   .stereo = options.sensor.stereo});
  std::vector<TestScene> scenes;
  for (const auto& [scene_id, bop_scene] : drawn.bop.scenes) {
    for (const auto& image : bop_scene.images) {
      std::vector<GroundTruth> truths;
      std::vector<ObjectTruth> objects;
      for (const auto& truth : image.ground_truths) {
        truths.push_back({drawn.part_names.at(truth.obj_id), truth.camera_from_model, truth.obj_id});
        objects.push_back({drawn.part_names.at(truth.obj_id),
                           {truth.camera_from_model},
                           truth.visibility ? truth.visibility->visib_fract : 1.0});
      }
      if (truths.empty()) truths.push_back({});
      const auto read = [bop_scene, image] {
        Scene scene;
        scene.path = bop_scene.depth_path(image);
        scene.depth = bop_scene.read_depth(image);
        scene.intrinsics = image.camera.intrinsics(scene.depth->width, scene.depth->height);
        scene.cloud = to_point_cloud(*scene.depth, *scene.intrinsics);
        return scene;
      };
      scenes.push_back({fmt::format("scene_{}_image_{}", scene_id, image.id), read, truths, {}, noise, objects});
    }
  }
  return scenes;
}

/// The spec's descriptors; the Recognizer has its own.
std::vector<std::string> descriptors_of(const ExperimentSpec& spec, const ExperimentConfiguration& configuration) {
  return configuration.pipeline.empty() ? std::vector<std::string>{"-"} : spec.descriptors;
}

void Experiment::run() {
  // What is wrong is said before the first frame, not after the hours of the runs before.
  for (const auto& configuration : spec_.configurations)
    if (!configuration.pipeline.empty()) read_pipeline_config(configuration.pipeline);
  if (!spec_.database.empty()) read_dataset_config(spec_.database);

  std::set<fs::path> kept;
  for (const auto& record : read_frame_records(output_)) {
    finished_.emplace(record.run, record.frame);
    kept.insert(record.folder);
  }
  remove_unfinished_folders(kept);
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

  const std::vector<TestScene> shown = scenes(group, protocol);
  std::vector<TestScene> left;
  for (const auto& scene : shown) {
    if (finished_.count({blank.run, scene.name}))
      ++done_;
    else
      left.push_back(scene);
  }
  if (left.empty()) return;

  GlobalPipelineConfig config = Recognizer::catalogue_config();
  if (!configuration.pipeline.empty()) {
    config = read_pipeline_config(configuration.pipeline);
    config.global_descriptor = descriptor;
    config.check();
  }
  const bool meshes_only = configuration.pipeline.empty() && configuration.recognizer == "engine";
  const Catalogue all =
      meshes_only ? mesh_catalogue(parts_of(group)) : load_catalogue(dataset(group, spec_.database), config, progress_);
  const auto make = [&](Catalogue catalogue) -> std::unique_ptr<PartRecognizer> {
    if (meshes_only) {
      EngineOptions options;
      options.min_score = configuration.min_score.value_or(options.min_score);
      return std::make_unique<Engine>(std::move(catalogue), options);
    }
    if (configuration.pipeline.empty()) return std::make_unique<Recognizer>(std::move(catalogue));
    return std::make_unique<GlobalPipeline>(std::move(catalogue), config);
  };
  const PoseJudge judge(all);

  // One recognizer for all scenes, or one without the part for the scenes of each part.
  std::stable_sort(left.begin(), left.end(),
                   [](const auto& a, const auto& b) { return a.truths[0].model_name < b.truths[0].model_name; });
  for (auto begin = left.begin(); begin != left.end();) {
    const std::string& part = begin->truths[0].model_name;
    const auto end = !protocol.left_out ? left.end() : std::find_if(begin, left.end(), [&](const auto& scene) {
      return scene.truths[0].model_name != part;
    });
    const auto recognizer = make(protocol.left_out && !part.empty() ? without_part(all, part) : all);
    const auto one = [&](std::size_t i) {
      keep(recognize(begin[static_cast<std::ptrdiff_t>(i)], *recognizer, judge, config, blank));
    };
    const auto count = static_cast<std::size_t>(end - begin);
    if (spec_.parallel_frames)
      parallel_for(count, one);
    else
      for (std::size_t i = 0; i < count; ++i) one(i);
    begin = end;
  }
  if (spec_.save_frames != "none") draw_failures(blank.run, shown, judge);
}

void Experiment::draw_failures(const std::string& run, const std::vector<TestScene>& scenes,
                               const PoseJudge& judge) const {
  std::vector<std::pair<Failure, FrameRecord>> failures;
  for (auto& record : read_frame_records(output_))
    if (record.run == run)
      if (const auto failure = failure_of(record)) failures.emplace_back(*failure, std::move(record));
  std::sort(failures.begin(), failures.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.frame) < std::tie(b.first, b.second.frame);
  });
  const fs::path folder = output_ / "failures";
  const std::string name = file_name_of(run);
  fs::remove(folder / (name + ".png"));
  fs::remove(folder / (name + ".md"));
  if (failures.empty()) return;
  constexpr std::size_t most_pictures = 60;
  constexpr int columns = 4;
  const std::size_t drawn = std::min(failures.size(), most_pictures);
  std::string list = fmt::format(
      "# Failing frames: {}\n\n![failing frames]({}.png)\n\nRow by row as in the picture{}. Green: where the objects "
      "are; orange: what was recognized.\n\n| row, column | what went wrong | frame | shown | recognized as | score | "
      "MSSD / diameter [%] |\n|---|---|---|---|---|---:|---:|\n",
      title_of_run(run), name, drawn < failures.size() ? fmt::format(", which has the first {}", drawn) : "");
  std::vector<ColourImage> pictures(drawn);
  const auto draw_one = [&](std::size_t i) {
    const FrameRecord& record = failures[i].second;
    const auto scene =
        std::find_if(scenes.begin(), scenes.end(), [&](const auto& s) { return s.name == record.frame; });
    const auto frame = scene == scenes.end() ? std::nullopt : judged_frame(*scene, scene->read());
    pictures[i] = frame ? picture_of_failure(record, scene->objects, judge, *frame)
                        : draw_overlay(DepthImage(320, 240), {320, 240, 300, 300, 159.5, 119.5});
  };
  parallel_for(drawn, draw_one);
  for (std::size_t i = 0; i < failures.size(); ++i) {
    const auto& [failure, record] = failures[i];
    const Evaluation& e = record.evaluation;
    list += fmt::format("| {} | {} | {} | {} | {} | {:.3f} | {} |\n",
                        i < drawn ? fmt::format("{}, {}", i / columns + 1, i % columns + 1) : "-", name_of(failure),
                        record.frame, e.ground_truth_model_name, record.result.model_name, record.score,
                        e.mssd_mm && e.diameter_mm ? fmt::format("{:.1f}", 100 * *e.mssd_mm / *e.diameter_mm) : "-");
  }
  fs::create_directories(folder);
  write_png(folder / (name + ".png"), tile(pictures, columns));
  write_file_atomically(folder / (name + ".md"), list);
}

FrameRecord Experiment::recognize(const TestScene& test, const PartRecognizer& recognizer, const PoseJudge& judge,
                                  const GlobalPipelineConfig& config, FrameRecord record) const {
  const Scene scene = test.read();
  const Recognition recognition = recognizer.recognize(scene);
  record.frame = test.name;
  record.result = recognition.result;
  const auto frame = judged_frame(test, scene);
  record.evaluation = best_evaluation(recognition.result, test, frame, judge);
  if (frame)
    record.objects = judge_objects(detections_of(recognition, recognizer.catalogue()),
                                   record.left_out ? std::vector<ObjectTruth>{} : test.objects, judge, *frame);
  if (test.range_noise_mm > 0 && record.evaluation.recognized_correctly && !record.left_out)
    record.bound = bound_of(recognition.result, test, judge);
  if (record.left_out) record.evaluation.recognized_correctly = recognition.accepted < 0;
  for (const auto& candidate : recognition.candidates) {
    if (candidate.score <= record.score) continue;
    record.score = candidate.score;
    const Catalogue& catalogue = recognizer.catalogue();
    record.best_is_right =
        catalogue.parts[catalogue.views[candidate.view_row].part].name == record.evaluation.ground_truth_model_name;
  }
  record.reason = recognition.reason;
  record.stages = recognition.stages;
  record.time_ms = recognition.total_ms();

  if (spec_.save_frames == "all" || (spec_.save_frames == "failures" && failure_of(record))) {
    const fs::path folder = output_ / "frames" / file_name_of(record.run);
    GlobalPipelineConfig saved = config;
    saved.debug.save_extras_json = saved.debug.save_point_clouds = true;
    const fs::path iteration = write_iteration(folder, recognition, scene, recognizer.catalogue(), saved);
    write_json(iteration / "evaluation.json", record.evaluation);
    record.folder = fs::relative(iteration, output_).string();
  }
  return record;
}

void Experiment::remove_unfinished_folders(const std::set<fs::path>& kept) const {
  if (!fs::exists(output_ / "frames")) return;
  std::vector<fs::path> unfinished;
  for (const auto& run : fs::directory_iterator(output_ / "frames"))
    if (run.is_directory())
      for (const auto& frame : fs::directory_iterator(run))
        if (frame.is_directory() && frame.path().filename() != "meshes" &&
            !kept.count(fs::relative(frame.path(), output_)))
          unfinished.push_back(frame.path());
  for (const auto& folder : unfinished) fs::remove_all(folder);
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
  if (parts.empty()) throw Error("parts: give at least one model file or folder");
}

void ExperimentProtocol::check() const {
  if (name.empty()) throw Error("name: must not be empty");
  if (!views.empty() + !captured.empty() + !scenes.empty() != 1)
    throw Error("give one of \"views\", \"captured\" and \"scenes\"");
  if (frames < 1) throw Error("frames {}: must be 1 or more", frames);
}

void ExperimentConfiguration::check() const {
  if (name.empty()) throw Error("name: must not be empty");
  if (recognizer != "recognizer" && recognizer != "engine")
    throw Error("recognizer \"{}\": must be \"recognizer\" or \"engine\"", recognizer);
  if (min_score && (recognizer != "engine" || !pipeline.empty()))
    throw Error("min_score {}: only where \"recognizer\" is \"engine\" and there is no \"pipeline\"", *min_score);
  if (min_score && !(*min_score >= 0 && *min_score <= 1)) throw Error("min_score {}: must be 0 to 1", *min_score);
}

void ExperimentSpec::check() const {
  check_names(groups, "groups");
  check_names(protocols, "protocols");
  check_names(configurations, "configurations");
  if (descriptors.empty()) throw Error("descriptors: give at least one");
  for (const auto& descriptor : descriptors) make_global_descriptor(descriptor, {});
  if (most_frames < 0) throw Error("most_frames {}: must be 0 or more", most_frames);
  if (!(limit_deg > 0)) throw Error("limit_deg {}: must be positive", limit_deg);
  if (!(limit_mm > 0)) throw Error("limit_mm {}: must be positive", limit_mm);
  if (save_frames != "none" && save_frames != "failures" && save_frames != "all")
    throw Error("save_frames \"{}\": must be \"none\", \"failures\" or \"all\"", save_frames);
}

namespace {

/// A hash of every file that the spec names, by path: finished frames are kept only while all of them are the same.
Json input_hashes(const ExperimentSpec& spec) {
  std::set<fs::path> files;
  const auto add = [&](const fs::path& path) {
    if (path.empty()) return;
    if (!fs::is_directory(path)) {
      files.insert(path);
      return;
    }
    for (const auto& entry : fs::directory_iterator(path))
      if (entry.is_regular_file()) files.insert(entry.path());
  };
  add(spec.database);
  for (const auto& group : spec.groups)
    for (const auto& part : group.parts) {
      if (!fs::is_directory(part))
        files.insert(part);
      else
        for (const auto& entry :
             fs::directory_iterator(part))  // what a model consists of, and nothing that lies beside it
          if (is_model_file(entry.path()) || lower_case_ending(entry.path()) == ".bin") files.insert(entry.path());
    }
  for (const auto& configuration : spec.configurations) add(configuration.pipeline);
  for (const auto& protocol : spec.protocols) {
    add(protocol.views);
    add(protocol.scenes);
    if (!protocol.captured.empty()) {
      add(fs::path(protocol.captured) / "gt.json");
      if (const auto file = fs::path(protocol.captured) / "symmetries.json"; fs::exists(file)) add(file);
    }
  }
  Json hashes = Json::object();
  for (const auto& file : files)
    if (fs::is_regular_file(file) && fs::file_size(file) > 0) hashes[file.string()] = content_hash(read_file(file));
  return hashes;
}

/// Throws Error when an input is another one than the finished frames were made of.
void check_inputs(const fs::path& file, const Json& now) {
  if (!fs::exists(file)) return;
  const Json before = read_json_file(file);
  for (const Json* names : {&before, &now})
    for (const auto& [path, hash] : names->items())
      if (!before.contains(path) || !now.contains(path) || before[path] != now[path])
        throw Error(
            "{}: has changed since the frames of {} were recognized; give another output folder, or remove that one",
            path, file.parent_path().string());
}

}  // namespace

std::string title_of_run(const std::string& run) { return run.ends_with(" / -") ? run.substr(0, run.size() - 4) : run; }

std::vector<FrameRecord> run_experiment(const fs::path& spec_file, const fs::path& output, const Progress& progress,
                                        const std::function<void(ExperimentSpec&)>& adjust) {
  const ExperimentSpec spec = read_spec(spec_file, adjust);
  const Json inputs = input_hashes(spec);
  const fs::path inputs_file = output / "inputs.json";
  const fs::path own_spec = output / "experiment.json";
  if (fs::exists(own_spec)) {
    const bool same = read_json_file(own_spec) == to_json(spec);
    if (!same && !read_frame_records(output).empty())
      throw Error("{}: holds another experiment than {}; give another output folder, or remove this one",
                  output.string(), spec_file.string());
    if (!read_frame_records(output).empty()) check_inputs(inputs_file, inputs);
    if (!same) write_json(own_spec, spec);  // of the other nothing was finished
  } else {
    if (fs::exists(output) && !fs::is_empty(output))
      throw Error("{}: is there and is no experiment's folder; give another one", output.string());
    fs::create_directories(output);
    write_json(own_spec, spec);
  }
  write_json_file(inputs_file, inputs);
  Experiment(spec, output, progress).run();
  auto records = in_order_of(spec, read_frame_records(output));
  write_tables(records, spec, output);
  return records;
}

std::vector<FrameRecord> read_frame_records(const fs::path& output) {
  std::vector<FrameRecord> records;
  std::ifstream in(output / "frames.jsonl");
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const Json json = Json::parse(line, nullptr, false);
    if (json.is_discarded()) continue;  // cut off when the run was killed
    try {
      records.push_back(from_json<FrameRecord>(json));
    } catch (const Error& error) {
      throw Error("{}: line {}: {}", (output / "frames.jsonl").string(), number, error.what());
    }
  }
  return records;
}

}  // namespace partpose
