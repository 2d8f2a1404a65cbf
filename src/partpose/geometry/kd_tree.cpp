// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/kd_tree.hpp"

#include <nanoflann.hpp>

#include <algorithm>

namespace partpose {

namespace {

struct Points {
  std::vector<Eigen::Vector3f> data;
  std::size_t kdtree_get_point_count() const { return data.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t axis) const { return data[index][static_cast<int>(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3, unsigned>;

}  // namespace

struct KdTree::Impl {
  Points points;
  Tree tree;
  explicit Impl(std::span<const Eigen::Vector3f> p)
      : points{{p.begin(), p.end()}}, tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {}
};

KdTree::KdTree(std::span<const Eigen::Vector3f> points_mm) : impl_(std::make_unique<Impl>(points_mm)) {}
KdTree::~KdTree() = default;
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;

KdTree::Neighbour KdTree::nearest(const Eigen::Vector3f& query_mm) const {
  if (impl_->points.data.empty()) return {};
  unsigned index = 0;
  float squared = 0;
  impl_->tree.knnSearch(query_mm.data(), 1, &index, &squared);
  return {static_cast<int>(index), squared};
}

std::vector<KdTree::Neighbour> KdTree::nearest_k(const Eigen::Vector3f& query_mm, int k) const {
  if (impl_->points.data.empty() || k < 1) return {};
  k = std::min(k, static_cast<int>(impl_->points.data.size()));
  std::vector<unsigned> indices(k);
  std::vector<float> squared(k);
  const auto found = impl_->tree.knnSearch(query_mm.data(), k, indices.data(), squared.data());
  std::vector<Neighbour> neighbours(found);
  for (std::size_t i = 0; i < found; ++i) neighbours[i] = {static_cast<int>(indices[i]), squared[i]};
  return neighbours;
}

}  // namespace partpose
