// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/hypothesis.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/random.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <numbers>

namespace partpose {
namespace {

/// A bracket on a table, among 40 boxes of other sizes in the catalogue.
class ShortlistTest : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 40; ++i)
      models.push_back(std::make_unique<PartModel>(
          shapes::box(Eigen::Vector3f(20 + 2 * static_cast<float>(i), 15 + static_cast<float>(i), 8))));
    models.push_back(std::make_unique<PartModel>(shapes::l_bracket()));
    for (const auto& model : models) all.push_back(model.get());
    const TriangleMesh bracket = shapes::l_bracket();
    const Eigen::Isometry3d onto_table(Eigen::Translation3d(0, 0, -bounding_box(bracket).min().z()));
    const TriangleMesh scene = shapes::joined(shapes::plane_patch(800, 600), shapes::moved(bracket, onto_table));
    Eigen::Isometry3d camera_from_table(Eigen::Translation3d(0, 0, 500));
    camera_from_table.linear() =
        Eigen::AngleAxisd(140 * std::numbers::pi / 180, Eigen::Vector3d::UnitX()).toRotationMatrix();
    depth = render_depth(scene, camera_from_table, camera);
    Random random(3);
    for (float& z : depth.z_mm)
      if (z > 0) z += 0.5f * static_cast<float>(random.normal_pair().first);
    FramePiecesOptions options;
    options.largest_part_mm = 150;
    options.smallest_part_mm = 20;
    pieces = split_frame(depth, camera, options);
    ASSERT_EQ(pieces.objects.size(), 1);
  }
  std::map<int, int> looks_of_parts(const ShortlistOptions& options) const {
    std::map<int, int> count;
    for (const auto& h : shortlist(all, ObjectView(pieces, pieces.objects[0]), options)) ++count[h.part];
    return count;
  }

  const Intrinsics camera{.width = 480, .height = 360, .fx = 500, .fy = 500, .cx = 239.5, .cy = 179.5};
  std::vector<std::unique_ptr<PartModel>> models;
  std::vector<const PartModel*> all;
  DepthImage depth;
  FramePieces pieces;
};

TEST_F(ShortlistTest, HasThePartThatIsSeenFirst) {
  const auto found = shortlist(all, ObjectView(pieces, pieces.objects[0]), {});
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].part, 40);
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LE(found[i - 1].cost, found[i].cost);
}

TEST_F(ShortlistTest, HasEveryPartOnlyWhereAskedFor) {
  EXPECT_LT(looks_of_parts({}).size(), models.size());
  const auto every = looks_of_parts({.every_part = true});
  EXPECT_EQ(every.size(), models.size());
  for (const auto& [part, count] : every) EXPECT_LE(count, 3) << part;
}

/// Lies on its flat side, with a knob at its rim.
TriangleMesh knobbed_disc() {
  return shapes::joined(shapes::cylinder(40, 20, 64), shapes::box({38, -5, -10}, {50, 5, 10}));
}

TEST(BestTurns, AreThoseOfADetailOnARoundPart) {
  const PartModel model(knobbed_disc());
  ASSERT_EQ(model.nearly_round.size(), 1u);
  EXPECT_GT(std::abs(model.nearly_round[0].direction.z()), 0.99);
  EXPECT_LT(model.nearly_round[0].place_mm.head<2>().norm(), 0.5);  // the box's middle lies 5 mm off
  const Intrinsics camera{.width = 480, .height = 360, .fx = 500, .fy = 500, .cx = 239.5, .cy = 179.5};
  Eigen::Isometry3d camera_from_table(Eigen::Translation3d(0, 0, 500));
  camera_from_table.linear() =
      Eigen::AngleAxisd(140 * std::numbers::pi / 180, Eigen::Vector3d::UnitX()).toRotationMatrix();
  Eigen::Isometry3d table_from_part(Eigen::Translation3d(0, 0, 10));
  table_from_part.linear() = Eigen::AngleAxisd(1.9, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const TriangleMesh scene =
      shapes::joined(shapes::plane_patch(800, 600), shapes::moved(knobbed_disc(), table_from_part));
  const DepthImage depth = render_depth(scene, camera_from_table, camera);
  FramePiecesOptions options;
  options.largest_part_mm = static_cast<float>(model.diameter_mm);
  options.smallest_part_mm = static_cast<float>(model.diameter_mm);
  const FramePieces pieces = split_frame(depth, camera, options);
  ASSERT_EQ(pieces.objects.size(), 1u);
  Hypothesis turned;
  turned.part = 0;
  turned.camera_from_model = camera_from_table * Eigen::Translation3d(0, 0, 10);  // the knob points elsewhere
  const auto found = best_turns(turned, model, ObjectView(pieces, pieces.objects[0]), 3);
  ASSERT_FALSE(found.empty());
  EXPECT_LE(found.size(), 3u);
  EXPECT_LT(rotation_error_deg(found[0].camera_from_model, camera_from_table * table_from_part), 6);
  for (const auto& other : found) EXPECT_LE(found[0].cost, other.cost);
}

TEST(BestTurns, NoneOfWhatIsRoundOrFarFromIt) {
  EXPECT_TRUE(PartModel(shapes::cylinder(40, 20, 64)).nearly_round.empty());
  EXPECT_TRUE(PartModel(shapes::l_bracket()).nearly_round.empty());
}

/// A base of sheet metal in the plane z = 0 to 3 with a flange at one edge, and the flange alone.
TriangleMesh flange_of_sheet() { return shapes::box({0, 0, 0}, {3, 40, 45}); }
TriangleMesh bent_sheet() { return shapes::joined(shapes::box({0, 0, 0}, {60, 40, 3}), flange_of_sheet()); }

class AtRest : public ::testing::Test {
 protected:
  AtRest() {
    camera_from_table.linear() =
        Eigen::AngleAxisd(140 * std::numbers::pi / 180, Eigen::Vector3d::UnitX()).toRotationMatrix();
    table_from_part.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  /// What lies on a table, as a camera without noise sees it.
  FramePieces pieces_of(const TriangleMesh& seen, const PartModel& model) {
    depth = render_depth(shapes::joined(shapes::plane_patch(800, 600), shapes::moved(seen, table_from_part)),
                         camera_from_table, camera);
    FramePiecesOptions options;
    options.largest_part_mm = options.smallest_part_mm = static_cast<float>(model.diameter_mm);
    return split_frame(depth, camera, options);
  }

  const Intrinsics camera{.width = 480, .height = 360, .fx = 500, .fy = 500, .cx = 239.5, .cy = 179.5};
  Eigen::Isometry3d camera_from_table{Eigen::Translation3d(0, 0, 500)};
  Eigen::Isometry3d table_from_part{Eigen::Translation3d(-20, 10, 0)};
  DepthImage depth;
};

TEST_F(AtRest, FindsThePartOfWhichOnlyAFlangeStandsOut) {
  const PartModel model(bent_sheet());
  const FramePieces pieces = pieces_of(flange_of_sheet(), model);
  ASSERT_EQ(pieces.objects.size(), 1u);
  const std::vector<const PartModel*> models = {nullptr, &model};
  const auto found = at_rest(models, ObjectView(pieces, pieces.objects[0]));
  ASSERT_FALSE(found.empty());
  EXPECT_LE(found.size(), 16u);
  const Eigen::Isometry3d truth = camera_from_table * table_from_part;
  bool right = false;
  for (const auto& h : found) {
    EXPECT_EQ(h.part, 1);
    EXPECT_TRUE(h.at_rest);
    EXPECT_NEAR(height_above_table_mm(pieces, model, h.camera_from_model).value(), 0, 2);
    right |= rotation_error_deg(h.camera_from_model, truth) < 10 &&
             (h.camera_from_model * model.middle_mm - truth * model.middle_mm).norm() < 12;
  }
  EXPECT_TRUE(right);
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LE(found[i - 1].cost, found[i].cost);
}

TEST_F(AtRest, NothingOfWhatIsLow) {
  const TriangleMesh plate = shapes::box({0, 0, 0}, {60, 40, 6});
  const PartModel model(plate);
  const FramePieces pieces = pieces_of(plate, model);
  ASSERT_EQ(pieces.objects.size(), 1u);
  const std::vector<const PartModel*> models = {&model};
  EXPECT_TRUE(at_rest(models, ObjectView(pieces, pieces.objects[0])).empty());
}

TEST_F(AtRest, PartsThatAreAlikeAreTriedInEachOthersPlace) {
  const TriangleMesh seen = shapes::box({0, 0, 0}, {60, 40, 30});
  const PartModel model(seen), longer(shapes::box({0, 0, 0}, {65, 40, 30})),
      other(shapes::box({0, 0, 0}, {60, 60, 60}));
  const FramePieces pieces = pieces_of(seen, model);
  ASSERT_EQ(pieces.objects.size(), 1u);
  const ObjectView view(pieces, pieces.objects[0]);
  Hypothesis wrong;  // the longer one, where the shorter one lies
  wrong.part = 1;
  wrong.camera_from_model = camera_from_table * table_from_part;
  const std::vector<const PartModel*> models = {&model, &longer, &other};
  EXPECT_TRUE(in_place_of(wrong, models, view, 0.03).empty());
  const auto found = in_place_of(wrong, models, view, 0.08);
  ASSERT_FALSE(found.empty());
  const Eigen::Vector3d middle_mm = wrong.camera_from_model * longer.middle_mm;
  for (const auto& h : found) {
    EXPECT_EQ(h.part, 0);
    EXPECT_LT((h.camera_from_model * model.middle_mm - middle_mm).norm(), 0.01);
    EXPECT_LE(found[0].cost, h.cost);
  }
}

TEST_F(AtRest, DropsWhatSinksIntoTheTable) {
  const TriangleMesh box = shapes::box({0, 0, 0}, {60, 40, 30});
  const PartModel model(box);
  const FramePieces pieces = pieces_of(box, model);
  const std::vector<const PartModel*> models = {&model};
  std::vector<Hypothesis> hypotheses;
  for (const double height_mm : {0.0, -9.0, -20.0, 15.0, -20.0}) {
    Hypothesis h;
    h.part = 0;
    h.cost = height_mm;
    h.camera_from_model = camera_from_table * Eigen::Translation3d(0, 0, height_mm) * table_from_part;
    hypotheses.push_back(h);
  }
  drop_sunk(hypotheses, models, ObjectView(pieces, pieces.objects[0]), 12 / model.diameter_mm);
  ASSERT_EQ(hypotheses.size(), 3u);
  EXPECT_EQ(hypotheses[0].cost, 0);
  EXPECT_EQ(hypotheses[1].cost, -9);
  EXPECT_EQ(hypotheses[2].cost, 15);
}

TEST(PartModel, RestsOnItsFaces) {
  const PartModel model(shapes::box({10, 20, 30}, {90, 80, 70}));  // 80 x 60 x 40
  ASSERT_EQ(model.rests.size(), 6u);
  EXPECT_GT(std::abs(model.rests[0].down.z()), 0.999);  // the largest face is the likeliest
  for (const auto& rest : model.rests) {
    double lowest_mm = 1e9;
    for (const auto& p : model.samples_mm)
      lowest_mm = std::min(lowest_mm, rest.origin_height_mm - rest.down.dot(p.cast<double>()));
    EXPECT_NEAR(lowest_mm, 0, 0.1);
  }
}

TEST(SinksIntoTable, WhatReachesBelowIt) {
  const PartModel model(shapes::l_bracket());
  FramePieces frame;
  frame.camera = {.width = 320, .height = 240, .fx = 500, .fy = 500, .cx = 159.5, .cy = 119.5};
  const auto lowest_at = [&](double z_mm) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = -model.middle_mm;
    pose.translation().z() = z_mm - model.box_mm.max().z();
    return pose;
  };
  EXPECT_FALSE(height_above_table_mm(frame, model, lowest_at(500)));
  EXPECT_FALSE(sinks_into_table(frame, model, lowest_at(500), 0));
  frame.table = FlatSurface{.q = {0, 0, 1 / 500.0f}};
  EXPECT_NEAR(height_above_table_mm(frame, model, lowest_at(470)).value(), 30, 1);
  EXPECT_FALSE(sinks_into_table(frame, model, lowest_at(470), 5));
  EXPECT_FALSE(sinks_into_table(frame, model, lowest_at(500), 5));
  EXPECT_TRUE(sinks_into_table(frame, model, lowest_at(530), 5));
}

}  // namespace
}  // namespace partpose
