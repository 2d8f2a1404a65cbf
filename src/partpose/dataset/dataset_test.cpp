// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/dataset/dataset.hpp"

#include "partpose/core/hash.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/io/testing.hpp"
#include "tests/shapes.hpp"

#include <map>
#include <set>

namespace partpose {
namespace {

namespace fs = std::filesystem;
using testing::content;
using testing::error_of;
using testing::TempFolder;

/// Small images from 12 places.
DatasetPreparationConfig small_config() {
  DatasetPreparationConfig config;
  config.tag = "a test";
  config.virtual_depth_camera.field_of_view_deg = {14, 10.5};
  config.virtual_depth_camera.resolution_px = {80, 60};
  config.virtual_views_icosahedron.subdivide = 0;
  return config;
}

TriangleMesh bracket() {
  return shapes::moved(shapes::l_bracket(), Eigen::Isometry3d(Eigen::Translation3d(7, -30, 100)));
}

/// Two STL files, a bracket off its origin and a box.
std::vector<fs::path> two_parts(const TempFolder& folder) {
  write_stl(folder / "bracket.stl", bracket());
  write_stl(folder / "block.stl", shapes::box({40, 30, 20}));
  return {folder / "bracket.stl", folder / "block.stl"};
}

/// Every file below a folder with its content.
std::map<std::string, std::string> files_below(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(folder).generic_string()] = content(entry.path());
  return files;
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

double largest_distance_to_mesh(const PointCloud& cloud, const Eigen::Isometry3d& model_from_cloud,
                                const TriangleMesh& mesh) {
  double largest = 0;
  for (std::size_t i = 0; i < cloud.size(); i += 3)
    largest = std::max(largest, shapes::distance_to_mesh(model_from_cloud * cloud.points[i].cast<double>(), mesh));
  return largest;
}

TEST(IcosahedronViews, StandAroundThePartAndLookAtItsCentre) {
  for (const int subdivide : {0, 1, 2}) {
    for (const bool use_vertices : {true, false}) {
      const IcosahedronOptions options = {
          .capture_distance_mm = 432.5, .subdivide = subdivide, .use_vertices = use_vertices, .xyz_rotation_deg = 7};
      const auto views = icosahedron_views(options);
      const int factor = 1 << (2 * subdivide);
      EXPECT_EQ(views.size(), use_vertices ? 10 * factor + 2 : 20 * factor);
      double nearest = 1e9;
      for (std::size_t i = 0; i < views.size(); ++i) {
        EXPECT_EQ(views[i].id, i);
        EXPECT_TRUE(is_rigid(views[i].T2.matrix(), 1e-12));
        EXPECT_NEAR(views[i].T2.inverse().translation().norm(), 432.5, 1e-9);
        const Eigen::Vector3d centre = views[i].T2 * Eigen::Vector3d::Zero();
        EXPECT_LT((centre - Eigen::Vector3d(0, 0, 432.5)).norm(), 1e-9) << "the part's centre is on the optical axis";
        for (std::size_t k = 0; k < i; ++k)
          nearest =
              std::min(nearest, (views[i].T2.inverse().translation() - views[k].T2.inverse().translation()).norm());
      }
      EXPECT_GT(nearest, 432.5 * 0.5 / (1 << subdivide));
    }
  }
}

TEST(IcosahedronViews, AreTurnedAboutXThenYThenZ) {
  const auto straight = icosahedron_views({.xyz_rotation_deg = 0}),
             turned = icosahedron_views({.xyz_rotation_deg = 25});
  const double a = radians(25);
  Eigen::Matrix3d x, y, z;
  x << 1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a);
  y << std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a);
  z << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1;
  for (std::size_t i = 0; i < straight.size(); ++i)
    EXPECT_LT((turned[i].T2.inverse().translation() - z * (y * (x * straight[i].T2.inverse().translation()))).norm(),
              1e-9);
}

TEST(CentredFromModel, MovesTheBoxsCentreToTheOrigin) {
  const auto centred = shapes::moved(bracket(), centred_from_model(bracket()));
  EXPECT_LT(bounding_box(centred).center().norm(), 1e-4);
  EXPECT_EQ(centred_from_model(bracket()).linear(), Eigen::Matrix3d::Identity());
}

TEST(DatasetOptions, CheckNamesTheKey) {
  const auto with = [](auto change) {
    DatasetPreparationConfig config;
    change(config);
    return error_of([&] { config.check(); });
  };
  EXPECT_EQ(with([](auto&) {}), "no error");
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_CONTAINS(with([&](auto& c) { c.virtual_views_icosahedron.capture_distance_mm = bad; }),
                    "capture_distance_mm");
  EXPECT_CONTAINS(with([](auto& c) { c.virtual_views_icosahedron.subdivide = 5; }), "subdivide 5");
  EXPECT_CONTAINS(with([](auto& c) { c.virtual_views_icosahedron.subdivide = -1; }), "subdivide -1");
  EXPECT_CONTAINS(
      with([](auto& c) { c.virtual_views_icosahedron.xyz_rotation_deg = std::numeric_limits<double>::infinity(); }),
      "xyz_rotation_deg");
  EXPECT_CONTAINS(with([](auto& c) { c.virtual_depth_camera.noise.model = "perlin"; }), "perlin");
}

TEST(DatasetOptions, OrganizedOutputMayStandInEitherPlace) {
  DatasetPreparationConfig config;
  EXPECT_FALSE(config.organized());
  config.organized_output = true;
  EXPECT_TRUE(config.organized());
  config.virtual_depth_camera.organized_output = false;
  EXPECT_FALSE(config.organized());
}

TEST(CreateDataset, HasTheLayoutOfTheReference) {
  const TempFolder folder;
  const auto dataset = create_dataset(small_config(), two_parts(folder), folder / "set");
  EXPECT_EQ(dataset.folder, folder / "set");
  EXPECT_EQ(names_in(folder / "set"),
            (std::set<std::string>{"dataset.json", "descriptors", "models", "models_info.json"}));
  EXPECT_TRUE(fs::is_empty(folder / "set/descriptors"));
  EXPECT_EQ(names_in(folder / "set/models"), (std::set<std::string>{"0000", "0001"}));
  for (const std::string model : {"set/models/0000", "set/models/0001"}) {
    EXPECT_EQ(names_in(folder / model), (std::set<std::string>{"mesh.stl", "views"}));
    const auto views = names_in(folder / (model + "/views"));
    EXPECT_EQ(views.size(), 12);
    EXPECT_TRUE(views.contains("0000.pcd") && views.contains("0011.pcd"));
  }
  EXPECT_EQ(content(folder / "set/models/0000/mesh.stl"), content(folder / "bracket.stl")) << "byte for byte";
  EXPECT_EQ(names_in(folder / ""), (std::set<std::string>{"bracket.stl", "block.stl", "set"})) << "nothing left beside";
}

TEST(CreateDataset, JsonRoundTrip) {
  const TempFolder folder;
  const auto dataset = create_dataset(small_config(), two_parts(folder), folder / "set");
  ASSERT_EQ(dataset.out.models.size(), 2);
  EXPECT_EQ(dataset.out.models[0].name, "bracket");
  EXPECT_EQ(dataset.out.models[1].name, "block");
  EXPECT_EQ(dataset.out.models[1].id, 1);
  EXPECT_EQ(dataset.out.models[0].mesh_hash, content_hash(content(folder / "bracket.stl")));
  EXPECT_EQ(dataset.out.views.size(), 12);

  const auto again = open_dataset(folder / "set");
  EXPECT_EQ(to_json(again.out).dump(), to_json(dataset.out).dump());
  EXPECT_EQ(again.out.dataset_preparation_config.tag, "a test");
  EXPECT_EQ(again.out.models[0].T1.matrix(), dataset.out.models[0].T1.matrix());
  for (int v = 0; v < 12; ++v) EXPECT_EQ(again.out.views[v].T2.matrix(), dataset.out.views[v].T2.matrix());
  const Json json = read_json_file(folder / "set/dataset.json");
  EXPECT_EQ(json["models"][0]["T1"][3], Json::parse("[0.0, 0.0, 0.0, 1.0]"));
}

TEST(CreateDataset, ViewsLieOnTheirMeshes) {
  const TempFolder folder;
  const auto dataset = create_dataset(small_config(), two_parts(folder), folder / "set");
  for (std::size_t m = 0; m < 2; ++m) {
    const auto mesh = read_stl(dataset.mesh_path(static_cast<int>(m)));
    for (std::size_t v = 0; v < 12; ++v) {
      const auto cloud = read_pcd(dataset.view_path(static_cast<int>(m), static_cast<int>(v)));
      EXPECT_GT(cloud.size(), 50);
      EXPECT_TRUE(cloud.has_normals());
      EXPECT_FALSE(cloud.is_organized());
      const auto camera_from_model = dataset.out.views[v].T2 * dataset.out.models[m].T1;
      EXPECT_EQ(camera_from_model.matrix(), dataset.camera_from_model(m, v).matrix());
      EXPECT_LT(largest_distance_to_mesh(cloud, camera_from_model.inverse(), mesh), 0.05);
      EXPECT_NEAR(centroid(cloud).z(), 650, 50);
      for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_LE(cloud.normals[i].dot(cloud.points[i]), 0);
    }
  }
}

TEST(CreateDataset, OrganizedViewsKeepTheImage) {
  const TempFolder folder;
  auto config = small_config();
  config.organized_output = true;
  const auto dataset = create_dataset(config, {two_parts(folder)[0]}, folder / "set");
  const auto cloud = read_pcd(dataset.view_path(0, 3));
  EXPECT_TRUE(cloud.is_organized());
  EXPECT_EQ(cloud.width, 80);
  EXPECT_EQ(cloud.height, 60);
}

TEST(CreateDataset, SameBytesForAnyNumberOfThreadsAndOtherNoiseInEachView) {
  const TempFolder folder;
  auto config = small_config();
  config.virtual_depth_camera.noise = {"gaussian", 1};
  const auto parts = two_parts(folder);
  // The same part under two names: their noise must differ.
  fs::copy_file(parts[1], folder / "copy.stl");
  const auto create = [&](int threads, const std::string& name) {
    const ThreadLimit limit(threads);
    create_dataset(config, {parts[0], parts[1], folder / "copy.stl"}, folder / name);
    return files_below(folder / name);
  };
  const auto one = create(1, "one"), two = create(2, "two");
  EXPECT_EQ(one.size(), 2 + 3 * 13);
  EXPECT_EQ(one, two);
  std::set<std::string> contents;
  for (const auto& [name, bytes] : one)
    if (name.ends_with(".pcd")) contents.insert(bytes);
  EXPECT_EQ(contents.size(), 3 * 12);
}

TEST(CreateDataset, TellsItsProgress) {
  const TempFolder folder;
  std::vector<std::size_t> steps;
  create_dataset(small_config(), two_parts(folder), folder / "set",
                 [&](std::string_view what, std::size_t done, std::size_t total) {
                   EXPECT_FALSE(what.empty());
                   if (what == "finding symmetries") {
                     EXPECT_EQ(total, 2);
                     return;
                   }
                   EXPECT_EQ(total, 24);
                   steps.push_back(done);
                 });
  ASSERT_EQ(steps.size(), 24);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(steps[i], i + 1);
}

TEST(CreateDataset, ReplacesAnOlderDatasetAtOnce) {
  const TempFolder folder;
  const auto parts = two_parts(folder);
  create_dataset(small_config(), parts, folder / "set");
  bool old_one_was_there = true;
  const auto progress = [&](std::string_view, std::size_t, std::size_t) {
    // While the new one is being made the old one must be whole.
    old_one_was_there = old_one_was_there && open_dataset(folder / "set").out.models.size() == 2;
  };
  create_dataset(small_config(), {parts[1]}, folder / "set/", progress);
  EXPECT_TRUE(old_one_was_there);
  const auto dataset = open_dataset(folder / "set");
  ASSERT_EQ(dataset.out.models.size(), 1);
  EXPECT_EQ(dataset.out.models[0].name, "block");
  EXPECT_FALSE(fs::exists(folder / "set/models/0001"));
  EXPECT_EQ(names_in(folder / ""), (std::set<std::string>{"bracket.stl", "block.stl", "set"}));
}

TEST(CreateDataset, AFailureLeavesEverythingAsItWas) {
  const TempFolder folder;
  const auto parts = two_parts(folder);
  create_dataset(small_config(), parts, folder / "set");
  const auto before = files_below(folder / "");
  const auto failing = [&](const std::vector<fs::path>& models, const Progress& progress = {}) {
    const auto message = error_of([&] { create_dataset(small_config(), models, folder / "set", progress); });
    auto after = files_below(folder / "");
    after.erase("broken.stl");
    EXPECT_EQ(after, before) << message;
    EXPECT_EQ(names_in(folder / "set"),
              (std::set<std::string>{"dataset.json", "descriptors", "models", "models_info.json"}));
    for (const auto& name : names_in(folder / "")) EXPECT_FALSE(name.starts_with("set.")) << name;
    return message;
  };
  EXPECT_CONTAINS(failing({}), "no models given");
  EXPECT_CONTAINS(failing({parts[0], folder / "missing.stl"}), "missing.stl: no such file");
  EXPECT_CONTAINS(failing({parts[0], folder.file("broken.stl", "solid")}), "broken.stl: ");
  EXPECT_CONTAINS(failing(parts,
                          [](std::string_view, std::size_t done, std::size_t) {
                            if (done == 13) throw Error("stopped by the user");
                          }),
                  "stopped by the user");
}

TEST(CreateDataset, RefusesToReplaceOtherThings) {
  const TempFolder folder;
  const auto parts = two_parts(folder);
  const auto creating = [&](const std::string& name) {
    return error_of([&] { create_dataset(small_config(), {parts[0]}, folder / name); });
  };
  fs::create_directory(folder / "photos");
  folder.file("photos/holiday.jpg", "x");
  EXPECT_CONTAINS(creating("photos"), "holds other things than a dataset");
  EXPECT_EQ(content(folder / "photos/holiday.jpg"), "x");

  EXPECT_EQ(creating("set"), "no error");
  folder.file("set/notes.txt", "mine");
  EXPECT_CONTAINS(creating("set"), "holds other things than a dataset");
  EXPECT_EQ(content(folder / "set/notes.txt"), "mine");

  folder.file("plain", "x");
  EXPECT_CONTAINS(creating("plain"), "exists and is not a folder");
  EXPECT_EQ(content(folder / "plain"), "x");

  fs::create_directory(folder / "empty");
  EXPECT_EQ(creating("empty"), "no error") << "an empty folder loses nothing";
}

TEST(CreateDataset, RefusesTwoPartsOfOneName) {
  const TempFolder folder;
  const auto parts = two_parts(folder);
  fs::create_directory(folder / "other");
  fs::copy_file(parts[0], folder / "other/bracket.stl");
  const auto message = error_of([&] {
    create_dataset(small_config(), {parts[0], folder / "other/bracket.stl"}, folder / "set");
  });
  EXPECT_CONTAINS(message, (folder / "other/bracket.stl").string() + ": another model is already named \"bracket\"");
}

TEST(OpenDataset, RefusesWhatIsNotWhole) {
  const TempFolder folder;
  const auto opening = [&](const std::string& name) { return error_of([&] { open_dataset(folder / name); }); };
  EXPECT_CONTAINS(opening("none"), "none: no such dataset folder");
  fs::create_directory(folder / "empty");
  EXPECT_CONTAINS(opening("empty"), "empty: has no dataset.json");

  create_dataset(small_config(), two_parts(folder), folder / "set");
  const auto text = content(folder / "set/dataset.json");
  const auto changed = [&](auto change) {
    Json json = Json::parse(text);
    change(json);
    folder.file("set/dataset.json", json.dump());
    return opening("set");
  };
  EXPECT_EQ(changed([](Json&) {}), "no error");
  EXPECT_CONTAINS(changed([](Json& j) { j.erase("views"); }), "key \"views\" is missing");
  EXPECT_CONTAINS(changed([](Json& j) { j["models"] = Json::array(); }), "has no models");
  EXPECT_CONTAINS(changed([](Json& j) { j["views"] = Json::array(); }), "has no views");
  EXPECT_CONTAINS(changed([](Json& j) { j["models"][1]["id"] = 0; }), "models: id 0 is negative or given twice");
  EXPECT_CONTAINS(changed([](Json& j) { j["views"][3]["id"] = -4; }), "views: id -4 is negative or given twice");
  EXPECT_CONTAINS(changed([](Json& j) { j["models"][0]["T1"][0][0] = 2; }),
                  "models[0].T1\": not a rigid transformation");
  EXPECT_CONTAINS(changed([](Json& j) { j["model"] = 1; }), "did you mean \"models\"?");
  folder.file("set/dataset.json", text);
  fs::remove(folder / "set/models/0001/mesh.stl");
  EXPECT_CONTAINS(opening("set"), "0001/mesh.stl: is missing");
}

TEST(OpenDataset, TakesADatasetOfAnotherProgram) {
  const TempFolder folder;
  create_dataset(small_config(), two_parts(folder), folder / "set");
  Json json = read_json_file(folder / "set/dataset.json");
  for (auto& model : json["models"]) model.erase("mesh_hash");
  write_json_file(folder / "set/dataset.json", json);
  auto dataset = open_dataset(folder / "set");
  const auto before = files_below(folder / "set");
  write_stl(dataset.mesh_path(0), shapes::box({10, 10, 10}));
  EXPECT_EQ(refresh_dataset(dataset), 0) << "who knows what its views were rendered from";
  auto after = files_below(folder / "set");
  after["models/0000/mesh.stl"] = before.at("models/0000/mesh.stl");
  EXPECT_EQ(after, before);
}

TEST(RefreshDataset, RendersAChangedMeshOnly) {
  const TempFolder folder;
  const auto parts = two_parts(folder);
  auto config = small_config();
  config.virtual_depth_camera.noise = {"gaussianray", 0.5f};
  create_dataset(config, parts, folder / "set");
  auto dataset = open_dataset(folder / "set");
  const auto before = files_below(folder / "set");
  EXPECT_EQ(refresh_dataset(dataset), 0);
  EXPECT_EQ(files_below(folder / "set"), before);

  const auto other = shapes::moved(shapes::cylinder(20, 50, 24), Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3)));
  write_stl(dataset.mesh_path(1), other);
  std::size_t rendered = 0;
  EXPECT_EQ(refresh_dataset(dataset, [&](std::string_view, std::size_t, std::size_t total) { rendered = total; }), 1);
  EXPECT_EQ(rendered, 12);
  const auto after = files_below(folder / "set");
  ASSERT_EQ(after.size(), before.size());
  for (const auto& [name, bytes] : after) EXPECT_EQ(bytes == before.at(name), name.starts_with("models/0000/")) << name;
  EXPECT_LT((dataset.out.models[1].T1.translation() - Eigen::Vector3d(-1, -2, -3)).norm(), 1e-5);
  EXPECT_EQ(refresh_dataset(dataset), 0) << "once is enough";
  EXPECT_EQ(to_json(open_dataset(folder / "set").out).dump(), to_json(dataset.out).dump());

  // The same as a dataset made of the new mesh.
  write_stl(folder / "block.stl", other);
  create_dataset(config, parts, folder / "new");
  EXPECT_EQ(files_below(folder / "new"), after);
}

TEST(RefreshDataset, SaysWhichMeshItCannotRead) {
  const TempFolder folder;
  auto dataset = create_dataset(small_config(), two_parts(folder), folder / "set");
  folder.file("set/models/0001/mesh.stl", "solid nonsense");
  EXPECT_CONTAINS(error_of([&] { refresh_dataset(dataset); }), "0001/mesh.stl: ");
  EXPECT_TRUE(fs::exists(folder / "set/dataset.json"));
}

TEST(ModelList, PathsAreRelativeToTheList) {
  const TempFolder folder;
  fs::create_directory(folder / "lists");
  const auto list = folder.file("lists/models.json", R"({"model_paths": ["a.stl", "../b.stl", "/far/c.stl"]})");
  const auto paths = read_model_list(list);
  ASSERT_EQ(paths.size(), 3);
  EXPECT_EQ(paths[0], folder / "lists/a.stl");
  EXPECT_EQ(paths[1].lexically_normal(), folder / "b.stl");
  EXPECT_EQ(paths[2], "/far/c.stl");
  EXPECT_CONTAINS(error_of([&] { read_model_list(folder.file("empty.json", "{}")); }),
                  "key \"model_paths\" is missing");
}

TEST(DatasetConfig, StereoNoiseHasItsOwnSection) {
  const auto read = [](const char* noise) {
    return from_json<DatasetPreparationConfig>(
        Json::parse(fmt::format("{{\"virtual_depth_camera\": {{\"noise\": {}}}}}", noise)));
  };
  EXPECT_FALSE(read("{\"model\": \"gaussian\"}").virtual_depth_camera.noise.stereo) << "old files say nothing of it";
  const auto config = read("{\"model\": \"stereo\", \"stereo\": {\"disparity_noise_px\": 0.05}}");
  EXPECT_EQ(config.virtual_depth_camera.noise.stereo->disparity_noise_px, 0.05);
  EXPECT_EQ(config.virtual_depth_camera.noise.stereo->baseline_mm, 55);
  EXPECT_EQ(to_json(from_json<DatasetPreparationConfig>(to_json(config))), to_json(config));
  EXPECT_FALSE(to_json(read("{}"))["virtual_depth_camera"]["noise"].contains("stereo"));
  const auto message = [&](const char* noise) { return shapes::error_of([&] { read(noise); }); };
  EXPECT_PRED2(shapes::mentions, message("{\"model\": \"sterio\"}"), "did you mean \"stereo\"");
  EXPECT_PRED2(shapes::mentions, message("{\"stereo\": {\"baseline\": 55}}"), "did you mean \"baseline_mm\"");
  EXPECT_PRED2(shapes::mentions, message("{\"stereo\": {\"baseline_mm\": -5}}"), "noise.stereo: baseline_mm -5");
}

}  // namespace
}  // namespace partpose
