// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/synthesis/bop_scenes.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/testing.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace partpose {
namespace {

namespace fs = std::filesystem;

std::vector<ScenePart> catalogue() {
  return {{"bracket", shapes::l_bracket()}, {"box", shapes::box(Eigen::Vector3f(60, 40, 20))}};
}
std::vector<ScenePart> unknown() { return {{"ball", shapes::sphere(18, 24, 12)}}; }

SceneDatasetOptions small() {
  SceneDatasetOptions options;
  options.scene.camera.intrinsics = {320, 240, 307, 308, 159.5, 119.5};
  options.scene.parts = {0, 2};
  options.scene.unknown_parts = {0, 1};
  options.scene.clutter = {0, 2};
  options.frames_per_scene = 4;
  return options;
}

std::map<std::string, std::string> all_files(const fs::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) out[fs::relative(entry.path(), folder).string()] = read_file(entry.path());
  return out;
}

class BopScenes : public ::testing::Test {
 protected:
  testing::TempFolder temporary;
  fs::path folder = temporary / "scenes";
};

TEST_F(BopScenes, AreReadBackAsTheyWereDrawn) {
  const auto options = small();
  std::size_t told = 0;
  write_scene_dataset(catalogue(), unknown(), options, 10, folder, {},
                      [&](std::string_view, std::size_t done, std::size_t) { told = done; });
  EXPECT_EQ(told, 10u);
  const SceneDataset dataset = read_scene_dataset(folder);
  EXPECT_EQ(dataset.part_names, (std::map<int, std::string>{{1, "bracket"}, {2, "box"}}));
  EXPECT_EQ(dataset.unknown_names, (std::map<int, std::string>{{1, "ball"}}));
  EXPECT_EQ(to_json(dataset.options), to_json(options));
  ASSERT_EQ(dataset.bop.scenes.size(), 3u);
  EXPECT_NEAR(dataset.bop.models.at(2).diameter_mm, std::sqrt(60 * 60 + 40 * 40 + 20 * 20), 1e-3);
  EXPECT_EQ(dataset.bop.read_model(2).triangles.size(), 12u);

  const SceneGenerator generator(catalogue(), unknown(), options.scene);
  const SceneSensor sensor = make_scene_sensor(options.sensor);
  std::size_t parts = 0, unknowns = 0, targets = 0;
  for (int frame = 0; frame < 10; ++frame) {
    const auto drawn = generator.generate(frame);
    const auto& scene = dataset.bop.scene(frame / 4 + 1);
    const auto& image = scene.image(frame % 4);
    const auto& unknown_image = dataset.unknown.at(frame / 4 + 1).image(frame % 4);
    std::size_t part = 0, not_ours = 0;
    for (const auto& piece : drawn.pieces) {
      if (piece.index < 0) continue;
      const auto& truth =
          piece.in_catalogue() ? image.ground_truths.at(part++) : unknown_image.ground_truths.at(not_ours++);
      EXPECT_EQ(truth.obj_id, piece.index + 1);
      EXPECT_LT((truth.camera_from_model.matrix() - piece.camera_from_model.matrix()).norm(), 1e-9);
      ASSERT_TRUE(truth.visibility);
      EXPECT_EQ(truth.visibility->px_count_visib, piece.visible_px);
      EXPECT_EQ(truth.visibility->bbox_visib, piece.visible_box);
      EXPECT_LE(truth.visibility->px_count_valid, piece.silhouette_px);
    }
    EXPECT_EQ(part, image.ground_truths.size());
    EXPECT_EQ(not_ours, unknown_image.ground_truths.size());
    parts += part;
    unknowns += not_ours;
    const DepthImage measured = sensor(drawn, options.scene.seed), read = scene.read_depth(image);
    ASSERT_EQ(read.z_mm.size(), measured.z_mm.size());
    for (std::size_t p = 0; p < read.z_mm.size(); ++p) ASSERT_NEAR(read.z_mm[p], measured.z_mm[p], 0.051);
    ASSERT_TRUE(image.camera.camera_from_world);
    EXPECT_LT((image.camera.camera_from_world->matrix() - drawn.camera_from_table.matrix()).norm(), 1e-9);
  }
  EXPECT_GT(parts, 5u);
  EXPECT_GT(unknowns, 2u);
  for (const auto& target : dataset.bop.targets) targets += target.inst_count;
  EXPECT_EQ(targets, parts);  // all are visible enough
}

TEST_F(BopScenes, AreTheSameBytesForAnyNumberOfThreads) {
  auto options = small();
  write_scene_dataset(catalogue(), unknown(), options, 6, folder);
  {
    const ThreadLimit one(1);
    write_scene_dataset(catalogue(), unknown(), options, 6, temporary / "again");
  }
  const auto first = all_files(folder), second = all_files(temporary / "again");
  EXPECT_EQ(first.size(), second.size());
  for (const auto& [name, bytes] : first) EXPECT_TRUE(second.contains(name) && second.at(name) == bytes) << name;
}

TEST_F(BopScenes, MoreFramesKeepTheFirstOnes) {
  auto options = small();
  options.frames_per_scene = 1000;
  write_scene_dataset(
      catalogue(), {},
      [&] {
        options.scene.unknown_parts = {0, 0};
        return options;
      }(),
      3, folder);
  const auto few = all_files(folder);
  write_scene_dataset(catalogue(), {}, options, 5, folder);  // replaces the older one
  const auto more = all_files(folder);
  EXPECT_EQ(more.size(), few.size() + 2);
  EXPECT_FALSE(fs::exists(folder / "unknown"));
  for (const char* name : {"test/000001/depth/000000.png", "test/000001/depth/000002.png"})
    EXPECT_EQ(few.at(name), more.at(name));
}

TEST_F(BopScenes, NothingIsLeftOfWhatFails) {
  auto options = small();
  options.scene.least_visible_fraction = 1;
  options.scene.parts = {2, 2};
  options.scene.place_radius_mm = 1;
  options.scene.camera.distance_mm = {200, 210};  // too near for two parts
  EXPECT_PRED2(shapes::mentions,
               shapes::error_of([&] { write_scene_dataset(catalogue(), unknown(), options, 2, folder); }),
               "no arrangement");
  EXPECT_TRUE(fs::is_empty((temporary / "x").parent_path()));
}

TEST_F(BopScenes, NothingOfTheUsersIsReplaced) {
  fs::create_directories(folder);
  std::ofstream(folder / "thesis.txt") << "years of work";
  EXPECT_PRED2(shapes::mentions,
               shapes::error_of([&] { write_scene_dataset(catalogue(), unknown(), small(), 1, folder); }),
               "thesis.txt");
  EXPECT_EQ(read_file(folder / "thesis.txt"), "years of work");
  fs::remove(folder / "thesis.txt");
  fs::create_directories(folder / "models");  // another's BOP dataset
  EXPECT_PRED2(shapes::mentions,
               shapes::error_of([&] { write_scene_dataset(catalogue(), unknown(), small(), 1, folder); }),
               "scenes.json");
}

TEST_F(BopScenes, BadInputIsNamed) {
  const auto error = [&](auto change) {
    auto options = small();
    change(options);
    return shapes::error_of([&] { write_scene_dataset(catalogue(), unknown(), options, 1, folder); });
  };
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.sensor.model = "sonar"; }), "sonar");
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.depth_scale_mm = 0.01; }), "65535");
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.frames_per_scene = 0; }), "frames_per_scene 0");
  EXPECT_PRED2(shapes::mentions,
               shapes::error_of([&] { write_scene_dataset(catalogue(), unknown(), small(), 0, folder); }), "0 frames");
  EXPECT_PRED2(shapes::mentions, shapes::error_of([&] { read_scene_dataset(folder); }), "scenes.json");
  write_scene_dataset(catalogue(), unknown(), small(), 1, folder);
  fs::remove_all(folder / "unknown");
  EXPECT_PRED2(shapes::mentions, shapes::error_of([&] { read_scene_dataset(folder); }), "unknown");
}

}  // namespace
}  // namespace partpose
