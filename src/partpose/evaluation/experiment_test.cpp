// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/experiment.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/evaluation/accuracy.hpp"
#include "partpose/evaluation/experiment_tables.hpp"
#include "partpose/evaluation/plot.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/io/testing.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

namespace partpose {
namespace {

namespace fs = std::filesystem;
using shapes::error_of;
using shapes::mentions;

const fs::path root = PARTPOSE_SOURCE_DIR;

/// Two parts from the 12 vertices of an icosahedron, by a small camera, with the reference's pipeline.
Json small_spec() {
  return {{"name", "small"},
          {"groups", {{{"name", "two parts"}, {"parts", {"parts"}}}}},
          {"protocols", {{{"name", "views"}, {"views", "views.json"}}}},
          {"database", "views.json"},
          {"descriptors", {"vfh"}},
          {"configurations", {{{"name", "D"}, {"pipeline", (root / "configs/pipeline_virtual.json").string()}}}},
          {"save_frames", "none"}};
}

class Experiments : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder / "parts");
    write_stl(folder / "parts/bracket.stl", shapes::l_bracket());
    write_stl(folder / "parts/link.stl",
              shapes::joined(shapes::box({0, 0, 0}, {100, 30, 15}), shapes::box({0, 0, 15}, {25, 30, 40})));
    Json views = read_json_file(root / "configs/dataset_ground_truth.json");
    views["virtual_views_icosahedron"]["subdivide"] = 0;
    views["virtual_depth_camera"]["resolution_px"] = {240, 180};
    views["virtual_depth_camera"]["noise"] = {{"model", "none"}, {"standard_deviation_mm", 0.0}};
    write_json_file(folder / "views.json", views);
    views["virtual_depth_camera"]["noise"] = {{"model", "gaussianray"}, {"standard_deviation_mm", 2.0}};
    views["virtual_views_icosahedron"]["xyz_rotation_deg"] = 15.0;
    write_json_file(folder / "noisy_views.json", views);
  }

  std::vector<FrameRecord> run(const Json& spec, const std::string& output = "out") {
    write_json_file(folder / "spec.json", spec);
    return run_experiment(folder / "spec.json", folder / output);
  }
  std::string error_of_run(const Json& spec, const std::string& output = "out") {
    return error_of([&] { run(spec, output); });
  }

  testing::TempFolder folder;
};

/// What must be the same when a frame is recognized again: all but times and folders.
std::string lasting(FrameRecord record) {
  record.time_ms = 0;
  record.folder.clear();
  record.result.timestamp.clear();
  record.evaluation.timestamp.clear();
  for (auto& stage : record.stages) stage.measure_ms = 0;
  return json_line(to_json(record));
}

void expect_same(const std::vector<FrameRecord>& a, const std::vector<FrameRecord>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(lasting(a[i]), lasting(b[i])) << "record " << i;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The folders of frames that an experiment kept, relative to its own.
std::set<std::string> kept_folders(const fs::path& output) {
  std::set<std::string> folders;
  if (!fs::exists(output / "frames")) return folders;
  for (const auto& run : fs::directory_iterator(output / "frames"))
    for (const auto& frame : fs::directory_iterator(run))
      if (frame.path().filename() != "meshes") folders.insert(fs::relative(frame.path(), output).string());
  return folders;
}
std::set<std::string> folders_of(const std::vector<FrameRecord>& records) {
  std::set<std::string> folders;
  for (const auto& record : records)
    if (!record.folder.empty()) folders.insert(record.folder);
  return folders;
}

TEST_F(Experiments, EveryViewOfEveryPartIsRecognizedAndJudgedOnce) {
  const auto records = run(small_spec());
  ASSERT_EQ(records.size(), 24u);
  std::set<std::string> frames;
  for (const auto& record : records) frames.insert(record.frame);
  for (const char* part : {"bracket", "link"})
    for (int view = 0; view < 12; ++view)
      EXPECT_EQ(frames.count(fmt::format("{}_view_{}", part, view)), 1u) << part << view;
  EXPECT_EQ(lines_of(folder / "out/frames.jsonl").size(), 24u);
  expect_same(
      in_order_of(read_json<ExperimentSpec>(folder / "out/experiment.json"), read_frame_records(folder / "out")),
      records);

  // Scenes are the database's own views: nearly all are right, and the pose that is judged is that of the view.
  const Dataset dataset = open_dataset(fs::directory_iterator(folder / "out/datasets")->path());
  int correct = 0;
  for (const auto& r : records) {
    EXPECT_EQ(r.run, "two parts / views / D / vfh");
    EXPECT_EQ(r.frame,
              fmt::format("{}_view_{}", r.evaluation.ground_truth_model_name, r.evaluation.ground_truth_view_id));
    std::size_t model = 0, view = 0;
    while (dataset.out.models.at(model).name != r.evaluation.ground_truth_model_name) ++model;
    while (dataset.out.views.at(view).id != r.evaluation.ground_truth_view_id) ++view;
    const GroundTruth truth{dataset.out.models[model].name, dataset.camera_from_model(model, view)};
    EXPECT_TRUE(r.evaluation.ground_truth_transformation_matrix.isApprox(truth.camera_from_model, 1e-6));
    EXPECT_NEAR(r.evaluation.translation_error_mm, evaluate(r.result, truth).translation_error_mm, 1e-3);
    EXPECT_EQ(r.evaluation.recognized_correctly, r.result.model_name == truth.model_name);
    EXPECT_EQ(r.evaluation.mssd_mm.has_value(), r.evaluation.recognized_correctly);
    if (r.result.candidate_id >= 0) {
      EXPECT_GE(r.score, 0);
      EXPECT_TRUE(r.reason.empty());
    } else {
      EXPECT_FALSE(r.reason.empty());
    }
    EXPECT_GT(r.time_ms, 0);
    EXPECT_FALSE(r.stages.empty());
    EXPECT_TRUE(r.folder.empty());
    correct += r.evaluation.recognized_correctly;
  }
  EXPECT_GE(correct, 20);
  for (const char* file :
       {"tables.md", "tables.json", "recognition.csv", "poses.csv", "confusion.csv", "errors.csv", "times.csv"})
    EXPECT_GT(fs::file_size(folder / "out" / file), 0u) << file;
  EXPECT_EQ(read_json_file(folder / "out/tables.json")["runs"][0]["correct"], correct);
}

TEST_F(Experiments, AKilledRunGoesOnWithoutLosingOrRepeatingAFrame) {
  Json spec = small_spec();
  spec["save_frames"] = "all";
  const auto whole = run(spec);
  const auto lines = lines_of(folder / "out/frames.jsonl");
  ASSERT_EQ(lines.size(), 24u);
  EXPECT_EQ(kept_folders(folder / "out"), folders_of(whole));
  EXPECT_EQ(folders_of(whole).size(), 24u);

  const auto joined = [&](std::size_t begin, std::size_t end) {
    std::string text;
    for (std::size_t i = begin; i < end; ++i) text += lines[i] + "\n";
    return text;
  };
  const std::string cut_line = lines[20].substr(0, lines[20].size() / 2);
  struct Case {
    const char* name;
    std::string left;
    std::size_t finished;
  };
  const std::vector<Case> cases = {
      {"nothing was written", "", 0},
      {"cut off in the first line", lines[0].substr(0, 10), 0},
      {"cut off in the middle of a line", joined(0, 20) + cut_line, 20},
      {"cut off before the end of a line", joined(0, 20) + lines[20], 21},
      {"lines are missing", joined(0, 3) + joined(9, 24), 18},
      {"killed twice", joined(0, 5) + cut_line + "\n" + joined(5, 22) + lines[22].substr(0, 1), 22},
      {"all were finished", joined(0, 24), 24},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    const fs::path output = folder / c.name;
    fs::copy(folder / "out", output, fs::copy_options::recursive);
    std::ofstream(output / "frames.jsonl", std::ios::binary) << c.left;
    const auto before = read_frame_records(output);
    EXPECT_EQ(before.size(), c.finished);
    const auto again = run(spec, c.name);
    expect_same(again, whole);
    // What was finished is there as it was, once; beside it only what was missing.
    const auto now = lines_of(output / "frames.jsonl");
    EXPECT_EQ(read_frame_records(output).size(), 24u);
    for (const auto& record : before)
      EXPECT_EQ(std::count(now.begin(), now.end(), json_line(to_json(record))), 1) << record.frame;
    EXPECT_EQ(kept_folders(output), folders_of(again)) << "folders of frames that were never finished";
    EXPECT_EQ(folders_of(again).size(), 24u);
  }
}

TEST_F(Experiments, TheNumberOfThreadsChangesNothing) {
  Json spec = small_spec(), one_by_one = spec;
  spec["protocols"][0]["views"] = one_by_one["protocols"][0]["views"] = "noisy_views.json";
  const auto several = run(spec);
  one_by_one["parallel_frames"] = false;
  const ThreadLimit limit(1);
  expect_same(run(spec, "one thread"), several);
  expect_same(run(one_by_one, "one by one"), several);
}

TEST_F(Experiments, OtherContentOfTheOutputFolderIsNotTouched) {
  Json spec = small_spec();
  spec["groups"][0]["parts"] = {"parts/link.stl"};
  run(spec);
  const std::string finished = read_file(folder / "out/frames.jsonl");
  Json other = spec;
  other["limit_mm"] = 3;
  EXPECT_PRED2(mentions, error_of_run(other), "holds another experiment");
  EXPECT_EQ(read_file(folder / "out/frames.jsonl"), finished);
  EXPECT_EQ(run(spec).size(), 12u) << "the first one is still accepted";

  fs::create_directories(folder / "foreign");
  folder.file("foreign/thesis.txt", "years of work");
  EXPECT_PRED2(mentions, error_of_run(spec, "foreign"), "is no experiment's folder");
  EXPECT_EQ(read_file(folder / "foreign/thesis.txt"), "years of work");
  EXPECT_FALSE(fs::exists(folder / "foreign/experiment.json"));

  fs::create_directories(folder / "empty");
  EXPECT_EQ(run(spec, "empty").size(), 12u);
}

TEST_F(Experiments, ASpecThatFailedBeforeItsFirstFrameMayBeMended) {
  Json spec = small_spec();
  spec["groups"][0]["parts"] = {"parts/lnik.stl"};
  EXPECT_PRED2(mentions, error_of_run(spec), "lnik.stl");
  spec["groups"][0]["parts"] = {"parts/link.stl"};
  EXPECT_EQ(run(spec).size(), 12u);
}

TEST_F(Experiments, BadSpecs) {
  const auto with = [](const std::string& pointer, const Json& value) {
    Json spec = small_spec();
    spec[Json::json_pointer(pointer)] = value;
    return spec;
  };
  EXPECT_PRED2(mentions, error_of_run(with("/descriptor", "vfh")), "did you mean \"descriptors\"");
  EXPECT_PRED2(mentions, error_of_run(with("/protocols/0/veiws", "x")), "views\"");
  EXPECT_PRED2(mentions, error_of_run(with("/descriptors", Json::array({"vhf"}))), "did you mean \"vfh\"");
  EXPECT_PRED2(mentions, error_of_run(with("/descriptors", Json::array())), "descriptors: give at least one");
  EXPECT_PRED2(mentions, error_of_run(with("/groups", Json::array())), "groups: give at least one");
  EXPECT_PRED2(mentions, error_of_run(with("/protocols", Json::array())), "protocols: give at least one");
  EXPECT_PRED2(mentions, error_of_run(with("/configurations", Json::array())), "configurations: give at least one");
  EXPECT_PRED2(mentions, error_of_run(with("/groups/0/parts", Json::array())), "parts: give at least one");
  EXPECT_PRED2(mentions, error_of_run(with("/groups/0/name", "")), "name: must not be empty");
  EXPECT_PRED2(mentions, error_of_run(with("/groups/1", small_spec()["groups"][0])), "\"two parts\" is there twice");
  EXPECT_PRED2(mentions, error_of_run(with("/protocols/0/captured", "scenes")),
               "one of \"views\", \"captured\" and \"scenes\"");
  EXPECT_PRED2(mentions, error_of_run(with("/protocols/0/views", "")), "one of \"views\", \"captured\" and \"scenes\"");
  EXPECT_PRED2(mentions, error_of_run(with("/protocols/0/frames", 0)), "frames 0");
  EXPECT_PRED2(mentions, error_of_run(with("/limit_deg", 0)), "limit_deg 0");
  EXPECT_PRED2(mentions, error_of_run(with("/limit_mm", -1)), "limit_mm -1");
  EXPECT_PRED2(mentions, error_of_run(with("/save_frames", "some")), "save_frames \"some\"");
  EXPECT_PRED2(mentions, error_of_run(with("/limit_mm", "15")), "limit_mm");
  unsetenv("PARTPOSE_TEST_FOLDER");
  EXPECT_PRED2(mentions, error_of_run(with("/groups/0/parts/0", "${PARTPOSE_TEST_FOLDER}/parts")),
               "the environment variable PARTPOSE_TEST_FOLDER is not set");
  EXPECT_PRED2(mentions, error_of_run(with("/groups/0/parts/0", "${PARTPOSE_TEST_FOLDER/parts")), "without \"}\"");
  EXPECT_PRED2(mentions, error_of([&] { run_experiment(folder / "nowhere.json", folder / "out"); }), "nowhere.json");
  EXPECT_PRED2(mentions, error_of([&] { run_experiment(folder.file("broken.json", "{\"name\": "), folder / "out"); }),
               "broken.json");
  EXPECT_FALSE(fs::exists(folder / "out")) << "a bad spec leaves nothing behind";

  // What it names is missing: said before any frame is recognized.
  EXPECT_PRED2(mentions, error_of_run(with("/protocols/0/views", "nowhere.json")), "nowhere.json");
  EXPECT_PRED2(mentions, error_of_run(with("/database", "nowhere.json")), "nowhere.json");
  EXPECT_PRED2(mentions, error_of_run(with("/configurations/1", {{"name", "E"}, {"pipeline", "nowhere.json"}})),
               "nowhere.json");
  EXPECT_TRUE(read_frame_records(folder / "out").empty());
}

TEST_F(Experiments, EnvironmentVariablesAndPathsBesideTheSpec) {
  setenv("PARTPOSE_TEST_FOLDER", (folder / "parts").c_str(), 1);
  setenv("PARTPOSE_TEST_PART", "link", 1);
  Json spec = small_spec();
  spec["groups"][0]["parts"] = {"${PARTPOSE_TEST_FOLDER}/${PARTPOSE_TEST_PART}.stl"};
  EXPECT_EQ(run(spec).size(), 12u);
  const auto as_run = read_json<ExperimentSpec>(folder / "out/experiment.json");
  EXPECT_EQ(as_run.groups[0].parts[0], fs::weakly_canonical(folder / "parts/link.stl").string());
  EXPECT_EQ(as_run.database, fs::weakly_canonical(folder / "views.json").string());
}

TEST_F(Experiments, APartThatIsLeftOutIsNeverNamed) {
  Json spec = small_spec();
  spec["protocols"].push_back({{"name", "left out"}, {"views", "views.json"}, {"left_out", true}});
  const auto records = run(spec);
  ASSERT_EQ(records.size(), 48u);
  int left_out = 0;
  for (const auto& r : records) {
    if (!r.left_out) continue;
    ++left_out;
    EXPECT_FALSE(r.evaluation.ground_truth_model_name.empty());
    EXPECT_NE(r.result.model_name, r.evaluation.ground_truth_model_name) << r.frame;
    EXPECT_FALSE(r.best_is_right) << r.frame;
    EXPECT_EQ(r.evaluation.recognized_correctly, r.result.candidate_id < 0) << "nothing is right";
  }
  EXPECT_EQ(left_out, 24);
  EXPECT_TRUE(fs::exists(folder / "out/accepts.csv"));
  EXPECT_TRUE(fs::exists(folder / "out/accepts.svg"));

  // A catalogue of one part would be empty without it: such runs have no frames.
  spec["groups"][0]["parts"] = {"parts/link.stl"};
  EXPECT_EQ(run(spec, "one part").size(), 12u);
}

TEST_F(Experiments, DrawnScenes) {
  Json spec = small_spec();
  Json camera = {{"width", 320}, {"height", 240}, {"fx", 307.5}, {"fy", 307.5}, {"cx", 159.5}, {"cy", 119.5}};
  Json scenes = {{"scene", {{"camera", camera}}}, {"sensor", {{"model", "none"}}}};
  write_json_file(folder / "scenes.json", scenes);
  spec["protocols"] = {{{"name", "drawn"}, {"scenes", "scenes.json"}, {"frames", 3}}};
  spec["configurations"] = {{{"name", "recognizer"}}};
  spec["save_frames"] = "all";
  const auto records = run(spec);
  ASSERT_EQ(records.size(), 3u);
  for (const auto& r : records) {
    EXPECT_EQ(r.descriptor, "-");
    EXPECT_TRUE(r.evaluation.ground_truth_model_name == "bracket" || r.evaluation.ground_truth_model_name == "link");
    EXPECT_GT(r.evaluation.ground_truth_transformation_matrix.translation().z(), 400);
    EXPECT_TRUE(fs::exists(folder / "out" / r.folder / "scene_depth.png"));
  }
  // Other frames of the same parts are other data; the first ones are drawn alike.
  spec["protocols"][0]["frames"] = 2;
  const auto fewer = run(spec, "fewer");
  ASSERT_EQ(fewer.size(), 2u);
  expect_same(fewer, {records[0], records[1]});

  // A frame with two parts, one of which is left out, rightly shows the other.
  scenes["scene"]["parts"] = {1, 2};
  write_json_file(folder / "scenes.json", scenes);
  spec["protocols"][0]["left_out"] = true;
  EXPECT_PRED2(mentions, error_of_run(spec, "two parts"), "scene.parts");
}

TEST_F(Experiments, TheEngineNeedsMeshesAlone) {
  Json spec = small_spec();
  spec["protocols"] = {{{"name", "noisy"}, {"views", "noisy_views.json"}},
                       {{"name", "left out"}, {"views", "noisy_views.json"}, {"left_out", true}}};
  spec["configurations"] = {{{"name", "engine"}, {"recognizer", "engine"}}};
  spec["save_frames"] = "all";
  spec["most_frames"] = 7;
  const auto records = run(spec);
  ASSERT_EQ(records.size(), 14u);
  int folders = 0;  // the scenes' dataset, none for the catalogue
  for (const auto& entry : fs::directory_iterator(folder / "out/datasets")) folders += entry.is_directory();
  EXPECT_EQ(folders, 1);
  std::set<std::string> shown;
  int bounds = 0;
  for (const auto& r : records) {
    shown.insert(r.evaluation.ground_truth_model_name);
    ASSERT_TRUE(r.objects.has_value());
    EXPECT_EQ(r.objects->objects.size(), r.left_out ? 0u : 1u);
    EXPECT_TRUE(fs::exists(folder / "out" / r.folder / "result.json"));
    if (!r.objects->objects.empty() && r.evaluation.recognized_correctly) {
      EXPECT_EQ(r.objects->objects[0].part, r.evaluation.ground_truth_model_name);
      EXPECT_EQ(r.objects->objects[0].detection, 0);
    }
    EXPECT_EQ(r.bound.has_value(), !r.left_out && r.evaluation.recognized_correctly);
    if (r.bound && r.bound->determined) {
      ++bounds;
      EXPECT_GT(r.bound->translation_mm, 0.01);
      EXPECT_LT(r.bound->translation_mm, 2);
    }
  }
  EXPECT_EQ(shown.size(), 2u);  // spread over all of the protocol
  EXPECT_GT(bounds, 0);
  const std::string page = read_file(folder / "out/tables.md");
  for (const char* words :
       {"each to be found", "Cramer-Rao", "## Confidence of engine", "| not in the catalogue | 7 |"})
    EXPECT_PRED2(mentions, page, words);

  // The argument stands before the file.
  write_json_file(folder / "spec.json", spec);
  EXPECT_EQ(
      run_experiment(folder / "spec.json", folder / "few", {}, [](ExperimentSpec& s) { s.most_frames = 3; }).size(),
      6u);
  spec["most_frames"] = -1;
  EXPECT_PRED2(mentions, error_of_run(spec, "bad"), "most_frames -1: must be 0 or more");
}

TEST_F(Experiments, EveryObjectOfAFrameIsAskedFor) {
  Json spec = small_spec();
  const Json scenes = {{"scene", {{"parts", {2, 2}}, {"contact", "touching"}, {"least_visible_fraction", 0.6}}},
                       {"sensor", {{"model", "none"}}}};
  write_json_file(folder / "scenes.json", scenes);
  spec["protocols"] = {{{"name", "touching"}, {"scenes", "scenes.json"}, {"frames", 3}}};
  spec["configurations"] = {{{"name", "engine"}, {"recognizer", "engine"}}};
  spec["save_frames"] = "failures";
  const auto records = run(spec);
  ASSERT_EQ(records.size(), 3u);
  bool fails = false;
  for (const auto& r : records) {
    ASSERT_EQ(r.objects->objects.size(), 2u);
    EXPECT_NE(r.objects->objects[0].part, r.objects->objects[1].part);
    for (const auto& object : r.objects->objects) {
      EXPECT_GE(object.visible_fraction, 0.6);
      fails = fails || !object.pose_right;
    }
    for (const auto& detection : r.objects->detections) fails = fails || detection.object < 0;
  }
  EXPECT_EQ(summarize_runs(records, ExperimentSpec{})[0].objects, 6);
  EXPECT_EQ(fs::exists(folder / "out/failures"), fails);
}

TEST_F(Experiments, CapturedScenesOfTheGroupsParts) {
  Json spec = small_spec();
  spec["protocols"] = {{{"name", "captured"}, {"captured", (root / "scenes").string()}, {"kinds", {"instance"}}}};
  spec["configurations"] = {{{"name", "recognizer"}}};
  spec["groups"][0]["parts"] = {(root / "parts/bracket.stl").string()};
  const Json truth = read_json_file(root / "scenes/gt.json");
  std::set<std::string> expected;
  for (const auto& scene : truth["scenes"])
    if (scene["kind"] == "instance" && (scene["model"] == "bracket" || scene["model"] == ""))
      expected.insert(scene["scene"].get<std::string>());
  std::set<std::string> frames;
  for (const auto& r : run(spec)) frames.insert(r.frame);
  EXPECT_GE(expected.size(), 1u);
  EXPECT_EQ(frames, expected);
  // None of another kind.
  spec["protocols"][0]["kinds"] = {"nothing"};
  EXPECT_TRUE(run(spec, "no kind").empty());
}

TEST(Experiment, ARunWithoutADescriptorIsShownWithoutIt) {
  EXPECT_EQ(title_of_run("a / b / engine / -"), "a / b / engine");
  EXPECT_EQ(title_of_run("a / b / D / vfh"), "a / b / D / vfh");
}

TEST_F(Experiments, WhichFramesAreKept) {
  Json spec = small_spec();
  spec["protocols"][0]["views"] = "noisy_views.json";
  const auto none = run(spec, "none");
  EXPECT_FALSE(fs::exists(folder / "none/frames"));
  // As poses are judged: neither MSSD below 10 % of the diameter, nor to be taken for the truth.
  const auto is_failure = [&](const FrameRecord& r) {
    const Evaluation& e = r.evaluation;
    return !e.indistinguishable.value_or(false) && !(e.recognized_correctly && *e.mssd_mm < 0.1f * *e.diameter_mm);
  };
  spec["save_frames"] = "failures";
  const auto records = run(spec, "failures");
  int failures = 0;
  for (const auto& r : records) {
    EXPECT_EQ(r.folder.empty(), !is_failure(r)) << r.frame;
    failures += is_failure(r);
    if (r.folder.empty()) continue;
    for (const char* file : {"extras.json", "result.json", "evaluation.json", "scene_original.ply"})
      EXPECT_TRUE(fs::exists(folder / "failures" / r.folder / file)) << r.frame << ": " << file;
    EXPECT_EQ(json_line(read_json_file(folder / "failures" / r.folder / "evaluation.json")),
              json_line(to_json(r.evaluation)));
  }
  EXPECT_GT(failures, 0);
  EXPECT_LT(failures, 24);
  // The list has the same ones, below a heading of two lines.
  int listed = -2;
  for (const auto& line : lines_of(folder / "failures/failures/two-parts---views---D---vfh.md"))
    listed += line[0] == '|';
  EXPECT_EQ(listed, failures);
  EXPECT_EQ(kept_folders(folder / "failures"), folders_of(records));
  expect_same(none, records);
}

TEST_F(Experiments, Progress) {
  write_json_file(folder / "spec.json", small_spec());
  std::size_t last = 0, total = 0;
  run_experiment(folder / "spec.json", folder / "out", [&](std::string_view what, std::size_t done, std::size_t all) {
    if (what != "recognizing") return;
    EXPECT_EQ(done, last + 1);
    last = done;
    total = all;
  });
  EXPECT_EQ(last, 24u);
  EXPECT_EQ(total, 24u);
}

TEST(ReadFrameRecords, NoFileAndDamagedLines) {
  const testing::TempFolder folder;
  EXPECT_TRUE(read_frame_records(folder / "nowhere").empty());
  FrameRecord record;
  record.run = "a / b / c / d";
  record.frame = "f";
  const std::string line = json_line(to_json(record));
  folder.file("frames.jsonl", line + "\n" + line.substr(0, 50) + "\n\n" + line + "\n");
  EXPECT_EQ(read_frame_records(folder / "").size(), 2u);
  folder.file("frames.jsonl", line + "\n" + line.substr(0, 50) + "\n{\"run\": 3}\n");
  EXPECT_PRED2(mentions, error_of([&] { read_frame_records(folder / ""); }), "line 3");
}

}  // namespace
}  // namespace partpose
