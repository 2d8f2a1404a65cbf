// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/experiment_tables.hpp"

#include "partpose/core/random.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "tests/shapes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <unistd.h>

namespace partpose {
namespace {

namespace fs = std::filesystem;

using Rows = std::vector<std::vector<std::string>>;

class TemporaryFolder {
 public:
  TemporaryFolder() : path_(fs::temp_directory_path() / fmt::format("partpose_tables_{}_{}", getpid(), count_++)) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  static inline int count_ = 0;
  fs::path path_;
};

/// CSV as of RFC 4180.
Rows read_csv(const fs::path& path) {
  const std::string text = read_file(path);
  Rows rows(1, {""});
  bool in_quotes = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& cell = rows.back().back();
    if (text[i] == '"' && in_quotes && i + 1 < text.size() && text[i + 1] == '"')
      cell += text[i++];
    else if (text[i] == '"')
      in_quotes = !in_quotes;
    else if (text[i] == ',' && !in_quotes)
      rows.back().emplace_back();
    else if (text[i] == '\n' && !in_quotes)
      rows.push_back({""});
    else
      cell += text[i];
  }
  EXPECT_FALSE(in_quotes) << path;
  EXPECT_EQ(rows.back(), std::vector<std::string>{""}) << path << " does not end with a line";
  rows.pop_back();
  return rows;
}

/// The cell of a column, by its name in the first row.
std::string cell(const Rows& rows, std::size_t row, const std::string& column) {
  const auto it = std::find(rows.at(0).begin(), rows.at(0).end(), column);
  if (it == rows[0].end()) {
    ADD_FAILURE() << "no column " << column;
    return "";
  }
  return rows.at(row).at(static_cast<std::size_t>(it - rows[0].begin()));
}

ExperimentSpec spec_of(const std::vector<std::string>& protocols = {"seen"}) {
  ExperimentSpec spec;
  spec.name = "By hand";
  spec.groups = {{"parts", {"parts"}}};
  for (const auto& name : protocols) {
    ExperimentProtocol protocol;
    protocol.name = name;
    protocol.views = "views.json";
    protocol.left_out = name == "left out";
    spec.protocols.push_back(protocol);
  }
  spec.configurations = {{"D", "pipeline.json"}};
  spec.descriptors = {"vfh"};
  spec.limit_deg = 15;
  spec.limit_mm = 10;
  return spec;
}

FrameRecord record_of(const std::string& frame, const std::string& shown, const std::string& named,
                      float rotation_deg = -1, float translation_mm = -1) {
  FrameRecord r;
  r.group = std::string("parts");
  r.protocol = std::string("seen");
  r.configuration = std::string("D");
  r.descriptor = std::string("vfh");
  r.run = std::string("parts / seen / D / vfh");
  r.frame = frame;
  r.result.model_name = named;
  r.result.candidate_id = named.empty() ? -1 : 0;
  r.evaluation.ground_truth_model_name = shown;
  r.evaluation.recognized_correctly = shown == named;
  r.evaluation.rotation_error_deg = rotation_deg;
  r.evaluation.translation_error_mm = translation_mm;
  return r;
}

FrameRecord of_protocol(FrameRecord r, const std::string& protocol) {
  r.protocol = protocol;
  r.run = fmt::format("{} / {} / {} / {}", r.group, protocol, r.configuration, r.descriptor);
  if (protocol == "left out") {
    r.left_out = true;
    r.evaluation.recognized_correctly = r.result.candidate_id < 0;
  }
  return r;
}

FrameRecord with_mssd(FrameRecord r, float mssd_mm, bool indistinguishable) {
  r.evaluation.diameter_mm = 100;
  r.evaluation.mssd_mm = mssd_mm;
  r.evaluation.indistinguishable = indistinguishable;
  return r;
}

FrameRecord scored(const std::string& shown, float score, bool best_is_right, bool left_out) {
  FrameRecord r = record_of("f", shown, "");
  r.score = score;
  r.best_is_right = best_is_right;
  r.left_out = left_out;
  return r;
}

/// Eight frames: 5 correct, 2 wrong, 1 none.
std::vector<FrameRecord> eight_frames() {
  std::vector<FrameRecord> records = {
      with_mssd(record_of("f0", "a", "a", 1, 2), 4, true),          // right by all
      with_mssd(record_of("f1", "a", "a", 14.9f, 9.9f), 8, false),  // within the limits, MSSD between 5 and 10 %
      with_mssd(record_of("f2", "a", "a", 15, 1), 5, false),        // at the limit is not below it; 5 % neither
      with_mssd(record_of("f3", "a", "a", 3, 10), 10, false),       // the same
      with_mssd(record_of("f4", "b", "b", 180, 1), 80, true),       // wrong, but for the camera
      with_mssd(record_of("f5", "b", "a"), 0, true),                // another part that looks the same
      record_of("f6", "b", "c"),
      record_of("f7", "b", ""),
  };
  records[5].evaluation.mssd_mm.reset();
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].time_ms = 10.0 * static_cast<double>(i + 1);  // 10 to 80
    records[i].stages = {{static_cast<double>(i), "normals"}};
  }
  records[7].stages.push_back({100, "verification"});
  return records;
}

TEST(SummarizeRuns, CountsByHand) {
  const auto summaries = summarize_runs(eight_frames(), spec_of());
  ASSERT_EQ(summaries.size(), 1u);
  const RunSummary& s = summaries[0];
  EXPECT_EQ(s.frames, 8);
  EXPECT_EQ(s.correct, 5);
  EXPECT_EQ(s.wrong, 2);
  EXPECT_EQ(s.none, 1);
  EXPECT_EQ(s.pose_right, 2);
  EXPECT_EQ(s.mssd_10, 3);
  EXPECT_EQ(s.mssd_5, 1);
  EXPECT_EQ(s.seen_right, 5);  // f0, f1, f2, f4, f5
  EXPECT_DOUBLE_EQ(s.percent(s.correct), 62.5);
  EXPECT_EQ(RunSummary{}.percent(0), 0);
  EXPECT_EQ(s.rotation_errors_deg.size(), 5u);
  EXPECT_EQ(s.translation_errors_mm.size(), 5u);
  const std::map<std::pair<std::string, std::string>, int> confusion = {
      {{"a", "a"}, 4}, {{"b", "b"}, 1}, {{"b", "a"}, 1}, {{"b", "c"}, 1}, {{"b", ""}, 1}};
  EXPECT_EQ(s.confusion, confusion);
  EXPECT_EQ(s.stage_ms.at("normals").size(), 8u);
  EXPECT_EQ(s.stage_ms.at("verification"), std::vector<double>{100});
  EXPECT_TRUE(summarize_runs({}, spec_of()).empty());
}

TEST(SummarizeRuns, ScenesThatShowNothingAndPartsLeftOut) {
  // Nothing is right when there is nothing to recognize, or when the part is not in the catalogue.
  std::vector<FrameRecord> records = {record_of("f0", "", ""), record_of("f1", "", "a"),
                                      of_protocol(record_of("f0", "a", ""), "left out"),
                                      of_protocol(record_of("f1", "a", "b"), "left out")};
  const auto summaries = summarize_runs(records, spec_of({"seen", "left out"}));
  ASSERT_EQ(summaries.size(), 2u);
  for (const auto& s : summaries) {
    EXPECT_EQ(s.frames, 2);
    EXPECT_EQ(s.correct, 1);
    EXPECT_EQ(s.wrong, 1);
    EXPECT_EQ(s.none, 0);
    EXPECT_EQ(s.pose_right, 1);
    EXPECT_EQ(s.mssd_10, 1);
    EXPECT_EQ(s.mssd_5, 1);
    EXPECT_EQ(s.seen_right, 1);
    EXPECT_TRUE(s.rotation_errors_deg.empty());
  }
  EXPECT_FALSE(summaries[0].left_out);
  EXPECT_TRUE(summaries[1].left_out);
}

std::vector<AcceptPoint> curve_of(const std::vector<FrameRecord>& known, const std::vector<FrameRecord>& left_out) {
  std::vector<const FrameRecord*> known_pointers, left_out_pointers;
  for (const auto& r : known) known_pointers.push_back(&r);
  for (const auto& r : left_out) left_out_pointers.push_back(&r);
  return accept_curve(known_pointers, left_out_pointers);
}

void expect_curve(const std::vector<AcceptPoint>& curve, const std::vector<std::array<double, 3>>& expected) {
  ASSERT_EQ(curve.size(), expected.size());
  for (std::size_t i = 0; i < curve.size(); ++i) {
    EXPECT_NEAR(curve[i].threshold, expected[i][0], 1e-6) << i;
    EXPECT_NEAR(curve[i].true_accepts_percent, expected[i][1], 1e-9) << i;
    EXPECT_NEAR(curve[i].false_accepts_percent, expected[i][2], 1e-9) << i;
  }
}

TEST(AcceptCurve, PointsByHand) {
  // Ties: two known ones and one left out have 0.9. One frame of each had no candidate; one candidate scored 0.
  const std::vector<FrameRecord> known = {scored("a", 0.9f, true, false), scored("a", 0.9f, false, false),
                                          scored("a", 0.5f, true, false), scored("a", -1, false, false)};
  const std::vector<FrameRecord> left_out = {scored("a", 0.9f, false, true), scored("a", 0.3f, false, true),
                                             scored("a", -1, false, true), scored("a", 0, false, true)};
  expect_curve(curve_of(known, left_out), {{1.9, 0, 0}, {0.9, 25, 25}, {0.5, 50, 25}, {0.3, 50, 50}, {0, 50, 75}});
}

TEST(AcceptCurve, NoCandidatesAndNoFrames) {
  expect_curve(curve_of({}, {}), {{1, 0, 0}, {0, 0, 0}});
  expect_curve(curve_of({scored("a", -1, false, false)}, {scored("a", -1, false, true)}), {{1, 0, 0}, {0, 0, 0}});
  expect_curve(curve_of({scored("a", 0.5f, true, false)}, {}), {{1.5, 0, 0}, {0.5, 100, 0}, {0, 100, 0}});
}

TEST(AcceptCurve, TrueAcceptsAreOfTheScenesThatShowAPart) {
  expect_curve(curve_of({scored("a", 0.5f, true, false), scored("", 0.4f, false, false)}, {}),
               {{1.5, 0, 0}, {0.5, 100, 0}, {0.4, 100, 0}, {0, 100, 0}});
}

TEST(WriteTables, EveryRowHasTheColumnsOfItsHeading) {
  const TemporaryFolder folder;
  auto records = eight_frames();
  records.push_back(of_protocol(record_of("f0", "a", "b"), "left out"));
  write_tables(records, spec_of({"seen", "left out"}), folder.path());
  for (const char* name : {"recognition.csv", "poses.csv", "confusion.csv", "times.csv", "errors.csv", "accepts.csv"}) {
    const Rows rows = read_csv(folder.path() / name);
    EXPECT_GE(rows.size(), 2u) << name;
    for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size()) << name;
  }
}

TEST(WriteTables, FiguresByHand) {
  const TemporaryFolder folder;
  write_tables(eight_frames(), spec_of(), folder.path());
  const Rows recognition = read_csv(folder.path() / "recognition.csv");
  ASSERT_EQ(recognition.size(), 2u);
  EXPECT_EQ(recognition[1], (std::vector<std::string>{"parts", "seen", "D", "vfh", "8", "5", "2", "1"}));

  const Rows poses = read_csv(folder.path() / "poses.csv");
  ASSERT_EQ(poses.size(), 2u);
  for (const auto& [column, value] : {std::pair{"under_limits", "2"},
                                      {"of_correct_percent", "40.00"},
                                      {"of_total_percent", "25.00"},
                                      {"mssd_10_of_total_percent", "37.50"},
                                      {"mssd_5_of_total_percent", "12.50"},
                                      {"mssd_10_or_indistinguishable_of_total_percent", "62.50"},
                                      {"rotation_median_deg", "14.90"},
                                      {"translation_median_mm", "2.00"}})
    EXPECT_EQ(cell(poses, 1, column), value) << column;

  const Rows confusion = read_csv(folder.path() / "confusion.csv");
  EXPECT_EQ(confusion.size(), 6u);
  EXPECT_NE(std::find(confusion.begin(), confusion.end(),
                      std::vector<std::string>{"parts", "seen", "D", "vfh", "b", "", "1"}),
            confusion.end());

  const Rows times = read_csv(folder.path() / "times.csv");
  EXPECT_EQ(times[1], (std::vector<std::string>{"parts", "seen", "D", "vfh", "frame", "45.00", "76.50"}));

  const Rows errors = read_csv(folder.path() / "errors.csv");
  ASSERT_EQ(errors.size(), 9u);
  EXPECT_EQ(cell(errors, 2, "frame"), "f1");
  EXPECT_EQ(cell(errors, 2, "rotation_error_deg"), "14.90");
  EXPECT_EQ(cell(errors, 7, "recognized_as"), "c");

  const Json run = read_json_file(folder.path() / "tables.json")["runs"][0];
  for (const auto& [key, value] : {std::pair{"frames", 8},
                                   {"correct", 5},
                                   {"incorrect", 2},
                                   {"no_result", 1},
                                   {"pose_under_limits", 2},
                                   {"mssd_under_10_percent", 3},
                                   {"mssd_under_5_percent", 1},
                                   {"mssd_under_10_percent_or_indistinguishable", 5}})
    EXPECT_EQ(run[key], value) << key;
  EXPECT_EQ(run["median_ms"], 45);

  const std::string page = read_file(folder.path() / "tables.md");
  for (const char* line :
       {"# By hand\n", "| D vfh | 8 | 5 | 62.50 | 2 | 25.00 | 1 | 12.50 |\n",
        "| D vfh | 2 | 40.00 | 25.00 | 37.50 | 12.50 | 62.50 | 14.90 | 2.00 |\n", "| shown | a | b | c | none |\n",
        "| a | 4 | 0 | 0 | 0 |\n", "| b | 1 | 1 | 1 | 1 |\n", "under 15 deg and 10 mm"})
    EXPECT_PRED2(shapes::mentions, page, line);
  // Each picture that the page shows is there.
  int pictures = 0;
  for (std::size_t at = page.find(".svg)"); at != std::string::npos; at = page.find(".svg)", at + 1), ++pictures) {
    const std::size_t begin = page.rfind('(', at) + 1;
    EXPECT_TRUE(fs::exists(folder.path() / page.substr(begin, at + 4 - begin)));
  }
  EXPECT_EQ(pictures, 2);
  EXPECT_FALSE(fs::exists(folder.path() / "accepts.csv")) << "no parts were left out";
}

TEST(WriteTables, ObjectsConfidenceAndBoundByHand) {
  const TemporaryFolder folder;
  std::vector<FrameRecord> records = {with_mssd(record_of("f0", "a", "a", 1, 2), 4, true),
                                      of_protocol(record_of("f0", "a", "b"), "left out")};
  records[0].objects.emplace();
  // One found and right, one found and wrong, one missed, one of which too little is seen.
  records[0].objects->objects = {{"a", 1, 0, true}, {"a", 0.6, 1, false}, {"b", 0.9, -1, false}, {"b", 0.5, -1, false}};
  records[0].objects->detections.resize(3);
  for (auto& detection : records[0].objects->detections) detection.confidence = 0.95;
  records[0].objects->detections[0].part_right = records[0].objects->detections[0].right = true;
  records[0].objects->detections[1].part_right = true;
  records[0].bound = BoundRecord{true, 0.5, 0.1, 1.0, 0.15};
  records[1].objects.emplace();
  records[1].objects->detections.resize(1);
  records[1].objects->detections[0].confidence = 0.15;
  write_tables(records, spec_of({"seen", "left out"}), folder.path());
  const std::string page = read_file(folder.path() / "tables.md");
  // 0.95 stated for 3, of which 1 is right; 0.15 for 1 that is wrong: (3 x |1/3 - 0.95| + 0.15) / 4 = 0.5.
  for (const char* line :
       {"| D vfh | 3 | 2 | 66.67 | 33.33 | 3 | 1 | 33.33 |\n",
        "Expected calibration error: 50.00 points, of 4 detections.", "| 0.9 to 1.0 | 3 | 1 | 33.33 | 95.00 |\n",
        "| 0.1 to 0.2 | 1 | 0 | 0.00 | 15.00 |\n", "| D vfh | 1 | 0 | 0.500 | 2.00 | 0.100 | 1.50 |\n",
        "| parts | seen | D vfh | known | 1 | 1 | 100.00 | 100.00 |\n",
        "| parts | left out | D vfh | not in the catalogue | 1 | 1 | 100.00 | - |\n"})
    EXPECT_PRED2(shapes::mentions, page, line);
  const Json run = read_json_file(folder.path() / "tables.json")["runs"][0];
  EXPECT_EQ(run["objects"], 3);
  EXPECT_EQ(run["objects_found"], 2);
  EXPECT_EQ(run["wrong_detections"], 1);
  EXPECT_NEAR(run["bound"]["translation_error_over_bound"].get<double>(), 1.5, 1e-9);
}

TEST(WriteTables, TheAcceptCurvePairsTheRunsOfOneConfiguration) {
  const TemporaryFolder folder;
  FrameRecord known = scored("a", 0.8f, true, false), unknown = of_protocol(scored("a", 0.6f, false, true), "left out");
  FrameRecord other = known;
  other.configuration = "E";
  other.run = "parts / seen / E / vfh";
  auto spec = spec_of({"seen", "left out"});
  spec.configurations.push_back({"E", "pipeline.json"});
  write_tables({unknown, known, other}, spec, folder.path());
  const Rows rows = read_csv(folder.path() / "accepts.csv");
  ASSERT_EQ(rows.size(), 5u) << "E has no run with parts left out";
  const std::string name = "parts: seen against left out, D vfh";
  EXPECT_EQ(rows[1], (std::vector<std::string>{name, "1.8000", "0.00", "0.00"}));
  EXPECT_EQ(rows[2], (std::vector<std::string>{name, "0.8000", "100.00", "0.00"}));
  EXPECT_EQ(rows[3], (std::vector<std::string>{name, "0.6000", "100.00", "100.00"}));
  EXPECT_EQ(rows[4], (std::vector<std::string>{name, "0.0000", "100.00", "100.00"}));
  EXPECT_PRED2(shapes::mentions, read_file(folder.path() / "tables.md"), "accepts.svg");
}

TEST(WriteTables, NamesAreQuotedInCsv) {
  const TemporaryFolder folder;
  const std::string odd = "six parts, \"small\"\nones";
  auto spec = spec_of();
  spec.groups[0].name = odd;
  FrameRecord r = record_of("f,0", "a,b", "\"c\"");
  r.group = odd;
  r.run = odd + " / seen / D / vfh";
  write_tables({r}, spec, folder.path());
  EXPECT_EQ(cell(read_csv(folder.path() / "recognition.csv"), 1, "group"), odd);
  const Rows confusion = read_csv(folder.path() / "confusion.csv");
  EXPECT_EQ(cell(confusion, 1, "shown"), "a,b");
  EXPECT_EQ(cell(confusion, 1, "recognized_as"), "\"c\"");
  EXPECT_EQ(cell(read_csv(folder.path() / "errors.csv"), 1, "frame"), "f,0");
}

/// Every file of a folder and its content.
std::map<std::string, std::string> content_of(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const auto& entry : fs::directory_iterator(folder))
    content[entry.path().filename().string()] = read_file(entry.path());
  return content;
}

TEST(WriteTables, RunsAreInTheOrderOfTheSpecWhateverThatOfTheRecords) {
  auto spec = spec_of({"z protocol", "a protocol", "left out"});
  spec.groups = {{"z group", {"parts"}}, {"a group", {"parts"}}};
  spec.configurations = {{"z", "pipeline.json"}, {"a", "pipeline.json"}, {"recognizer", ""}};
  spec.descriptors = {"vfh", "cvfh"};
  std::vector<FrameRecord> records;
  std::vector<std::vector<std::string>> expected;
  Random random(3);
  for (const auto& group : spec.groups)
    for (const auto& protocol : spec.protocols)
      for (const auto& configuration : spec.configurations)
        for (const auto& descriptor :
             configuration.pipeline.empty() ? std::vector<std::string>{"-"} : spec.descriptors) {
          expected.push_back({group.name, protocol.name, configuration.name, descriptor});
          for (int i = 0; i < 3; ++i) {
            FrameRecord r = record_of(fmt::format("f{}", i), "a", i == 1 ? "b" : "a", 5, 5);
            r.group = group.name;
            r.configuration = configuration.name;
            r.descriptor = descriptor;
            r.time_ms = random.uniform();
            r.score = static_cast<float>(random.uniform());
            records.push_back(of_protocol(r, protocol.name));
          }
        }
  const TemporaryFolder first;
  write_tables(records, spec, first.path());
  const Rows rows = read_csv(first.path() / "recognition.csv");
  ASSERT_EQ(rows.size(), expected.size() + 1);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(std::vector(rows[i + 1].begin(), rows[i + 1].begin() + 4), expected[i]);

  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = records.size() - 1; i > 0; --i)
      std::swap(records[i], records[static_cast<std::size_t>(random.uniform() * static_cast<double>(i + 1))]);
    const TemporaryFolder again;
    write_tables(records, spec, again.path());
    EXPECT_EQ(content_of(again.path()), content_of(first.path()));
  }
}

TEST(WriteTables, PlotsOfNamesThatMakeTheSameFileNameAreKeptApart) {
  const TemporaryFolder folder;
  auto spec = spec_of();
  spec.groups = {{"a b", {"parts"}}, {"a-b", {"parts"}}};
  FrameRecord one = record_of("f", "a", "a", 1, 1), two = one;
  one.group = "a b";
  one.run = "a b / seen / D / vfh";
  two.group = "a-b";
  two.run = "a-b / seen / D / vfh";
  write_tables({one, two}, spec, folder.path());
  int plots = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) plots += entry.path().extension() == ".svg";
  EXPECT_EQ(plots, 4);
}

TEST(WriteTables, NoRecords) {
  const TemporaryFolder folder;
  write_tables({}, spec_of(), folder.path());
  EXPECT_EQ(read_csv(folder.path() / "recognition.csv").size(), 1u);
  EXPECT_TRUE(read_json_file(folder.path() / "tables.json")["runs"].empty());
}

}  // namespace
}  // namespace partpose
