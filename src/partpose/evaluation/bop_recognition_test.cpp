// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/bop_recognition.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/evaluation/bop_score.hpp"
#include "partpose/io/stl.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <memory>

namespace partpose {
namespace {

namespace fs = std::filesystem;

constexpr int bracket = 2, link = 5, t_plate = 7;

/// Two brackets and a link on a table, seen obliquely; the dataset also has a T-plate that is not asked for.
class TwoBracketsAndALink : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    root = fs::temp_directory_path() / fmt::format("partpose_bop_recognition_{}", getpid());
    const Intrinsics camera = Intrinsics::from_field_of_view(640, 480, 55, 43);
    std::map<int, TriangleMesh> meshes;
    std::map<int, BopModelInfo> infos;
    for (const auto& [id, name] :
         {std::pair(bracket, "bracket"), std::pair(link, "link"), std::pair(t_plate, "t_plate")}) {
      meshes[id] = read_stl(fs::path(PARTPOSE_SOURCE_DIR) / "parts" / (std::string(name) + ".stl"));
      infos[id] = bop_model_info(meshes[id]);
      write_bop_model(root / "toy/models", id, meshes[id]);
    }
    infos[link].symmetries.discrete.emplace_back(Eigen::AngleAxisd(radians(180), Eigen::Vector3d::UnitX()));
    write_bop_models_info(root / "toy/models", infos);

    // The table: z = 0 of the world, z up; the camera looks down on it from 40 degrees off the vertical.
    Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
    camera_from_world.translation().z() = 650;
    camera_from_world.rotate(Eigen::AngleAxisd(radians(180 - 40), Eigen::Vector3d::UnitX()));
    const TriangleMesh table{{{-2000, -2000, 0}, {2000, -2000, 0}, {2000, 2000, 0}, {-2000, 2000, 0}},
                             {{0, 1, 2}, {0, 2, 3}}};
    BopScene scene{1, bop_scene_folder(root / "toy", "test", 1), true, {}};
    BopImage image{0, BopCamera::of(camera, 0.1), {}};
    DepthImage depth = render(table, camera_from_world, camera).depth;
    const auto place = [&](int id, double x, double y, double yaw_deg) {
      const auto& mesh = meshes[id];
      Eigen::Isometry3d world_from_model = Eigen::Isometry3d::Identity();
      world_from_model.translation() = Eigen::Vector3d(x, y, -bounding_box(mesh).min().z());
      world_from_model.rotate(Eigen::AngleAxisd(radians(yaw_deg), Eigen::Vector3d::UnitZ()));
      const Eigen::Isometry3d pose = camera_from_world * world_from_model;
      const DepthImage rendered = render(mesh, pose, camera).depth;
      for (std::size_t i = 0; i < depth.z_mm.size(); ++i)
        if (rendered.z_mm[i] > 0) depth.z_mm[i] = std::min(depth.z_mm[i], rendered.z_mm[i]);
      image.ground_truths.push_back({id, pose, BopVisibility{}});
    };
    place(bracket, -110, 30, 20);
    place(link, 20, -90, 75);
    place(bracket, 120, 60, 200);
    scene.images.push_back(image);
    write_bop_depth(scene.folder, 0, depth, 0.1);
    write_bop_scene(scene);
    dataset = std::make_unique<BopDataset>(read_bop_dataset(root / "toy"));
    recognizer = std::make_unique<Recognizer>(bop_catalogue(*dataset, root / "cache"));
  }

  static void TearDownTestSuite() {
    recognizer.reset();
    dataset.reset();
    fs::remove_all(root);
  }

  static inline fs::path root;
  static inline std::unique_ptr<BopDataset> dataset;
  static inline std::unique_ptr<Recognizer> recognizer;
};

TEST_F(TwoBracketsAndALink, TheCatalogueHasTheTargetsPartsOnly) {
  std::vector<std::string> names;
  for (const auto& part : recognizer->catalogue().parts) names.push_back(part.name);
  EXPECT_EQ(names, (std::vector<std::string>{"obj_000002", "obj_000005"}));
}

TEST_F(TwoBracketsAndALink, AllThreeAreRecognizedWithOneTimeForTheImage) {
  const auto estimates = recognize_bop(*dataset, *recognizer, 0.5f);
  ASSERT_EQ(estimates.size(), 3);
  for (const auto& e : estimates) {
    EXPECT_EQ(e.scene_id, 1);
    EXPECT_EQ(e.im_id, 0);
    EXPECT_GT(e.time_s, 0);
    EXPECT_EQ(e.time_s, estimates[0].time_s);
  }
  EXPECT_EQ(std::ranges::count(estimates, bracket, &BopEstimate::obj_id), 2);
  write_bop_results(root / "partpose_toy-test.csv", estimates);
  const BopScores scores = score_bop(*dataset, read_bop_results(root / "partpose_toy-test.csv"));
  EXPECT_EQ(scores.mssd.average_recall, 1);
  EXPECT_EQ(scores.mspd.average_recall, 1);
  EXPECT_GT(scores.vsd->average_recall, 0.95);
}

TEST_F(TwoBracketsAndALink, NoMoreThanAskedForAreGiven) {
  const BopScene& scene = dataset->scene(1);
  const DepthImage depth = scene.read_depth(scene.images[0]);
  const auto camera = scene.images[0].camera.intrinsics(depth.width, depth.height);
  const auto found = recognize_bop_image(*recognizer, depth, camera, {{bracket, 1}}, 0.5f);
  ASSERT_EQ(found.size(), 1);
  EXPECT_EQ(found[0].obj_id, bracket);
  EXPECT_TRUE(recognize_bop_image(*recognizer, depth, camera, {}, 0.5f).empty());
  EXPECT_TRUE(recognize_bop_image(*recognizer, DepthImage(64, 48), Intrinsics::from_field_of_view(64, 48, 55, 43),
                                  {{bracket, 1}}, 0.5f)
                  .empty());
}

TEST_F(TwoBracketsAndALink, WithoutTargetsOrDepthThereIsNoCatalogue) {
  BopDataset other = *dataset;
  other.targets.clear();
  EXPECT_THROW(bop_catalogue(other, root / "cache"), Error);
  other = *dataset;
  other.scenes.at(1).folder = root / "nowhere";
  EXPECT_THROW(bop_catalogue(other, root / "cache"), Error);
}

}  // namespace
}  // namespace partpose
