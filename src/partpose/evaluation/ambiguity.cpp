// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/ambiguity.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/distance_grid.hpp"
#include "partpose/geometry/icosphere.hpp"
#include "partpose/geometry/surface_distance.hpp"
#include "partpose/geometry/symmetry_search.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace partpose {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The pixels of a camera that meshes may cover, as a camera of its own; pixel (0, 0) of it is a pixel of the camera.
Intrinsics cropped(const Intrinsics& camera,
                   std::initializer_list<std::pair<const TriangleMesh*, Eigen::Isometry3d>> seen) {
  Eigen::AlignedBox2d window;
  for (const auto& [mesh, camera_from_model] : seen) {
    const auto box = bounding_box(*mesh);
    for (int c = 0; c < 8; ++c) {
      const Eigen::Vector3d corner = camera_from_model * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c));
      if (corner.z() < 1) return camera;
      window.extend(camera.project(corner));
    }
  }
  const auto low = [](double value, int size) {
    return static_cast<int>(std::clamp(std::floor(value) - 2, 0.0, size - 1.0));
  };
  const auto high = [](double value, int size) {
    return static_cast<int>(std::clamp(std::ceil(value) + 2, 0.0, size - 1.0));
  };
  const int left = low(window.min().x(), camera.width), right = high(window.max().x(), camera.width);
  const int top = low(window.min().y(), camera.height), bottom = high(window.max().y(), camera.height);
  Intrinsics out = camera;
  out.width = std::max(right - left, 0) + 1;
  out.height = std::max(bottom - top, 0) + 1;
  out.cx -= left;
  out.cy -= top;
  return out;
}

/// The least difference of `z` to the other image within one pixel of (u, v), in standard deviations.
double least_difference(float z, const DepthImage& other, int u, int v, double sigma_mm) {
  double least = infinity;
  for (int y = std::max(v - 1, 0); y <= std::min(v + 1, other.height - 1); ++y)
    for (int x = std::max(u - 1, 0); x <= std::min(u + 1, other.width - 1); ++x)
      if (const float there = other.at(x, y); there > 0)
        least = std::min(least, static_cast<double>(std::abs(there - z)) / sigma_mm);
  return least;
}

/// By which b's depths are to be multiplied to be most like a's, as far as a camera may err by it unknown.
float common_factor(const DepthImage& a, const DepthImage& b, double slow_percent) {
  std::vector<float> factors;
  for (std::size_t p = 0; p < a.z_mm.size(); ++p)
    if (a.z_mm[p] > 0 && b.z_mm[p] > 0) factors.push_back(a.z_mm[p] / b.z_mm[p]);
  if (factors.empty()) return 1;
  const auto median = factors.begin() + static_cast<std::ptrdiff_t>(factors.size() / 2);
  std::nth_element(factors.begin(), median, factors.end());
  const auto most = static_cast<float>(slow_percent / 100);
  return std::clamp(*median, 1 - most, 1 + most);
}

/// Takes from both renderings what something nearer hides, as `indistinguishable` says. `left`, `top`: where their
/// pixel (0, 0) is in `measured`.
void take_hidden(DepthImage& a, DepthImage& b, const DepthImage& measured, int left, int top, double fx_px,
                 const AmbiguityOptions& options) {
  const int width = a.width, height = a.height;
  const auto is_hidden = [&](float z_mm, float measured_mm) {
    return measured_mm > 0 && measured_mm < z_mm - options.sigmas * options.sigma_mm(z_mm, fx_px);
  };
  const auto is_before = [&](int u, int v) {
    const float za = a.at(u, v), zb = b.at(u, v), z_measured = measured.at(left + u, top + v);
    return (za > 0 || zb > 0) && (!(za > 0) || is_hidden(za, z_measured)) && (!(zb > 0) || is_hidden(zb, z_measured));
  };
  std::vector<std::pair<int, int>> next;
  const auto take = [&](int u, int v) {
    a.at(u, v) = b.at(u, v) = 0;
    next.emplace_back(u, v);
  };
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      if (b.at(u, v) > 0 && is_before(u, v)) take(u, v);
  while (!next.empty()) {
    const auto [u, v] = next.back();
    next.pop_back();
    for (int y = std::max(v - 1, 0); y <= std::min(v + 1, height - 1); ++y)
      for (int x = std::max(u - 1, 0); x <= std::min(u + 1, width - 1); ++x)
        if (is_before(x, y)) take(x, y);
  }
}

}  // namespace

void AmbiguityOptions::check() const {
  const auto at_least_zero = [](const char* name, double value) {
    if (!(value >= 0) || !std::isfinite(value)) throw Error("{} {}: must be at least 0", name, value);
  };
  const auto positive = [](const char* name, double value) {
    if (!(value > 0) || !std::isfinite(value)) throw Error("{} {}: must be positive", name, value);
  };
  at_least_zero("disparity_sigma_px", disparity_sigma_px);
  positive("baseline_mm", baseline_mm);
  positive("floor_mm", floor_mm);
  at_least_zero("slow_percent", slow_percent);
  if (slow_percent > 20) throw Error("slow_percent {}: must be at most 20", slow_percent);
  positive("sigmas", sigmas);
  at_least_zero("max_share", max_share);
  if (max_share > 1) throw Error("max_share {}: must be at most 1", max_share);
  if (max_px < 0) throw Error("max_px {}: must be at least 0", max_px);
  positive("max_rms_sigmas", max_rms_sigmas);
}

AmbiguityOptions AmbiguityOptions::of(const NoiseOptions& noise) {
  AmbiguityOptions options;
  if (noise.model == "stereo") {
    const auto stereo = noise.stereo.value_or(StereoSensorOptions{});
    options.disparity_sigma_px = stereo.disparity_noise_px;
    options.baseline_mm = stereo.baseline_mm;
    options.slow_percent = stereo.static_pattern_percent / 2;  // which is from peak to peak
    return options;
  }
  options.disparity_sigma_px = 0;
  if (noise.model != "none") options.floor_mm = std::max<double>(options.floor_mm, noise.standard_deviation_mm);
  return options;
}

double AmbiguityOptions::sigma_mm(double z_mm, double fx_px) const {
  return std::hypot(floor_mm, z_mm * z_mm * disparity_sigma_px / (fx_px * baseline_mm));
}

bool DepthDifference::indistinguishable(const AmbiguityOptions& options) const {
  return differing_px <= std::max<double>(options.max_px, options.max_share * union_px) &&
         differing_px <= union_px / 4 && rms_sigmas <= options.max_rms_sigmas;
}

DepthDifference depth_difference(const DepthImage& a, const DepthImage& other, double fx_px,
                                 const AmbiguityOptions& options) {
  if (a.width != other.width || a.height != other.height)
    throw Error("depth images of {} x {} and {} x {} cannot be compared", a.width, a.height, other.width, other.height);
  DepthImage b = other;
  if (options.slow_percent > 0) {
    const float factor = common_factor(a, b, options.slow_percent);
    for (float& z : b.z_mm) z *= factor;
  }
  DepthDifference out;
  double sum = 0;
  int compared = 0;
  for (int v = 0; v < a.height; ++v) {
    for (int u = 0; u < a.width; ++u) {
      const float za = a.at(u, v), zb = b.at(u, v);
      if (!(za > 0) && !(zb > 0)) continue;
      ++out.union_px;
      double most = 0;
      if (za > 0) most = least_difference(za, b, u, v, options.sigma_mm(za, fx_px));
      if (zb > 0) most = std::max(most, least_difference(zb, a, u, v, options.sigma_mm(zb, fx_px)));
      if (most > options.sigmas) {
        ++out.differing_px;
      } else {
        sum += most * most;
        ++compared;
      }
    }
  }
  if (compared) out.rms_sigmas = std::sqrt(sum / compared);
  return out;
}

DepthDifference depth_difference(const TriangleMesh& part_a, const Eigen::Isometry3d& camera_from_a,
                                 const TriangleMesh& part_b, const Eigen::Isometry3d& camera_from_b,
                                 const Intrinsics& camera, const AmbiguityOptions& options) {
  camera.check();
  options.check();
  const Intrinsics window = cropped(camera, {{&part_a, camera_from_a}, {&part_b, camera_from_b}});
  return depth_difference(render(part_a, camera_from_a, window).depth, render(part_b, camera_from_b, window).depth,
                          camera.fx, options);
}

bool indistinguishable(const TriangleMesh& part_a, const Eigen::Isometry3d& camera_from_a, const TriangleMesh& part_b,
                       const Eigen::Isometry3d& camera_from_b, const Intrinsics& camera,
                       const AmbiguityOptions& options) {
  return depth_difference(part_a, camera_from_a, part_b, camera_from_b, camera, options).indistinguishable(options);
}

bool indistinguishable(const TriangleMesh& part_a, const Eigen::Isometry3d& camera_from_a, const TriangleMesh& part_b,
                       const Eigen::Isometry3d& camera_from_b, const Intrinsics& camera,
                       const AmbiguityOptions& options, const DepthImage& measured) {
  camera.check();
  options.check();
  if (measured.width != camera.width || measured.height != camera.height)
    throw Error("a depth image of {} x {} is not of a camera of {} x {}", measured.width, measured.height, camera.width,
                camera.height);
  const Intrinsics window = cropped(camera, {{&part_a, camera_from_a}, {&part_b, camera_from_b}});
  DepthImage a = render(part_a, camera_from_a, window).depth, b = render(part_b, camera_from_b, window).depth;
  if (depth_difference(a, b, camera.fx, options).indistinguishable(options)) return true;
  take_hidden(a, b, measured, static_cast<int>(std::lround(camera.cx - window.cx)),
              static_cast<int>(std::lround(camera.cy - window.cy)), camera.fx, options);
  return depth_difference(a, b, camera.fx, options).indistinguishable(options);
}

struct AmbiguitySearch::Impl {
  /// What the search needs of a part. Model frame.
  struct Prepared {
    SurfaceDistance surface;
    DistanceGrid grid;
    std::vector<Eigen::Vector3d> samples;   ///< of the surface
    std::vector<Eigen::Vector3d> extremes;  ///< vertices that outline it from somewhere
    std::vector<Eigen::Isometry3d> equivalent;
    std::vector<Eigen::Isometry3d> turns;  ///< model_from_model, worth trying from any view
    Eigen::Vector3d centre;
    double diameter_mm;

    Prepared(const AmbiguityPart& part, double turn_step_deg)
        : surface(part.mesh), grid(grid_points(part.mesh), 5.0f, 64), samples(even_surface_samples(part.mesh, 300)) {
      if (samples.empty()) throw Error("part \"{}\": its triangles have no area", part.name);
      diameter_mm = diameter(part.mesh);
      centre = Eigen::Vector3d::Zero();
      for (const auto& p : samples) centre += p / static_cast<double>(samples.size());
      std::set<std::size_t> chosen;
      for (const auto& direction : icosphere_directions(2, true)) {
        const Eigen::Vector3f d = direction.cast<float>();
        const auto farthest =
            std::max_element(part.mesh.vertices.begin(), part.mesh.vertices.end(),
                             [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a.dot(d) < b.dot(d); });
        if (chosen.insert(farthest - part.mesh.vertices.begin()).second) extremes.push_back(farthest->cast<double>());
      }
      equivalent = symmetry_transformations(part.symmetries, 0.05);

      const auto near = search_symmetries(part.mesh).near.symmetries;
      Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
      for (const auto& p : samples) second += (p - centre) * (p - centre).transpose();
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(second);
      std::vector<Symmetries::Continuous> axes = near.continuous;
      for (int k = 0; k < 3; ++k) axes.push_back({solver.eigenvectors().col(k), centre});
      for (const auto& [axis, offset_mm] : axes) {
        const int steps = std::max(1, static_cast<int>(std::lround(360 / turn_step_deg)));
        for (int step = 1; step < steps; ++step) {
          Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
          turn.linear() = Eigen::AngleAxisd(2 * std::numbers::pi * step / steps, axis.normalized()).toRotationMatrix();
          turn.translation() = offset_mm - turn.linear() * offset_mm;
          turns.push_back(turn);
        }
      }
      turns.insert(turns.end(), near.discrete.begin(), near.discrete.end());
    }

    static std::vector<Eigen::Vector3f> grid_points(const TriangleMesh& mesh) {
      std::vector<Eigen::Vector3f> points;
      for (const auto& p : even_surface_samples(mesh, 15000)) points.push_back(p.cast<float>());
      if (points.empty()) throw Error("a part without area cannot be seen");
      return points;
    }
  };

  std::vector<AmbiguityPart> parts;
  Intrinsics camera;
  Options options;
  std::vector<Prepared> prepared;
  std::vector<Eigen::Matrix3d> rotations;  ///< all, on a grid of about 16 degrees

  Impl(std::vector<AmbiguityPart> given, const Intrinsics& intrinsics, const Options& o)
      : parts(std::move(given)), camera(intrinsics), options(o) {
    camera.check();
    options.difference.check();
    if (parts.empty()) throw Error("ambiguous views: no parts given");
    if (!(options.min_displacement > 0)) throw Error("min_displacement {}: must be positive", options.min_displacement);
    if (!(options.turn_step_deg >= 1 && options.turn_step_deg <= 180))
      throw Error("turn_step_deg {}: must be 1 to 180", options.turn_step_deg);
    for (const auto& part : parts) prepared.emplace_back(part, options.turn_step_deg);
    constexpr int rolls = 24;
    for (const auto& direction : icosphere_directions(2, true))
      for (int roll = 0; roll < rolls; ++roll)
        rotations.push_back(
            (Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction) *
             Eigen::Quaterniond(Eigen::AngleAxisd(2 * std::numbers::pi * roll / rolls, Eigen::Vector3d::UnitZ())))
                .toRotationMatrix());
  }

  /// What is seen of a part: the points in the camera frame, and the box around them in pixels.
  struct View {
    std::vector<Eigen::Vector3d> points;
    Eigen::AlignedBox2d box_px;
    double nearest_mm = infinity;
  };
  View view_of(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model) const {
    const Intrinsics window = cropped(camera, {{&mesh, camera_from_model}});
    const DepthImage depth = render(mesh, camera_from_model, window).depth;
    View view;
    const auto seen = std::count_if(depth.z_mm.begin(), depth.z_mm.end(), [](float z) { return z > 0; });
    const auto step = std::max<std::ptrdiff_t>(1, seen / 200);
    std::ptrdiff_t index = 0;
    for (int v = 0; v < depth.height; ++v)
      for (int u = 0; u < depth.width; ++u) {
        const float z = depth.at(u, v);
        if (!(z > 0)) continue;
        const Eigen::Vector3d p = window.unproject(u, v, z).cast<double>();
        view.box_px.extend(camera.project(p));
        view.nearest_mm = std::min(view.nearest_mm, p.z());
        if (index++ % step == 0) view.points.push_back(p);
      }
    return view;
  }

  /// Mean distance of the points seen to a part's surface, each at most 10 mm.
  double misfit(const View& view, const Prepared& part, const Eigen::Isometry3d& model_from_camera) const {
    double sum = 0;
    const Eigen::Isometry3f moved = model_from_camera.cast<float>();
    for (const auto& p : view.points) sum += std::min(10.0f, part.grid.at(moved * p.cast<float>()));
    return sum / static_cast<double>(view.points.size());
  }

  /// Poses of a part whose outline is as large as that seen, where it is seen, that fit the points best.
  std::vector<Eigen::Isometry3d> poses_by_outline(const View& view, const Prepared& part) const {
    constexpr std::size_t most = 12;
    const Eigen::Vector2d size = view.box_px.sizes();
    const Eigen::Vector2d tolerance_px = 0.08 * size + Eigen::Vector2d::Constant(4);
    const Eigen::Vector3d ray = camera.unproject(view.box_px.center().x(), view.box_px.center().y(), 1).cast<double>();
    std::vector<std::pair<double, Eigen::Isometry3d>> found;
    // Turned with the line of sight, so that the grid means the same everywhere in the image.
    const Eigen::Matrix3d sight = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray).toRotationMatrix();
    for (const auto& rotation : rotations) {
      const Eigen::Matrix3d turn = sight * rotation;
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = turn;
      double nearest = infinity;
      for (const auto& p : part.extremes) nearest = std::min(nearest, (turn * (p - part.centre)).z());
      pose.translation() = (view.nearest_mm - nearest) * ray - turn * part.centre;
      // Twice: moving the box moves the nearest point along with the perspective.
      Eigen::AlignedBox2d box;
      for (int pass = 0; pass < 2; ++pass) {
        box.setEmpty();
        double z = infinity;
        for (const auto& p : part.extremes) {
          const Eigen::Vector3d moved = pose * p;
          if (moved.z() < 1) return {};
          z = std::min(z, moved.z());
          box.extend(camera.project(moved));
        }
        const Eigen::Vector2d shift = view.box_px.center() - box.center();
        const double depth = (pose * part.centre).z();
        pose.translation() +=
            Eigen::Vector3d(shift.x() / camera.fx * depth, shift.y() / camera.fy * depth, view.nearest_mm - z);
      }
      if (((box.sizes() - size).cwiseAbs() - tolerance_px).maxCoeff() > 0) continue;
      found.emplace_back(misfit(view, part, pose.inverse()), pose);
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Eigen::Isometry3d> poses;
    for (const auto& [score, pose] : found) {
      if (poses.size() == most || score > 5) break;
      if (std::all_of(poses.begin(), poses.end(),
                      [&, &pose = pose](const auto& other) { return rotation_error_deg(pose, other) > 20; }))
        poses.push_back(pose);
    }
    return poses;
  }

  /// MSSD (Hodan et al. 2020) over samples of the surface.
  double displacement_mm(const Prepared& part, const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) const {
    double least = infinity;
    for (const auto& symmetry : part.equivalent) {
      const Eigen::Isometry3d equivalent = b * symmetry;
      double largest = 0;
      for (std::size_t i = 0; i < part.samples.size() && largest < least; i += 4)
        largest = std::max(largest, (a * part.samples[i] - equivalent * part.samples[i]).norm());
      least = std::min(least, largest);
    }
    return least;
  }

  std::vector<AmbiguousPose> at(int seen, const Eigen::Isometry3d& truth) const {
    std::vector<AmbiguousPose> all;
    const View view = view_of(parts[seen].mesh, truth);
    if (view.points.size() < 10) return all;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& p : view.points) middle += p / static_cast<double>(view.points.size());
    const double noise_mm = options.difference.sigma_mm(middle.z(), camera.fx);
    for (int b = 0; b < static_cast<int>(parts.size()); ++b) {
      const Prepared& part = prepared[b];
      const double apart = options.min_displacement * part.diameter_mm;
      std::vector<Eigen::Isometry3d> starts = poses_by_outline(view, part);
      if (b == seen) {
        std::vector<Eigen::Isometry3d> turned;
        for (const auto& turn : part.turns)
          if (misfit(view, part, (truth * turn).inverse()) < 5) turned.push_back(truth * turn);
        starts.insert(starts.begin(), turned.begin(), turned.end());
      }
      std::vector<AmbiguousPose> found;
      for (const auto& start : starts) {
        const Eigen::Isometry3d pose =
            align_to_surface(view.points, part.surface, start.inverse(), noise_mm, middle, 8).inverse();
        const double displacement = b == seen ? displacement_mm(part, pose, truth) : infinity;
        if (displacement < apart) continue;
        if (std::any_of(found.begin(), found.end(), [&](const AmbiguousPose& other) {
              return displacement_mm(part, pose, other.camera_from_model) < apart;
            }))
          continue;
        if (misfit(view, part, pose.inverse()) > part.grid.cell_mm() + 2 * noise_mm) continue;
        const auto difference =
            depth_difference(parts[seen].mesh, truth, parts[b].mesh, pose, camera, options.difference);
        if (difference.indistinguishable(options.difference)) found.push_back({b, pose, difference, displacement});
      }
      std::stable_sort(found.begin(), found.end(), [](const AmbiguousPose& x, const AmbiguousPose& y) {
        return x.difference.share() < y.difference.share();
      });
      if (static_cast<int>(found.size()) > options.most_poses) found.resize(options.most_poses);
      all.insert(all.end(), found.begin(), found.end());
    }
    return all;
  }
};

AmbiguitySearch::AmbiguitySearch(std::vector<AmbiguityPart> parts, const Intrinsics& camera, const Options& options)
    : impl_(std::make_unique<Impl>(std::move(parts), camera, options)) {}
AmbiguitySearch::AmbiguitySearch(std::vector<AmbiguityPart> parts, const Intrinsics& camera)
    : AmbiguitySearch(std::move(parts), camera, Options{}) {}
AmbiguitySearch::~AmbiguitySearch() = default;
AmbiguitySearch::AmbiguitySearch(AmbiguitySearch&&) noexcept = default;

std::vector<AmbiguousPose> AmbiguitySearch::at(int part, const Eigen::Isometry3d& camera_from_model) const {
  if (part < 0 || part >= static_cast<int>(impl_->parts.size()))
    throw Error("ambiguous views: part {} of {}", part, impl_->parts.size());
  return impl_->at(part, camera_from_model);
}
const std::vector<AmbiguityPart>& AmbiguitySearch::parts() const { return impl_->parts; }

}  // namespace partpose
