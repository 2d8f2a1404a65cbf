// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/separation.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/random.hpp"
#include "partpose/engine/engine.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace partpose {
namespace {

NamedMesh named(const char* name, TriangleMesh mesh) {
  NamedMesh out;
  out.name = name;
  out.mesh = std::move(mesh);
  return out;
}

class SeparationTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    engine = std::make_unique<Engine>(
        std::vector<NamedMesh>{named("bracket", shapes::l_bracket()), named("pin", shapes::cylinder(15, 70, 40))});
  }
  static void TearDownTestSuite() { engine.reset(); }

  /// A table's frame, z up, seen from 50 degrees above the table.
  static Eigen::Isometry3d camera_from_table() {
    Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, 500));
    pose.linear() = Eigen::AngleAxisd(140 * std::numbers::pi / 180, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return pose;
  }
  static DepthImage measured(const TriangleMesh& scene, Random& random) {
    DepthImage depth = render(scene, camera_from_table(), camera).depth;
    for (float& z : depth.z_mm)
      if (z > 0) z += 0.5f * static_cast<float>(random.normal_pair().first);
    return depth;
  }
  /// How far the surface found lies from where it should.
  static double deviation_mm(const Detection& found, const TriangleMesh& mesh,
                             const Eigen::Isometry3d& table_from_part) {
    double farthest = 0;
    const Eigen::Isometry3d part_from_found =
        (camera_from_table() * table_from_part).inverse() * found.camera_from_model;
    for (const auto& v : mesh.vertices)
      farthest = std::max(farthest, shapes::distance_to_mesh(part_from_found * v.cast<double>(), mesh));
    return farthest;
  }
  static const Detection* found_near(const Recognition& r, int part, const TriangleMesh& mesh,
                                     const Eigen::Isometry3d& table_from_part) {
    for (const auto& detection : r.detections)
      if (detection.part == part && deviation_mm(detection, mesh, table_from_part) < 4) return &detection;
    return nullptr;
  }

  static inline std::unique_ptr<Engine> engine;
  static inline const Intrinsics camera{.width = 480, .height = 360, .fx = 500, .fy = 500, .cx = 239.5, .cy = 179.5};
  const TriangleMesh table = shapes::plane_patch(800, 600);
};

/// The bracket lies on its side: its width of 30 mm is up.
Eigen::Isometry3d bracket_at(const TriangleMesh& bracket, double x, double y, double turn_deg) {
  const Eigen::AlignedBox3d box = bounding_box(bracket);
  Eigen::Isometry3d pose(Eigen::Translation3d(x, y, 0));
  pose.linear() = Eigen::AngleAxisd(turn_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose * Eigen::Translation3d(0, 0, -box.min().z()) * Eigen::Isometry3d::Identity();
}

TEST_F(SeparationTest, FindsEachOfThreePartsThatTouch) {
  Random random(5);
  const TriangleMesh bracket = shapes::l_bracket(), pin = shapes::cylinder(15, 70, 40);
  const Eigen::Isometry3d first = bracket_at(bracket, -60, 0, 0);
  const double length_mm = bounding_box(bracket).sizes().x();
  const Eigen::Isometry3d second = bracket_at(bracket, -60 + length_mm + 0.3, 12, 0);
  Eigen::Isometry3d third = Eigen::Isometry3d::Identity();  // the pin lies before both
  third.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::AlignedBox3d pin_box = bounding_box(shapes::moved(pin, third));
  third.pretranslate(
      Eigen::Vector3d(-20, (first * bounding_box(bracket).min()).y() - pin_box.max().y() - 0.3, -pin_box.min().z()));
  TriangleMesh scene = table;
  scene = shapes::joined(scene, shapes::moved(bracket, first));
  scene = shapes::joined(scene, shapes::moved(bracket, second));
  scene = shapes::joined(scene, shapes::moved(pin, third));
  const Recognition r = engine->recognize(measured(scene, random), camera);
  EXPECT_NE(found_near(r, 0, bracket, first), nullptr);
  EXPECT_NE(found_near(r, 0, bracket, second), nullptr);
  EXPECT_NE(found_near(r, 1, pin, third), nullptr);
  EXPECT_EQ(r.detections.size(), 3u);
}

TEST_F(SeparationTest, FindsFlatPartsSideBySide) {
  Random random(8);
  const TriangleMesh bracket = shapes::l_bracket();
  const double length_mm = bounding_box(bracket).sizes().x();
  TriangleMesh scene = table;
  std::vector<Eigen::Isometry3d> poses;
  for (int k = -1; k <= 1; ++k) {
    poses.push_back(bracket_at(bracket, k * (length_mm + 0.3), 12 * k, 0));
    scene = shapes::joined(scene, shapes::moved(bracket, poses.back()));
  }
  const Recognition r = engine->recognize(measured(scene, random), camera);
  for (const auto& pose : poses) EXPECT_NE(found_near(r, 0, bracket, pose), nullptr) << pose.translation().transpose();
  EXPECT_EQ(r.detections.size(), poses.size());
}

/// What is sure by one piece of it is what lies in the way of a neighbour in another.
/// The block explains most of what is seen of both.
TEST_F(SeparationTest, FindsASmallPartInThePieceOfALargeOne) {
  Random random(8);
  const TriangleMesh block = shapes::box({-60, -40, 0}, {60, 40, 50}), small = shapes::box({0, 0, 0}, {40, 24, 18});
  const Engine both({named("block", block), named("small", small)});
  const Eigen::Isometry3d beside(Eigen::Translation3d(-10, -64.2, 0));
  TriangleMesh scene = shapes::joined(table, block);
  scene = shapes::joined(scene, shapes::moved(small, beside));
  const Recognition r = both.recognize(measured(scene, random), camera);
  EXPECT_TRUE(found_near(r, 0, block, Eigen::Isometry3d::Identity()));
  EXPECT_TRUE(found_near(r, 1, small, beside));
  EXPECT_EQ(r.detections.size(), 2);
}

TEST_F(SeparationTest, AKnownPartTakesItsPixelsOfOtherPieces) {
  Random random(4);
  const TriangleMesh bracket = shapes::l_bracket(), pin = shapes::cylinder(15, 70, 40);
  const Eigen::Isometry3d first = bracket_at(bracket, -60, 0, 0);
  const auto beside = static_cast<float>((first * bounding_box(bracket).max()).x());
  Eigen::Isometry3d second = Eigen::Isometry3d::Identity();
  second.translation() = Eigen::Vector3d(beside + 15.3, 0, -bounding_box(pin).min().z());
  const TriangleMesh scene =
      shapes::joined(shapes::joined(table, shapes::moved(bracket, first)), shapes::moved(pin, second));
  const DepthImage depth = measured(scene, random);
  FramePieces frame = split_frame(depth, camera, {.largest_part_mm = 90, .smallest_part_mm = 60});
  const PartModel bracket_model(bracket), pin_model(pin);
  const std::array<const PartModel*, 2> models = {&bracket_model, &pin_model};
  // Half of the bracket is a piece of its own.
  constexpr std::uint8_t own = 60, others = 61;
  const Eigen::Isometry3d bracket_pose = camera_from_table() * first;
  const int middle_u = static_cast<int>(camera.project(bracket_pose * bracket_model.middle_mm).x());
  for (int p = 0; p < static_cast<int>(frame.label.size()); ++p)
    if (frame.label[p] > FramePieces::background) frame.label[p] = p % camera.width < middle_u ? own : others;
  std::bitset<256> of_bracket, unexplained;
  of_bracket.set(own), unexplained.set(others);
  Hypothesis known;
  known.part = 0;
  known.camera_from_model = bracket_pose;
  const std::vector<KnownPart> sure = {{known, of_bracket}};
  const auto parts = separate(models, frame, unexplained, sure);
  ASSERT_EQ(parts.size(), 2u);
  const auto is_pin = [](const SeparatedPart& part) { return part.hypotheses[0].part == 1; };
  EXPECT_EQ(std::count_if(parts.begin(), parts.end(), is_pin), 1);
  for (const auto& part : parts)
    if (!is_pin(part)) {
      int left = 0;  // of its pixels: all have its own label now
      for (const std::uint8_t label : frame.label) left += label == own;
      EXPECT_LT(left, 0.1 * part.object.pixels);
    }
}

TEST_F(SeparationTest, FindsAPartBeneathSomethingUnknownThatTouchesIt) {
  Random random(11);
  const TriangleMesh bracket = shapes::l_bracket();
  const Eigen::Isometry3d first = bracket_at(bracket, -60, 0, 0);
  const Eigen::Isometry3d second = bracket_at(bracket, -60 + bounding_box(bracket).sizes().x() + 0.3, 12, 0);
  const Eigen::Vector3d low = first * bounding_box(bracket).min();
  const auto x = static_cast<float>(low.x()), y = static_cast<float>(low.y());
  const auto top = static_cast<float>((first * bounding_box(bracket).max()).z());
  TriangleMesh scene = shapes::joined(table, shapes::moved(bracket, first));
  scene = shapes::joined(scene, shapes::moved(bracket, second));
  // A bar lies across the end of one of them.
  scene = shapes::joined(scene, shapes::box({x - 8, y - 10, top}, {x + 8, y + 50, top + 14}));
  const Recognition r = engine->recognize(measured(scene, random), camera);
  EXPECT_NE(found_near(r, 0, bracket, first), nullptr);
  EXPECT_NE(found_near(r, 0, bracket, second), nullptr);
}

TEST_F(SeparationTest, OfAPartWithSomethingBesideItTakesItsOwnPixels) {
  Random random(13);
  const TriangleMesh bracket = shapes::l_bracket();
  const Eigen::Isometry3d pose = bracket_at(bracket, 0, 0, 20);
  // A ball lies at the end of the bracket's longer leg.
  const Eigen::AlignedBox3d box = bounding_box(bracket);
  Eigen::Vector3d middle = pose * Eigen::Vector3d(box.max().x() + 13, box.min().y() + 6, 0);
  middle.z() = 14;
  const TriangleMesh ball = shapes::moved(shapes::sphere(14, 40, 20), Eigen::Isometry3d(Eigen::Translation3d(middle)));
  const TriangleMesh scene = shapes::joined(shapes::joined(table, shapes::moved(bracket, pose)), ball);
  const DepthImage depth = measured(scene, random);
  const PartModel model(bracket);
  const PartModel* const models[] = {&model};
  FramePiecesOptions options;
  options.largest_part_mm = options.smallest_part_mm = static_cast<float>(model.diameter_mm);
  const auto taken = [&](const Eigen::Vector3d& off_mm) {
    FramePieces frame = split_frame(depth, camera, options);
    Hypothesis known;
    known.part = 0;
    known.camera_from_model = Eigen::Translation3d(off_mm) * camera_from_table() * pose;
    std::bitset<256> labels;
    for (const auto& object : frame.objects) labels |= object.labels;
    const int pixels = static_cast<int>(
        std::count_if(frame.label.begin(), frame.label.end(), [&](std::uint8_t label) { return labels.test(label); }));
    const auto parts = separate_known(models, frame, labels, {&known, 1});
    return parts.empty() ? 0.0 : static_cast<double>(parts[0].object.pixels) / pixels;
  };
  const auto visible = [&](const TriangleMesh& mesh) {
    const DepthImage alone = render(mesh, camera_from_table(), camera).depth;
    return static_cast<double>(std::count_if(alone.z_mm.begin(), alone.z_mm.end(), [](float z) { return z > 0; }));
  };
  const double own = visible(shapes::moved(bracket, pose));
  const double share = own / (own + visible(ball));
  ASSERT_LT(share, 0.92);
  EXPECT_NEAR(taken({0.3, 0, 0}), share, 0.05);
  EXPECT_EQ(taken({40, 0, 0}), 0);
}

TEST_F(SeparationTest, FindsAPartOfWhichAPlateHidesMuch) {
  Random random(7);
  const TriangleMesh bracket = shapes::l_bracket();
  int found = 0;
  constexpr int turns = 6;
  for (int k = 0; k < turns; ++k) {
    const Eigen::Isometry3d pose = bracket_at(bracket, 0, 0, 60 * k + 10);
    // A plate held over the right third of it.
    const Eigen::Vector3d middle = pose * bounding_box(bracket).center();
    const auto x = static_cast<float>(middle.x() + 8), y = static_cast<float>(middle.y());
    TriangleMesh scene = shapes::joined(table, shapes::moved(bracket, pose));
    scene = shapes::joined(scene, shapes::box({x, y - 120, 120}, {x + 120, y + 40, 123}));
    const Recognition r = engine->recognize(measured(scene, random), camera);
    found += found_near(r, 0, bracket, pose) != nullptr;
  }
  EXPECT_GE(found, turns - 1);
}

/// A disc of 60 mm whose upper edge is chamfered by 4 mm.
TriangleMesh chamfered_disc() {
  constexpr int sides = 48;
  const std::vector<std::pair<double, double>> profile = {{0, 0}, {30, 0}, {30, 10}, {26, 14}, {0, 14}};  // radius, z
  TriangleMesh mesh;
  for (const auto& [radius, z] : profile)
    for (int k = 0; k < sides; ++k) {
      const double turn = 2 * std::numbers::pi * k / sides;
      mesh.vertices.emplace_back(Eigen::Vector3d(radius * std::cos(turn), radius * std::sin(turn), z).cast<float>());
    }
  for (int ring = 0; ring + 1 < static_cast<int>(profile.size()); ++ring)
    for (int k = 0; k < sides; ++k) {
      const int next = (k + 1) % sides;
      shapes::add_quad(mesh, ring * sides + k, ring * sides + next, (ring + 1) * sides + next, (ring + 1) * sides + k);
    }
  return mesh;
}

TEST_F(SeparationTest, AChamferedDiscIsNoPlaceOnALargerPlate) {
  const Engine discs({named("disc", chamfered_disc()), named("bracket", shapes::l_bracket())});
  Random random(3);
  const TriangleMesh bracket = shapes::l_bracket();
  for (const float length_mm : {70.0f, 90.0f, 110.0f}) {
    const Eigen::Isometry3d pose = bracket_at(bracket, 0, 0, 0);
    const auto beside = static_cast<float>((pose * bounding_box(bracket).max()).x() + 0.3);
    const auto low = static_cast<float>((pose * bounding_box(bracket).min()).y());
    TriangleMesh scene = shapes::joined(table, shapes::moved(bracket, pose));
    scene = shapes::joined(scene, shapes::box({beside, low, 0}, {beside + 66, low + length_mm, 14}));
    const Recognition r = discs.recognize(measured(scene, random), camera);
    for (const auto& detection : r.detections) EXPECT_NE(detection.part, 0) << length_mm;
  }
}

}  // namespace
}  // namespace partpose
