// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/progress.hpp"
#include "partpose/evaluation/object_judge.hpp"
#include "partpose/pipeline/records.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace partpose {

/// Some parts that are in the catalogue together.
struct PartGroup {
  std::string name;
  std::vector<std::string> parts;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("name", self.name, "names the group in the tables");
    visit("parts", self.parts, "model files, or folders of them");
  }
  void check() const;
};

/// Where the scenes come from.
struct ExperimentProtocol {
  std::string name;
  std::string views;
  std::string captured;
  std::vector<std::string> kinds;
  std::string scenes;
  int frames = 100;
  bool left_out = false;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("name", self.name, "names the protocol in the tables");
    visit("views", self.views, "dataset configuration (JSON) by which the group's parts are rendered as scenes");
    visit("captured", self.captured,
          "or: folder of captured scenes with gt.json, of which those of the group's parts are used; none of them: no "
          "run");
    visit("kinds", self.kinds, "captured scenes of these kinds only; empty: all");
    visit("scenes", self.scenes,
          "or: scene configuration (JSON, see docs/scenes.md) by which frames of the group's parts are drawn");
    visit("frames", self.frames, "how many frames are drawn by \"scenes\", >= 1");
    visit("left_out", self.left_out,
          "each scene is shown to a catalogue without its part: every recognition is a false accept");
  }
  void check() const;
};

struct ExperimentConfiguration {
  std::string name;
  std::string pipeline;
  std::string recognizer = "engine";
  std::optional<float> min_score = {};

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("name", self.name, "names the configuration in the tables");
    visit("recognizer", self.recognizer, "where nothing is configured: \"engine\" or \"recognizer\"");
    visit("min_score", self.min_score, "of the engine: what scores less is refused, 0 to 1; absent: its default");
    visit("pipeline", self.pipeline, "pipeline configuration (JSON); empty: nothing is configured");
  }
  void check() const;
};

/// A grid of runs: each group with each protocol, configuration and descriptor. Paths are relative to the file, and
/// ${NAME} stands for an environment variable.
struct ExperimentSpec {
  std::string name;
  std::vector<PartGroup> groups;
  std::vector<ExperimentProtocol> protocols;
  std::string database;
  std::vector<std::string> descriptors = {"vfh"};
  std::vector<ExperimentConfiguration> configurations = {{"default", ""}};
  int most_frames = 0;
  double limit_deg = 15;
  double limit_mm = 15;
  std::string save_frames = "failures";
  bool parallel_frames = true;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("name", self.name, "title of the tables");
    visit("groups", self.groups, "which parts are in the catalogue together");
    visit("protocols", self.protocols, "which scenes are shown");
    visit("database", self.database, "dataset configuration (JSON) of the catalogue's views; empty: the defaults");
    visit("descriptors", self.descriptors, "global descriptors that a configuration is run with, in place of its own");
    visit("configurations", self.configurations, "which pipelines recognize them");
    visit("most_frames", self.most_frames,
          "at most so many frames of each protocol, spread evenly over it; 0: all of them");
    visit("limit_deg", self.limit_deg, "a pose is right below this rotation error [deg], > 0");
    visit("limit_mm", self.limit_mm, "a pose is right below this translation error [mm], > 0");
    visit("save_frames", self.save_frames,
          "which frames keep an output folder for the report: \"none\", \"failures\" or \"all\"");
    visit("parallel_frames", self.parallel_frames,
          "several frames side by side; false: times are those of an idle machine");
  }
  void check() const;
};

/// The error of a right part's pose beside the Cramer-Rao bound of the frame (pose_bound()), both about the middle of
/// the part's box; up to the part's symmetry.
struct BoundRecord {
  bool determined = false;
  double rotation_deg = 0, translation_mm = 0;
  double rotation_error_deg = 0, translation_error_mm = 0;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("determined", self.determined, "whether the ranges determine the pose; without it the rest is 0");
    visit("rotation_deg", self.rotation_deg, "bound of the rotation: root of the trace [deg]");
    visit("translation_mm", self.translation_mm, "bound of the translation: root of the trace [mm]");
    visit("rotation_error_deg", self.rotation_error_deg, "reached [deg]");
    visit("translation_error_mm", self.translation_error_mm, "reached [mm]");
  }
};

/// What one frame of one run gave: one line of frames.jsonl.
struct FrameRecord {
  std::string run;  ///< names the run: group, protocol, configuration and descriptor
  std::string group, protocol, configuration, descriptor;
  std::string frame;  ///< names the frame within its protocol
  bool left_out = false;
  Result result;
  Evaluation evaluation;
  float score = -1;            ///< of the best candidate, accepted or not; -1: there was none
  bool best_is_right = false;  ///< whether that candidate names the part shown
  std::string reason;          ///< why nothing was recognized
  std::vector<MeasuredOperation> stages;
  double time_ms = 0;
  std::optional<FrameObjects> objects;  ///< absent in the records of older versions
  std::optional<BoundRecord> bound;     ///< where the noise is known and the part is right
  std::string folder;                   ///< of the frame's output, relative to the experiment's; empty: not kept

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("run", self.run, "group, protocol, configuration and descriptor");
    visit("group", self.group, "the parts");
    visit("protocol", self.protocol, "the scenes");
    visit("configuration", self.configuration, "the pipeline");
    visit("descriptor", self.descriptor, "its descriptor; \"-\": the Recognizer's own");
    visit("frame", self.frame, "names the frame within its protocol");
    visit("left_out", self.left_out, "whether the part shown is missing from the catalogue");
    visit("result", self.result, "C.2.2");
    visit("evaluation", self.evaluation, "C.2.4");
    visit("score", self.score, "of the best candidate, accepted or not, 0 to 1; -1: there was none");
    visit("best_is_right", self.best_is_right, "whether that candidate names the part shown");
    visit("reason", self.reason, "why nothing was recognized");
    visit("stages", self.stages, "time of each step");
    visit("time_ms", self.time_ms, "time of the frame [ms]");
    visit("objects", self.objects, "each object of the frame and each detection");
    visit("bound", self.bound, "the physical limit beside the error; where the noise is known and the part is right");
    visit("folder", self.folder, "of the frame's output; empty: not kept");
  }
};

/// A run's name for people: without the "-" of a configuration that has no descriptor.
std::string title_of_run(const std::string& run);

/// Runs all frames that `output` does not have yet, and writes the tables. What `output` holds:
/// experiment.json (the spec as it is run), frames.jsonl (one line per finished frame, written at once, so that a run
/// that was killed goes on where it stopped), frames/ (output folders), datasets/, and the tables of write_tables().
/// Throws Error when `output` holds finished frames of another experiment, or anything else. The records are in the
/// order of in_order_of(). `adjust` may change what the file says, before its paths are resolved.
std::vector<FrameRecord> run_experiment(const std::filesystem::path& spec_file, const std::filesystem::path& output,
                                        const Progress& progress = {},
                                        const std::function<void(ExperimentSpec&)>& adjust = {});

/// The finished frames of an experiment's folder; a half-written last line is left out. Empty when there is no such
/// file.
std::vector<FrameRecord> read_frame_records(const std::filesystem::path& output);

}  // namespace partpose
