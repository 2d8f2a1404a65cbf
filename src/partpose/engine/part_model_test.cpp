// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/part_model.hpp"

#include "partpose/core/pose.hpp"
#include "partpose/engine/hypothesis.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

Eigen::Isometry3d turned(double angle_deg, const Eigen::Vector3d& axis) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(radians(angle_deg), axis.normalized()));
}

const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
/// As a part is seen somewhere.
const Eigen::Isometry3d pose = Eigen::Translation3d(10, -20, 500) * turned(50, {1, 2, 3});

TEST(PartModelSymmetries, AreThoseOfTheShape) {
  const PartModel box(shapes::box({60, 40, 20}));
  EXPECT_EQ(box.symmetries.size(), 3u);
  EXPECT_TRUE(box.round.empty());
  const PartModel square(shapes::box({40, 40, 20}));
  EXPECT_EQ(square.symmetries.size(), 7u);  // those about the diagonals are found by composition
  const PartModel bracket(shapes::l_bracket());
  EXPECT_TRUE(bracket.symmetries.empty());
  EXPECT_TRUE(bracket.round.empty());
  const PartModel cylinder(shapes::cylinder(40, 20, 64));
  ASSERT_EQ(cylinder.round.size(), 1u);
  EXPECT_GT(std::abs(cylinder.round[0].direction.z()), 0.99);
}

TEST(PartModelSymmetries, MakePosesTheSame) {
  const PartModel square(shapes::box({40, 40, 20}));
  EXPECT_TRUE(square.is_about_the_same(pose, pose));
  EXPECT_TRUE(square.is_about_the_same(pose, pose * turned(90, z)));
  EXPECT_TRUE(square.is_about_the_same(pose, pose * turned(180, x + y)));
  EXPECT_TRUE(square.is_about_the_same(pose, pose * turned(95, z)));
  EXPECT_FALSE(square.is_about_the_same(pose, pose * turned(45, z)));
  EXPECT_FALSE(square.is_about_the_same(pose, pose * turned(90, x)));
  EXPECT_FALSE(square.is_about_the_same(pose, pose * turned(90, z) * Eigen::Translation3d(0, 0, 5)));

  const PartModel cylinder(shapes::cylinder(40, 20, 64));
  EXPECT_TRUE(cylinder.is_about_the_same(pose, pose * turned(37, z)));
  EXPECT_TRUE(cylinder.is_about_the_same(pose, pose * turned(180, x) * turned(37, z)));
  EXPECT_FALSE(cylinder.is_about_the_same(pose, pose * turned(20, x)));

  const PartModel bracket(shapes::l_bracket());
  EXPECT_TRUE(bracket.is_about_the_same(pose, pose * turned(5, y)));
  for (const auto& axis : {x, y, z}) EXPECT_FALSE(bracket.is_about_the_same(pose, pose * turned(180, axis)));
}

TEST(Distinct, KeepsTheBestOfPosesThatAreTheSame) {
  const PartModel square(shapes::box({40, 40, 20})), bracket(shapes::l_bracket());
  const std::vector<const PartModel*> models = {&square, &bracket};
  const auto at = [](int part, double cost, const Eigen::Isometry3d& camera_from_model) {
    Hypothesis h;
    h.part = part;
    h.cost = cost;
    h.camera_from_model = camera_from_model;
    return h;
  };
  const auto kept = distinct({at(0, 1, pose), at(1, 2, pose), at(0, 3, pose * turned(90, z)),
                              at(1, 4, pose * turned(90, z)), at(0, 5, pose * turned(45, z))},
                             models);
  ASSERT_EQ(kept.size(), 4u);
  EXPECT_EQ(kept[0].cost, 1);
  EXPECT_EQ(kept[1].cost, 2);
  EXPECT_EQ(kept[2].cost, 4);
  EXPECT_EQ(kept[3].cost, 5);
}

}  // namespace
}  // namespace partpose
