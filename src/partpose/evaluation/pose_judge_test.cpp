// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/pose_judge.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using shapes::error_of;
using shapes::mentions;

constexpr double distance_mm = 650;
const Intrinsics vga{640, 480, 615, 615, 319.5, 239.5};

Catalogue catalogue_of(const std::vector<std::pair<std::string, TriangleMesh>>& parts) {
  Catalogue catalogue;
  for (const auto& [name, mesh] : parts) {
    CataloguePart part;
    part.id = static_cast<int>(catalogue.parts.size());
    part.name = name;
    part.mesh = mesh;
    catalogue.parts.push_back(part);
  }
  return catalogue;
}

/// Before the camera, its axes those of the camera.
Eigen::Isometry3d straight_ahead() { return Eigen::Isometry3d(Eigen::Translation3d(0, 0, distance_mm)); }

/// The model's origin before the camera, looked at from a direction of the model frame.
Eigen::Isometry3d seen_from(const Eigen::Vector3d& direction) {
  Eigen::Isometry3d pose = straight_ahead();
  pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(direction.normalized(), -Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

Eigen::Isometry3d turn(double angle_deg, const Eigen::Vector3d& axis) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(radians(angle_deg), axis));
}

Result result_of(const std::string& name, const Eigen::Isometry3d& pose) {
  Result result;
  result.model_name = name;
  result.candidate_id = name.empty() ? -1 : 0;
  result.T_final = pose;
  return result;
}

/// Judged without a measured depth.
Evaluation judged(const PoseJudge& judge, const std::string& named, const Eigen::Isometry3d& estimate,
                  const std::string& shown, const Eigen::Isometry3d& truth, const Intrinsics& camera = vga) {
  return judge.judge(result_of(named, estimate), {shown, truth, 0, 0}, {camera, {}, {}});
}

/// A shaft along z with a key that stands out by 4 mm about the +x direction. Its farthest corner is 24.33 mm from z.
TriangleMesh keyed_shaft() {
  return shapes::joined(shapes::cylinder(20, 120, 144), shapes::box({18, -4, 10}, {24, 4, 40}));
}
const double key_radius_mm = std::hypot(24.0, 4.0);

TEST(PoseJudge, ATruePoseHasNoError) {
  const PoseJudge judge(catalogue_of({{"bracket", shapes::l_bracket()}}));
  const auto pose = seen_from({0.5, 0.4, 1});
  const Evaluation e = judged(judge, "bracket", pose, "bracket", pose);
  EXPECT_TRUE(e.recognized_correctly);
  EXPECT_NEAR(e.diameter_mm.value(), std::sqrt(80.0 * 80 + 50 * 50 + 30 * 30), 1e-3);
  EXPECT_NEAR(judge.diameter_mm("bracket"), std::sqrt(80.0 * 80 + 50 * 50 + 30 * 30), 1e-3);
  EXPECT_NEAR(e.add_mm.value(), 0, 1e-4);
  EXPECT_NEAR(e.adi_mm.value(), 0, 1e-4);
  EXPECT_NEAR(e.mssd_mm.value(), 0, 1e-4);
  EXPECT_NEAR(e.mspd_px.value(), 0, 1e-4);
  EXPECT_EQ(e.vsd.value(), 0);
  EXPECT_TRUE(e.indistinguishable.value());
}

TEST(PoseJudge, ABoxTurnedByHalf) {
  const PoseJudge judge(catalogue_of({{"block", shapes::box({80, 60, 40})}}));
  const auto pose = seen_from({0.5, 0.4, 1});
  const Evaluation e = judged(judge, "block", pose * turn(180, Eigen::Vector3d::UnitZ()), "block", pose);
  EXPECT_NEAR(e.rotation_error_deg, 180, 0.01);
  EXPECT_NEAR(e.add_mm.value(), 100, 1e-3);  // each corner is 50 mm from the axis
  EXPECT_NEAR(e.adi_mm.value(), 0, 1e-3);
  EXPECT_NEAR(e.mssd_mm.value(), 0, 1e-3);
  EXPECT_NEAR(e.mspd_px.value(), 0, 1e-3);
  EXPECT_LT(e.vsd.value(), 0.01);
  EXPECT_TRUE(e.indistinguishable.value());
  // By a quarter it is no symmetry: the corners (40, 30) and (-30, 40) are 70.7 mm apart, at any equivalent pose.
  const Evaluation quarter = judged(judge, "block", pose * turn(90, Eigen::Vector3d::UnitZ()), "block", pose);
  EXPECT_NEAR(quarter.mssd_mm.value(), 50 * std::numbers::sqrt2, 1e-2);
  EXPECT_FALSE(quarter.indistinguishable.value());
}

TEST(PoseJudge, ACylinderTurnedAboutItsAxis) {
  const PoseJudge judge(catalogue_of({{"pin", shapes::cylinder(20, 90, 144)}}));
  const auto pose = seen_from({1, 0.4, 0.6});
  for (const double angle : {2.5, 60.0, 132.5}) {
    const Evaluation e = judged(judge, "pin", pose * turn(angle, Eigen::Vector3d::UnitZ()), "pin", pose);
    // The 2 * 144 vertices of the rims move, the centres of the ends do not.
    EXPECT_NEAR(e.add_mm.value(), 2 * 20 * std::sin(radians(angle / 2)) * 288 / 290, 1e-3) << angle;
    EXPECT_NEAR(e.adi_mm.value(), 0, 1e-3) << angle;
    EXPECT_LT(e.mssd_mm.value(), 20 * 0.011) << "a turn is 0.01 rad at most from the nearest of the symmetries";
    EXPECT_TRUE(e.indistinguishable.value()) << angle;
  }
  // About a cross axis it turns end for end: a symmetry too. By 90 degrees it is none.
  EXPECT_LT(judged(judge, "pin", pose * turn(180, Eigen::Vector3d::UnitX()), "pin", pose).mssd_mm.value(), 0.3);
  EXPECT_GT(judged(judge, "pin", pose * turn(90, Eigen::Vector3d::UnitX()), "pin", pose).mssd_mm.value(), 20);
}

TEST(PoseJudge, MovedAlongTheLineOfSight) {
  const PoseJudge judge(catalogue_of({{"bracket", shapes::l_bracket()}, {"block", shapes::box({80, 60, 40})}}));
  const auto pose = seen_from({0.5, 0.4, 1});
  for (const double d : {0.5, 7.0, 20.0, -20.0}) {
    const auto moved = Eigen::Translation3d(0, 0, d) * pose;
    const Evaluation e = judged(judge, "bracket", moved, "bracket", pose);
    EXPECT_NEAR(e.translation_error_mm, std::abs(d), 1e-3);
    EXPECT_NEAR(e.rotation_error_deg, 0, 1e-3);
    EXPECT_NEAR(e.add_mm.value(), std::abs(d), 1e-3);
    EXPECT_NEAR(e.mssd_mm.value(), std::abs(d), 1e-3);
    EXPECT_LE(e.adi_mm.value(), std::abs(d) + 1e-3);
    EXPECT_EQ(e.indistinguishable.value(), std::abs(d) < 1) << d;
  }
  // A face straight ahead, 20 mm farther: wrong by the 3 taus below 20 mm (5, 10 and 15 % of 107.7 mm); by the others
  // only where the nearer face reaches beyond the farther one.
  const Evaluation e =
      judged(judge, "block", Eigen::Translation3d(0, 0, 20) * straight_ahead(), "block", straight_ahead());
  EXPECT_NEAR(e.vsd.value(), 0.3 + 0.7 * (1 - std::pow(630.0 / 650.0, 2)), 0.02);
  // Far off, it is wrong everywhere.
  const auto aside = Eigen::Translation3d(200, 0, 0) * straight_ahead();
  EXPECT_EQ(judged(judge, "block", aside, "block", straight_ahead()).vsd.value(), 1);
}

TEST(PoseJudge, PixelsAreThoseOfAnImage640Wide) {
  const PoseJudge judge(catalogue_of({{"bracket", shapes::l_bracket()}}));
  const auto pose = straight_ahead(), moved = Eigen::Translation3d(6, 0, 0) * pose;
  const double expected_px = 615 * 6 / distance_mm;  // of the nearest corners, those at z = 0 of the model
  EXPECT_NEAR(judged(judge, "bracket", moved, "bracket", pose).mspd_px.value(), expected_px, 1e-3);
  const Intrinsics half{320, 240, 307.5, 307.5, 159.5, 119.5};
  EXPECT_NEAR(judged(judge, "bracket", moved, "bracket", pose, half).mspd_px.value(), expected_px, 1e-3);
}

TEST(PoseJudge, VsdLooksAtWhatWasMeasured) {
  const TriangleMesh mesh = shapes::box({80, 60, 40});
  const PoseJudge judge(catalogue_of({{"block", mesh}}));
  const auto pose = straight_ahead();
  const auto vsd = [&](const Eigen::Isometry3d& estimate, const DepthImage& measured) {
    return judge.judge(result_of("block", estimate), {"block", pose, 0, 0}, {vga, measured, {}}).vsd.value();
  };
  const DepthImage own = render(mesh, pose, vga).depth;
  EXPECT_EQ(vsd(pose, own), 0);
  const auto aside = Eigen::Translation3d(40, 0, 0) * pose;  // half of it beside the truth
  EXPECT_NEAR(vsd(aside, own), 2.0 / 3, 0.02);
  // A screen before it all: nothing of the part is visible.
  DepthImage screen(vga.width, vga.height);
  std::fill(screen.z_mm.begin(), screen.z_mm.end(), 300.0f);
  EXPECT_EQ(vsd(pose, screen), 1);
}

TEST(PoseJudge, AHiddenKeyIsNoError) {
  const PoseJudge judge(catalogue_of({{"shaft", keyed_shaft()}}));
  const auto from_behind = seen_from({-1, 0.1, 0.2}), from_the_front = seen_from({1, 0.1, 0.2});
  for (const double angle : {35.0, -40.0}) {
    const auto turned = turn(angle, Eigen::Vector3d::UnitZ());
    const double displacement_mm = 2 * key_radius_mm * std::sin(radians(std::abs(angle) / 2));
    const Evaluation hidden = judged(judge, "shaft", from_behind * turned, "shaft", from_behind);
    EXPECT_NEAR(hidden.mssd_mm.value(), displacement_mm, 0.01) << "the shaft has no symmetry";
    EXPECT_FALSE(mssd_below(hidden, 0.10));
    EXPECT_TRUE(hidden.indistinguishable.value());
    const Evaluation visible = judged(judge, "shaft", from_the_front * turned, "shaft", from_the_front);
    EXPECT_NEAR(visible.mssd_mm.value(), displacement_mm, 0.01);
    EXPECT_FALSE(visible.indistinguishable.value());
  }
}

TEST(PoseJudge, AnotherPartHasNoPose) {
  const PoseJudge judge(catalogue_of({{"shaft", keyed_shaft()}, {"plain", shapes::cylinder(20, 120, 144)}}));
  const auto from_behind = seen_from({-1, 0.1, 0.2}), from_the_front = seen_from({1, 0.1, 0.2});
  for (const auto& pose : {from_behind, from_the_front}) {
    const Evaluation e = judged(judge, "plain", pose, "shaft", pose);
    EXPECT_FALSE(e.recognized_correctly);
    EXPECT_NEAR(e.diameter_mm.value(), judge.diameter_mm("shaft"), 1e-3);
    EXPECT_EQ(e.rotation_error_deg, -1);
    EXPECT_EQ(e.translation_error_mm, -1);
    EXPECT_FALSE(e.add_mm || e.adi_mm || e.mssd_mm || e.mspd_px || e.vsd);
    EXPECT_FALSE(mssd_below(e, 0.10));
  }
  EXPECT_TRUE(judged(judge, "plain", from_behind, "shaft", from_behind).indistinguishable.value());
  EXPECT_FALSE(judged(judge, "plain", from_the_front, "shaft", from_the_front).indistinguishable.value());
}

TEST(PoseJudge, NothingRecognizedOrNotInTheCatalogue) {
  const PoseJudge judge(catalogue_of({{"block", shapes::box({80, 60, 40})}}));
  const auto pose = straight_ahead();
  const auto no_figures = [](const Evaluation& e) {
    return !e.diameter_mm && !e.add_mm && !e.adi_mm && !e.mssd_mm && !e.mspd_px && !e.vsd && !e.indistinguishable;
  };
  const Evaluation none = judged(judge, "", Eigen::Isometry3d::Identity(), "block", pose);
  EXPECT_FALSE(none.recognized_correctly);
  EXPECT_TRUE(no_figures(none));
  const Evaluation left_out = judged(judge, "block", pose, "bracket", pose);
  EXPECT_FALSE(left_out.recognized_correctly);
  EXPECT_EQ(left_out.ground_truth_model_name, "bracket");
  EXPECT_TRUE(no_figures(left_out));
  const Evaluation rightly = judged(judge, "", Eigen::Isometry3d::Identity(), "", pose);
  EXPECT_TRUE(rightly.recognized_correctly);
  EXPECT_EQ(rightly.rotation_error_deg, -1);
  EXPECT_TRUE(no_figures(rightly));
  EXPECT_PRED2(mentions, error_of([&] { judge.diameter_mm("bracket"); }), "no part \"bracket\"");
  EXPECT_TRUE(no_figures(judged(PoseJudge(Catalogue{}), "block", pose, "block", pose)));
}

TEST(PoseJudge, TheDatasetsSymmetriesComeFirst) {
  Catalogue catalogue = catalogue_of({{"first", shapes::l_bracket()}, {"block", shapes::box({80, 60, 40})}});
  DatasetModel model;
  model.id = 1;
  model.name = "block";
  catalogue.dataset.out.models = {model};
  const auto pose = seen_from({0.5, 0.4, 1}), turned = pose * turn(180, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(judged(PoseJudge(catalogue), "block", turned, "block", pose).mssd_mm.value(), 0, 1e-3)
      << "an older dataset states nothing: they are searched for";
  catalogue.dataset.out.models[0].symmetries.symmetry_tolerance_mm = 0.1;  // searched for, none found
  EXPECT_NEAR(judged(PoseJudge(catalogue), "block", turned, "block", pose).mssd_mm.value(), 100, 1e-3);
}

TEST(MssdBelow, ShareOfTheDiameter) {
  Evaluation e;
  EXPECT_FALSE(mssd_below(e, 0.1));
  e.mssd_mm = 9.9f;
  EXPECT_FALSE(mssd_below(e, 0.1)) << "no diameter";
  e.diameter_mm = 100;
  EXPECT_TRUE(mssd_below(e, 0.1));
  e.mssd_mm = 10;
  EXPECT_FALSE(mssd_below(e, 0.1));
  e.diameter_mm = 0;
  e.mssd_mm = 0;
  EXPECT_FALSE(mssd_below(e, 0.1)) << "a single point";
}

}  // namespace
}  // namespace partpose
