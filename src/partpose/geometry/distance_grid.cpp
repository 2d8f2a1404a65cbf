// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/distance_grid.hpp"

#include "partpose/core/error.hpp"

#include <cmath>
#include <limits>

namespace partpose {

namespace {

/// The lower envelope of parabolas along one line (Felzenszwalb and Huttenlocher 2012): squared distances in cells.
class LineTransform {
 public:
  explicit LineTransform(int longest) : value_(longest), vertex_(longest), border_(longest + 1) {}

  void operator()(float* line, std::ptrdiff_t stride, int count) {
    int last = -1;
    for (int q = 0; q < count; ++q) {
      value_[q] = line[q * stride];
      if (!std::isfinite(value_[q])) continue;
      float start = -std::numeric_limits<float>::infinity();
      while (last >= 0) {
        const int v = vertex_[last];
        start = ((value_[q] + static_cast<float>(q * q)) - (value_[v] + static_cast<float>(v * v))) /
                static_cast<float>(2 * (q - v));
        if (start > border_[last]) break;
        --last;
      }
      ++last;
      vertex_[last] = q;
      border_[last] = last == 0 ? -std::numeric_limits<float>::infinity() : start;
    }
    if (last < 0) return;  // nothing on this line yet: stays infinite
    border_[last + 1] = std::numeric_limits<float>::infinity();
    for (int q = 0, k = 0; q < count; ++q) {
      while (border_[k + 1] < static_cast<float>(q)) ++k;
      const auto offset = static_cast<float>(q - vertex_[k]);
      line[q * stride] = offset * offset + value_[vertex_[k]];
    }
  }

 private:
  std::vector<float> value_;
  std::vector<int> vertex_;
  std::vector<float> border_;
};

}  // namespace

DistanceGrid::DistanceGrid(std::span<const Eigen::Vector3f> points_mm, float margin_mm, int cells_along_longest) {
  if (points_mm.empty()) throw Error("a distance grid needs at least one point");
  Eigen::AlignedBox3f box;
  for (const auto& p : points_mm) box.extend(p);
  const Eigen::Vector3f margin = Eigen::Vector3f::Constant(margin_mm);
  origin_ = box.min() - margin;
  const Eigen::Vector3f extent = box.sizes() + 2 * margin;
  per_mm_ = static_cast<float>(cells_along_longest) / std::max(extent.maxCoeff(), 1e-3f);
  size_ = (extent * per_mm_).array().ceil().cast<int>() + 1;
  last_ = size_.cast<float>() - Eigen::Vector3f::Constant(1.0f);

  constexpr float infinity = std::numeric_limits<float>::infinity();
  distance_mm_.assign(static_cast<std::size_t>(size_.x()) * size_.y() * size_.z(), infinity);
  for (const auto& p : points_mm) {
    const Eigen::Vector3i i = ((p - origin_) * per_mm_).cast<int>();
    distance_mm_[(static_cast<std::size_t>(i.z()) * size_.y() + i.y()) * size_.x() + i.x()] = 0;
  }
  LineTransform transform(size_.maxCoeff());
  const std::ptrdiff_t row = size_.x(), slice = row * size_.y();
  for (int z = 0; z < size_.z(); ++z)
    for (int y = 0; y < size_.y(); ++y) transform(&distance_mm_[z * slice + y * row], 1, size_.x());
  for (int z = 0; z < size_.z(); ++z)
    for (int x = 0; x < size_.x(); ++x) transform(&distance_mm_[z * slice + x], row, size_.y());
  for (int y = 0; y < size_.y(); ++y)
    for (int x = 0; x < size_.x(); ++x) transform(&distance_mm_[y * row + x], slice, size_.z());
  for (float& value : distance_mm_) value = std::sqrt(value) / per_mm_;
}

}  // namespace partpose
