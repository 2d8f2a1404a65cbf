// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

namespace partpose {

/// Nearest neighbours among points that do not change. The points are copied; queries are thread-safe.
class KdTree {
 public:
  struct Neighbour {
    int index = -1;                ///< into the points given, -1: none
    float squared_distance = 0.f;  ///< mm^2
  };

  explicit KdTree(std::span<const Eigen::Vector3f> points_mm);
  ~KdTree();
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;

  /// The nearest point; index -1 for an empty tree.
  Neighbour nearest(const Eigen::Vector3f& query_mm) const;
  /// The k nearest, nearest first; fewer when the tree has fewer.
  std::vector<Neighbour> nearest_k(const Eigen::Vector3f& query_mm, int k) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partpose
