// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/bop.hpp"

#include "partpose/io/testing.hpp"

#include "tests/shapes.hpp"

#include <algorithm>
#include <numbers>

namespace partpose {
namespace {

using namespace testing;
namespace fs = std::filesystem;

Eigen::Isometry3d some_pose(double angle) {
  Eigen::Isometry3d pose(Eigen::Translation3d(1.0 / 3, -20, 600 + angle));
  return pose.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()));
}

/// Two objects, two scenes, all keys that we know.
class BopFolder : public ::testing::Test {
 protected:
  BopFolder() {
    const TriangleMesh box = shapes::box({30, 40, 120}), cylinder = shapes::cylinder(10, 40, 24);
    Symmetries of_box, of_cylinder;
    of_box.discrete.emplace_back(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    of_cylinder.continuous.push_back({{0, 0, 2}, {1, 2, 3}});
    models = {{1, bop_model_info(box, of_box)}, {12, bop_model_info(cylinder, of_cylinder)}};
    write_bop_model(root() / "models", 1, box);
    write_bop_model(root() / "models", 12, cylinder);
    write_bop_models_info(root() / "models", models);
    write_bop_camera(root(), {camera, 0.1});
    for (const int scene_id : {1, 4}) {
      BopScene scene{scene_id, bop_scene_folder(root(), "test", scene_id), true, {}};
      for (const int im_id : {0, 3, 12}) {
        BopImage image{im_id, BopCamera::of(camera, 0.1), {}};
        image.camera.camera_from_world = some_pose(0.4);
        BopVisibility visibility{{-5, 2, 30, 40}, {0, 2, 25, 40}, 900, 800, 450, 0.5};
        image.ground_truths.push_back({12, some_pose(im_id), visibility});
        image.ground_truths.push_back({1, some_pose(im_id + 1), visibility});
        visibility.visib_fract = 0.05;
        image.ground_truths.push_back({1, some_pose(im_id + 2), visibility});
        scene.images.push_back(image);
        DepthImage depth(camera.width, camera.height);
        depth.at(5, 6) = static_cast<float>(500.3 + im_id);
        write_bop_depth(scene.folder, im_id, depth, 0.1);
      }
      write_bop_scene(scene);
      scenes.push_back(scene);
    }
    write_bop_targets(root(), bop_targets_of(scenes));
  }

  fs::path root() const { return folder / "toy"; }
  /// The message about a dataset with a change in one of its files.
  std::string with(const std::string& file, const std::string& from, const std::string& to) const {
    const std::string old = content(root() / file);
    std::ofstream(root() / file, std::ios::binary) << replaced(old, from, to);
    const std::string message = error_of([&] { read_bop_dataset(root()); });
    std::ofstream(root() / file, std::ios::binary) << old;
    return message;
  }

  const Intrinsics camera{32, 24, 40.5, 41, 15.5, 11.5};
  const TempFolder folder;
  std::map<int, BopModelInfo> models;
  std::vector<BopScene> scenes;
};

TEST_F(BopFolder, RoundTripKeepsEveryBit) {
  const BopDataset dataset = read_bop_dataset(root());
  ASSERT_TRUE(dataset.camera);
  EXPECT_EQ(dataset.camera->intrinsics.fx, 40.5);
  EXPECT_EQ(dataset.camera->depth_scale_mm, 0.1);
  ASSERT_EQ(dataset.models.size(), 2);
  for (const auto& [id, info] : models) {
    const auto& again = dataset.models.at(id);
    EXPECT_EQ(again.diameter_mm, info.diameter_mm);
    EXPECT_TRUE(again.box_mm.isApprox(info.box_mm));
    ASSERT_EQ(again.symmetries.discrete.size(), info.symmetries.discrete.size());
    ASSERT_EQ(again.symmetries.continuous.size(), info.symmetries.continuous.size());
  }
  EXPECT_EQ(dataset.models.at(1).symmetries.discrete[0].matrix(), models.at(1).symmetries.discrete[0].matrix());
  EXPECT_EQ(dataset.models.at(12).symmetries.continuous[0].axis, Eigen::Vector3d(0, 0, 2));
  EXPECT_EQ(dataset.models.at(12).symmetries.continuous[0].offset_mm, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(dataset.models.at(1).diameter_mm, 130);
  EXPECT_EQ(dataset.read_model(1).triangles.size(), 12);

  ASSERT_EQ(dataset.scenes.size(), 2);
  for (const auto& scene : scenes) {
    const auto& again = dataset.scene(scene.id);
    ASSERT_EQ(again.images.size(), 3);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto &a = again.images[i], &b = scene.images[i];
      EXPECT_EQ(a.id, b.id);
      EXPECT_EQ(a.camera.K, b.camera.K);
      EXPECT_EQ(a.camera.depth_scale_mm, 0.1);
      EXPECT_EQ(a.camera.camera_from_world->matrix(), b.camera.camera_from_world->matrix());
      EXPECT_NEAR(again.read_depth(a).at(5, 6), 500.3 + b.id, 1e-4);
      ASSERT_EQ(a.ground_truths.size(), 3);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(a.ground_truths[k].obj_id, b.ground_truths[k].obj_id);
        EXPECT_EQ(a.ground_truths[k].camera_from_model.matrix(), b.ground_truths[k].camera_from_model.matrix());
        const auto &v = *a.ground_truths[k].visibility, &w = *b.ground_truths[k].visibility;
        EXPECT_EQ(v.bbox_obj, w.bbox_obj);
        EXPECT_EQ(v.bbox_visib, w.bbox_visib);
        EXPECT_EQ(std::tuple(v.px_count_all, v.px_count_valid, v.px_count_visib, v.visib_fract),
                  std::tuple(w.px_count_all, w.px_count_valid, w.px_count_visib, w.visib_fract));
      }
    }
  }
  ASSERT_EQ(dataset.targets.size(), 12);
  EXPECT_EQ(dataset.targets[0].obj_id, 1);
  EXPECT_EQ(dataset.targets[0].inst_count, 1) << "the other instance is hardly visible";
}

TEST_F(BopFolder, OptionalFilesAreOptional) {
  fs::remove(root() / "camera.json");
  fs::remove(root() / "test_targets_bop19.json");
  fs::remove(root() / "test/000001/scene_gt_info.json");
  fs::remove(root() / "test/000004/scene_gt.json");
  const BopDataset dataset = read_bop_dataset(root());
  EXPECT_FALSE(dataset.camera);
  EXPECT_FALSE(dataset.scene(1).images[0].ground_truths[0].visibility);
  EXPECT_FALSE(dataset.scene(4).has_ground_truth);
  EXPECT_EQ(dataset.targets.size(), 6) << "without a file: all ground truths";
  EXPECT_EQ(dataset.targets[0].inst_count, 2);
}

TEST_F(BopFolder, EvaluationModelsGoBeforeOthers) {
  fs::create_directories(root() / "models_eval");
  EXPECT_CONTAINS(error_of([&] { read_bop_dataset(root()); }), "models_eval/models_info.json: no such file");
  fs::copy(root() / "models", root() / "models_eval");
  EXPECT_EQ(read_bop_dataset(root()).models_folder, root() / "models_eval");
}

TEST_F(BopFolder, OtherKeysAreIgnored) {
  EXPECT_EQ(with("test/000001/scene_gt.json", "\"obj_id\"", "\"elev\": 3, \"obj_id\""), "no error");
  EXPECT_EQ(with("camera.json", "\"width\"", "\"lens\": \"x\", \"width\""), "no error");
}

TEST_F(BopFolder, DamageIsNamedByFileAndKey) {
  const std::string gt = "test/000001/scene_gt.json", cameras = "test/000001/scene_camera.json",
                    infos = "test/000001/scene_gt_info.json", info = "models/models_info.json",
                    targets = "test_targets_bop19.json";
  EXPECT_CONTAINS(with(gt, "cam_t_m2c", "cam_t"), "scene_gt.json: key \"0[0].cam_t_m2c\" is missing");
  EXPECT_CONTAINS(with(gt, "\"obj_id\":12", "\"obj_id\":2"), "key \"0[0].obj_id\": 2 is none of the objects");
  EXPECT_CONTAINS(with(gt, "\"obj_id\":12", "\"obj_id\":\"12\""), "key \"0[0].obj_id\": expected a whole number");
  EXPECT_CONTAINS(with(gt, "\"cam_R_m2c\":[1.0", "\"cam_R_m2c\":[7.0"), "key \"0[0].cam_R_m2c\": not a rotation");
  EXPECT_CONTAINS(with(gt, "\"cam_R_m2c\":[1.0,", "\"cam_R_m2c\":["), "expected an array of 9");
  EXPECT_CONTAINS(with(gt, "\"3\":", "\"4\":"), "key \"4\": there is no such image in scene_camera.json");
  EXPECT_CONTAINS(with(gt, "\"3\":", "\"03\":"), "no error");
  EXPECT_CONTAINS(with(gt, "\"3\":", "\"00\":"), "the id 0 is given twice");
  EXPECT_CONTAINS(with(gt, "\"3\":", "\"x\":"), "key \"x\": an id");
  EXPECT_CONTAINS(with(gt, "{", "[{"), "scene_gt.json: line 6, column 1");
  EXPECT_CONTAINS(with(cameras, "40.5", "-40.5"), "key \"0.cam_K\": the focal lengths must be positive");
  EXPECT_CONTAINS(with(cameras, "\"depth_scale\":0.1", "\"depth_scale\":0"), "key \"0.depth_scale\": must be positive");
  EXPECT_CONTAINS(with(infos, "\"visib_fract\"", "\"visible\""), "key \"0[0].visib_fract\" is missing");
  EXPECT_CONTAINS(with(infos, "\"0\": [", "\"0\": [{\"visib_fract\": 1},"), "4 entries, but scene_gt.json has 3");
  EXPECT_CONTAINS(with(info, "\"diameter\":130.0", "\"diameter\":-1"), "key \"1.diameter\": must be positive");
  EXPECT_CONTAINS(with(info, "min_x", "min"), "key \"1.min_x\" is missing");
  EXPECT_CONTAINS(with(info, "\"axis\":[0.0,0.0,2.0]", "\"axis\":[0,0,0]"), "axis\": has no direction");
  EXPECT_CONTAINS(with(info, "\"symmetries_discrete\":[[1.0,", "\"symmetries_discrete\":[[3.0,"), "not a rigid");
  EXPECT_CONTAINS(with("camera.json", "\"width\": 32", "\"width\": 0"), "camera.json: ");
  EXPECT_CONTAINS(with(targets, "\"inst_count\":1", "\"inst_count\":0"), "must be 1 or more");
  EXPECT_CONTAINS(with(targets, "\"scene_id\":1", "\"scene_id\":3"), "entry 0: there is no scene 3");
  EXPECT_CONTAINS(with(targets, "\"im_id\":0", "\"im_id\":1"), "entry 0: scene 1 has no image 1");
  EXPECT_CONTAINS(with(targets, "\"obj_id\":1,", "\"obj_id\":12,"), "scene 1, image 0, object 12 is there twice");
}

TEST_F(BopFolder, WhatIsNoDatasetIsAnError) {
  EXPECT_CONTAINS(error_of([&] { read_bop_dataset(folder / "nowhere"); }), "no such folder");
  EXPECT_CONTAINS(error_of([&] { read_bop_dataset(root(), "train"); }), "train: no such folder");
  fs::create_directories(root() / "train/notes");
  EXPECT_CONTAINS(error_of([&] { read_bop_dataset(root(), "train"); }), "has no scenes");
  fs::remove(root() / "test/000001/scene_camera.json");
  EXPECT_CONTAINS(error_of([&] { read_bop_dataset(root()); }), "scene_camera.json: no such file");
}

TEST_F(BopFolder, ACameraWithSkewHasNoIntrinsics) {
  BopCamera skewed = BopCamera::of(camera);
  EXPECT_EQ(skewed.intrinsics(32, 24).cx, 15.5);
  skewed.K(0, 1) = 0.5;
  EXPECT_CONTAINS(error_of([&] { skewed.intrinsics(32, 24); }), "skew");
}

TEST_F(BopFolder, DamagedTruthIsReadOrRefused) {
  const fs::path scene = folder / "scene";
  fs::create_directories(scene);
  fs::copy(root() / "test/000001/scene_camera.json", scene);
  const auto read = [&](const fs::path& damaged) {
    fs::copy_file(damaged, scene / "scene_gt.json", fs::copy_options::overwrite_existing);
    try {
      return read_bop_scene(scene, 1);
    } catch (const Error& error) {
      const std::string own = (scene / "scene_gt.json").string(), message = error.what();
      EXPECT_TRUE(message.starts_with(own));
      throw Error("{}{}", damaged.string(), message.substr(own.size()));
    }
  };
  const std::string one = "{\"0\": [{\"cam_R_m2c\": [1,0,0,0,1,0,0,0,1], \"cam_t_m2c\": [1,2,3], \"obj_id\": 12}]}";
  survive_damage(one, read, 300);
}

// Results.

const std::string results =
    "scene_id,im_id,obj_id,score,R,t,time\n"
    "1,0,3,0.97,1 0 0 0 1 0 0 0 1,84.5 110.25 503,0.136\n"
    "1,0,4,-2.5e-3,0 -1 0 1 0 0 0 0 1,-57 135 732.5,0.1365\n"
    "2,7,4,1,1 0 0 0 0 -1 0 1 0,0 0 600,-1\n";

TEST(BopResults, AreReadAndWrittenToTheBit) {
  const TempFolder folder;
  const auto estimates = read_bop_results(folder.file("a.csv", results));
  ASSERT_EQ(estimates.size(), 3);
  EXPECT_EQ(estimates[1].obj_id, 4);
  EXPECT_EQ(estimates[1].score, -2.5e-3);
  EXPECT_EQ(estimates[1].camera_from_model.linear()(0, 1), -1);
  EXPECT_EQ(estimates[1].camera_from_model.translation(), Eigen::Vector3d(-57, 135, 732.5));
  EXPECT_EQ(estimates[2].time_s, -1);
  auto turned = estimates;
  for (auto& e : turned) e.camera_from_model = e.camera_from_model * some_pose(0.3);
  write_bop_results(folder / "b.csv", turned);
  EXPECT_TRUE(content(folder / "b.csv").starts_with("scene_id,im_id,obj_id,score,R,t,time\n1,0,3,0.97,"));
  const auto again = read_bop_results(folder / "b.csv");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again[i].camera_from_model.matrix(), turned[i].camera_from_model.matrix());
    EXPECT_EQ(again[i].time_s, turned[i].time_s);
  }
}

TEST(BopResults, MayLackTheHeaderAndHaveOtherLineEnds) {
  const TempFolder folder;
  EXPECT_EQ(read_bop_results(folder.file("a.csv", results.substr(results.find('\n') + 1))).size(), 3);
  std::string windows;
  for (const char c : results) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(read_bop_results(folder.file("b.csv", windows)).size(), 3);
  EXPECT_EQ(read_bop_results(folder.file("c.csv", results.substr(0, results.find('\n')))).size(), 0);
}

TEST(BopResults, DamageIsNamedByLine) {
  const TempFolder folder;
  const auto with = [&](const std::string& from, const std::string& to) {
    return error_of([&] { read_bop_results(folder.file("a.csv", replaced(results, from, to))); });
  };
  EXPECT_CONTAINS(with("1,0,3,", "1,0,x,"), "a.csv: line 2: obj_id: 'x' where an id");
  EXPECT_CONTAINS(with("0.97", "nan"), "line 2: score: 'nan' where a number");
  EXPECT_CONTAINS(with("0 -1 0 1 0 0 0 0 1", "0 -1 0 1 0 0 0 0"), "line 3: R: ");
  EXPECT_CONTAINS(with("0 -1 0 1 0 0 0 0 1", "0 -1 0 1 0 0 0 0 2"), "line 3: R is not a rotation");
  EXPECT_CONTAINS(with("84.5 110.25 503", "84.5 110.25 503 1"), "line 2: t: ");
  EXPECT_CONTAINS(with(",0.136\n", "\n"), "line 2: 6 comma-separated values, 7 expected");
  EXPECT_CONTAINS(with("0.1365", "0.138"), "line 3: time 0.138, but 0.136 in an earlier row of scene 1, image 0");
  EXPECT_CONTAINS(with("600,-1", "600,-3"), "line 4: time -3");
  EXPECT_CONTAINS(error_of([&] { read_bop_results(folder / "nowhere.csv"); }), "no such file");
}

TEST(BopResults, OnesThatTheToolkitRefusesAreNotWritten) {
  const TempFolder folder;
  std::vector<BopEstimate> estimates(2);
  estimates[0].time_s = 1;
  estimates[1].time_s = 2;
  EXPECT_CONTAINS(error_of([&] { write_bop_results(folder / "a.csv", estimates); }), "estimate 1: time 2, but 1");
  estimates[1].time_s = 1;
  estimates[1].score = std::numeric_limits<double>::infinity();
  EXPECT_CONTAINS(error_of([&] { write_bop_results(folder / "a.csv", estimates); }), "estimate 1: the score");
  EXPECT_EQ(folder.files(), 0);
}

TEST(BopResults, SurviveDamage) {
  survive_damage(
      results, [](const auto& path) { return read_bop_results(path); }, 1000);
}

}  // namespace
}  // namespace partpose
