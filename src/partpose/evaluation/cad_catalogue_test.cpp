// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// A STEP file and an STL export of it give catalogues that recognize each other's views.
#include "partpose/engine/engine.hpp"
#include "partpose/evaluation/accuracy.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/pipeline/recognizer.hpp"
#include "tests/step_files.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace partpose {
namespace {

namespace fs = std::filesystem;

const fs::path root = PARTPOSE_SOURCE_DIR;

class StepAndStl : public ::testing::Test {
 protected:
  StepAndStl() {
    if (!reads_step()) return;
    fs::create_directories(folder_);
  }
  ~StepAndStl() override { fs::remove_all(folder_); }

  Dataset dataset(const std::string& name, const std::vector<NamedMesh>& parts, int subdivide, double turn_deg) const {
    DatasetPreparationConfig config;
    config.virtual_views_icosahedron.subdivide = subdivide;
    config.virtual_views_icosahedron.xyz_rotation_deg = turn_deg;
    return create_dataset(config, parts, folder_ / name);
  }

  /// A catalogue of `known`, and views from other directions of `shown`, as a share of views recognized correctly.
  ProtocolSummary recognize(const std::string& name, const std::vector<NamedMesh>& known,
                            const std::vector<NamedMesh>& shown) const {
    const auto config = read_pipeline_config(root / "configs/pipeline_virtual.json");
    const GlobalPipeline pipeline(load_catalogue(dataset(name + "_known", known, 1, 5), config), config);
    return summarize(run_protocol(pipeline, dataset(name + "_shown", shown, 0, 20)));
  }

  /// The same where nothing is configured: how many of the views are named right.
  template <typename PartRecognizerType>
  int named_right(const std::string& name, const std::vector<NamedMesh>& known,
                  const std::vector<NamedMesh>& shown) const {
    const PartRecognizerType recognizer(
        load_catalogue(dataset(name + "_known", known, 1, 5), Recognizer::catalogue_config()));
    const Dataset views = dataset(name + "_shown", shown, 0, 20);
    int right = 0;
    for (const auto& model : views.out.models)
      for (const auto& view : views.out.views) {
        const fs::path path = views.view_path(model.id, view.id);
        right += recognizer.recognize(Scene{path, read_pcd(path), {}, {}}).result.model_name == model.name;
      }
    return right;
  }

  /// Both ways; nearly all, and as many as of the STL with itself but for two.
  template <typename PartRecognizerType>
  void expect_name_each_other(const std::vector<NamedMesh>& step, const std::vector<NamedMesh>& stl) const {
    const int frames = 12 * static_cast<int>(stl.size());
    const int itself = named_right<PartRecognizerType>("itself", stl, stl);
    for (const auto& [name, known, shown] : {std::tuple{"step", step, stl}, std::tuple{"stl", stl, step}}) {
      const int right = named_right<PartRecognizerType>(name, known, shown);
      EXPECT_GE(right, itself - 2) << name << " knows, the other is shown";
      EXPECT_GE(right, 0.9 * frames) << name << " knows, the other is shown";
    }
  }

  /// Both ways; as good as the STL with itself but for two views, and nearly all right.
  void expect_recognize_each_other(const std::vector<NamedMesh>& step, const std::vector<NamedMesh>& stl) const {
    const auto itself = recognize("itself", stl, stl);
    for (const auto& [name, known, shown] : {std::tuple{"step", step, stl}, std::tuple{"stl", stl, step}}) {
      const auto summary = recognize(name, known, shown);
      EXPECT_EQ(summary.frames, 12 * static_cast<int>(shown.size()));
      EXPECT_GE(summary.correct, itself.correct - 2) << name << " knows, the other is shown";
      EXPECT_GE(summary.correct_percent(), 95) << name << " knows, the other is shown";
      EXPECT_GE(summary.pose_right, itself.pose_right - 4) << name << " knows, the other is shown";
    }
  }

  const fs::path folder_ = fs::temp_directory_path() / fmt::format("partpose_cad_{}", getpid());
};

/// Runs where PARTPOSE_DATA says where the published parts are: by FreeCAD and trimesh, one of them in inches.
TEST_F(StepAndStl, PublishedPartsRecognizeEachOther) {
  const char* data = std::getenv("PARTPOSE_DATA");
  if (!reads_step()) GTEST_SKIP() << "no OpenCASCADE";
  if (!data || !fs::is_directory(fs::path(data) / "parts/step")) GTEST_SKIP() << "PARTPOSE_DATA is not set";
  std::vector<fs::path> step, stl;
  for (const char* part : {"DN15_FIG_130", "DN15_Stamped_Flange", "NEMA-17_Stepper_Motor_40mm_with_connector", "cup",
                           "featuretype", "DIN471_CLASS_A_M34RetainingRings"}) {
    step.push_back(fs::path(data) / "parts/step" / fmt::format("{}.step", part));
    stl.push_back(fs::path(data) / "parts/stl" / fmt::format("{}.stl", part));
  }
  expect_recognize_each_other(read_meshes(step), read_meshes(stl));
}

#ifdef PARTPOSE_HAS_OCCT
TEST_F(StepAndStl, OwnPartsRecognizeEachOther) {
  using namespace step_files;
  // A stepped plate with a bore and a boss, and a pin with a flange; in inches and in metres.
  write(folder_ / "plate.step", {{"plate", BRepAlgoAPI_Cut(block(90, 60, 12), cylinder(22, 20, -5, 11, 30)).Shape()}},
        "INCH");
  TopoDS_Compound pin;
  BRep_Builder().MakeCompound(pin);
  BRep_Builder().Add(pin, cylinder(0, 0, 0, 8, 70));
  BRep_Builder().Add(pin, cylinder(0, 0, 70, 20, 9));
  write(folder_ / "pin.step", {{"pin", pin}}, "M");
  write(folder_ / "block.step", {{"block", bored_block()}});
  const auto step = read_meshes(folder_, {.chord_tolerance_mm = 0.3});
  ASSERT_EQ(step.size(), 3u);
  // What another program exports: finer triangles.
  fs::create_directories(folder_ / "stl");
  for (const auto& part : read_meshes(folder_, {.chord_tolerance_mm = 0.02, .angle_tolerance_deg = 5}))
    write_stl(folder_ / "stl" / (part.name + ".stl"), part.mesh);
  const auto stl = read_meshes(folder_ / "stl");
  expect_recognize_each_other(step, stl);
  expect_name_each_other<Recognizer>(step, stl);
  expect_name_each_other<Engine>(step, stl);
}
#endif

}  // namespace
}  // namespace partpose
