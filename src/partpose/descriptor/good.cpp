// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/good.hpp"

#include "partpose/core/error.hpp"
#include "partpose/descriptor/order_free.hpp"

#include <Eigen/Eigenvalues>

#include <array>

namespace partpose {

namespace {

/// A principal axis, turned to its better side.
struct Axis {
  Eigen::Vector3d direction;
  double variance = 0;     ///< mm^2
  bool two_sided = false;  ///< the other side is as good, nearly
};

/// Largest variance first.
struct PrincipalAxes {
  Eigen::Vector3d centre;  ///< mm, camera frame
  std::array<Axis, 3> axes;
};

/// Which side of an axis is the positive one. Kasaei et al. 2016: the side with more points, of those that are farther
/// than the threshold from the plane through the centroid. As in the authors' code, a majority of less than a tenth of
/// all points decides nothing. Then it is the side without the longer tail (by the sign of the third moment), which
/// most often is the side with more points; and where there is no tail, the side away from the camera.
void turn_to_better_side(Axis& axis, const std::vector<Eigen::Vector3d>& centred, const Eigen::Vector3d& centre,
                         double threshold_mm) {
  const auto count = static_cast<int>(centred.size());
  int votes = 0;
  double largest = 0;
  for (const auto& p : centred) {
    const double x = axis.direction.dot(p);
    votes += static_cast<int>(x > threshold_mm) - static_cast<int>(x < -threshold_mm);
    largest = std::max(largest, std::abs(x));
  }
  const double third_moment = order_free_sum(centred.size(), largest * largest * largest, [&](std::size_t i) {
    const double x = axis.direction.dot(centred[i]);
    return x * x * x;
  });
  const double spread = count * axis.variance * std::sqrt(axis.variance);
  const double skewness = spread > 0 ? third_moment / spread : 0;
  constexpr double no_tail = 1e-6, clear_tail = 0.2, clear_majority = 0.15;

  double side = 0;
  if (votes != 0 && std::abs(votes) >= count / 10) {
    axis.two_sided = std::abs(votes) < clear_majority * count;
    side = votes;
  } else {
    axis.two_sided = std::abs(skewness) < clear_tail;
    side = std::abs(skewness) > no_tail ? -skewness : axis.direction.dot(centre);
  }
  if (side < 0) axis.direction = -axis.direction;
}

PrincipalAxes principal_axes(const std::vector<Eigen::Vector3d>& centred, const Eigen::Vector3d& centre,
                             double threshold_mm) {
  double largest = 0;
  for (const auto& p : centred) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  Eigen::Matrix3d covariance;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c)
      covariance(r, c) = covariance(c, r) =
          order_free_sum(centred.size(), largest * largest,
                         [&](std::size_t i) { return centred[i][r] * centred[i][c]; }) /
          static_cast<double>(centred.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);  // smallest first
  PrincipalAxes result;
  result.centre = centre;
  for (int i = 0; i < 3; ++i) {
    result.axes[i].direction = eigen.eigenvectors().col(2 - i);
    result.axes[i].variance = std::max(eigen.eigenvalues()[2 - i], 0.0);
    turn_to_better_side(result.axes[i], centred, centre, threshold_mm);
  }
  return result;
}

/// Right-handed; the third axis follows from the first two, its side with it.
Eigen::Matrix3d frame_of(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
  Eigen::Matrix3d frame;
  frame.col(0) = x.normalized();
  frame.col(1) = (y - frame.col(0).dot(y) * frame.col(0)).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

/// The frame of the definition first, then, if asked for, those that little noise could turn it into: the other side of
/// axes without a better side, and the exchange of axes of nearly equal variance.
std::vector<Eigen::Matrix3d> plausible_frames(const PrincipalAxes& principal, bool ambiguous_frames) {
  const auto& axes = principal.axes;
  std::vector<Eigen::Matrix3d> frames = {frame_of(axes[0].direction, axes[1].direction)};
  if (!ambiguous_frames) return frames;
  const auto near = [&](int a, int b) {
    constexpr double nearly_equal = 0.9;  // of the variances
    return axes[std::max(a, b)].variance >= nearly_equal * axes[std::min(a, b)].variance;
  };
  frames.clear();
  for (const auto& [x, y] : std::array<std::pair<int, int>, 6>{{{0, 1}, {1, 0}, {0, 2}, {2, 1}, {1, 2}, {2, 0}}}) {
    const int z = 3 - x - y;
    if (!(near(0, x) && near(1, y) && near(2, z))) continue;
    for (const double sx : {1.0, -1.0})
      for (const double sy : {1.0, -1.0})
        if ((sx > 0 || axes[x].two_sided) && (sy > 0 || axes[y].two_sided))
          frames.push_back(frame_of(sx * axes[x].direction, sy * axes[y].direction));
  }
  return frames;
}

/// One orthographic view: how the points spread over n x n bins, as shares of the points that it shows.
struct View {
  std::vector<double> shares;
  double entropy = 0;   ///< bits
  double variance = 0;  ///< of the bins' numbers, 1 to n n
};

View view_of(const std::vector<int>& counts) {
  double sum = 0;
  for (const int count : counts) sum += count;
  View view;
  view.shares.assign(counts.size(), 0.0);
  if (sum == 0) return view;
  double mean = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double share = view.shares[i] = counts[i] / sum;
    if (share > 0) view.entropy -= share * std::log2(share);
    mean += static_cast<double>(i + 1) * share;
  }
  for (std::size_t i = 0; i < counts.size(); ++i)
    view.variance += (static_cast<double>(i + 1) - mean) * (static_cast<double>(i + 1) - mean) * view.shares[i];
  return view;
}

/// The views along x (y by z), along y (x by z) and along z (x by y), in the order of Kasaei et al. 2016: the highest
/// entropy first, then the smaller variance; the order just given where they are equal.
std::vector<float> histogram_of(const std::vector<Eigen::Vector3d>& centred, const Eigen::Matrix3d& frame, int n) {
  const auto size = static_cast<std::size_t>(n) * n;
  std::array<std::vector<int>, 3> counts;
  for (auto& c : counts) c.assign(size, 0);

  // All views are as wide as the longest side of the cloud's box in the frame, with the centroid in the middle: of a
  // lopsided cloud some points lie outside.
  std::vector<Eigen::Vector3d> points;
  points.reserve(centred.size());
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
  for (const auto& p : centred) {
    const auto& q = points.emplace_back(frame.transpose() * p);
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  constexpr double margin = 1 + 1e-9;  // for points at the upper border
  const double longest = (high - low).maxCoeff() * margin;
  const auto bin_of = [&](double coordinate) {
    return longest > 0 ? static_cast<int>(std::floor((coordinate / longest + 0.5) * n)) : n / 2;
  };
  for (const auto& q : points) {
    const int x = bin_of(q.x()), y = bin_of(q.y()), z = bin_of(q.z());
    const auto add = [&](std::vector<int>& view, int row, int column) {
      if (row >= 0 && row < n && column >= 0 && column < n) ++view[static_cast<std::size_t>(row) * n + column];
    };
    add(counts[0], y, z);
    add(counts[1], x, z);
    add(counts[2], x, y);
  }

  std::array<View, 3> views = {view_of(counts[0]), view_of(counts[1]), view_of(counts[2])};
  constexpr double equal = 1e-9;
  int first = 0;
  for (int i = 1; i < 3; ++i)
    if (views[i].entropy > views[first].entropy + equal) first = i;
  std::rotate(views.begin(), views.begin() + first, views.begin() + first + 1);
  if (views[2].variance < views[1].variance - equal) std::swap(views[1], views[2]);
  std::vector<float> histogram;
  histogram.reserve(3 * size);
  for (const auto& view : views) histogram.insert(histogram.end(), view.shares.begin(), view.shares.end());
  return histogram;
}

class Good final : public GlobalDescriptor {
 public:
  explicit Good(const GoodOptions& options) : options_(options) {}
  int bins() const override { return 3 * options_.num_of_bins * options_.num_of_bins; }
  std::vector<Description> describe(const PointCloud& cloud) const override { return good(cloud, options_); }

 private:
  GoodOptions options_;
};

}  // namespace

void GoodOptions::check() const {
  check_neighbours(k_nn);
  if (num_of_bins < 1 || num_of_bins > 100) throw Error("num_of_bins {}: must be 1 to 100", num_of_bins);
  if (!(threshold >= 0)) throw Error("threshold {}: must be 0 or more", threshold);
}

std::unique_ptr<GlobalDescriptor> make_descriptor(const GoodOptions& options) {
  return std::make_unique<Good>(options);
}

std::vector<Description> good(const PointCloud& cloud, const GoodOptions& options) {
  const auto points = finite_points(cloud);
  if (points.empty()) return {};
  const Eigen::Vector3d centre = order_free_centroid(points);
  std::vector<Eigen::Vector3d> centred;
  centred.reserve(points.size());
  for (const auto& p : points) centred.push_back(p.cast<double>() - centre);
  const auto principal = principal_axes(centred, centre, options.threshold);
  std::vector<Description> descriptions;
  for (const auto& frame : plausible_frames(principal, options.ambiguous_frames)) {
    Eigen::Isometry3d camera_from_reference(Eigen::Translation3d{centre});
    camera_from_reference.linear() = frame;
    descriptions.push_back({.histogram = histogram_of(centred, frame, options.num_of_bins),
                            .centroid_mm = centre,
                            .support = static_cast<int>(points.size()),
                            .camera_from_reference = camera_from_reference});
  }
  return descriptions;
}

}  // namespace partpose
