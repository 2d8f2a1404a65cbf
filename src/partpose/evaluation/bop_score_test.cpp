// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/bop_score.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/evaluation/pose_error.hpp"
#include "partpose/io/json.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <tuple>

namespace partpose {
namespace {

namespace fs = std::filesystem;

const fs::path golden_folder = fs::path(PARTPOSE_SOURCE_DIR) / "tests/bop_golden";

class TemporaryFolder {
 public:
  TemporaryFolder() : path_(fs::temp_directory_path() / fmt::format("partpose_bop_{}_{}", getpid(), count_++)) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  static inline int count_ = 0;
  fs::path path_;
};

template <typename T>
T get(const Json& json, const char* key) {
  return from_json<T>(json.at(key));
}

/// null is infinity.
double error_of(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

using Match = std::array<int, 4>;

std::vector<Match> sorted_matches(const std::vector<BopMatch>& matches) {
  std::vector<Match> out;
  for (const auto& m : matches) out.push_back({m.scene_id, m.im_id, m.gt_id, m.est_id});
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<Match> sorted_matches(const Json& json) {
  auto out = from_json<std::vector<Match>>(json);
  std::sort(out.begin(), out.end());
  return out;
}

void expect_score(const BopScore& score, const Json& expected) {
  const bool by_tau = expected["recall"][0].is_array();
  EXPECT_NEAR(score.average_recall, get<double>(expected, "average_recall"), 1e-12);
  for (std::size_t i = 0; i < score.recalls.size(); ++i) {
    const auto& recall = score.recalls[i];
    const auto at = [&](const char* key) { return by_tau ? expected[key][i / 10][i % 10] : expected[key][i]; };
    EXPECT_EQ(recall.tp_count, at("tp_count").get<int>());
    EXPECT_NEAR(recall.recall, at("recall").get<double>(), 1e-12);
    if (expected.contains("mean_obj_recall")) {
      EXPECT_NEAR(recall.mean_obj_recall, at("mean_obj_recall").get<double>(), 1e-12);
      EXPECT_NEAR(recall.mean_scene_recall, at("mean_scene_recall").get<double>(), 1e-12);
    }
    if (expected.contains("matches")) {
      EXPECT_EQ(sorted_matches(recall.matches), sorted_matches(at("matches")));
    }
  }
}

BopErrorType type_of(const std::string& name) {
  return name == "mssd" ? BopErrorType::mssd : name == "mspd" ? BopErrorType::mspd : BopErrorType::vsd;
}

std::vector<BopTargetErrors> golden_targets(const Json& set) {
  std::vector<BopTargetErrors> targets;
  for (const auto& item : set["targets"]) {
    const BopTarget t{get<int>(item, "scene_id"), get<int>(item, "im_id"), get<int>(item, "obj_id"),
                      get<int>(item, "inst_count")};
    BopTargetErrors out{t, {}, {}};
    const auto& gts = set["gts"][std::to_string(t.scene_id)][std::to_string(t.im_id)];
    std::vector<int> ids;
    std::vector<double> visibilities;
    for (std::size_t id = 0; id < gts.size(); ++id) {
      if (get<int>(gts[id], "obj_id") != t.obj_id) continue;
      ids.push_back(static_cast<int>(id));
      visibilities.push_back(get<double>(gts[id], "visib_fract"));
    }
    for (const int k : bop_valid_ground_truths(visibilities, t.inst_count)) out.gt_ids.push_back(ids[k]);

    std::vector<BopTargetErrors::Estimate> all;
    std::vector<double> scores;
    for (const auto& e : set["estimates"]) {
      if (std::tuple(get<int>(e, "scene_id"), get<int>(e, "im_id"), get<int>(e, "obj_id")) !=
          std::tuple(t.scene_id, t.im_id, t.obj_id))
        continue;
      auto& estimate = all.emplace_back(BopTargetErrors::Estimate{get<int>(e, "est_id"), get<double>(e, "score"), {}});
      scores.push_back(estimate.score);
      for (const auto& [gt_id, error] : e["errors"].items()) {
        BopErrors& errors = estimate.errors[std::stoi(gt_id)];
        if (error.is_array())
          for (const auto& of_tau : error) errors.vsd.push_back(error_of(of_tau));
        else
          errors.mssd_mm = errors.mspd_px = error_of(error);
      }
    }
    for (const int k : bop_kept_estimates(scores, t.inst_count)) out.estimates.push_back(all[k]);
    targets.push_back(std::move(out));
  }
  return targets;
}

TEST(GoldenScores, AllSetsAreReproduced) {
  const Json golden = read_json_file(golden_folder / "scores.json");
  ASSERT_EQ(golden["sets"].size(), 6);
  std::map<std::string, double> average_recall;
  for (const auto& set : golden["sets"]) {
    const auto name = get<std::string>(set, "name");
    SCOPED_TRACE(name);
    BopScoreBasis basis;
    if (set.contains("diameters"))
      for (const auto& [id, diameter] : set["diameters"].items())
        basis.diameter_mm[std::stoi(id)] = diameter.get<double>();
    else
      for (const int id : get<std::vector<int>>(set, "obj_ids")) basis.diameter_mm[id] = 1;
    if (set.contains("image_width")) basis.image_width = get<int>(set, "image_width");
    basis.obj_ids = get<std::vector<int>>(set, "obj_ids");
    basis.scene_ids = get<std::vector<int>>(set, "scene_ids");
    const auto type = type_of(get<std::string>(set, "error_type"));
    const auto thresholds = get<std::vector<double>>(set, "thresholds");
    EXPECT_TRUE(std::ranges::equal(thresholds, type == BopErrorType::mspd ? bop_pixels() : bop_fractions()));

    const auto targets = golden_targets(set);
    std::size_t kept = 0;
    for (const auto& target : targets) kept += target.estimates.size();
    EXPECT_EQ(kept, get<std::size_t>(set["expected"], "n_estimates_kept"));
    const BopScore score = bop_score(targets, type, basis);
    EXPECT_EQ(score.recalls[0].targets_count, get<int>(set["expected"], "targets_count"));
    expect_score(score, set["expected"]);
    average_recall[name] = score.average_recall;
  }
  const double combined = (average_recall["full_vsd"] + average_recall["full_mssd"] + average_recall["full_mspd"]) / 3;
  EXPECT_NEAR(combined, get<double>(golden["combined"], "average_recall"), 1e-12);
}

void expect_golden_mini_bop(const BopDataset& dataset, const fs::path& results) {
  const Json expected = read_json_file(golden_folder / "mini_bop/expected.json");
  const auto estimates = read_bop_results(results);
  const BopScoreOptions options{.image_width = get<int>(expected, "image_width")};
  const BopScores scores = score_bop(dataset, estimates, options);
  EXPECT_EQ(scores.targets_count, get<int>(expected, "targets_count"));
  EXPECT_EQ(scores.estimates_kept, static_cast<int>(expected["estimates"].size()));
  EXPECT_NEAR(scores.average_time_per_image_s, get<double>(expected, "average_time_per_image_s"), 1e-12);
  EXPECT_FALSE(scores.vsd || scores.average_recall) << "there are no depth images";
  expect_score(scores.mssd, expected["mssd"]);
  expect_score(scores.mspd, expected["mspd"]);

  std::map<std::array<int, 4>, const Json*> expected_of;
  for (const auto& e : expected["estimates"])
    expected_of[{get<int>(e, "scene_id"), get<int>(e, "im_id"), get<int>(e, "obj_id"), get<int>(e, "est_id")}] = &e;
  int compared = 0;
  for (const auto& target : bop_errors(dataset, estimates, options)) {
    const auto& t = target.target;
    for (const auto& estimate : target.estimates) {
      const Json& e = *expected_of.at({t.scene_id, t.im_id, t.obj_id, estimate.est_id});
      EXPECT_EQ(estimate.score, get<double>(e, "score"));
      EXPECT_EQ(estimate.errors.size(), e["mssd_mm"].size());
      for (const auto& [gt_id, errors] : estimate.errors) {
        const double mssd = error_of(e["mssd_mm"][std::to_string(gt_id)]);
        if (std::isinf(mssd))
          EXPECT_EQ(errors.mssd_mm, mssd);
        else
          EXPECT_NEAR(errors.mssd_mm, mssd, 1e-9);
        EXPECT_NEAR(errors.mspd_px, error_of(e["mspd_px"][std::to_string(gt_id)]), 1e-9);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 20);
}

TEST(GoldenMiniBop, IsReadAndScored) {
  expect_golden_mini_bop(read_bop_dataset(golden_folder / "mini_bop"),
                         golden_folder / "mini_bop/golden_minibop-test.csv");
}

TEST(GoldenMiniBop, WrittenAndReadAgainScoresTheSame) {
  const TemporaryFolder folder;
  const BopDataset dataset = read_bop_dataset(golden_folder / "mini_bop");
  for (const auto& [id, info] : dataset.models)
    write_bop_model(folder.path() / "models_eval", id, dataset.read_model(id));
  write_bop_models_info(folder.path() / "models_eval", dataset.models);
  for (auto [id, scene] : dataset.scenes) {
    scene.folder = bop_scene_folder(folder.path(), "test", id);
    write_bop_scene(scene);
  }
  write_bop_targets(folder.path(), dataset.targets);
  const fs::path results = folder.path() / "golden_minibop-test.csv";
  write_bop_results(results, read_bop_results(golden_folder / "mini_bop/golden_minibop-test.csv"));
  expect_golden_mini_bop(read_bop_dataset(folder.path()), results);
}

TEST(GoldenMiniBop, WithoutAKnownImageWidthIsAnError) {
  EXPECT_THROW(score_bop(read_bop_dataset(golden_folder / "mini_bop"), {}), Error);
}

// A dataset of our own: two L-shaped parts before a wall, with depth images.
class OwnDataset : public ::testing::Test {
 protected:
  static constexpr int width = 160, height = 120;

  OwnDataset() {
    const BopDataset golden = read_bop_dataset(golden_folder / "mini_bop");
    mesh = golden.read_model(1);
    write_bop_model(folder.path() / "models", 1, mesh);
    write_bop_models_info(folder.path() / "models", {{1, bop_model_info(mesh)}});
    write_bop_camera(folder.path(), {camera, 0.1});
    BopScene scene{3, bop_scene_folder(folder.path(), "test", 3), true, {}};
    for (const int im_id : {0, 5}) {
      BopImage image{im_id, BopCamera::of(camera, 0.1), {}};
      DepthImage depth(width, height);
      std::fill(depth.z_mm.begin(), depth.z_mm.end(), 900.f);
      for (const double x : {-60.0, 60.0}) {
        Eigen::Isometry3d pose(Eigen::Translation3d(x, 0, 700 + im_id));
        pose.rotate(Eigen::AngleAxisd(0.7 + x, Eigen::Vector3d(1, 2, 3).normalized()));
        image.ground_truths.push_back({1, pose, BopVisibility{}});
        const auto rendered = render(mesh, pose, camera).depth;
        for (std::size_t i = 0; i < depth.z_mm.size(); ++i)
          if (rendered.z_mm[i] > 0) depth.z_mm[i] = std::min(depth.z_mm[i], rendered.z_mm[i]);
      }
      scene.images.push_back(image);
      write_bop_depth(scene.folder, im_id, depth, 0.1);
    }
    write_bop_scene(scene);
    dataset = read_bop_dataset(folder.path());
  }

  std::vector<BopEstimate> truth() const {
    std::vector<BopEstimate> out;
    for (const auto& image : dataset.scene(3).images)
      for (const auto& gt : image.ground_truths)
        out.push_back({3, image.id, 1, 0.5, gt.camera_from_model, 0.2 + image.id});
    return out;
  }

  const Intrinsics camera = Intrinsics::from_field_of_view(width, height, 30, 23);
  TriangleMesh mesh;
  TemporaryFolder folder;
  BopDataset dataset;
};

TEST_F(OwnDataset, TheTruthScoresOne) {
  ASSERT_EQ(dataset.targets.size(), 2);
  EXPECT_EQ(dataset.targets[0].inst_count, 2);
  const BopScores scores = score_bop(dataset, truth());
  EXPECT_EQ(scores.targets_count, 4);
  EXPECT_EQ(scores.mssd.average_recall, 1);
  EXPECT_EQ(scores.mspd.average_recall, 1);
  ASSERT_TRUE(scores.vsd);
  EXPECT_EQ(scores.vsd->average_recall, 1);
  EXPECT_NEAR(*scores.average_recall, 1, 1e-15);
  EXPECT_NEAR(scores.average_time_per_image_s, 2.7, 1e-12);
  EXPECT_FALSE(score_bop(dataset, truth(), {.vsd = false}).vsd);
}

TEST_F(OwnDataset, AnOffsetLosesTheThresholdsThatItExceeds) {
  auto estimates = truth();
  const double diameter_mm = dataset.models.at(1).diameter_mm;
  for (auto& e : estimates) e.camera_from_model.pretranslate(Eigen::Vector3d(0, 0.12 * diameter_mm, 0));
  const BopScores scores = score_bop(dataset, estimates);
  EXPECT_NEAR(scores.mssd.average_recall, 0.8, 1e-12);  // 0.12 is below eight of the ten thresholds
  EXPECT_LT(scores.vsd->average_recall, 1);
  estimates[0].camera_from_model.pretranslate(Eigen::Vector3d(0, diameter_mm, 0));  // its sphere overlaps no more
  EXPECT_NEAR(score_bop(dataset, estimates).mssd.average_recall, 0.6, 1e-12);
}

TEST_F(OwnDataset, NothingFoundScoresZero) {
  const BopScores scores = score_bop(dataset, {});
  EXPECT_EQ(scores.average_recall, 0);
  EXPECT_EQ(scores.targets_count, 4);
  EXPECT_EQ(scores.average_time_per_image_s, -1);
}

TEST_F(OwnDataset, EstimatesOfOtherImagesAndBeyondTheCountAreLeftOut) {
  auto estimates = truth();
  for (auto& e : estimates) e.camera_from_model.pretranslate(Eigen::Vector3d(300, 0, 0));
  const auto wrong = estimates;
  for (auto& e : estimates) e.score = 0.4;
  for (const auto& e : truth()) estimates.push_back(e);  // better scores, kept instead
  estimates.push_back({9, 9, 1, 1.0, Eigen::Isometry3d::Identity(), 0.1});
  EXPECT_EQ(score_bop(dataset, estimates).mssd.average_recall, 1);
  EXPECT_EQ(score_bop(dataset, estimates).estimates_kept, 4);
  EXPECT_EQ(score_bop(dataset, wrong).mssd.average_recall, 0);
}

TEST_F(OwnDataset, AMissingDepthImageIsAnError) {
  fs::remove(dataset.scene(3).depth_path(dataset.scene(3).image(5)));
  EXPECT_THROW(score_bop(dataset, truth()), Error);
  EXPECT_EQ(score_bop(dataset, truth(), {.vsd = false}).mssd.average_recall, 1);
}

TEST_F(OwnDataset, WithoutGroundTruthScoringIsAnError) {
  const auto estimates = truth();
  write_bop_targets(folder.path(), dataset.targets);
  fs::remove(dataset.scene(3).folder / "scene_gt.json");
  EXPECT_THROW(score_bop(read_bop_dataset(folder.path()), estimates), Error);
}

TEST_F(OwnDataset, AnyNumberOfThreadsGivesTheSameBits) {
  auto estimates = truth();
  for (auto& e : estimates) e.camera_from_model.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
  const auto errors = [&] {
    std::vector<double> out;
    for (const auto& target : bop_errors(dataset, estimates))
      for (const auto& estimate : target.estimates)
        for (const auto& [gt_id, e] : estimate.errors) {
          out.insert(out.end(), {e.mssd_mm, e.mspd_px});
          out.insert(out.end(), e.vsd.begin(), e.vsd.end());
        }
    return out;
  };
  const auto many = errors();
  const ThreadLimit limit(1);
  EXPECT_EQ(errors(), many);
}

TEST(Matching, IsGreedyByScoreAndTakesTheNearestFree) {
  const std::vector<std::vector<double>> errors = {{3, 2}, {1, 1}, {0, 0}};
  EXPECT_EQ(bop_matching(errors, 2.5), (std::vector<int>{1, 0, -1}));
  EXPECT_EQ(bop_matching(errors, 2), (std::vector<int>{-1, 0, 1}));  // strictly below
}

TEST(Matching, OfEqualsTakesTheFirst) {
  EXPECT_EQ(bop_kept_estimates(std::vector{0.5, 0.7, 0.5, 0.7}, 3), (std::vector<int>{1, 3, 0}));
  EXPECT_EQ(bop_valid_ground_truths(std::vector{0.5, 0.5, 0.9}, 2), (std::vector<int>{0, 2}));
  EXPECT_EQ(bop_kept_estimates({}, 3), std::vector<int>{});
}

TEST(AverageTime, IsThatOfImagesAndUnknownWithOneUnknown) {
  std::vector<BopEstimate> e(3);
  e[0].time_s = e[1].time_s = 1;
  e[2].im_id = 1;
  e[2].time_s = 4;
  EXPECT_EQ(bop_average_time_s(e), 2.5);
  e[1].time_s = -1;
  EXPECT_EQ(bop_average_time_s(e), -1);
}

}  // namespace
}  // namespace partpose
