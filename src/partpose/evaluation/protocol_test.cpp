// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/core/parallel.hpp"
#include "partpose/engine/engine.hpp"
#include "partpose/evaluation/accuracy.hpp"
#include "partpose/evaluation/captured_set.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/scene.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/pipeline/catalogue_cache.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/pipeline/recognizer.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace partpose {
namespace {

namespace fs = std::filesystem;

const fs::path root = PARTPOSE_SOURCE_DIR;

class TemporaryFolder {
 public:
  TemporaryFolder() : path_(fs::temp_directory_path() / fmt::format("partpose_protocol_{}_{}", getpid(), count_++)) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  static inline int count_ = 0;
  fs::path path_;
};

std::vector<fs::path> shipped_parts(std::initializer_list<const char*> names) {
  std::vector<fs::path> paths;
  for (const char* name : names) paths.push_back(root / "parts" / (std::string(name) + ".stl"));
  return paths;
}

TEST(GroundTruthProtocol, ThreePartsAreRecognizedInNearlyAllViews) {
  const TemporaryFolder folder;
  const auto config = read_pipeline_config(root / "configs/pipeline_virtual.json");
  const Dataset dataset = create_dataset(read_dataset_config(root / "configs/dataset_ground_truth.json"),
                                         shipped_parts({"bracket", "link", "mount_left"}), folder.path() / "dataset");
  const GlobalPipeline pipeline(load_catalogue(dataset, config), config);
  const auto summary = summarize(run_protocol(pipeline, dataset));
  EXPECT_EQ(summary.frames, 3 * 42);
  EXPECT_GE(summary.correct_percent(), 98);
  EXPECT_LE(summary.wrong_percent(), 1);
  EXPECT_GE(summary.pose_right_percent(), 95);
}

TEST(GroundTruthProtocol, APartThatIsNotInTheCatalogueIsMostlyNotRecognized) {
  const TemporaryFolder folder;
  const auto config = read_pipeline_config(root / "configs/pipeline_virtual.json");
  auto views = read_dataset_config(root / "configs/dataset_ground_truth.json");
  views.virtual_views_icosahedron.subdivide = 0;
  const GlobalPipeline pipeline(
      load_catalogue(create_dataset(views, shipped_parts({"bracket", "link"}), folder.path() / "dataset"), config),
      config);
  const Dataset other = create_dataset(views, shipped_parts({"pump_body"}), folder.path() / "other");
  const auto summary = summarize(run_protocol(pipeline, other));
  EXPECT_EQ(summary.correct, 0);
  EXPECT_LE(summary.wrong, 1);
}

struct Written {
  fs::file_time_type descriptors, view;
};

TEST(OfflineStage, ResultsAreKeptUntilSomethingTheyDependOnChanges) {
  const TemporaryFolder folder;
  auto config = read_pipeline_config(root / "configs/pipeline_virtual.json");
  auto views = read_dataset_config(root / "configs/dataset_ground_truth.json");
  views.virtual_views_icosahedron.subdivide = 0;
  const Dataset dataset = create_dataset(views, shipped_parts({"bracket", "link"}), folder.path() / "dataset");
  const auto written = [&] {
    return Written{fs::last_write_time(dataset.folder / "descriptors/vfh.pcd"),
                   fs::last_write_time(dataset.view_path(1, 3))};
  };
  const Catalogue first = load_catalogue(dataset, config);
  const Written original = written();

  const Catalogue again = load_catalogue(open_dataset(dataset.folder), config);
  EXPECT_EQ(written().descriptors, original.descriptors) << "computed again though nothing changed";
  ASSERT_EQ(again.index.size(), first.index.size());
  for (int row = 0; row < first.index.size(); ++row)
    EXPECT_TRUE(std::equal(first.index.row(row).begin(), first.index.row(row).end(), again.index.row(row).begin()));

  config.descriptors.vfh.k_nn = 3;  // of the search, not of the descriptors
  load_catalogue(open_dataset(dataset.folder), config);
  EXPECT_EQ(written().descriptors, original.descriptors);

  config.normal_estimation.search_radius = 7;
  load_catalogue(open_dataset(dataset.folder), config);
  const Written other_radius = written();
  EXPECT_NE(other_radius.descriptors, original.descriptors);
  EXPECT_EQ(other_radius.view, original.view);

  fs::copy_file(root / "parts/flange.stl", dataset.mesh_path(1), fs::copy_options::overwrite_existing);
  const Catalogue other_mesh = load_catalogue(open_dataset(dataset.folder), config);
  EXPECT_NE(written().descriptors, other_radius.descriptors);
  EXPECT_NE(written().view, original.view) << "views of the changed mesh are not rendered again";
  EXPECT_EQ(other_mesh.parts[1].mesh.triangles.size(), read_stl(root / "parts/flange.stl").triangles.size());

  // A damaged file is computed again, not believed.
  fs::resize_file(dataset.folder / "descriptors/vfh.pcd", 300);
  EXPECT_EQ(load_catalogue(open_dataset(dataset.folder), config).index.size(), first.index.size());
}

class ShippedFrames : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    cache_ = new TemporaryFolder;
    recognizer_ = new Recognizer(
        cached_catalogue(model_files(root / "parts"), {}, Recognizer::catalogue_config(), cache_->path()));
  }
  static void TearDownTestSuite() {
    delete recognizer_;
    delete cache_;
  }
  static Recognition recognize(const fs::path& path) {
    const Scene scene = read_scene(path);
    return recognizer_->recognize(scene);
  }
  static inline TemporaryFolder* cache_ = nullptr;
  static inline Recognizer* recognizer_ = nullptr;
};

TEST_F(ShippedFrames, AllAreRecognizedWithTheirPoses) {
  const CapturedSet set = read_captured_set(root / "scenes");
  ASSERT_GE(set.scenes.size(), 15u);
  for (const auto& scene : set.scenes) {
    const Recognition recognition = recognize(scene.path);
    EXPECT_EQ(recognition.result.model_name, scene.model_name) << scene.path << " " << recognition.reason;
    if (recognition.accepted < 0 || recognition.result.model_name != scene.model_name) continue;
    const auto& view = recognizer_->catalogue().views[recognition.candidates[recognition.accepted].view_row];
    const auto error =
        symmetric_pose_error(recognition.result.T_final, scene.camera_from_model, set.symmetries.at(scene.model_name),
                             bounding_box(recognizer_->catalogue().parts[view.part].mesh));
    EXPECT_LT(error.rotation_deg, 2) << scene.path;
    EXPECT_LT(error.translation_mm, 3) << scene.path;
  }
}

TEST_F(ShippedFrames, TheSameBitsWithOneThreadAndWithTwo) {
  for (const char* name : {"bracket.png", "link_table.ply"}) {
    Recognition one, two;
    {
      const ThreadLimit limit(1);
      one = recognize(root / "scenes" / name);
    }
    {
      const ThreadLimit limit(2);
      two = recognize(root / "scenes" / name);
    }
    EXPECT_EQ(one.result.T_final.matrix(), two.result.T_final.matrix()) << name;
    EXPECT_EQ(one.candidates.size(), two.candidates.size()) << name;
  }
}

TEST(ShippedFramesByTheEngine, AllAreRecognizedWithTheirPoses) {
  const Engine engine(read_meshes(std::vector<fs::path>{root / "parts"}));
  const CapturedSet set = read_captured_set(root / "scenes");
  for (const auto& scene : set.scenes) {
    const Recognition recognition = engine.recognize(read_scene(scene.path));
    EXPECT_EQ(recognition.result.model_name, scene.model_name) << scene.path << " " << recognition.reason;
    if (recognition.detections.empty() || recognition.result.model_name != scene.model_name) continue;
    const auto error =
        symmetric_pose_error(recognition.result.T_final, scene.camera_from_model, set.symmetries.at(scene.model_name),
                             bounding_box(engine.catalogue().parts[recognition.detections[0].part].mesh));
    EXPECT_LT(error.rotation_deg, 5) << scene.path;
    EXPECT_LT(error.translation_mm, 5) << scene.path;
  }
}

/// At least `least` scenes of a kind are recognized with a pose within 15 degrees and 15 mm. The limits leave room for
/// one or two below what is reached today.
void expect_pose_right(const char* set_name, const std::string& kind, int least) {
  const char* data = std::getenv("PARTPOSE_DATA");
  if (!data || !*data || !fs::exists(fs::path(data) / set_name)) GTEST_SKIP() << "no real captures (PARTPOSE_DATA)";
  const TemporaryFolder cache;
  const CapturedSet set = read_captured_set(fs::path(data) / set_name);
  const Recognizer recognizer(
      cached_catalogue(model_files(set.folder / "models"), {}, Recognizer::catalogue_config(), cache.path()));
  int right = 0;
  for (const auto& scene : set.scenes) {
    if (scene.kind != kind) continue;
    const Scene frame = read_scene(scene.path);
    const auto recognition =
        frame.depth ? recognizer.recognize(*frame.depth, *frame.intrinsics) : recognizer.recognize(frame.cloud);
    if (recognition.result.model_name != scene.model_name) continue;
    const auto& view = recognizer.catalogue().views[recognition.candidates[recognition.accepted].view_row];
    const auto error =
        symmetric_pose_error(recognition.result.T_final, scene.camera_from_model, set.symmetries.at(scene.model_name),
                             bounding_box(recognizer.catalogue().parts[view.part].mesh));
    right += error.rotation_deg < 15 && error.translation_mm < 15;
  }
  EXPECT_GE(right, least);
}

TEST(RealCaptures, PartsOnATable) { expect_pose_right("cranfield", "with_table", 13); }
TEST(RealCaptures, PartsAlone) { expect_pose_right("cranfield", "object_only", 21); }
TEST(RealCaptures, FullFramesWithClutter) { expect_pose_right("cube", "full_frame", 7); }

TEST(RealCaptures, AFrameThatShowsNoneOfThePartsGivesNothing) {
  const char* data = std::getenv("PARTPOSE_DATA");
  if (!data || !*data || !fs::exists(fs::path(data) / "milk")) GTEST_SKIP() << "no real captures (PARTPOSE_DATA)";
  const TemporaryFolder cache;
  const Recognizer recognizer(
      cached_catalogue(model_files(root / "parts"), {}, Recognizer::catalogue_config(), cache.path()));
  for (const auto& scene : read_captured_set(fs::path(data) / "milk").scenes)
    EXPECT_EQ(recognizer.recognize(read_scene(scene.path).cloud).result.candidate_id, -1) << scene.path;
}

TEST(SymmetricPoseError, AnEquivalentPoseIsNoError) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-10, -10, -40), Eigen::Vector3d(10, 10, 40));
  const std::vector<Eigen::Isometry3d> flip = {Eigen::Isometry3d::Identity(),
                                               Eigen::Isometry3d(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))};
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  truth.translate(Eigen::Vector3d(5, -3, 600)).rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  const auto error = symmetric_pose_error(truth * flip[1], {truth}, flip, box);
  EXPECT_NEAR(error.rotation_deg, 0, 1e-5);
  EXPECT_NEAR(error.translation_mm, 0, 1e-9);
  const auto without = symmetric_pose_error(truth * flip[1], {truth}, {flip[0]}, box);
  EXPECT_NEAR(without.rotation_deg, 180, 1e-5);
}

TEST(Evaluation, ComparesNameAndPose) {
  Result result;
  result.model_name = "a";
  result.timestamp = "now";
  result.T_final.translate(Eigen::Vector3d(1, 2, 2));
  const Evaluation right = evaluate(result, {"a", Eigen::Isometry3d::Identity(), 4, 7});
  EXPECT_TRUE(right.recognized_correctly);
  EXPECT_FLOAT_EQ(right.translation_error_mm, 3);
  EXPECT_NEAR(right.rotation_error_deg, 0, 1e-5);
  EXPECT_EQ(right.ground_truth_model_id, 4);
  EXPECT_EQ(right.timestamp, "now");
  const Evaluation wrong = evaluate(result, {"b", Eigen::Isometry3d::Identity(), 4, 7});
  EXPECT_FALSE(wrong.recognized_correctly);
  EXPECT_EQ(wrong.translation_error_mm, -1);
}

TEST(Summary, CountsCorrectWrongAndNone) {
  std::vector<ProtocolFrame> frames(4);
  for (int i : {0, 1}) frames[i].evaluation.recognized_correctly = true;
  frames[0].evaluation.rotation_error_deg = 14;
  frames[0].evaluation.translation_error_mm = 14;
  frames[1].evaluation.rotation_error_deg = 16;
  frames[1].evaluation.translation_error_mm = 1;
  frames[2].result.candidate_id = 3;
  frames[3].result.candidate_id = -1;
  const auto summary = summarize(frames);
  EXPECT_EQ(summary.correct, 2);
  EXPECT_EQ(summary.wrong, 1);
  EXPECT_EQ(summary.none, 1);
  EXPECT_EQ(summary.pose_right, 1);
  EXPECT_DOUBLE_EQ(summary.correct_percent(), 50);
}

}  // namespace
}  // namespace partpose
