// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/dataset/model_info.hpp"

#include "partpose/dataset/dataset.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/io/testing.hpp"
#include "tests/shapes.hpp"

namespace partpose {
namespace {

namespace fs = std::filesystem;
using testing::error_of;
using testing::TempFolder;

fs::path repository() { return PARTPOSE_SOURCE_DIR; }

/// How far a set of motions is from another: the largest, over both, of the distance to the nearest of the other.
double distance(const std::vector<Eigen::Isometry3d>& a, const std::vector<Eigen::Isometry3d>& b) {
  double largest = 0;
  for (const auto& [from, to] : {std::pair{&a, &b}, {&b, &a}})
    for (const auto& motion : *from) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& other : *to) nearest = std::min(nearest, (motion.matrix() - other.matrix()).norm());
      largest = std::max(largest, nearest);
    }
  return largest;
}

TEST(ModelSymmetries, AreFoundAsListedForTheShippedParts) {
  // scenes/symmetries.json was made by another program (tools/make_frames.py).
  const auto listed = read_models_info(repository() / "scenes/symmetries.json");
  ASSERT_EQ(listed.size(), 13u);
  for (const auto& [name, info] : listed) {
    const auto mesh = read_stl(repository() / "parts" / (name + ".stl"));
    const auto search = search_symmetries(mesh, info.symmetries.symmetry_tolerance_mm);
    const Symmetries expected = info.symmetries.symmetries();
    EXPECT_LT(distance(search.found.symmetries.discrete, expected.discrete), 0.02) << name;
    ASSERT_EQ(search.found.symmetries.continuous.size(), expected.continuous.size()) << name;
    for (std::size_t i = 0; i < expected.continuous.size(); ++i) {
      const auto& found = search.found.symmetries.continuous[i];
      const auto& [axis, offset_mm] = expected.continuous[i];
      EXPECT_LT(found.axis.cross(axis).norm(), 1e-3) << name;
      EXPECT_LT((found.offset_mm - offset_mm).cross(axis).norm(), 0.02) << name;
    }
    EXPECT_NEAR(search.found.largest_deviation_mm(), *info.symmetries.symmetry_deviation_mm, 0.01) << name;
    EXPECT_NEAR(search.diameter_mm, *info.diameter, 0.01) << name;
    // The default tolerance says the same of these parts.
    const auto by_default = search_symmetries(mesh);
    EXPECT_EQ(by_default.found.symmetries.discrete.size(), expected.discrete.size()) << name;
    EXPECT_EQ(by_default.found.symmetries.continuous.size(), expected.continuous.size()) << name;
  }
}

TEST(ModelSymmetries, NearOnesOfTheShippedParts) {
  const auto near = [](const char* name) {
    return search_symmetries(read_stl(repository() / "parts" / (std::string(name) + ".stl"))).near.symmetries;
  };
  const auto shaft = near("keyed_shaft");  // round but for its keyway
  ASSERT_EQ(shaft.continuous.size(), 1u);
  EXPECT_LT(shaft.continuous[0].axis.cross(Eigen::Vector3d::UnitX()).norm(), 0.01);
  const auto plate = near("t_plate");  // a half turn about its stem but for counterbores and chamfers
  ASSERT_EQ(plate.discrete.size(), 1u);
  EXPECT_GT(std::abs(Eigen::AngleAxisd(plate.discrete[0].linear()).axis().y()), 0.999);
  EXPECT_TRUE(near("mount_left").empty());
}

TEST(ModelSymmetries, JsonRoundTrip) {
  Symmetries symmetries;
  Random random(1);
  symmetries.discrete = {shapes::random_pose(random, {1, 2, 3}), shapes::random_pose(random, {-40, 5, 6})};
  symmetries.continuous = {{Eigen::Vector3d(1, 2, 2) / 3, {7, 8, 9}}};
  const auto read = from_json<ModelSymmetries>(to_json(ModelSymmetries::of(symmetries))).symmetries();
  EXPECT_LT(distance(read.discrete, symmetries.discrete), 1e-8);
  ASSERT_EQ(read.continuous.size(), 1u);
  EXPECT_LT((read.continuous[0].axis - symmetries.continuous[0].axis).norm(), 1e-8);
  EXPECT_LT((read.continuous[0].offset_mm - symmetries.continuous[0].offset_mm).norm(), 1e-8);
  EXPECT_EQ(to_json(ModelSymmetries::of(Symmetries{})).dump(), "{}");
}

TEST(ReadModelsInfo, NamesFileAndKey) {
  const TempFolder folder;
  const auto error = [&](const std::string& text) {
    return error_of([&] { read_models_info(folder.file("info.json", text)); });
  };
  EXPECT_EQ(error(R"({"1": {"diameter": 3, "symmetries_continuous": [{"axis": [0, 0, 2], "offset": [0, 0, 0]}]}})"),
            "no error");
  EXPECT_CONTAINS(error(R"({"1": {"symmetry_discrete": []}})"), "info.json: 1: unknown key");
  EXPECT_CONTAINS(error(R"({"1": {"symmetries_discrete": [[1, 0, 0]]}})"), "symmetries_discrete[0]");
  EXPECT_CONTAINS(error(R"({"1": {"symmetries_discrete": [[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]]}})"), "not a rigid");
  EXPECT_CONTAINS(error(R"({"1": {"symmetries_continuous": [{"axis": [0, 0, 0], "offset": [0, 0, 0]}]}})"), "axis");
  EXPECT_CONTAINS(error("[]"), "expected an object");
}

/// Small images from 12 places.
DatasetPreparationConfig small_config() {
  DatasetPreparationConfig config;
  config.virtual_depth_camera.resolution_px = {40, 30};
  config.virtual_views_icosahedron.subdivide = 0;
  return config;
}

TEST(DatasetSymmetries, AreFoundUnlessGiven) {
  const TempFolder folder;
  write_stl(folder / "block.stl", shapes::box({60, 40, 20}));
  write_stl(folder / "prism.stl", shapes::cylinder(30, 25, 6));
  write_stl(folder / "bracket.stl", shapes::l_bracket());
  const std::vector<fs::path> parts = {folder / "block.stl", folder / "prism.stl", folder / "bracket.stl"};
  auto config = small_config();
  create_dataset(config, parts, folder / "found");
  auto models = open_dataset(folder / "found").out.models;
  EXPECT_EQ(models[0].symmetries.symmetries().discrete.size(), 3u);
  EXPECT_EQ(models[1].symmetries.symmetries().discrete.size(), 11u);
  EXPECT_TRUE(models[2].symmetries.symmetries().empty());
  for (const auto& model : models) EXPECT_TRUE(model.symmetries.symmetry_tolerance_mm.has_value());

  const auto infos = read_models_info(folder / "found/models_info.json");
  ASSERT_EQ(infos.size(), 3u);
  EXPECT_EQ(infos.at("0").name, "block");
  EXPECT_NEAR(*infos.at("0").diameter, std::sqrt(3600 + 1600 + 400), 1e-4);
  EXPECT_EQ(*infos.at("0").min_x, -30);
  EXPECT_EQ(*infos.at("0").size_z, 20);
  EXPECT_EQ(infos.at("1").symmetries.symmetries_discrete->size(), 11u);

  // By name, by id, and of parts that are not there; the others are searched for.
  config.symmetries = folder
                          .file("given.json", R"({
      "block": {"symmetries_discrete": [[1,0,0,0, 0,-1,0,0, 0,0,-1,0, 0,0,0,1]]},
      "2": {"symmetries_continuous": [{"axis": [0, 0, 1], "offset": [1, 2, 3]}]}, "other": {}})")
                          .string();
  create_dataset(config, parts, folder / "given");
  models = open_dataset(folder / "given").out.models;
  EXPECT_EQ(models[0].symmetries.symmetries().discrete.size(), 1u);
  EXPECT_FALSE(models[0].symmetries.symmetry_tolerance_mm.has_value());
  EXPECT_EQ(models[1].symmetries.symmetries().discrete.size(), 11u);
  EXPECT_EQ(models[2].symmetries.symmetries().continuous.size(), 1u);

  // What was given stays when a mesh changes, what was found is found again.
  auto dataset = open_dataset(folder / "given");
  write_stl(dataset.mesh_path(0), shapes::box({50, 50, 50}));
  write_stl(dataset.mesh_path(1), shapes::box({50, 50, 50}));
  EXPECT_EQ(refresh_dataset(dataset), 2);
  EXPECT_EQ(dataset.out.models[0].symmetries.symmetries().discrete.size(), 1u);
  EXPECT_EQ(dataset.out.models[1].symmetries.symmetries().discrete.size(), 23u);

  config.symmetries = folder.file("none.json", R"({"blok": {}})").string();
  EXPECT_CONTAINS(error_of([&] { create_dataset(config, parts, folder / "no"); }), "none of the models");
  EXPECT_FALSE(fs::exists(folder / "no"));
  config.symmetries = (folder / "missing.json").string();
  EXPECT_CONTAINS(error_of([&] { create_dataset(config, parts, folder / "no"); }), "missing.json");
}

TEST(DatasetSymmetries, OlderFilesHaveNone) {
  const TempFolder folder;
  write_stl(folder / "block.stl", shapes::box({60, 40, 20}));
  create_dataset(small_config(), {folder / "block.stl"}, folder / "set");
  Json json = read_json_file(folder / "set/dataset.json");
  for (const char* key : {"symmetries_discrete", "symmetry_tolerance_mm", "symmetry_deviation_mm"})
    EXPECT_EQ(json["models"][0].erase(key), 1u) << key;
  write_json_file(folder / "set/dataset.json", json);
  EXPECT_TRUE(open_dataset(folder / "set").out.models[0].symmetries.symmetries().empty());
}

TEST(DatasetSymmetries, ToleranceIsThatOfTheConfiguration) {
  const TempFolder folder;
  write_stl(folder / "block.stl", shapes::box({60, 59, 20}));
  auto config = small_config();
  config.symmetry_tolerance_mm = 0.2;
  EXPECT_EQ(create_dataset(config, {folder / "block.stl"}, folder / "a")
                .out.models[0]
                .symmetries.symmetries()
                .discrete.size(),
            3u);
  config.symmetry_tolerance_mm = 1;
  EXPECT_EQ(create_dataset(config, {folder / "block.stl"}, folder / "b")
                .out.models[0]
                .symmetries.symmetries()
                .discrete.size(),
            7u);
  config.symmetry_tolerance_mm = -1;
  EXPECT_CONTAINS(error_of([&] { config.check(); }), "symmetry_tolerance_mm -1");
}

}  // namespace
}  // namespace partpose
