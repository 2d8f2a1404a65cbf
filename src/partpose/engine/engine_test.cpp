// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/engine.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

namespace partpose {
namespace {

Catalogue catalogue_of(const std::vector<TriangleMesh>& meshes) {
  Catalogue catalogue;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    CataloguePart part;
    part.id = static_cast<int>(i);
    part.name = "part_" + std::to_string(i);
    part.mesh = meshes[i];
    catalogue.parts.push_back(part);
    CatalogueView view;
    view.part = static_cast<int>(i);
    view.T2.translation() = Eigen::Vector3d(0, 0, 500);
    catalogue.views.push_back(view);
  }
  return catalogue;
}

class EngineTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    engine = std::make_unique<Engine>(
        catalogue_of({shapes::l_bracket(), shapes::l_bracket(80, 25, 12, 30), shapes::cylinder(20, 70, 40)}));
  }
  static void TearDownTestSuite() { engine.reset(); }

  /// A part before an empty background, with noise of 1 mm.
  static DepthImage frame_of(int part, const Eigen::Isometry3d& pose, Random& random) {
    DepthImage depth = render(engine->catalogue().parts[part].mesh, pose, camera).depth;
    for (float& z : depth.z_mm)
      if (z > 0) z += static_cast<float>(random.normal_pair().first);
    return depth;
  }
  static inline std::unique_ptr<Engine> engine;
  static inline const Intrinsics camera{.width = 320, .height = 240, .fx = 500, .fy = 500, .cx = 159.5, .cy = 119.5};
};

TEST_F(EngineTest, FindsPartAndPose) {
  Random random(11);
  int right = 0;
  constexpr int frames = 12;
  for (int i = 0; i < frames; ++i) {
    const Eigen::Isometry3d truth = shapes::random_pose(random, {5, -10, 500});
    const Recognition r = engine->recognize(frame_of(0, truth, random), camera);
    ASSERT_GE(r.accepted, 0);
    ASSERT_EQ(r.detections.size(), 1u);
    EXPECT_EQ(r.detections[0].part, engine->catalogue().views[r.candidates[0].view_row].part);
    if (r.result.model_name != "part_0") continue;
    // The bracket is the same after a half turn about the bisector of its width, or nearly: the surfaces must coincide.
    double farthest = 0;
    for (const auto& v : shapes::l_bracket().vertices) {
      const Eigen::Vector3d at = truth.inverse() * (r.result.T_final * v.cast<double>());
      farthest = std::max(farthest, shapes::distance_to_mesh(at, shapes::l_bracket()));
    }
    right += farthest < 3;
  }
  EXPECT_GE(right, frames - 1);  // a view may hide what tells the two brackets apart
}

TEST_F(EngineTest, TheCandidatesTransformsMultiplyToThePose) {
  Random random(2);
  const Recognition r = engine->recognize(frame_of(1, shapes::random_pose(random, {0, 0, 480}), random), camera);
  ASSERT_FALSE(r.candidates.empty());
  for (const auto& c : r.candidates) {
    const auto& view = engine->catalogue().views[c.view_row];
    const Eigen::Isometry3d product = c.T4 * c.T3 * view.T2 * engine->catalogue().parts[view.part].T1;
    EXPECT_TRUE(product.isApprox(c.camera_from_model, 1e-9));
  }
}

TEST_F(EngineTest, SameBitsForAnyNumberOfThreads) {
  Random random(4);
  const DepthImage depth = frame_of(0, shapes::random_pose(random, {0, 0, 480}), random);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return engine->recognize(depth, camera);
  };
  const Recognition one = with(1), two = with(2);
  ASSERT_EQ(one.candidates.size(), two.candidates.size());
  for (std::size_t i = 0; i < one.candidates.size(); ++i) {
    EXPECT_EQ(one.candidates[i].score, two.candidates[i].score);
    EXPECT_EQ(one.candidates[i].camera_from_model.matrix(), two.candidates[i].camera_from_model.matrix());
  }
}

TEST_F(EngineTest, NothingIsNoResult) {
  EXPECT_LT(engine->recognize(DepthImage(320, 240), camera).accepted, 0);
  EXPECT_FALSE(engine->recognize(DepthImage(320, 240), camera).reason.empty());
  EXPECT_LT(engine->recognize(PointCloud{}).accepted, 0);
  PointCloud broken;
  broken.points.assign(100, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_LT(engine->recognize(broken).accepted, 0);
}

TEST_F(EngineTest, AVoxelGridsCloudIsSeenByACoarserCamera) {
  Random random(21);
  const Intrinsics taken_with{640, 480, 615, 615, 319.5, 239.5};
  Eigen::Isometry3d table = Eigen::Isometry3d::Identity();
  table.linear() = Eigen::AngleAxisd(2.6, Eigen::Vector3d::UnitX()).toRotationMatrix();
  table.translation().z() = 850;
  const TriangleMesh bracket = shapes::l_bracket();
  int right = 0;
  constexpr int frames = 6;
  for (int i = 0; i < frames; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(1.1 * i, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    pose.translation().z() = -bounding_box(bracket).min().z();
    const TriangleMesh scene = shapes::joined(shapes::plane_patch(600, 450), shapes::moved(bracket, pose));
    DepthImage depth = render(scene, table, taken_with).depth;
    for (float& z : depth.z_mm)
      if (z > 0) z += 0.5f * static_cast<float>(random.normal_pair().first);
    // The mean of the points in each cube of 2 mm.
    std::map<std::tuple<int, int, int>, std::pair<Eigen::Vector3f, int>> cubes;
    for (const auto& p : to_point_cloud(depth, taken_with).points) {
      const Eigen::Array3i cube = (p / 2).array().floor().cast<int>();
      auto& [sum, count] = cubes.try_emplace({cube.x(), cube.y(), cube.z()}, Eigen::Vector3f::Zero(), 0).first->second;
      sum += p, ++count;
    }
    PointCloud cloud;
    for (const auto& [cube, points] : cubes) cloud.points.push_back(points.first / static_cast<float>(points.second));
    right += engine->recognize(cloud).result.model_name == "part_0";
  }
  EXPECT_EQ(right, frames);
}

TEST_F(EngineTest, ABallIsNoneOfThem) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0, 0, 480);
  const Recognition r = engine->recognize(render(shapes::sphere(35, 40, 20), pose, camera).depth, camera);
  EXPECT_LT(r.accepted, 0) << r.result.model_name << " scores " << r.candidates[0].score;
}

TEST_F(EngineTest, StatesHowSureItIs) {
  Random random(6);
  const Recognition r = engine->recognize(frame_of(0, shapes::random_pose(random, {0, 0, 480}), random), camera);
  ASSERT_EQ(r.detections.size(), 1u);
  const Detection& found = r.detections[0];
  EXPECT_GT(found.confidence, 0.3);
  EXPECT_LE(found.confidence, found.score + 1e-9);
  double others = 0;
  for (const auto& other : found.alternatives) others += other.probability;
  EXPECT_LE(others, 1);
  EXPECT_GT(found.covariance(5, 5), 0);
  EXPECT_LT(found.covariance(5, 5), 1);  // depth is known best
  EXPECT_TRUE(found.covariance.isApprox(found.covariance.transpose(), 1e-6));
}

TEST(Engine, PartsComeAndGo) {
  const auto named = [](const char* name, TriangleMesh mesh) {
    NamedMesh out;
    out.name = name;
    out.mesh = std::move(mesh);
    return out;
  };
  Engine engine({named("bracket", shapes::l_bracket())});
  const Intrinsics camera{320, 240, 500, 500, 159.5, 119.5};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 1, 0).normalized()).toRotationMatrix();
  pose.translation().z() = 480;
  const DepthImage depth = render(shapes::cylinder(20, 70, 40), pose, camera).depth;
  EXPECT_LT(engine.recognize(depth, camera).accepted, 0);
  engine.add(named("pin", shapes::cylinder(20, 70, 40)));
  EXPECT_EQ(engine.recognize(depth, camera).result.model_name, "pin");
  EXPECT_THROW(engine.add(named("pin", shapes::l_bracket())), Error);
  EXPECT_LT(engine.memory_bytes(1), std::size_t{2} << 20);
  engine.remove("pin");
  EXPECT_LT(engine.recognize(depth, camera).accepted, 0);
  EXPECT_THROW(engine.remove("pin"), Error);
  EXPECT_THROW(engine.remove("bracket"), Error);
}

TEST(Engine, SaysWhatIsWrong) {
  EXPECT_THROW(Engine(catalogue_of({shapes::l_bracket()}), {.min_score = 2}), Error);
  Catalogue without_views = catalogue_of({shapes::l_bracket()});
  without_views.views.clear();
  EXPECT_THROW(Engine(std::move(without_views)), Error);
}

}  // namespace
}  // namespace partpose
