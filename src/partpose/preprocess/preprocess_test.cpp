// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/preprocess/preprocess.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/geometry/normals.hpp"
#include "partpose/geometry/voxel_grid.hpp"
#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

using namespace shapes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Points 2 mm apart on a table 600 mm before the camera, a box standing on it, and a few lone points above.
PointCloud table_scene(Random& random) {
  auto cloud = surface_points(plane_patch(200, 160), 6000, random);
  append(cloud, surface_points(box({-20, -15, -40}, {25, 15, 0}), 3000, random));
  cloud = transformed(cloud, Eigen::Isometry3d(Eigen::Translation3d(10, -5, 600)));
  cloud.normals.clear();
  append(cloud, random_cube(random, 30, 60, {0, 0, 480}));
  return cloud;
}

PreprocessOptions no_steps() {
  PreprocessOptions options;
  options.voxel_grid_flag = false;
  return options;
}

/// The indices of the points for which `keep` holds.
template <typename Keep>
PointCloud those(const PointCloud& cloud, const Keep& keep) {
  std::vector<int> kept;
  for (int i = 0; i < static_cast<int>(cloud.size()); ++i)
    if (keep(i)) kept.push_back(i);
  return select(cloud, kept);
}

TEST(Scaled, MultipliesPointsOnly) {
  PointCloud cloud;
  cloud.points = {{0.1f, -0.2f, 0.65f}};
  cloud.normals = {{0, 0, -1}};
  cloud.curvatures = {0.25f};
  const auto bigger = scaled(cloud, 1000);
  EXPECT_EQ(bigger.points[0], Eigen::Vector3f(0.1f * 1000, -0.2f * 1000, 0.65f * 1000));
  EXPECT_EQ(bigger.normals, cloud.normals);
  EXPECT_EQ(bigger.curvatures, cloud.curvatures);
}

TEST(Cropped, KeepsWhatIsWithinTheLimits) {
  Random random(1);
  auto cloud = random_cube(random, 4000, 100);
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.curvatures.push_back(static_cast<float>(i));
  const auto some = cropped(cloud, {-50, 20, 0, 90, -100, -10});
  const auto expected = those(cloud, [&](int i) {
    const auto& p = cloud.points[i];
    return -50 <= p.x() && p.x() <= 20 && 0 <= p.y() && p.y() <= 90 && -100 <= p.z() && p.z() <= -10;
  });
  EXPECT_GT(expected.size(), 200);
  EXPECT_TRUE(same_bits(some, expected));
}

TEST(Cropped, LimitsThemselvesAreWithin) {
  PointCloud cloud;
  cloud.points = {
      {1, 3, 5}, {2, 4, 6}, {std::nextafter(1.0f, 0.0f), 3, 5}, {2, std::nextafter(4.0f, 5.0f), 6}, {1, 3, nan}};
  EXPECT_EQ(cropped(cloud, {1, 2, 3, 4, 5, 6}).size(), 2);
}

TEST(WithoutRadiusOutliers, CountsOtherPointsByBruteForce) {
  Random random(2);
  auto cloud = random_cube(random, 800, 20, {-15, 5, 600});
  append(cloud, random_cube(random, 200, 5, {-15, 5, 600}));
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.curvatures.push_back(static_cast<float>(i));
  for (const float radius : {2.0f, 4.5f}) {
    std::vector<int> others(cloud.size(), 0);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      for (std::size_t k = 0; k < cloud.size(); ++k)
        others[i] += i != k && (cloud.points[i] - cloud.points[k]).norm() <= radius;
    for (const int least : {0, 1, 2, 5, 1000}) {
      const auto expected = those(cloud, [&](int i) { return others[i] >= least; });
      EXPECT_EQ(without_radius_outliers(cloud, radius, least).curvatures, expected.curvatures);
      if (least == 0) {
        EXPECT_EQ(expected.size(), cloud.size());
      }
    }
  }
}

TEST(WithoutRadiusOutliers, APointIsNotItsOwnNeighbour) {
  PointCloud cloud;
  cloud.points = {{0, 0, 600}, {3, 0, 600}, {50, 0, 600}};
  EXPECT_EQ(without_radius_outliers(cloud, 3, 0).size(), 3);
  EXPECT_EQ(without_radius_outliers(cloud, 3, 1).size(), 2) << "just at the radius is within";
  EXPECT_EQ(without_radius_outliers(cloud, 3, 2).size(), 0);
  cloud.points.assign(4, {1, 2, 600});
  EXPECT_EQ(without_radius_outliers(cloud, 1, 3).size(), 4) << "others at the same place count";
  EXPECT_TRUE(without_radius_outliers(PointCloud{}, 1, 1).empty());
}

void expect_statistical_outliers_by_definition(PointCloud cloud, const std::vector<int>& neighbour_counts) {
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.curvatures.push_back(static_cast<float>(i));
  for (const int neighbours : neighbour_counts) {
    std::vector<double> mean_distance;
    for (const auto& p : cloud.points) {
      std::vector<double> distances;
      for (const auto& other : cloud.points) distances.push_back((p.cast<double>() - other.cast<double>()).norm());
      std::partial_sort(distances.begin(), distances.begin() + neighbours + 1, distances.end());
      double sum = 0;
      for (int k = 1; k <= neighbours; ++k) sum += distances[k];
      mean_distance.push_back(sum / neighbours);
    }
    double mean = 0, variance = 0;
    for (const double d : mean_distance) mean += d / static_cast<double>(cloud.size());
    for (const double d : mean_distance) variance += (d - mean) * (d - mean) / static_cast<double>(cloud.size() - 1);
    for (const float deviations : {-0.5f, 0.0f, 1.0f, 2.5f}) {
      const double limit = mean + deviations * std::sqrt(variance);
      const auto expected = those(cloud, [&](int i) { return mean_distance[i] <= limit; });
      EXPECT_EQ(without_statistical_outliers(cloud, neighbours, deviations).curvatures, expected.curvatures);
    }
  }
}

TEST(WithoutStatisticalOutliers, ByTheirDefinition) {
  Random random(3);
  auto cloud = random_cube(random, 400, 10, {0, 0, 600});
  append(cloud, random_cube(random, 40, 40, {0, 0, 600}));
  expect_statistical_outliers_by_definition(cloud, {1, 8, 50});
  for (int i = 0; i < 100; ++i) expect_statistical_outliers_by_definition(random_cube(random, 6, 10), {1, 3});
}

TEST(WithoutStatisticalOutliers, RemovesAFarPoint) {
  Random random(4);
  auto cloud = random_cube(random, 300, 10, {0, 0, 600});
  const auto clean = cloud;
  cloud.points.insert(cloud.points.begin() + 100, Eigen::Vector3f(0, 0, 900));
  EXPECT_EQ(without_statistical_outliers(cloud, 10, 5).points, clean.points);
}

TEST(WithoutStatisticalOutliers, FewPoints) {
  PointCloud cloud;
  EXPECT_TRUE(without_statistical_outliers(cloud, 50, 1).empty());
  cloud.points = {{0, 0, 600}};
  EXPECT_EQ(without_statistical_outliers(cloud, 50, 1).size(), 1);
  cloud.points.assign(5, {0, 0, 600});
  EXPECT_EQ(without_statistical_outliers(cloud, 50, 1).size(), 5);
}

TEST(Preprocess, WithoutAnyStepOnlyDropsMissingPoints) {
  Random random(5);
  auto scene = random_cube(random, 200, 50, {0, 0, 600});
  scene.width = 20, scene.height = 10;
  for (int i = 0; i < 200; i += 3) scene.points[i].setConstant(nan);
  const auto out = preprocess(scene, no_steps());
  EXPECT_TRUE(same_bits(out.cloud, without_missing(scene)));
  EXPECT_FALSE(out.plane);
}

TEST(Preprocess, EveryChoiceOfStepsRunsThemInTheOrderOfTheKeys) {
  Random random(6);
  const auto scene = scaled(table_scene(random), 0.001f);
  PreprocessOptions options;
  options.xyz_limits = {-0.2f, 0.08f, -0.2f, 0.2f, 0.1f, 0.7f};  // of the unscaled scene
  options.voxel_size = 0.002f;
  options.plane_removal_distance_threshold = 0.004f;
  options.radius_outlier_removal_radius = 0.01f;
  options.radius_outlier_removal_min_points_in_radius = 8;
  options.statistical_outlier_removal_num_of_k_nearest_neighbors = 12;
  auto in_mm = options;
  for (float& limit : in_mm.xyz_limits) limit *= 1000;
  in_mm.voxel_size *= 1000;
  in_mm.plane_removal_distance_threshold *= 1000;
  in_mm.radius_outlier_removal_radius *= 1000;

  std::vector<std::size_t> sizes;
  for (int choice = 0; choice < 64; ++choice) {
    auto chosen = choice & 1 ? in_mm : options;
    chosen.scale_flag = choice & 1;
    chosen.xyz_filter_flag = choice & 2;
    chosen.voxel_grid_flag = choice & 4;
    chosen.plane_removal_flag = choice & 8;
    chosen.radius_outlier_removal_flag = choice & 16;
    chosen.statistical_outlier_removal_flag = choice & 32;
    const auto out = preprocess(scene, chosen);

    auto cloud = without_missing(scene);
    if (chosen.scale_flag) cloud = scaled(cloud, 1000);
    if (chosen.xyz_filter_flag) cloud = cropped(cloud, chosen.xyz_limits);
    if (chosen.voxel_grid_flag) cloud = voxel_grid(cloud, chosen.voxel_size);
    EXPECT_EQ(out.plane.has_value(), chosen.plane_removal_flag);
    if (out.plane) {
      const float threshold = chosen.plane_removal_distance_threshold;
      cloud = those(cloud, [&](int i) { return std::abs(out.plane->signed_distance_mm(cloud.points[i])) > threshold; });
    }
    if (chosen.radius_outlier_removal_flag)
      cloud = without_radius_outliers(cloud, chosen.radius_outlier_removal_radius, 8);
    if (chosen.statistical_outlier_removal_flag) cloud = without_statistical_outliers(cloud, 12, 1);
    EXPECT_TRUE(same_bits(out.cloud, cloud)) << "choice " << choice;
    sizes.push_back(cloud.size());
  }
  // Each step must have had something to do.
  EXPECT_EQ(sizes[0], sizes[1]);
  for (const int step : {2, 4, 8, 16, 32}) EXPECT_LT(sizes[step], sizes[0]) << step;
}

TEST(Preprocess, LeavesTheBoxOfATableScene) {
  Random random(7);
  auto options = no_steps();
  options.voxel_grid_flag = options.plane_removal_flag = options.radius_outlier_removal_flag = true;
  options.voxel_size = 2;
  options.plane_removal_distance_threshold = 5;
  options.radius_outlier_removal_min_points_in_radius = 10;
  const auto out = preprocess(table_scene(random), options);
  ASSERT_TRUE(out.plane);
  EXPECT_LT(angle_deg(out.plane->normal, -Eigen::Vector3d::UnitZ()), 0.5);
  EXPECT_NEAR(out.plane->offset_mm, 600, 1);
  EXPECT_GT(out.cloud.size(), 800);
  const auto upper_box = box({-10, -20, 560}, {35, 10, 596});
  for (const auto& p : out.cloud.points) EXPECT_LT(distance_to_mesh(p.cast<double>(), upper_box), 3);
}

TEST(Preprocess, NothingStaysNothing) {
  PreprocessOptions all;
  all.scale_flag = all.xyz_filter_flag = all.plane_removal_flag = true;
  all.radius_outlier_removal_flag = all.statistical_outlier_removal_flag = true;
  EXPECT_TRUE(preprocess(PointCloud{}, all).cloud.empty());
  PointCloud missing;
  missing.points.assign(100, Eigen::Vector3f::Constant(nan));
  EXPECT_TRUE(preprocess(missing, all).cloud.empty());
  PointCloud far;
  far.points.assign(100, Eigen::Vector3f(0, 0, 50));
  EXPECT_TRUE(preprocess(far, all).cloud.empty()) << "cropped, all steps then see an empty cloud";
}

TEST(Preprocess, ATableAloneBecomesNothing) {
  Random random(8);
  auto options = no_steps();
  options.plane_removal_flag = options.radius_outlier_removal_flag = options.statistical_outlier_removal_flag = true;
  auto cloud = surface_points(plane_patch(300, 300), 4000, random);
  cloud.normals.clear();
  const auto out = preprocess(transformed(cloud, random_pose(random, {0, 0, 600})), options);
  EXPECT_TRUE(out.cloud.empty());
  EXPECT_TRUE(out.plane);
}

TEST(Preprocess, SameBitsForAnyNumberOfThreads) {
  Random random(9);
  const auto scene = table_scene(random);
  PreprocessOptions options;
  options.plane_removal_flag = options.radius_outlier_removal_flag = options.statistical_outlier_removal_flag = true;
  options.radius_outlier_removal_min_points_in_radius = 5;
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return with_normals(preprocess(scene, options).cloud, {});
  };
  const auto one = with_threads(1);
  EXPECT_GT(one.size(), 500);
  EXPECT_TRUE(same_bits(one, with_threads(2)));
}

TEST(PreprocessOptions, CheckNamesTheKey) {
  const auto with = [](auto change) {
    PreprocessOptions options;
    change(options);
    return error_of([&] { options.check(); });
  };
  EXPECT_EQ(with([](auto&) {}), "no error");
  for (const float bad : {0.0f, -1.0f, nan}) {
    EXPECT_PRED2(mentions, with([&](auto& o) { o.scale_factor = bad; }), "scale_factor");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.voxel_size = bad; }), "voxel_size");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.plane_removal_distance_threshold = bad; }),
                 "plane_removal_distance_threshold");
    EXPECT_PRED2(mentions, with([&](auto& o) { o.radius_outlier_removal_radius = bad; }),
                 "radius_outlier_removal_radius");
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto message = with([&](auto& o) { o.xyz_limits[2 * axis] = o.xyz_limits[2 * axis + 1]; });
    EXPECT_PRED2(mentions, message, "xyz_limits");
    EXPECT_PRED2(mentions, message, std::string(" of ") + "xyz"[axis]);
  }
  EXPECT_PRED2(mentions, with([](auto& o) { o.xyz_limits[3] = nan; }), "xyz_limits");
  EXPECT_PRED2(mentions, with([](auto& o) { o.radius_outlier_removal_min_points_in_radius = -1; }),
               "radius_outlier_removal_min_points_in_radius -1");
  EXPECT_PRED2(mentions, with([](auto& o) { o.statistical_outlier_removal_num_of_k_nearest_neighbors = 0; }),
               "statistical_outlier_removal_num_of_k_nearest_neighbors 0");
}

TEST(PreprocessOptions, CheckRefusesAMultiplierThatIsNotANumber) {
  PreprocessOptions options;
  options.statistical_outlier_removal_std_deviation_multiplier = nan;
  EXPECT_PRED2(mentions, error_of([&] { options.check(); }), "statistical_outlier_removal_std_deviation_multiplier");
}

TEST(NormalEstimationOptions, CheckNamesTheKey) {
  const auto with = [](float radius, float angle) {
    const NormalEstimationOptions options = {radius, angle};
    return error_of([&] { options.check(); });
  };
  EXPECT_EQ(with(9, 89), "no error");
  EXPECT_EQ(with(9, 0), "no error");
  EXPECT_EQ(with(9, 180), "no error");
  for (const float bad : {0.0f, -1.0f, nan}) EXPECT_PRED2(mentions, with(bad, 89), "search_radius");
  for (const float bad : {-1.0f, 181.0f, nan})
    EXPECT_PRED2(mentions, with(9, bad), "normal_to_view_angle_deviation_degrees");
}

TEST(WithNormals, DropsGrazingPoints) {
  Random random(10);
  for (const double tilt_deg : {0.0, 30.0, 60.0, 75.0, 85.0}) {
    Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, 600));
    pose.rotate(Eigen::AngleAxisd(radians(tilt_deg), Eigen::Vector3d::UnitX()));
    auto cloud = transformed(surface_points(plane_patch(60, 60), 1500, random), pose);
    cloud.normals.clear();
    for (const float limit_deg : {20.0f, 50.0f, 70.0f, 89.0f}) {
      const auto kept = with_normals(cloud, {.normal_to_view_angle_deviation_degrees = limit_deg});
      EXPECT_EQ(kept.size(), tilt_deg < limit_deg ? cloud.size() : 0) << tilt_deg << " against " << limit_deg;
      for (const auto& normal : kept.normals) EXPECT_NEAR(angle_deg(normal.cast<double>(), {0, 0, -1}), tilt_deg, 0.05);
    }
  }
}

TEST(WithNormals, JudgesByTheOpticalAxisNotByTheRay) {
  // A plate parallel to the image, 27 degrees off the axis.
  Random random(13);
  auto cloud = transformed(surface_points(plane_patch(60, 60), 1500, random),
                           Eigen::Isometry3d(Eigen::Translation3d(300, 0, 600)));
  cloud.normals.clear();
  EXPECT_EQ(with_normals(cloud, {.normal_to_view_angle_deviation_degrees = 10}).size(), 1500);
}

TEST(WithNormals, DropsPointsWithoutANormal) {
  Random random(11);
  auto cloud =
      transformed(surface_points(plane_patch(40, 40), 800, random), Eigen::Isometry3d(Eigen::Translation3d(0, 0, 600)));
  cloud.normals.clear();
  cloud.points.insert(cloud.points.begin() + 5, Eigen::Vector3f(200, 0, 600));
  const auto kept = with_normals(cloud, {});
  EXPECT_EQ(kept.size(), 800);
  EXPECT_TRUE(kept.has_normals());
  EXPECT_TRUE(kept.has_curvatures());
  EXPECT_TRUE(with_normals(PointCloud{}, {}).empty());
}

TEST(WithNormals, AreThoseOfTheEstimation) {
  Random random(12);
  auto cloud = table_scene(random);
  auto direct = cloud;
  estimate_normals(direct, 7);
  EXPECT_TRUE(same_bits(with_normals(cloud, {.search_radius = 7, .normal_to_view_angle_deviation_degrees = 180}),
                        without_missing(direct)));
}

}  // namespace
}  // namespace partpose
