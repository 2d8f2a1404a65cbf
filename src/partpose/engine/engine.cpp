// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/engine.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/descriptor/crh.hpp"
#include "partpose/engine/comparison.hpp"
#include "partpose/engine/field_refinement.hpp"
#include "partpose/engine/part_model.hpp"
#include "partpose/engine/segment_view.hpp"
#include "partpose/registration/projective_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>

namespace partpose {

namespace {

constexpr int rolls = 24;

/// A part at a pose, with a cost by which hypotheses of one stage are compared: the lower the better.
struct Hypothesis {
  int part = -1, view = -1;
  double cost = 0;
  double template_cost = 0;                                 ///< mean difference of the template's cells, in caps
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  ///< by the template
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
};

/// An object of the frame as the stages see it.
struct Target {
  const Segment* segment = nullptr;
  LabelledDepth coarse, fine;
  std::vector<Eigen::Vector3f> points;  ///< of the coarse object, camera frame
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double noise_mm = 1, local_noise_mm = 1;
  std::vector<Hypothesis> hypotheses;  ///< before the verification, best first
  std::vector<Candidate> candidates;   ///< best first
  double best_score = 0;

  double evidence() const { return std::pow(best_score, 6) * std::sqrt(static_cast<double>(segment->pixels.size())); }
};

std::vector<Eigen::Vector3f> spread(const std::vector<Eigen::Vector3f>& points, int count) {
  std::vector<Eigen::Vector3f> out;
  const double step = std::max(1.0, static_cast<double>(points.size()) / count);
  for (double i = 0.5 * step; i < static_cast<double>(points.size()); i += step)
    out.push_back(points[static_cast<std::size_t>(i)]);
  return out;
}

void sort_by_cost(std::vector<Hypothesis>& hypotheses) {
  std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
}

/// The `count` of lowest cost, and besides them the best `per_part` of each part.
std::vector<Hypothesis> best_of(std::vector<Hypothesis> all, std::size_t count, int per_part) {
  sort_by_cost(all);
  std::map<int, int> taken;
  std::vector<Hypothesis> kept;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (taken[all[i].part]++ < per_part || i < count) kept.push_back(all[i]);
  return kept;
}

class StageTimes {
 public:
  explicit StageTimes(std::vector<MeasuredOperation>& stages) : stages_(stages) {}
  template <typename Body>
  auto operator()(const char* name, const Body& body) {
    struct Add {
      StageTimes& times;
      const char* name;
      Stopwatch watch;
      ~Add() { times.add(name, watch.elapsed_ms()); }
    } const add{*this, name, {}};
    return body();
  }

 private:
  void add(const char* name, double ms) {
    for (auto& stage : stages_)
      if (stage.tag == name) {
        stage.measure_ms += ms;
        return;
      }
    stages_.push_back({ms, name});
  }
  std::vector<MeasuredOperation>& stages_;
};

DepthImage object_depth(const LabelledDepth& frame) {
  DepthImage depth = frame.depth;
  for (std::size_t p = 0; p < depth.z_mm.size(); ++p)
    if (frame.label[p] != PixelLabel::object) depth.z_mm[p] = 0;
  return depth;
}

/// The box of pixels that the object and the part at its pose cover.
LabelledDepth about_part(const LabelledDepth& frame, const TriangleMesh& mesh,
                         const Eigen::Isometry3d& camera_from_model) {
  double u0 = 1e9, u1 = -1e9, v0 = 1e9, v1 = -1e9;
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d corner = camera_from_model * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
    if (corner.z() < 1) return frame;
    const Eigen::Vector2d pixel = frame.camera.project(corner);
    u0 = std::min(u0, pixel.x()), u1 = std::max(u1, pixel.x());
    v0 = std::min(v0, pixel.y()), v1 = std::max(v1, pixel.y());
  }
  for (int v = 0; v < frame.depth.height; ++v)
    for (int u = 0; u < frame.depth.width; ++u)
      if (frame.label[static_cast<std::size_t>(v) * frame.depth.width + u] == PixelLabel::object) {
        u0 = std::min<double>(u0, u), u1 = std::max<double>(u1, u);
        v0 = std::min<double>(v0, v), v1 = std::max<double>(v1, v);
      }
  const auto pixel = [](double x, double most) { return static_cast<int>(std::clamp(x, -2.0, most + 2)); };
  return cropped(frame, pixel(u0 - 2, frame.depth.width), pixel(v0 - 2, frame.depth.height),
                 pixel(u1 + 2, frame.depth.width), pixel(v1 + 2, frame.depth.height));
}

}  // namespace

void EngineOptions::check() const {
  if (!(min_score >= 0 && min_score <= 1)) throw Error("min_score {}: must be 0 to 1", min_score);
}

struct Engine::Impl {
  Catalogue catalogue;
  EngineOptions options;
  std::vector<PartModel> models;
  SegmentationOptions segmentation;

  Target target_of(const DepthImage& depth, const Intrinsics& camera, const Segment& segment) const;
  std::vector<Hypothesis> shortlist(const Target& target) const;
  void refine(std::vector<Hypothesis>& hypotheses, const Target& target, int points, int iterations) const;
  double two_way_cost(const Hypothesis& hypothesis, double forward, const Target& target, double tolerance_mm) const;
  std::vector<Hypothesis> distinct(std::vector<Hypothesis> sorted) const;
  void verify(Target& target) const;
  /// Moves the contenders onto the data; returns the least that a fit leaves, in mm.
  double polish(Target& target) const;
  void decide(Target& target) const;
  std::size_t contenders_of(const Target& target) const;
  SensorModel sensor(const Target& target, int part) const {
    return {.noise_mm = target.noise_mm, .size_mm = models[part].diameter_mm};
  }
  Candidate candidate_of(const Hypothesis& hypothesis, int id) const;
  std::vector<Detection> detections(const std::vector<Target>& targets) const;
  int part_of(const Candidate& candidate) const { return catalogue.views[candidate.view_row].part; }
};

Engine::Engine(Catalogue catalogue, EngineOptions options) : impl_(std::make_unique<Impl>()) {
  options.check();
  impl_->catalogue = std::move(catalogue);
  impl_->options = options;
  const auto& parts = impl_->catalogue.parts;
  std::vector<bool> has_view(parts.size(), false);
  for (const auto& view : impl_->catalogue.views) has_view[view.part] = true;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (!has_view[i]) throw Error("part {}: the catalogue has no view of it", parts[i].name);
  std::vector<std::optional<PartModel>> models(parts.size());
  parallel_for(parts.size(), [&](std::size_t i) { models[i].emplace(parts[i].mesh, diameter(parts[i].mesh)); });
  impl_->segmentation.largest_part_mm = 0;
  impl_->segmentation.smallest_part_mm = std::numeric_limits<float>::infinity();
  for (auto& model : models) {
    const auto size = static_cast<float>(model->diameter_mm);
    impl_->segmentation.largest_part_mm = std::max(impl_->segmentation.largest_part_mm, size);
    impl_->segmentation.smallest_part_mm = std::min(impl_->segmentation.smallest_part_mm, size);
    impl_->models.push_back(std::move(*model));
  }
}

Engine::~Engine() = default;

const Catalogue& Engine::catalogue() const { return impl_->catalogue; }

Recognition Engine::recognize(const Scene& scene) const {
  return scene.depth ? recognize(*scene.depth, *scene.intrinsics) : recognize(scene.cloud);
}

Recognition Engine::recognize(const PointCloud& cloud) const {
  Recognition nothing;
  nothing.result.timestamp = make_timestamp();
  nothing.num_of_points_input = static_cast<int>(cloud.size());
  const PointCloud seen = before_camera(cloud);
  const auto camera = intrinsics_of(seen);
  if (!camera || seen.size() < static_cast<std::size_t>(impl_->segmentation.min_pixels)) {
    nothing.reason = fmt::format(
        "{} of the scene's {} points lie before the camera (x right, y down, z forward), too few "
        "or too near together to recognize anything",
        seen.size(), cloud.size());
    return nothing;
  }
  Recognition recognition = recognize(to_depth_image(seen, *camera), *camera);
  recognition.num_of_points_input = static_cast<int>(cloud.size());
  return recognition;
}

Recognition Engine::recognize(const DepthImage& depth, const Intrinsics& camera) const {
  Recognition r;
  r.result.timestamp = make_timestamp();
  r.num_of_points_input =
      static_cast<int>(std::count_if(depth.z_mm.begin(), depth.z_mm.end(), [](float z) { return z > 0; }));
  StageTimes time(r.stages);
  const auto segments = time("segmentation", [&] {
    return with_pairs(segment(depth, camera, impl_->segmentation), depth, camera, impl_->segmentation.largest_part_mm,
                      4);
  });
  if (segments.empty()) {
    r.reason = "nothing of a part's size stands out from the table or the background";
    float farthest_mm = 0;
    for (const float z : depth.z_mm) farthest_mm = std::max(farthest_mm, z);
    constexpr float nearest_camera_mm = 20;
    if (farthest_mm > 0 && farthest_mm < nearest_camera_mm)
      r.reason += fmt::format("; its farthest point is {:.3g} mm away: is it in metres?", farthest_mm);
    return r;
  }
  std::vector<Target> targets;
  for (const auto& segment : segments) {
    Target target = time("targets", [&] { return impl_->target_of(depth, camera, segment); });
    if (target.points.size() < 30) continue;
    auto hypotheses = time("templates", [&] { return impl_->shortlist(target); });
    time("refine_1", [&] {
      impl_->refine(hypotheses, target, 64, 6);
      hypotheses = best_of(std::move(hypotheses), 24, 2);
    });
    time("refine_2", [&] {
      impl_->refine(hypotheses, target, 192, 8);
      hypotheses = best_of(impl_->distinct(best_of(std::move(hypotheses), 1000, 1)), 6, 1);
      if (hypotheses.size() > 12) hypotheses.resize(12);
    });
    target.hypotheses = std::move(hypotheses);
    if (!target.hypotheses.empty()) targets.push_back(std::move(target));
  }
  // A closer look at the objects that a part explains best.
  constexpr std::size_t most_verified = 6;
  std::stable_sort(targets.begin(), targets.end(),
                   [](const Target& a, const Target& b) { return a.hypotheses[0].cost < b.hypotheses[0].cost; });
  if (targets.size() > most_verified) targets.resize(most_verified);
  time("verify", [&] {
    for (auto& target : targets) impl_->verify(target);
  });
  const auto by_evidence = [](const Target& a, const Target& b) { return a.evidence() > b.evidence(); };
  std::stable_sort(targets.begin(), targets.end(), by_evidence);
  time("decision", [&] {
    // Objects that a part hardly explains need no closer look.
    while (!targets.empty() && targets.back().evidence() < 0.1 * targets.front().evidence()) targets.pop_back();
    // What the likeliest object's best fit leaves is the frame's noise; what others leave beyond that speaks against
    // them. By the square law of triangulation it grows with the distance.
    double noise_per_mm2 = 0;
    for (auto& target : targets) {
      const double left_mm = impl_->polish(target);
      const double z_mm = target.centre.z();
      if (&target == &targets[0] && std::isfinite(left_mm)) noise_per_mm2 = left_mm / (z_mm * z_mm);
      if (noise_per_mm2 > 0) target.noise_mm = std::max(noise_per_mm2 * z_mm * z_mm, target.local_noise_mm);
      impl_->decide(target);
    }
    std::stable_sort(targets.begin(), targets.end(), by_evidence);
  });
  if (targets.empty()) {
    r.reason = "no segment has enough points";
    return r;
  }
  r.detections = impl_->detections(targets);
  r.candidates = std::move(targets[0].candidates);
  const Candidate& best = r.candidates[0];
  if (best.score < impl_->options.min_score) {
    r.reason = fmt::format("the best candidate, {}, scores {:.2f}, below {:.2f}",
                           impl_->catalogue.parts[impl_->part_of(best)].name, best.score, impl_->options.min_score);
  } else {
    r.accepted = 0;
    const std::string timestamp = r.result.timestamp;
    r.result = result_of(best, impl_->catalogue);
    r.result.timestamp = timestamp;
  }
  return r;
}

/// The best candidate of each object, those that share pixels with a likelier one left out.
std::vector<Detection> Engine::Impl::detections(const std::vector<Target>& targets) const {
  std::vector<Detection> out;
  std::vector<int> taken;  // pixels, rising
  for (const auto& target : targets) {
    const Candidate& best = target.candidates[0];
    if (best.score < options.min_score) continue;
    std::vector<int> shared;
    std::set_intersection(taken.begin(), taken.end(), target.segment->pixels.begin(), target.segment->pixels.end(),
                          std::back_inserter(shared));
    if (!shared.empty()) continue;
    std::vector<int> both;
    std::set_union(taken.begin(), taken.end(), target.segment->pixels.begin(), target.segment->pixels.end(),
                   std::back_inserter(both));
    taken = std::move(both);
    out.push_back({part_of(best), best.camera_from_model, best.score});
  }
  return out;
}

Target Engine::Impl::target_of(const DepthImage& depth, const Intrinsics& camera, const Segment& segment) const {
  Target target;
  target.segment = &segment;
  const double margin_mm = 0.5 * segmentation.largest_part_mm;
  target.coarse = neighbourhood(depth, camera, segment, margin_mm, 1200);
  target.fine = neighbourhood(depth, camera, segment, margin_mm, 6000);
  target.points = object_points(target.coarse);
  for (const auto& p : target.points) target.centre += p.cast<double>();
  target.centre /= std::max<double>(static_cast<double>(target.points.size()), 1);
  target.noise_mm = target.local_noise_mm = std::max(local_noise_mm(depth, segment), 0.1);
  return target;
}

std::vector<Hypothesis> Engine::Impl::shortlist(const Target& target) const {
  const Eigen::Matrix3d sight = sight_frame(target.centre);
  std::vector<Eigen::Vector3f> relative;
  for (const auto& p : target.points) relative.push_back((sight * (p.cast<double>() - target.centre)).cast<float>());
  const double spacing_mm = target.centre.norm() / target.coarse.camera.fx;

  std::map<double, std::vector<DepthTemplate>> turned;  // by the cells' size
  for (const auto& model : models) {
    auto& templates = turned[model.scale.cell_mm];
    if (!templates.empty()) continue;
    for (int k = 0; k < rolls; ++k)
      templates.push_back(make_template(relative, 2 * std::numbers::pi * k / rolls, spacing_mm, model.scale));
  }
  std::vector<Hypothesis> best;
  for (int part = 0; part < static_cast<int>(models.size()); ++part) {
    const PartModel& model = models[part];
    const auto& templates = turned.at(model.scale.cell_mm);
    std::vector<std::pair<int, int>> cost_of;  // cost, view * rolls + roll
    for (int view = 0; view < static_cast<int>(model.views.size()); ++view)
      for (int k = 0; k < rolls; ++k)
        cost_of.emplace_back(capped_difference(model.templates[view], templates[k], model.scale.cap), view * rolls + k);
    const std::size_t keep = std::min<std::size_t>(60, cost_of.size());
    std::partial_sort(cost_of.begin(), cost_of.begin() + static_cast<std::ptrdiff_t>(keep), cost_of.end());
    for (std::size_t i = 0; i < keep; ++i) {
      const int view = cost_of[i].second / rolls, k = cost_of[i].second % rolls;
      Hypothesis h;
      h.part = part;
      h.view = view;
      // In mm, so that parts of different size compare: each cell stands for its area.
      h.cost = cost_of[i].first * model.scale.depth_unit_mm * model.scale.cell_mm * model.scale.cell_mm;
      h.template_cost = static_cast<double>(cost_of[i].first) / (model.scale.cap * DepthTemplate::cells);
      const Eigen::AngleAxisd roll_back(-2 * std::numbers::pi * k / rolls, Eigen::Vector3d::UnitZ());
      Eigen::Isometry3d camera_from_sight = Eigen::Isometry3d::Identity();
      camera_from_sight.linear() = sight.transpose() * roll_back.toRotationMatrix();
      camera_from_sight.translation() = target.centre;
      h.start = h.camera_from_model = camera_from_sight * model.views[view].sight_from_model;
      best.push_back(h);
    }
  }
  return best_of(std::move(best), 60, 8);
}

void Engine::Impl::refine(std::vector<Hypothesis>& hypotheses, const Target& target, int points, int iterations) const {
  // One part's after the other's, so that its field stays in the cache.
  std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const auto& a, const auto& b) { return a.part < b.part; });
  const auto probes = spread(target.points, points);
  const Eigen::Vector3f centre = target.centre.cast<float>();
  parallel_for(
      hypotheses.size(),
      [&](std::size_t i) {
        Hypothesis& h = hypotheses[i];
        const PartModel& model = models[h.part];
        const double end_mm = std::max(0.01 * model.diameter_mm, target.noise_mm);
        const auto refined = refine_on_field(model.field, h.camera_from_model, probes, centre,
                                             {.start_scale_mm = std::max(0.06 * model.diameter_mm, end_mm),
                                              .end_scale_mm = end_mm,
                                              .max_iterations = iterations});
        h.camera_from_model = refined.camera_from_model;
        h.cost = two_way_cost(h, refined.mean_capped / 3, target, 3 * end_mm);
      },
      4);
}

double Engine::Impl::two_way_cost(const Hypothesis& hypothesis, double forward, const Target& target,
                                  double tolerance_mm) const {
  const LabelledDepth& frame = target.coarse;
  const Eigen::Isometry3f camera_from_model = hypothesis.camera_from_model.cast<float>();
  const auto& visible = models[hypothesis.part].views[hypothesis.view].visible_mm;
  double reverse = 0;
  for (const auto& p : visible) {
    const Eigen::Vector3f q = camera_from_model * p;
    if (!(q.z() > 1)) return 10;
    const int u = static_cast<int>(std::lround(frame.camera.fx * q.x() / q.z() + frame.camera.cx));
    const int v = static_cast<int>(std::lround(frame.camera.fy * q.y() / q.z() + frame.camera.cy));
    if (u < 0 || v < 0 || u >= frame.depth.width || v >= frame.depth.height) {
      reverse += 0.4;
      continue;
    }
    const double before_mm = frame.depth.at(u, v) - q.z();
    switch (frame.label[static_cast<std::size_t>(v) * frame.depth.width + u]) {
      case PixelLabel::object:
        reverse += std::min(std::abs(before_mm) / tolerance_mm, 1.0);
        break;
      case PixelLabel::background:
        reverse += before_mm > tolerance_mm ? 1.0 : 0.4;
        break;
      case PixelLabel::nothing:
        reverse += 0.5;
        break;
    }
  }
  return forward + reverse / static_cast<double>(std::max<std::size_t>(visible.size(), 1));
}

std::vector<Hypothesis> Engine::Impl::distinct(std::vector<Hypothesis> sorted) const {
  std::vector<Hypothesis> kept;
  for (const auto& h : sorted) {
    const double size_mm = models[h.part].diameter_mm;
    const Eigen::Vector3d middle = bounding_box(catalogue.parts[h.part].mesh).center();
    const bool seen = std::any_of(kept.begin(), kept.end(), [&](const Hypothesis& k) {
      return k.part == h.part &&
             (k.camera_from_model * middle - h.camera_from_model * middle).norm() < 0.05 * size_mm &&
             rotation_error_deg(k.camera_from_model, h.camera_from_model) < 8;
    });
    if (!seen) kept.push_back(h);
  }
  return kept;
}

Candidate Engine::Impl::candidate_of(const Hypothesis& h, int id) const {
  Candidate candidate;
  candidate.id = id;
  candidate.match_distance = static_cast<float>(h.template_cost);
  // The catalogue's view from the nearest side.
  double nearest = -2;
  const Eigen::Vector3d middle = bounding_box(catalogue.parts[h.part].mesh).center();
  const Eigen::Vector3d side =
      (h.camera_from_model.linear().transpose() * -(h.camera_from_model * middle)).normalized();
  for (int row = 0; row < static_cast<int>(catalogue.views.size()); ++row) {
    if (catalogue.views[row].part != h.part) continue;
    const Eigen::Isometry3d view = catalogue.views[row].T2 * catalogue.parts[h.part].T1;
    const double cosine = (view.linear().transpose() * -(view * middle)).normalized().dot(side);
    if (cosine > nearest) nearest = cosine, candidate.view_row = row;
  }
  const auto& view = catalogue.views[candidate.view_row];
  const Eigen::Isometry3d view_from_model = view.T2 * catalogue.parts[h.part].T1;
  candidate.T3 = h.start * view_from_model.inverse();
  candidate.T4 = h.camera_from_model * h.start.inverse();
  candidate.camera_from_model = h.camera_from_model;
  return candidate;
}

void Engine::Impl::verify(Target& target) const {
  std::vector<Hypothesis> hypotheses = std::move(target.hypotheses);
  const auto probes = spread(target.points, 200);
  const Eigen::Vector3f centre = target.centre.cast<float>();
  // All object pixels onto the surface; what is left of the best is the noise, with the slow waves in it.
  std::vector<double> rms(hypotheses.size());
  const auto settle = [&](Hypothesis& h) {
    const PartModel& model = models[h.part];
    const double end_mm = std::max(0.005 * model.diameter_mm, target.noise_mm);
    FieldRefinementOptions settling{.start_scale_mm = std::max(0.02 * model.diameter_mm, target.noise_mm),
                                    .end_scale_mm = end_mm,
                                    .max_iterations = 6};
    h.camera_from_model = refine_on_field(model.field, h.camera_from_model, probes, centre, settling).camera_from_model;
    settling = {.start_scale_mm = end_mm, .end_scale_mm = end_mm, .max_iterations = 2};
    const auto refined = refine_on_field(model.field, h.camera_from_model, target.points, centre, settling);
    h.camera_from_model = refined.camera_from_model;
    return refined.rms_mm;
  };
  parallel_for(hypotheses.size(), [&](std::size_t i) { rms[i] = settle(hypotheses[i]); });
  double best_rms = std::numeric_limits<double>::infinity();
  for (const double value : rms) best_rms = std::min(best_rms, value);
  if (!hypotheses.empty())
    target.noise_mm = std::max(target.noise_mm, std::min(best_rms, 0.01 * models[hypotheses[0].part].diameter_mm));

  const auto compare = [&](const Hypothesis& h) {
    const TriangleMesh& mesh = catalogue.parts[h.part].mesh;
    return compare_depth(mesh, h.camera_from_model, about_part(target.coarse, mesh, h.camera_from_model),
                         sensor(target, h.part));
  };
  parallel_for(hypotheses.size(), [&](std::size_t i) { hypotheses[i].cost = -compare(hypotheses[i]).score(); });
  sort_by_cost(hypotheses);
  // What nearly puts the part back onto itself, of the best few.
  std::vector<Hypothesis> more;
  for (std::size_t i = 0; i < std::min<std::size_t>(hypotheses.size(), 3); ++i)
    for (const auto& partner : models[hypotheses[i].part].partners) {
      more.push_back(hypotheses[i]);
      more.back().camera_from_model = hypotheses[i].camera_from_model * partner;
    }
  parallel_for(more.size(), [&](std::size_t i) {
    // Far from fitting, it need not be rendered.
    more[i].cost = settle(more[i]) < 3 * target.noise_mm ? -compare(more[i]).score() : 0;
  });
  hypotheses.insert(hypotheses.end(), more.begin(), more.end());
  sort_by_cost(hypotheses);
  hypotheses = distinct(std::move(hypotheses));
  if (hypotheses.size() > 8) hypotheses.resize(8);
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    target.candidates.push_back(candidate_of(hypotheses[i], static_cast<int>(i)));
    target.candidates.back().score = static_cast<float>(-hypotheses[i].cost);
  }
  target.best_score = target.candidates.empty() ? 0 : target.candidates[0].score;
}

std::size_t Engine::Impl::contenders_of(const Target& target) const {
  constexpr float share = 0.85f;
  std::size_t contenders = 0;
  while (contenders < std::min<std::size_t>(target.candidates.size(), 4) &&
         target.candidates[contenders].score >= share * target.candidates[0].score)
    ++contenders;
  return contenders;
}

double Engine::Impl::polish(Target& target) const {
  auto& candidates = target.candidates;
  const std::size_t contenders = contenders_of(target);
  std::vector<double> rms(contenders);
  parallel_for(contenders, [&](std::size_t i) {
    Candidate& candidate = candidates[i];
    const TriangleMesh& mesh = catalogue.parts[part_of(candidate)].mesh;
    const LabelledDepth frame = about_part(target.fine, mesh, candidate.camera_from_model);
    const auto refined =
        refine_projectively(mesh, candidate.camera_from_model, object_depth(frame), frame.camera,
                            {.gate_mm = static_cast<float>(std::max(6 * target.noise_mm, 2.0)), .max_iterations = 3});
    candidate.T4 = refined.camera_from_model * candidate.camera_from_model.inverse() * candidate.T4;
    candidate.camera_from_model = refined.camera_from_model;
    candidate.icp_converged = std::isfinite(refined.rms_mm);
    candidate.icp_fitness = candidate.icp_converged ? static_cast<float>(refined.rms_mm) : -1;
    rms[i] = refined.rms_mm;
  });
  double noise_mm = std::numeric_limits<double>::infinity();
  for (const double value : rms) noise_mm = std::min(noise_mm, value);
  return noise_mm;
}

void Engine::Impl::decide(Target& target) const {
  auto& candidates = target.candidates;
  const std::size_t contenders = contenders_of(target);
  std::vector<DepthComparison> comparison(contenders);
  parallel_for(contenders, [&](std::size_t i) {
    const int part = part_of(candidates[i]);
    const TriangleMesh& mesh = catalogue.parts[part].mesh;
    comparison[i] = compare_depth(mesh, candidates[i].camera_from_model,
                                  about_part(target.fine, mesh, candidates[i].camera_from_model), sensor(target, part));
    candidates[i].score = static_cast<float>(comparison[i].score());
  });
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < contenders; ++i) order.emplace_back(-comparison[i].log_likelihood, i);
  std::sort(order.begin(), order.end());
  std::vector<Candidate> decided;
  for (const auto& [negative, i] : order) decided.push_back(candidates[i]);
  decided.insert(decided.end(), candidates.begin() + static_cast<std::ptrdiff_t>(contenders), candidates.end());
  candidates = std::move(decided);
  target.best_score = candidates[0].score;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i].verified = true;
    candidates[i].verification.accepted = i == 0 && candidates[i].score >= options.min_score;
    candidates[i].verification.reason =
        candidates[i].score < options.min_score
            ? fmt::format("scores {:.2f}, below {:.2f}", candidates[i].score, options.min_score)
            : fmt::format("scores {:.2f}, but is less likely than another", candidates[i].score);
  }
}

}  // namespace partpose
