// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"
#include "output.hpp"
#include "recognition_output.hpp"
#include "recognizer_choice.hpp"
#include "scene_reader.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/png.hpp"

#include <CLI/CLI.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <thread>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct LiveArguments {
  std::string source;
  std::vector<fs::path> models;
  std::string recognizer = default_recognizer;
  std::optional<float> min_score;
  fs::path camera, cache, jsonl;
  std::optional<int> frames;
  bool json = false, follow = false;
};

/// Cameras and recordings are read by the Python package (python/partpose/sources.py).
bool is_for_python(const std::string& source) {
  const auto is = [&](const std::string& kind) { return source == kind || source.starts_with(kind + ":"); };
  const std::string ending = lower_case_ending(source);
  return is("realsense") || is("openni") || ending == ".bag" || ending == ".db3" || ending == ".oni";
}

/// Replaces this process when there is such a program.
void execute(std::vector<std::string> words) {
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::fflush(nullptr);
  execvp(pointers[0], pointers.data());
}

/// Goes on as partpose-live, or as that of python3's package, with the same arguments.
[[noreturn]] void become_python(const LiveArguments& arguments, const Common& common) {
  std::vector<std::string> given = {arguments.source, "--recognizer", arguments.recognizer};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) given.insert(given.end(), {option, value});
  };
  add("--min-score", arguments.min_score ? fmt::format("{}", *arguments.min_score) : "");
  add("--cache", arguments.cache.string());
  add("--jsonl", arguments.jsonl.string());
  add("--frames", arguments.frames ? fmt::format("{}", *arguments.frames) : "");
  add("--threads", common.threads > 0 ? fmt::format("{}", common.threads) : "");
  for (const auto& [flag, is_set] : {std::pair{"--json", arguments.json},
                                     {"--follow", arguments.follow},
                                     {"--quiet", common.quiet},
                                     {"--verbose", common.verbose}})
    if (is_set) given.emplace_back(flag);
  given.emplace_back("--models");
  for (const auto& model : arguments.models) given.push_back(model.string());

  std::vector<std::string> program = {"partpose-live"};
  program.insert(program.end(), given.begin(), given.end());
  execute(program);
  const std::string missing = fmt::format(
      "live: {}: cameras and recordings are read by partpose's Python package, which is not installed here: pip "
      "install "
      "'.[realsense]' or '.[openni]' in the folder of its source; a folder of depth PNGs needs none",
      arguments.source);
  program = {"python3", "-c",
             "import sys\n"
             "message = sys.argv.pop(1)\n"
             "try:\n"
             "    from partpose.live import main\n"
             "except ImportError as error:\n"
             "    print(f'partpose: {message} ({error})', file=sys.stderr)\n"
             "    sys.exit(2)\n"
             "sys.exit(main())\n",
             missing};
  program.insert(program.end(), given.begin(), given.end());
  execute(program);
  throw Error("{}", missing);
}

/// The depth PNGs of a folder, by name, each once; those that come later as well. Pictures among them are left out.
class DepthFolder {
 public:
  explicit DepthFolder(fs::path folder) : folder_(std::move(folder)) {
    if (fs::is_regular_file(folder_))
      throw Error("{}: is a file, not a folder; partpose recognize takes single files", folder_.string());
    if (!fs::is_directory(folder_))
      throw Error(
          "{}: no such source; give a folder of depth PNGs, a recording (.bag, .db3, .oni), realsense, "
          "realsense:SERIAL, openni or openni:URI",
          folder_.string());
  }
  /// None: nothing new is there.
  std::optional<fs::path> next() {
    if (waiting_.empty())
      for (const auto& entry : fs::directory_iterator(folder_))
        if (entry.path().extension() == ".png" && known_.insert(entry.path()).second) add(entry.path());
    if (waiting_.empty()) return {};
    return waiting_.extract(waiting_.begin()).value();
  }

  bool has_pictures() const { return has_pictures_; }

 private:
  void add(const fs::path& file) {
    if (!is_picture_png(file)) {
      waiting_.insert(file);
      return;
    }
    if (!has_pictures_)
      complain(fmt::format("{}: is a picture (8-bit or in colours), not a depth image: such files are left out",
                           file.string()));
    has_pictures_ = true;
  }

  fs::path folder_;
  std::set<fs::path> known_, waiting_;
  bool has_pictures_ = false;
};

/// When the file was written last, by the system's clock.
double written_s(const fs::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) throw Error("{}: cannot be read", file.string());
  return static_cast<double>(status.st_mtim.tv_sec) + 1e-9 * static_cast<double>(status.st_mtim.tv_nsec);
}

/// Null where a recognizer says no confidence.
Json confidence_of(const Detection& detection) {
  return detection.confidence > 0 ? Json(detection.confidence) : Json(nullptr);
}

Json json_of(const Detection& detection, const Catalogue& catalogue) {
  Json alternatives = Json::array();
  for (const auto& other : detection.alternatives)
    alternatives.push_back({{"part", catalogue.parts[other.part].name},
                            {"camera_from_model", to_json(other.camera_from_model)},
                            {"probability", other.probability}});
  return {{"part", catalogue.parts[detection.part].name},
          {"camera_from_model", to_json(detection.camera_from_model)},
          {"score", to_json(detection.score)},
          {"confidence", confidence_of(detection)},
          {"alternatives", std::move(alternatives)}};
}

/// The detections, the result first, also of a recognizer that has the result alone.
std::vector<Detection> detections_of(const Recognition& found, const Catalogue& catalogue) {
  if (!found.detections.empty() || found.accepted < 0) return found.detections;
  const Candidate& candidate = found.candidates[found.accepted];
  return {{catalogue.views[candidate.view_row].part, found.result.T_final, candidate.score}};
}

/// Recognizes frames and writes their lines, the same as python/partpose/live.py.
struct Live {
  const PartRecognizer& recognizer;
  const LiveArguments& arguments;
  const Common& common;
  std::optional<std::ofstream> jsonl = {};
  SceneReader reader = SceneReader({.camera = arguments.camera});
  int count = 0, recognized = 0;

  void show(const fs::path& file) {
    const double timestamp_s = written_s(file);
    const Scene scene = reader.read(file);
    const Recognition found = named_after(file, [&] { return recognizer.recognize(scene); });
    const Json line = line_of(file, timestamp_s, found);
    if (arguments.json)
      fmt::print("{}\n", json_line(line));
    else
      fmt::print("{}: {} ({:.0f} ms)\n", file.string(), words_of(found), found.total_ms());
    std::fflush(stdout);
    if (jsonl) *jsonl << json_line(line) << std::endl;
    note_stages(common, found);
    ++count;
    recognized += found.accepted >= 0;
  }

 private:
  Json line_of(const fs::path& file, double timestamp_s, const Recognition& found) const {
    const auto detections = detections_of(found, recognizer.catalogue());
    const bool any = !detections.empty();
    Json line;
    line["frame"] = count;
    line["timestamp_s"] = timestamp_s;
    line["name"] = file.string();
    line["part"] = any ? Json(found.result.model_name) : Json(nullptr);
    line["camera_from_model"] = any ? to_json(found.result.T_final) : Json(nullptr);
    line["score"] = to_json(found.candidates.empty() ? -1.0f : found.candidates[std::max(found.accepted, 0)].score);
    line["confidence"] = any ? confidence_of(detections[0]) : Json(nullptr);
    line["reason"] = found.reason;
    line["detections"] = Json::array();
    for (const auto& detection : detections) line["detections"].push_back(json_of(detection, recognizer.catalogue()));
    line["time_ms"] = found.total_ms();
    return line;
  }

  std::string words_of(const Recognition& found) const {
    if (found.accepted < 0) return fmt::format("nothing recognized: {}", found.reason);
    const Detection best = detections_of(found, recognizer.catalogue())[0];
    const Eigen::Vector3d t = best.camera_from_model.translation();
    return fmt::format("{} at ({:.1f}, {:.1f}, {:.1f}) mm{}", found.result.model_name, t.x(), t.y(), t.z(),
                       certainty_text(best.score, &best));
  }
};

void recognize_folder(const LiveArguments& arguments, const Common& common) {
  check_file_can_be_written(arguments.jsonl);
  DepthFolder folder(arguments.source);
  std::optional<fs::path> file = folder.next();
  if (!file && !arguments.follow)
    throw Error("{}: holds no {}; to wait for files to come, give --follow", arguments.source,
                folder.has_pictures() ? "16-bit depth image" : ".png");
  const auto recognizer = make_recognizer(
      arguments.recognizer,
      catalogue_for(arguments.recognizer, read_parts(arguments.models, {}, common), arguments.cache, common),
      arguments.min_score);
  Live live{*recognizer, arguments, common};
  if (!arguments.jsonl.empty()) {
    live.jsonl.emplace(arguments.jsonl, std::ios::app);
    if (!*live.jsonl) throw Error("{}: cannot be written", arguments.jsonl.string());
  }
  const Unfinished frame;  // each is finished before a signal counts
  const Stopwatch since_start;
  for (; exit_code_of_signal() == 0 && live.count != arguments.frames; file = folder.next()) {
    if (!file && !arguments.follow) break;
    if (!file) {  // looked for again in a moment
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      continue;
    }
    try {
      live.show(*file);
    } catch (const Error& error) {
      // One bad file does not end it.
      complain(error.what());
      ++common.failures;
    }
  }
  if (live.count == 0) check_not_interrupted();
  accept_signal();
  if (live.jsonl && !*live.jsonl)
    throw Error("{}: could not be written completely: is the disk full?", arguments.jsonl.string());
  if (!common.quiet)
    fmt::print(stderr, "{}, {} recognized, {:.1f} frames/s\n", counted(live.count, "frame"), live.recognized,
               1000 * live.count / std::max(since_start.elapsed_ms(), 1e-6));
}

}  // namespace

void add_live_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<LiveArguments>();
  auto* live = app.add_subcommand("live", "Recognize the frames of a camera, a recording or a folder, as they come");
  live->add_option("source", arguments->source,
                   "realsense, realsense:SERIAL, openni, openni:URI, a recording (.bag, .db3, .oni), or a folder of "
                   "16-bit depth PNGs")
      ->required();
  live->add_option("-m,--models", arguments->models, part_files_help)->required();
  live->add_option("--camera", arguments->camera, "Of a folder: camera JSON for all depth images");
  add_recognizer_option(*live, arguments->recognizer);
  add_min_score_option(*live, arguments->min_score);
  live->add_option("--cache", arguments->cache,
                   "Where catalogues for --recognizer recognizer are kept (default: ~/.cache/partpose)");
  live->add_flag("--json", arguments->json, "Print one JSON line for each frame");
  live->add_option("--jsonl", arguments->jsonl,
                   "Append one JSON line for each frame to this file (-: standard output, as --json)");
  live->add_option("--frames", arguments->frames, "End after so many frames")->check(CLI::PositiveNumber);
  live->add_flag("--follow", arguments->follow, "Of a folder: wait for files to come");
  live->footer(
      "Examples:\n"
      "  partpose live realsense --models parts/               # a line of text for each frame\n"
      "  partpose live recording.bag --models parts/ --json    # a line of JSON for each frame of a recording\n"
      "  partpose live frames/ --models parts/ --follow --jsonl out.jsonl   # depth PNGs as some program writes them\n"
      "Cameras and recordings need the Python package (pip install '.[realsense]' or '.[openni]'), whose partpose-live "
      "is\n"
      "the same command. Ctrl-C ends it after the frame at hand, with exit code 0; 130: before the first frame.");
  live->callback([arguments, &common] {
    if (is_standard_output(arguments->jsonl)) {  // a file of that name is hardly meant
      arguments->json = true;
      arguments->jsonl.clear();
    }
    if (!is_for_python(arguments->source)) return recognize_folder(*arguments, common);
    if (arguments->follow) throw Error("{}: only a folder can be followed", arguments->source);
    if (!arguments->camera.empty())
      throw Error("{}: --camera is of folders; cameras and recordings know their own", arguments->source);
    become_python(*arguments, common);
  });
}

}  // namespace partpose::apps
