// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/geometry/symmetry_search.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/distance_grid.hpp"
#include "partpose/geometry/icosphere.hpp"
#include "partpose/geometry/surface_distance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>

namespace partpose {

namespace {

using std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The triangles' area, its centre, and its second moments about the centre.
struct AreaMoments {
  double area = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  explicit AreaMoments(const TriangleMesh& mesh) {
    // About a corner rather than the origin, which may be far away.
    const Eigen::Vector3d base = mesh.vertices[mesh.triangles[0][0]].cast<double>();
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    for (const auto& [i, j, k] : mesh.triangles) {
      const Eigen::Vector3d a = mesh.vertices[i].cast<double>() - base, b = mesh.vertices[j].cast<double>() - base,
                            c = mesh.vertices[k].cast<double>() - base;
      const double triangle = 0.5 * (b - a).cross(c - a).norm();
      const Eigen::Vector3d sum = a + b + c;
      area += triangle;
      first += triangle / 3 * sum;
      second += triangle / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
    if (!(area > 0)) return;
    centre = first / area;
    second = second / area - centre * centre.transpose();
    centre += base;
  }
};

/// A mesh about `centre`, its vertices those that triangles use, each once.
TriangleMesh centred(const TriangleMesh& mesh, const Eigen::Vector3d& centre) {
  TriangleMesh used;
  std::vector<int> new_index(mesh.vertices.size(), -1);
  for (const auto& triangle : mesh.triangles) {
    auto& [a, b, c] = used.triangles.emplace_back();
    for (const auto& [corner, to] : {std::pair{triangle[0], &a}, {triangle[1], &b}, {triangle[2], &c}}) {
      if (new_index[corner] < 0) {
        new_index[corner] = static_cast<int>(used.vertices.size());
        used.vertices.emplace_back((mesh.vertices[corner].cast<double>() - centre).cast<float>());
      }
      *to = new_index[corner];
    }
  }
  return with_merged_vertices(used);
}

struct Axis {
  Eigen::Vector3d direction;  ///< of unit length
  Eigen::Vector3d point;

  Eigen::Isometry3d turn(double angle_rad) const {
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle_rad, direction).toRotationMatrix();
    Eigen::Isometry3d motion(Eigen::Translation3d(point - rotation * point));
    motion.linear() = rotation;
    return motion;
  }
  /// The axis of a motion: its point nearest to the origin. The motion's shift along the axis is lost.
  static Axis of(const Eigen::Isometry3d& motion) {
    const Eigen::AngleAxisd rotation(motion.linear());
    const Eigen::Vector3d a = rotation.axis();
    const Eigen::Vector3d across = motion.translation() - a * a.dot(motion.translation());
    const Eigen::Matrix3d system = Eigen::Matrix3d::Identity() - motion.linear() + a * a.transpose();
    return {a, system.partialPivLu().solve(across)};
  }
};

double angle_of(const Eigen::Isometry3d& motion) { return Eigen::AngleAxisd(motion.linear()).angle(); }

struct Element {
  Eigen::Isometry3d motion;
  double deviation = infinity;
  double share = 1;  ///< of the surface that lies farther off than the tolerance
};

/// The search in coordinates about the surface's centre.
class Search {
 public:
  Search(const TriangleMesh& mesh, const AreaMoments& moments, double tolerance)
      : mesh_(centred(mesh, moments.centre)),
        surface_(mesh_),
        tolerance_(tolerance),
        coarse_samples_(even_surface_samples(mesh_, 96)),
        align_samples_(even_surface_samples(mesh_, 250)),
        share_samples_(even_surface_samples(mesh_, 1000)),
        grid_(grid_points(mesh_), 1.0f, 64) {
    for (const auto& v : mesh_.vertices) samples_.push_back(v.cast<double>());
    for (const auto& v : samples_) radius_ = std::max(radius_, v.norm());
    const auto even = even_surface_samples(mesh_, 4000);
    samples_.insert(samples_.end(), even.begin(), even.end());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.second);
    for (int k = 0; k < 3; ++k) principal_axes_.push_back({solver.eigenvectors().col(k), Eigen::Vector3d::Zero()});
  }

  void run() {
    for (const auto& axis : principal_axes_) try_round(axis);
    if (finish_round()) return;

    std::vector<Axis> axes = principal_axes_;
    for (const auto& element : elements_from_all_rotations()) {
      add(element);
      add_axis(axes, Axis::of(element.motion));
    }
    for (std::size_t i = principal_axes_.size(); i < axes.size(); ++i) try_round(axes[i]);
    if (finish_round()) return;
    for (const auto& axis : axes) add_turns(axis);
    close_group();
    thin_out_near();
  }

  SymmetrySearch result(const Eigen::Vector3d& centre) const {
    SymmetrySearch search;
    search.tolerance_mm = tolerance_;
    const Eigen::Translation3d to_centre(centre);
    auto elements = elements_;
    std::stable_sort(elements.begin(), elements.end(), [](const Element& a, const Element& b) {
      return std::lround(1e4 * angle_of(a.motion)) < std::lround(1e4 * angle_of(b.motion));
    });
    for (const auto& element : elements) {
      auto& list = exact(element) ? search.found : search.near;
      list.symmetries.discrete.push_back(to_centre * element.motion * to_centre.inverse());
      list.discrete_deviation_mm.push_back(element.deviation);
    }
    for (const auto& [axis, deviation] : round_) {
      auto& list = deviation <= tolerance_ ? search.found : search.near;
      list.symmetries.continuous.push_back({axis.direction, axis.point + centre});
      list.continuous_deviation_mm.push_back(deviation);
    }
    return search;
  }

 private:
  struct RoundAxis {
    Axis axis;
    double deviation;
  };

  static std::vector<Eigen::Vector3f> grid_points(const TriangleMesh& mesh) {
    std::vector<Eigen::Vector3f> points = mesh.vertices;
    for (const auto& p : even_surface_samples(mesh, 15000)) points.push_back(p.cast<float>());
    return points;
  }

  bool exact(const Element& element) const { return element.deviation <= tolerance_; }

  /// The largest distance between the surface and its moved copy; infinite beyond `limit`.
  double deviation(const Eigen::Isometry3d& motion, double limit) const {
    const Eigen::Isometry3d back = motion.inverse();
    const double search_limit = limit * (1 + 1e-9) + 1e-9;
    const auto of = [&](const Eigen::Vector3d& p, double so_far) {
      const double enough = std::max(so_far, 0.005 * tolerance_);  // nobody asks for more digits
      const double there = surface_.nearest(motion * p, search_limit, enough).distance_mm;
      return std::isinf(there) ? there : std::max(there, surface_.nearest(back * p, search_limit, enough).distance_mm);
    };
    double largest = 0;
    for (const auto& p : coarse_samples_) {
      largest = std::max(largest, of(p, largest));
      if (std::isinf(largest)) return infinity;
    }
    std::vector<double> of_sample(samples_.size(), 0.0);
    std::atomic<bool> beyond = false;
    parallel_ranges(
        samples_.size(),
        [&](std::size_t begin, std::size_t end) {
          double largest_here = largest;
          for (std::size_t i = begin; i < end && !beyond; ++i) {
            largest_here = std::max(largest_here, of(samples_[i], largest_here));
            of_sample[i] = largest_here;
            if (std::isinf(largest_here)) beyond = true;
          }
        },
        256);
    if (beyond) return infinity;
    return std::max(largest, *std::max_element(of_sample.begin(), of_sample.end()));
  }

  /// The share of the surface and of its moved copy that lies farther from the other than the tolerance; 1 when that
  /// is more than a near symmetry may have.
  double share_off(const Eigen::Isometry3d& motion) const {
    const Eigen::Isometry3d back = motion.inverse();
    const auto all = static_cast<double>(2 * share_samples_.size());
    int off = 0;
    for (const auto& p : share_samples_) {
      for (const Eigen::Vector3d& moved : {motion * p, back * p})
        off += surface_.nearest(moved, tolerance_, tolerance_).triangle < 0;
      if (off > SymmetrySearch::near_area_share * all) return 1;
    }
    return off / all;
  }

  /// A motion measured: what is neither exact nor near has an infinite deviation.
  Element measured(const Eigen::Isometry3d& motion) const {
    Element element{motion};
    element.share = share_off(motion);
    if (element.share < 1) element.deviation = deviation(motion, infinity);
    return element;
  }

  Eigen::Isometry3d aligned(const Eigen::Isometry3d& motion) const {
    return align_to_surface(align_samples_, surface_, motion, tolerance_, Eigen::Vector3d::Zero());
  }

  double displacement(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) const {
    double largest = 0;
    for (std::size_t i = 0; i < align_samples_.size(); i += 5)
      largest = std::max(largest, (a * align_samples_[i] - b * align_samples_[i]).norm());
    return largest;
  }
  bool same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) const {
    return displacement(a, b) <= std::max(4 * tolerance_, 1e-3 * radius_);
  }

  static double angle_between(const Axis& axis, const std::vector<Axis>& axes) {
    double least = pi;
    for (const auto& other : axes)
      least = std::min(least, std::atan2(axis.direction.cross(other.direction).norm(),
                                         std::abs(axis.direction.dot(other.direction))));
    return least;
  }
  static void add_axis(std::vector<Axis>& axes, const Axis& axis) {
    if (angle_between(axis, axes) > radians(0.5)) axes.push_back(axis);
  }

  /// The identity and those that are there already are left out: what was aligned comes before what follows from an
  /// axis.
  void add(const Element& element) {
    if (std::isinf(element.deviation) || same(element.motion, Eigen::Isometry3d::Identity())) return;
    if (std::none_of(elements_.begin(), elements_.end(),
                     [&](const Element& other) { return same(element.motion, other.motion); }))
      elements_.push_back(element);
  }

  /// The largest deviation of some turns about an axis that share no period; infinite when one is not even near.
  double round_deviation(const Axis& axis) const {
    double largest = 0;
    for (int k = 1; k <= round_turns && largest < infinity; ++k)
      largest = std::max(largest, deviation(axis.turn(golden * k), tolerance_));
    if (largest < infinity) return largest;
    for (int k = 1; k <= round_turns; ++k)
      if (share_off(axis.turn(golden * k)) == 1) return infinity;
    for (int k = 1; k <= round_turns; ++k)
      largest = std::max(k == 1 ? 0 : largest, deviation(axis.turn(golden * k), infinity));
    return largest;
  }

  /// Whether the surface is one of revolution about an axis near the one given.
  void try_round(const Axis& guess) {
    int off = 0;
    for (const auto& p : coarse_samples_)
      off += surface_.nearest(guess.turn(golden) * p, 2 * tolerance_ + 0.05 * radius_, infinity).triangle < 0;
    if (off > 2 * SymmetrySearch::near_area_share * static_cast<double>(coarse_samples_.size())) return;
    const Axis axis = Axis::of(aligned(guess.turn(pi)));
    if (angle_between(axis, {guess}) > radians(5)) return;
    for (const auto& other : round_)
      if (angle_between(axis, {other.axis}) < radians(5)) return;
    const double deviation = round_deviation(axis);
    if (deviation < infinity) round_.push_back({axis, deviation});
  }

  /// If the surface is one of revolution: its one axis, or three for a sphere, and the half turn across, if any.
  bool finish_round() {
    std::vector<RoundAxis> axes;
    for (const auto& round : round_)
      if (round.deviation <= tolerance_) axes.push_back(round);
    if (axes.empty()) return false;
    elements_.clear();
    round_.clear();
    std::stable_sort(axes.begin(), axes.end(),
                     [](const RoundAxis& a, const RoundAxis& b) { return a.deviation < b.deviation; });
    if (axes.size() > 1) {
      // Round about two axes is round about all: about those of the model frame, so that the numbers are plain.
      for (int k = 0; k < 3; ++k) {
        const Axis axis{Eigen::Vector3d::Unit(k), axes[0].axis.point};
        const double deviation = round_deviation(axis);
        if (deviation <= tolerance_) round_.push_back({axis, deviation});
      }
      if (round_.size() == 3) return true;
      round_.clear();
    }
    Axis& axis = axes[0].axis;
    int largest = 0;
    axis.direction.cwiseAbs().maxCoeff(&largest);
    if (axis.direction[largest] < 0) axis.direction = -axis.direction;
    round_.push_back(axes[0]);
    add(measured(half_turn_across(axis)));
    return true;
  }

  /// The half turn that swaps the ends of a surface of revolution best.
  Eigen::Isometry3d half_turn_across(const Axis& axis) const {
    int least = 0;
    axis.direction.cwiseAbs().minCoeff(&least);
    const Eigen::Vector3d across = axis.direction.cross(Eigen::Vector3d::Unit(least)).normalized();
    // The alignment may turn about the axis, which is free; only its place along the axis is taken.
    const double along = axis.direction.dot(Axis::of(aligned(Axis{across, axis.point}.turn(pi))).point);
    return Axis{across, axis.point + (along - axis.direction.dot(axis.point)) * axis.direction}.turn(pi);
  }

  /// Every rotation on a grid of about 8 degrees, scored by a table of distances; the local best ones aligned.
  std::vector<Element> elements_from_all_rotations() const {
    constexpr int rolls = 40;
    constexpr std::size_t most = 64;  // an icosahedron has 59
    const auto directions = icosphere_directions(3, true);
    std::vector<Eigen::Vector3f> points;
    for (const auto& p : coarse_samples_) points.push_back(p.cast<float>());
    float mean_radius = 0;
    for (const auto& p : points) mean_radius += p.norm() / static_cast<float>(points.size());
    const float limit = (0.12f * mean_radius + static_cast<float>(tolerance_) + 0.5f * grid_.cell_mm()) *
                        static_cast<float>(points.size());

    std::vector<Eigen::Quaterniond> rotations;
    for (const auto& direction : directions)
      for (int roll = 0; roll < rolls; ++roll)
        rotations.push_back(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction) *
                            Eigen::Quaterniond(Eigen::AngleAxisd(2 * pi * roll / rolls, Eigen::Vector3d::UnitZ())));
    std::vector<float> score(rotations.size());
    parallel_for(
        rotations.size(),
        [&](std::size_t r) {
          const Eigen::Matrix3f rotation = rotations[r].toRotationMatrix().cast<float>();
          for (const auto& p : points) {
            score[r] += grid_.at(rotation * p);
            if (score[r] > limit) break;
          }
        },
        64);
    std::vector<std::size_t> order;
    for (std::size_t r = 0; r < score.size(); ++r)
      if (score[r] <= limit) order.push_back(r);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return score[a] < score[b]; });

    const auto apart = [](const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
      return 2 * std::acos(std::min(1.0, std::abs(a.dot(b)))) > radians(22);
    };
    std::vector<Eigen::Quaterniond> starts;
    for (const std::size_t r : order) {
      if (starts.size() == most) break;
      if (apart(rotations[r], Eigen::Quaterniond::Identity()) &&
          std::all_of(starts.begin(), starts.end(), [&](const auto& other) { return apart(rotations[r], other); }))
        starts.push_back(rotations[r]);
    }
    std::vector<std::optional<Eigen::Isometry3d>> motions(starts.size());
    parallel_for(starts.size(), [&](std::size_t i) {
      const auto motion = align_to_surface(coarse_samples_, surface_, Eigen::Isometry3d(starts[i]), tolerance_,
                                           Eigen::Vector3d::Zero(), 8);
      const double loose = 2 * tolerance_ + 0.02 * radius_;
      int off = 0;
      for (const auto& p : coarse_samples_) off += surface_.nearest(motion * p, loose, loose).triangle < 0;
      if (off <= 3 * SymmetrySearch::near_area_share * static_cast<double>(coarse_samples_.size()))
        motions[i] = aligned(motion);
    });
    std::vector<Element> elements;
    for (const auto& motion : motions) {
      if (!motion || same(*motion, Eigen::Isometry3d::Identity())) continue;
      if (std::any_of(elements.begin(), elements.end(), [&](const Element& e) { return same(e.motion, *motion); }))
        continue;
      const Element element = measured(*motion);
      if (element.deviation < infinity) elements.push_back(element);
    }
    return elements;
  }

  /// All turns by multiples of 360 / n degrees, for the largest n for which all are within the tolerance.
  std::vector<Element> turns_about(const Axis& axis) const {
    double reach = 0;  // of the farthest sample from the axis
    for (const auto& p : align_samples_) reach = std::max(reach, axis.direction.cross(p - axis.point).norm());
    const int largest = static_cast<int>(std::clamp(2 * pi * reach / (4 * tolerance_), 1.0, 180.0));
    for (int n = largest; n >= 2; --n) {
      // One that all others are multiples of fails if any does.
      int generator = std::max(1, 2 * n / 5);
      while (std::gcd(generator, n) != 1) --generator;
      if (deviation(axis.turn(2 * pi * generator / n), tolerance_) == infinity) continue;
      std::vector<Element> turns;
      for (int k = n / 2; k >= 1; --k) {
        const Eigen::Isometry3d motion = axis.turn(2 * pi * k / n);
        const double reached = deviation(motion, tolerance_);
        if (reached == infinity) break;
        turns.push_back({motion, reached, 0});
        if (2 * k != n) turns.push_back({motion.inverse(), reached, 0});
      }
      if (static_cast<int>(turns.size()) == n - 1) return turns;
    }
    return {};
  }

  void add_turns(const Axis& axis) {
    const auto turns = turns_about(axis);
    for (const auto& element : turns) add(element);
    // A half turn about a line across the axis may be too narrow a target among many teeth.
    const int n = static_cast<int>(turns.size()) + 1;
    if (n < 7) return;
    const Eigen::Vector3d across = axis.direction.unitOrthogonal();
    constexpr int steps = 12;
    for (int step = 0; step < steps; ++step) {
      const Axis line{Eigen::AngleAxisd(pi / n * step / steps, axis.direction) * across, axis.point};
      if (deviation(line.turn(pi), 0.1 * radius_) == infinity) continue;
      const Element flip = measured(aligned(line.turn(pi)));
      if (!exact(flip)) continue;
      add(flip);
      break;
    }
  }

  /// All products of those that are symmetries, as far as they are within the tolerance themselves.
  void close_group() {
    constexpr std::size_t most = 720;
    std::vector<Element> group, generators;
    const auto find = [this](const std::vector<Element>& list, const Eigen::Isometry3d& motion) {
      return std::find_if(list.begin(), list.end(),
                          [&](const Element& e) { return exact(e) && same(e.motion, motion); });
    };
    for (const auto& element : elements_) {
      if (!exact(element) || find(group, element.motion) != group.end()) continue;
      generators.push_back(element);
      group.push_back(element);
      for (std::size_t i = 0; i < group.size() && group.size() < most; ++i) {
        for (const auto& generator : generators) {
          const Eigen::Isometry3d product = generator.motion * group[i].motion;
          if (same(product, Eigen::Isometry3d::Identity()) || find(group, product) != group.end()) continue;
          if (const auto known = find(elements_, product); known != elements_.end()) {
            group.push_back(*known);
            continue;
          }
          const Eigen::Isometry3d motion = aligned(product);
          const double reached = deviation(motion, tolerance_);
          if (reached <= tolerance_ && find(group, motion) == group.end()) group.push_back({motion, reached, 0});
        }
      }
    }
    for (const auto& element : elements_)
      if (!exact(element)) group.push_back(element);
    elements_ = group;
  }

  /// A near symmetry beside an exact one, or beside a nearer one, is the same but for a detail, or not one at all.
  /// What turns about a nearly round axis and a half turn across give is left to them.
  void thin_out_near() {
    const double apart = 0.3 * radius_;
    std::vector<Element> near, kept;
    for (const auto& element : elements_) (exact(element) ? kept : near).push_back(element);
    for (const auto& round : round_) {
      std::erase_if(near, [&](const Element& e) {
        const double between = angle_between(Axis::of(e.motion), {round.axis});
        return between < radians(10) || (angle_of(e.motion) > radians(160) && between > radians(80));
      });
      if (const Element flip = measured(half_turn_across(round.axis)); flip.share < 1 && !exact(flip))
        near.push_back(flip);
    }
    std::stable_sort(near.begin(), near.end(), [](const Element& a, const Element& b) { return a.share < b.share; });
    for (const auto& element : near)
      if (displacement(element.motion, Eigen::Isometry3d::Identity()) > apart &&
          std::all_of(kept.begin(), kept.end(),
                      [&](const Element& e) { return displacement(e.motion, element.motion) > apart; }))
        kept.push_back(element);
    elements_ = kept;
  }

  static constexpr int round_turns = 12;
  static constexpr double golden = 2.399963229728653;  ///< rad: its multiples share no period with any polygon

  TriangleMesh mesh_;
  SurfaceDistance surface_;
  double tolerance_ = 0, radius_ = 0;
  std::vector<Eigen::Vector3d> coarse_samples_, align_samples_, share_samples_, samples_;
  DistanceGrid grid_;
  std::vector<Axis> principal_axes_;
  std::vector<RoundAxis> round_;
  std::vector<Element> elements_;
};

}  // namespace

double MeasuredSymmetries::largest_deviation_mm() const {
  double largest = 0;
  for (const auto* list : {&discrete_deviation_mm, &continuous_deviation_mm})
    for (const double deviation : *list) largest = std::max(largest, deviation);
  return largest;
}

double default_symmetry_tolerance_mm(double diameter_mm) {
  return std::max(0.005 * diameter_mm, std::min(0.5, 0.02 * diameter_mm));
}

SymmetrySearch search_symmetries(const TriangleMesh& mesh, std::optional<double> tolerance_mm) {
  for (const auto& v : mesh.vertices)
    if (!v.allFinite()) throw Error("symmetry: the mesh has a vertex that is not finite");
  if (mesh.triangles.empty()) throw Error("symmetry: the mesh has no triangles");
  const AreaMoments moments(mesh);
  if (!(moments.area > 0)) throw Error("symmetry: the mesh's triangles have no area");
  const double diameter_mm = diameter(mesh);
  const double tolerance = tolerance_mm.value_or(default_symmetry_tolerance_mm(diameter_mm));
  if (!(tolerance > 0) || !std::isfinite(tolerance))
    throw Error("symmetry tolerance {} mm: must be positive", tolerance);
  Search search(mesh, moments, tolerance);
  search.run();
  SymmetrySearch result = search.result(moments.centre);
  result.diameter_mm = diameter_mm;
  return result;
}

}  // namespace partpose
