// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/smooth_clusters.hpp"

#include "partpose/descriptor/testing.hpp"

#include <set>

namespace partpose {
namespace {

using namespace testing_clusters;

const SmoothClusterLimits small = {.min_points = 100, .cluster_tolerance_distance = 4, .radius_normals = 5};

TEST(SmoothClusters, AreTheFacesOfABox) {
  const auto smooth = smooth_clusters(sorted_by_position(box_view()), small);
  ASSERT_EQ(smooth.clusters.size(), 3);
  const auto pose = corner_pose();
  // The largest first: the faces of 60 x 40, 60 x 25 and 40 x 25 mm.
  const Eigen::Vector3d normals[] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  const Eigen::Vector3d half_size(30, 20, 12.5);
  for (int i = 0; i < 3; ++i) {
    const auto& cluster = smooth.clusters[i];
    EXPECT_LT(angle_deg(cluster.normal.cast<double>(), pose.linear() * normals[i]), 1.5);
    EXPECT_NEAR(cluster.normal.norm(), 1, 1e-6);
    // Points near the edges between faces are left out for their curvature: the centre moves outwards.
    EXPECT_LT((cluster.centre_mm.cast<double>() - pose * normals[i].cwiseProduct(half_size)).norm(), 3);
    EXPECT_GE(smooth.clusters[0].members.size(), cluster.members.size());
  }
}

/// The same by trying all pairs.
std::set<std::vector<int>> connected_components(const PointCloud& points, const SmoothClusterLimits& limits) {
  const int n = static_cast<int>(points.size());
  const double cosine = std::cos(radians(limits.eps_angle_threshold_deg));
  std::vector<int> root(n);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i];
    return i;
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j)
      if ((points.points[i] - points.points[j]).norm() <= limits.cluster_tolerance_distance &&
          points.normals[i].dot(points.normals[j]) > cosine)
        root[find(i)] = find(j);
  std::vector<std::vector<int>> by_root(n);
  for (int i = 0; i < n; ++i)
    if (points.normals[i].allFinite()) by_root[find(i)].push_back(i);
  std::set<std::vector<int>> large;
  for (const auto& members : by_root)
    if (!members.empty() && members.size() >= limits.min_points) large.insert(members);
  return large;
}

TEST(SmoothClusters, AreConnectedComponents) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto cloud = every_nth(bracket_view(seed), 3);
    for (const SmoothClusterLimits& limits :
         {SmoothClusterLimits{
              .min_points = 5, .cluster_tolerance_distance = 3, .eps_angle_threshold_deg = 6, .radius_normals = 6},
          SmoothClusterLimits{
              .min_points = 1, .cluster_tolerance_distance = 6, .eps_angle_threshold_deg = 20, .radius_normals = 4}}) {
      const auto smooth = smooth_clusters(cloud, limits);
      std::set<std::vector<int>> ours;
      for (const auto& c : smooth.clusters) ours.insert(c.members);
      EXPECT_EQ(ours, connected_components(smooth.points, limits));
      EXPECT_GT(ours.size(), 1);
    }
  }
}

TEST(SmoothClusters, LeaveHighCurvatureOut) {
  auto cloud = box_view();
  const auto all = smooth_clusters(cloud, {.min_points = 1, .curvature_threshold = 1});
  EXPECT_EQ(all.points.size(), cloud.size());
  const auto some = smooth_clusters(cloud, {.min_points = 1, .curvature_threshold = 0.01f});
  EXPECT_EQ(some.points.size(),
            std::count_if(cloud.curvatures.begin(), cloud.curvatures.end(), [](float c) { return c <= 0.01f; }));
  EXPECT_LT(some.points.size(), all.points.size());
  cloud.curvatures.clear();
  EXPECT_EQ(smooth_clusters(cloud, {.min_points = 1, .curvature_threshold = 0}).points.size(), cloud.size());
}

TEST(SmoothClusters, HaveTheirFewestPoints) {
  const auto cloud = sorted_by_position(box_view());
  auto limits = small;
  const auto three = smooth_clusters(cloud, limits).clusters;
  ASSERT_EQ(three.size(), 3);
  limits.min_points = static_cast<int>(three[1].members.size());
  EXPECT_EQ(smooth_clusters(cloud, limits).clusters.size(), 2);
  ++limits.min_points;
  EXPECT_EQ(smooth_clusters(cloud, limits).clusters.size(), 1);
  limits.min_points = static_cast<int>(cloud.size()) + 1;
  EXPECT_TRUE(smooth_clusters(cloud, limits).clusters.empty());
}

TEST(SmoothClusters, OfEquallyLargeOnesTheNearestComesFirst) {
  PointCloud cloud;
  for (const float z : {700.f, 600.f, 650.f})
    for (int i = 0; i < 100; ++i) cloud.points.emplace_back(static_cast<float>(i % 10), static_cast<float>(i / 10), z);
  cloud.normals.assign(cloud.size(), {0, 0, -1});
  const auto clusters =
      smooth_clusters(sorted_by_position(cloud), {.min_points = 50, .cluster_tolerance_distance = 2}).clusters;
  ASSERT_EQ(clusters.size(), 3);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(clusters[i].centre_mm, Eigen::Vector3f(4.5f, 4.5f, 600 + 50 * static_cast<float>(i)));
}

TEST(SmoothClusters, SortedCloudsAreTheSameWhateverTheirOrderWas) {
  auto cloud = bracket_view(4);
  append(cloud, select(cloud, std::vector<int>{5, 6, 7}));  // some points twice
  cloud.points.push_back({NAN, 0, 600});
  cloud.normals.push_back({0, 0, -1});
  cloud.curvatures.push_back(0);
  const auto sorted = sorted_by_position(cloud);
  EXPECT_EQ(sorted.size(), cloud.size() - 1);
  for (const std::uint64_t seed : {1, 2}) EXPECT_TRUE(same_bits(sorted_by_position(shuffled(cloud, seed)), sorted));
}

TEST(SmoothClusters, NeedNormals) {
  PointCloud cloud;
  EXPECT_TRUE(sorted_by_position(cloud).empty());
  cloud.points = {{0, 0, 600}};
  EXPECT_PRED2(mentions, error_of([&] { sorted_by_position(cloud); }), "needs normals");
}

TEST(SmoothClusters, CheckNamesTheKey) {
  EXPECT_EQ(error_of([] { SmoothClusterLimits{}.check(); }), "no error");
  EXPECT_PRED2(mentions, error_of([] { SmoothClusterLimits{.min_points = 0}.check(); }), "min_points 0");
  EXPECT_PRED2(mentions, error_of([] { SmoothClusterLimits{.curvature_threshold = NAN}.check(); }),
               "curvature_threshold");
  EXPECT_PRED2(mentions, error_of([] { SmoothClusterLimits{.radius_normals = INFINITY}.check(); }),
               "radius_normals inf");
}

}  // namespace
}  // namespace partpose
