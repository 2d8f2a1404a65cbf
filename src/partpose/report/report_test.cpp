// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/report/report.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/random.hpp"
#include "partpose/io/bytes.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/pipeline/records.hpp"
#include "partpose/report/output_folder.hpp"
#include "partpose/report/packet.hpp"
#include "partpose/report/page.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>

namespace partpose {
namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder() : path_(fs::temp_directory_path() / fmt::format("partpose_report_{}_{}", getpid(), count_++)) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  static inline int count_ = 0;
  fs::path path_;
};

/// What web/src/packet.ts does, written a second time.
struct Decoder {
  Json header;
  std::string sections;

  explicit Decoder(const std::string& bytes) {
    const auto length = load<std::uint32_t>(bytes, 0);
    header = Json::parse(bytes.substr(4, length));
    sections = bytes.substr(4 + length);
  }
  std::uint8_t byte(std::size_t at) const { return static_cast<std::uint8_t>(sections.at(at)); }
  std::uint16_t level(std::size_t offset, std::size_t count, std::size_t i) const {
    return static_cast<std::uint16_t>(byte(offset + i) << 8 | byte(offset + count + i));
  }
  std::vector<Eigen::Vector3d> points(const Json& section, std::size_t count) const {
    std::vector<Eigen::Vector3d> out(count);
    for (int a = 0; a < 3; ++a) {
      std::uint16_t sum = 0;
      for (std::size_t i = 0; i < count; ++i) {
        sum = static_cast<std::uint16_t>(sum + level(section["offset"].get<std::size_t>() + 2 * count * a, count, i));
        out[i][a] = section["lo"][a].get<double>() + section["size"][a].get<double>() * sum / 65535;
      }
    }
    return out;
  }
};

PointCloud random_cloud(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points.push_back(
        Eigen::Vector3d(400 * random.uniform() - 200, 300 * random.uniform(), 500 + 90 * random.uniform())
            .cast<float>());
    cloud.normals.push_back(Eigen::Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5)
                                .normalized()
                                .cast<float>());
  }
  return cloud;
}

TEST(Packet, Base64AndDeflateAreThoseOfTheirStandards) {
  // RFC 4648, section 10.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
  const std::string text(10000, 'x');
  const std::string small = deflated(text);
  EXPECT_LT(small.size(), 100u);
  std::string back(text.size(), '\0');
  uLongf size = back.size();
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(back.data()), &size, reinterpret_cast<const Bytef*>(small.data()),
                       small.size()),
            Z_OK);
  EXPECT_EQ(back, text);
}

TEST(Packet, PointsAndNormalsComeBackWithinTheQuantisation) {
  const PointCloud cloud = random_cloud(500, 1);
  Packet packet;
  packet.header["cloud"] = packet.add(cloud, 1000);
  const Decoder decoder(packet.bytes());
  const Json& section = decoder.header["cloud"];
  ASSERT_EQ(section["count"], 500);
  ASSERT_EQ(section["of"], 500);
  const auto points = decoder.points(section, 500);
  std::vector<bool> found(cloud.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < cloud.size(); ++k)
      if ((points[i] - cloud.points[k].cast<double>()).norm() <
          (points[i] - cloud.points[nearest].cast<double>()).norm())
        nearest = k;
    EXPECT_LT((points[i] - cloud.points[nearest].cast<double>()).cwiseAbs().maxCoeff(), 0.51 * 400 / 65535);
    found[nearest] = true;
    const std::size_t at = section["offset"].get<std::size_t>() + 6 * 500;
    double x = decoder.byte(at + i) / 127.5 - 1, y = decoder.byte(at + 500 + i) / 127.5 - 1;
    const double z = 1 - std::abs(x) - std::abs(y);
    if (z < 0) {
      const double folded_x = std::copysign(1 - std::abs(y), x);
      y = std::copysign(1 - std::abs(x), y);
      x = folded_x;
    }
    const Eigen::Vector3d normal = Eigen::Vector3d(x, y, z).normalized();
    EXPECT_GT(normal.dot(cloud.normals[nearest].cast<double>()), std::cos(0.02));
  }
  EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](bool f) { return f; }));
}

TEST(Packet, ThinningKeepsAnEvenShare) {
  Packet packet;
  packet.header["cloud"] = packet.add(random_cloud(5000, 2), 500);
  const Decoder decoder(packet.bytes());
  EXPECT_EQ(decoder.header["cloud"]["count"], 500);
  EXPECT_EQ(decoder.header["cloud"]["of"], 5000);
  int left = 0;
  for (const auto& p : decoder.points(decoder.header["cloud"], 500)) left += p.x() < 0;
  EXPECT_NEAR(left, 250, 30);
}

TEST(Packet, EmptyAndFlatCloudsAndPointsThatAreNotFinite) {
  Packet packet;
  EXPECT_EQ(packet.add(PointCloud{}, 10)["count"], 0);
  PointCloud flat;
  flat.points = {{1, 2, 3}, {1, 2, 4}, {std::nanf(""), 0, 0}};
  packet.header["cloud"] = packet.add(flat, 10);
  const Decoder decoder(packet.bytes());
  const auto points = decoder.points(decoder.header["cloud"], 2);
  EXPECT_EQ(points[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(points[1], Eigen::Vector3d(1, 2, 4));
}

TEST(Packet, DepthComesBackExactlyInItsUnit) {
  Random random(3);
  DepthImage depth(37, 23);
  for (auto& z : depth.z_mm) z = random.uniform() < 0.3 ? 0.0f : static_cast<float>(0.25 * random.below(60000));
  Packet packet;
  packet.header["depth"] = packet.add(depth, 0.25);
  const Decoder decoder(packet.bytes());
  const std::size_t count = depth.z_mm.size(), offset = decoder.header["depth"]["offset"];
  std::vector<int> units(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int u = static_cast<int>(i % 37);
    const int left = u > 0 ? units[i - 1] : 0, above = i >= 37 ? units[i - 37] : 0,
              corner = u > 0 && i >= 37 ? units[i - 38] : 0;
    const int lower = std::min(left, above), upper = std::max(left, above);
    const int predicted = corner >= upper ? lower : corner <= lower ? upper : left + above - corner;
    units[i] = (predicted + decoder.level(offset, count, i)) & 0xFFFF;
    ASSERT_EQ(units[i] * 0.25f, depth.z_mm[i]) << i;
  }
}

TEST(Packet, MeshesComeBack) {
  const TriangleMesh mesh = shapes::box({10, 20, 30});
  Packet packet;
  packet.header["mesh"] = packet.add(mesh);
  const Decoder decoder(packet.bytes());
  const std::size_t vertices = mesh.vertices.size(), corners = 3 * mesh.triangles.size();
  const auto points = decoder.points(decoder.header["mesh"], vertices);
  for (std::size_t i = 0; i < vertices; ++i) EXPECT_LT((points[i] - mesh.vertices[i].cast<double>()).norm(), 1e-3);
  const std::size_t at = decoder.header["mesh"]["offset"].get<std::size_t>() + 6 * vertices;
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < corners; ++i) {
    last +=
        static_cast<std::uint32_t>(decoder.level(at, corners, i)) << 16 | decoder.level(at + 2 * corners, corners, i);
    EXPECT_EQ(static_cast<int>(last), mesh.triangles[i / 3][i % 3]);
  }
}

TEST(Simplified, ASphereKeepsItsShape) {
  const TriangleMesh sphere = shapes::sphere(50, 80, 60);
  ASSERT_GT(sphere.triangles.size(), 5000u);
  const TriangleMesh few = simplified(sphere, 2000);
  EXPECT_LE(few.triangles.size(), 2000u);
  EXPECT_GT(few.triangles.size(), 500u);
  for (const auto& v : few.vertices) EXPECT_NEAR(v.norm(), 50, 1.5);
  EXPECT_EQ(simplified(sphere, 1000000).triangles, sphere.triangles);
}

TEST(Reduced, PixelsLookWhereTheyLooked) {
  const Intrinsics camera{64, 48, 60, 60, 31.5, 23.5};
  DepthImage depth(64, 48);
  for (auto& z : depth.z_mm) z = 500;
  const ReducedDepth half = reduced(depth, camera, 8, 4, 40, 32, 2);
  EXPECT_EQ(half.depth.width, 20);
  EXPECT_EQ(half.depth.height, 16);
  // The middle of four pixels.
  const Eigen::Vector3f whole = camera.unproject(8 + 2 * 5 + 0.5, 4 + 2 * 7 + 0.5, 500);
  EXPECT_LT((half.camera.unproject(5, 7, half.depth.at(5, 7)) - whole).norm(), 1e-3);
}

/// A result of a part, or of nothing.
Result result_of(const std::string& model_name, const std::string& timestamp) {
  Result result;
  result.model_name = model_name;
  result.candidate_id = model_name.empty() ? -1 : 0;
  result.model_id = model_name.empty() ? -1 : 3;
  result.timestamp = timestamp;
  return result;
}

Evaluation evaluation_of(const std::string& shown, const Result& result) {
  Evaluation evaluation;
  evaluation.ground_truth_model_name = shown;
  evaluation.timestamp = result.timestamp;
  evaluation.recognized_correctly = shown == result.model_name;
  if (evaluation.recognized_correctly) evaluation.rotation_error_deg = 2.5f, evaluation.translation_error_mm = 1.5f;
  return evaluation;
}

void write_frame(const fs::path& folder, const Result& result, const std::optional<std::string>& shown) {
  fs::create_directories(folder / result.timestamp);
  write_json(folder / result.timestamp / "result.json", result);
  if (shown) write_json(folder / result.timestamp / "evaluation.json", evaluation_of(*shown, result));
}

TEST(OutputFolder, VerdictsAreWhatTheFilesSay) {
  const TemporaryFolder folder;
  write_frame(folder.path(), result_of("a", "1"), "a");
  write_frame(folder.path(), result_of("b", "2"), "a");
  write_frame(folder.path(), result_of("", "3"), "a");
  write_frame(folder.path(), result_of("", "4"), "");
  write_frame(folder.path(), result_of("a", "5"), "");
  write_frame(folder.path(), result_of("a", "6"), std::nullopt);
  write_frame(folder.path(), result_of("", "7"), std::nullopt);
  const OutputFolder read = read_output_folder(folder.path());
  ASSERT_EQ(read.frames.size(), 7u);
  const std::vector<Verdict> expected = {Verdict::correct, Verdict::wrong, Verdict::none,   Verdict::correct,
                                         Verdict::wrong,   Verdict::found, Verdict::nothing};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(read.frames[i].verdict, expected[i]) << i;
  EXPECT_TRUE(read.problems.empty());
  EXPECT_EQ(read.frames[0].figures.at("rotation_error_deg"), 2.5);
  EXPECT_FALSE(read.frames[1].figures.contains("rotation_error_deg")) << "-1 is no value";
  EXPECT_TRUE(read.frames[0].flags.at("recognized_correctly"));
  EXPECT_FALSE(read.frames[1].flags.at("recognized_correctly"));
  EXPECT_FALSE(read.experiment);
  EXPECT_FALSE(read.frames[0].has_extras);
  EXPECT_TRUE(read.frames[0].input.empty());
  EXPECT_FALSE(read.frames[0].time_ms);
}

TEST(OutputFolder, CandidatesHaveTheirCoarsePoseAndTheirMesh) {
  const TemporaryFolder folder;
  write_frame(folder.path() / "run", result_of("a", "1"), "a");
  Extras extras;
  CandidateExtras candidate;
  candidate.id = 0;
  candidate.model_name = "a";
  candidate.T_4.translation() = Eigen::Vector3d(1, 2, 3);
  candidate.T_final.translation() = Eigen::Vector3d(10, 20, 600);
  candidate.score = 0.5f;
  candidate.verdict = "accepted";
  candidate.mesh = "meshes/a.stl";
  extras.candidate_extras = {candidate};
  extras.time_profiling = {{12.5, "matching", 100, 90}, {7.5, "sorting"}};
  extras.scene = "somewhere/frame.png";
  write_json(folder.path() / "run/1/extras.json", extras);
  fs::create_directories(folder.path() / "run/meshes");
  write_file_atomically(folder.path() / "run/meshes/a.stl", "x");
  const SavedFrame frame = read_output_folder(folder.path()).frames.at(0);
  EXPECT_EQ(frame.name, "frame.png");
  EXPECT_EQ(frame.run, "run");
  ASSERT_EQ(frame.candidates.size(), 1u);
  EXPECT_EQ(frame.candidates[0].coarse.translation(), Eigen::Vector3d(9, 18, 597));
  EXPECT_EQ(frame.candidates[0].score, 0.5);
  EXPECT_FALSE(frame.candidates[0].icp_fitness) << "-1 is no value";
  EXPECT_EQ(frame.candidates[0].mesh.filename(), "a.stl");
  EXPECT_EQ(frame.time_ms, 20);
  EXPECT_EQ(frame.steps[0].points_out, 90);
  EXPECT_FALSE(frame.steps[1].points_in);
}

TEST(OutputFolder, AllObjectsOfAFrame) {
  const TemporaryFolder folder;
  write_frame(folder.path(), result_of("a", "1"), "a");
  write_frame(folder.path(), result_of("a", "2"), "a");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(10, 20, 600);
  write_json_file(folder.path() / "1/detections.json",
                  Json::array({{{"model_name", "a"}, {"T", to_json(pose)}, {"score", 0.9}, {"confidence", 0.8}},
                               {{"model_name", "b"}, {"T", to_json(pose)}, {"score", 0.7}, {"mesh", "meshes/b.stl"}}}));
  fs::create_directories(folder.path() / "meshes");
  write_file_atomically(folder.path() / "meshes/b.stl", "x");
  const OutputFolder read = read_output_folder(folder.path());
  const auto& all = read.frames.at(0).detections;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].model_name, "a");
  EXPECT_EQ(all[0].confidence, 0.8);
  EXPECT_TRUE(all[0].mesh.empty());
  EXPECT_EQ(all[1].camera_from_model.translation(), pose.translation());
  EXPECT_FALSE(all[1].confidence);
  EXPECT_EQ(all[1].mesh.filename(), "b.stl");
  EXPECT_TRUE(read.frames.at(1).detections.empty());
}

TEST(OutputFolder, LinesOfAnExperimentWithAndWithoutFolders) {
  const TemporaryFolder folder;
  write_frame(folder.path() / "iterations", result_of("a", "1"), "a");
  write_frame(folder.path() / "iterations", result_of("b", "2"), "b");
  std::ofstream(folder.path() / "frames.jsonl")
      << R"({"run":"r","protocol":"p","descriptor":"vfh","frame":7,"truth":{"model_name":"a"},"time_ms":12,"folder":"iterations/1"})"
      << "\n"
      << R"({"run":"r","frame":"x","truth":{"model_name":null},"result":{"candidate_id":-1,"model_name":""},"time_ms":{"total":9,"matching":4},"folder":""})"
      << "\n\n"
      << R"({"run":"r","frame":"y","folder":"iterations/9","result":{"candidate_id":0,"model_name":"b"},"new_key":[1]})"
      << "\n"
      << R"({"run":"r","fra)";
  const OutputFolder read = read_output_folder(folder.path());
  ASSERT_EQ(read.frames.size(), 4u) << "three lines, and the folder that no line names";
  EXPECT_TRUE(read.experiment);
  EXPECT_EQ(read.frames[0].name, "7");
  EXPECT_EQ(read.frames[0].descriptor, "vfh");
  EXPECT_EQ(read.frames[0].verdict, Verdict::correct);
  EXPECT_EQ(read.frames[0].time_ms, 12);
  EXPECT_EQ(read.frames[1].verdict, Verdict::correct) << "rightly none";
  EXPECT_EQ(read.frames[1].time_ms, 9);
  EXPECT_EQ(read.frames[1].steps.at(0).tag, "matching");
  EXPECT_EQ(read.frames[2].verdict, Verdict::found);
  EXPECT_EQ(read.frames[3].model_name, "b");
  EXPECT_EQ(read.problems.size(), 2u);
}

TEST(OutputFolder, WhatIsNoOutputFolderIsAnErrorAndBrokenFilesAreNoted) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_output_folder(folder.path() / "nowhere"), Error);
  EXPECT_THROW(read_output_folder(folder.path()), Error);
  write_frame(folder.path(), result_of("a", "1"), "a");
  write_file_atomically(folder.path() / "1/extras.json", R"({"candidate_extras": [)");
  write_frame(folder.path(), result_of("a", "2"), "a");
  write_file_atomically(folder.path() / "2/extras.json", R"({"candidate_extras": 7, "time_profiling": [{"tag": 1}]})");
  const OutputFolder read = read_output_folder(folder.path());
  EXPECT_EQ(read.frames.size(), 2u);
  EXPECT_TRUE(read.frames[1].candidates.empty());
  ASSERT_EQ(read.problems.size(), 1u);
  EXPECT_NE(read.problems[0].find("extras.json"), std::string::npos);
}

TEST(Report, ThePageIsBuiltWithOnePlaceForTheDataAndLoadsNothing) {
  const std::string_view page = report_page();
  const auto at = page.find(report_data_mark);
  ASSERT_NE(at, std::string_view::npos);
  EXPECT_EQ(page.find(report_data_mark, at + 1), std::string_view::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string_view::npos);
  EXPECT_NE(page.find("three.js authors"), std::string_view::npos) << "its licence";
  for (const char* loaded : {"<link rel=\"stylesheet\"", "<script src", "@import", "url(http"})
    EXPECT_EQ(page.find(loaded), std::string_view::npos) << loaded;
}

TEST(Report, TheSameFolderGivesTheSameBytesWithAnyNumberOfThreads) {
  const TemporaryFolder folder;
  for (int i = 0; i < 5; ++i) {
    write_frame(folder.path(), result_of("a", std::to_string(i)), "a");
    write_ply(folder.path() / std::to_string(i) / "scene_cloud_w_normals.ply", random_cloud(3000, i));
  }
  const TemporaryFolder out;
  std::map<std::string, std::vector<std::size_t>> told;
  const auto progress = [&](std::string_view what, std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 5u);
    told[std::string(what)].push_back(done);
  };
  const ReportSummary summary = write_report(folder.path(), out.path() / "a.html", {}, progress);
  EXPECT_EQ(summary.frames, 5);
  const std::vector<std::size_t> each = {1, 2, 3, 4, 5};
  EXPECT_EQ(told,
            (std::map<std::string, std::vector<std::size_t>>{{"packing frames", each}, {"reading frames", each}}));
  EXPECT_FALSE(summary.thinned);
  EXPECT_TRUE(summary.problems.empty());
  EXPECT_EQ(summary.bytes, fs::file_size(out.path() / "a.html"));
  const ThreadLimit limit(1);
  write_report(folder.path(), out.path() / "b.html");
  EXPECT_EQ(read_file(out.path() / "a.html"), read_file(out.path() / "b.html"));
}

TEST(Report, PointsAreThinnedUntilTheFileIsSmallEnough) {
  const TemporaryFolder folder;
  for (int i = 0; i < 10; ++i) {
    write_frame(folder.path(), result_of("a", std::to_string(i)), "a");
    write_ply(folder.path() / std::to_string(i) / "scene_original.ply", random_cloud(20000, i));
    write_ply(folder.path() / std::to_string(i) / "result_full.ply", random_cloud(9000, i));
  }
  const TemporaryFolder out;
  const std::size_t page = report_page().size();
  const ReportSummary full = write_report(folder.path(), out.path() / "full.html");
  ReportOptions options;
  options.most_bytes = page + (full.bytes - page) / 3;
  const ReportSummary small = write_report(folder.path(), out.path() / "small.html", options);
  EXPECT_FALSE(full.thinned);
  EXPECT_GT(full.bytes, page + 10 * 20000 * 5) << "all points";
  EXPECT_TRUE(small.thinned);
  EXPECT_LE(small.bytes, options.most_bytes);
  EXPECT_GT(small.bytes, page + (full.bytes - page) / 10);
}

TEST(Report, TextsOfTheFolderCannotBreakThePage) {
  const TemporaryFolder folder;
  write_frame(folder.path(), result_of("</script><script>alert(1)</script>", "1"), "a");
  const TemporaryFolder out;
  write_report(folder.path(), out.path() / "a.html", {.title = "</script><b>"});
  EXPECT_EQ(read_file(out.path() / "a.html").find("alert(1)"), std::string::npos);
}

TEST(Report, FlagsOfVisualizeSelectTheirStages) {
  const auto of = [](auto flag) {
    VisualizeOptions visualize;
    visualize.*flag = true;
    const ReportStages s = stages_of(visualize);
    return std::vector<bool>{s.input, s.preprocessed, s.normals, s.coarse, s.fine, s.verdict, s.candidates};
  };
  using V = VisualizeOptions;
  EXPECT_EQ(of(&V::preprocess), (std::vector<bool>{true, true, false, false, false, false, false}));
  EXPECT_EQ(of(&V::normal_estimation), (std::vector<bool>{false, false, true, false, false, false, false}));
  EXPECT_EQ(of(&V::coarse_alignment), (std::vector<bool>{false, false, false, true, false, false, false}));
  EXPECT_EQ(of(&V::pose_refinement), (std::vector<bool>{false, false, false, false, true, false, false}));
  EXPECT_EQ(of(&V::result), (std::vector<bool>{false, false, false, false, false, true, false}));
  EXPECT_EQ(of(&V::result_with_candidates), (std::vector<bool>{false, false, false, false, false, true, true}));
}

}  // namespace
}  // namespace partpose
