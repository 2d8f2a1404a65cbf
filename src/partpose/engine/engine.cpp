// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/engine.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/median.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/engine/anchored_search.hpp"
#include "partpose/engine/comparison.hpp"
#include "partpose/engine/frame_pieces.hpp"
#include "partpose/engine/hypothesis.hpp"
#include "partpose/engine/part_model.hpp"
#include "partpose/engine/part_outline.hpp"
#include "partpose/engine/separation.hpp"
#include "partpose/engine/verdict.hpp"
#include "partpose/pipeline/stage_times.hpp"
#include "partpose/preprocess/segmentation.hpp"
#include "partpose/registration/projective_refinement.hpp"

#include <Eigen/Eigenvalues>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>

namespace partpose {

namespace {

/// An object of the frame on its way through the stages.
struct Target {
  ObjectView view;
  double noise_mm;                        ///< of the depths about a part that fits: slow waves are in it
  double extent_mm = 0;                   ///< about the diameter of what is seen
  double relief_mm = 0;                   ///< standard deviation of what is seen from its best plane
  double local_noise_mm;                  ///< of the depths from pixel to pixel
  std::vector<Candidate> candidates;      ///< best first
  std::vector<double> log_likelihoods;    ///< of the candidates, of the coarse comparison
  double best_score = 0;                  ///< probability_of_part of the best
  double unexplained_px = 0;              ///< by the best
  Detection detection;                    ///< of the best candidate
  std::set<int> heard;                    ///< parts whose hypotheses were refined
  bool partly_hidden = false;             ///< by something nearer
  int fine_pixels = 2500;                 ///< that are looked at when it is polished and decided
  bool polished = false;                  ///< whether the contenders lie as near to the data as they get
  FrameWindow fine;                       ///< about the contenders
  std::vector<ProjectiveRefinement> fit;  ///< of the contenders

  Target(const FramePieces& frame, const FrameObject& object)
      : view(frame, object),
        noise_mm(view.noise_mm),
        local_noise_mm(view.local_noise_mm > 0 ? std::max(view.local_noise_mm, 0.05) : view.noise_mm) {
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& p : view.points.points_mm) {
      const Eigen::Vector3d arm = p.cast<double>() - view.all.centre_mm();
      spread += arm * arm.transpose();
    }
    spread /= std::max<double>(static_cast<double>(view.points.points_mm.size()), 1);
    extent_mm = 3 * std::sqrt(spread.trace());
    relief_mm = std::sqrt(std::max(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues()[0], 0.0));
  }
  /// By which the frame's objects compete: how sure (odds) and how large. What hides a part may be the larger one.
  double evidence() const {
    constexpr double never_sure = 0.02;
    return best_score / (1 + never_sure - best_score) * std::sqrt(static_cast<double>(view.object->pixels));
  }
  /// By which several parts compete with one that is all of them: how much they explain.
  double explained() const { return best_score * std::sqrt(static_cast<double>(view.object->pixels)); }
  /// Whether a closer look may find better. Of what is partly hidden a wrong pose explains much.
  bool is_weak() const { return best_score < (partly_hidden ? weak_when_hidden : weak); }
  /// Whether another part or pose is so likely that more pixels may tell.
  bool has_rivals() const {
    constexpr double clear = 0.9;
    return detection.confidence < clear * detection.score;
  }
  static constexpr double weak = 0.65, weak_when_hidden = 0.8;
  static constexpr double strong = 0.85;  ///< with such a score its pieces are nothing else
  DepthNoise noise() const { return {std::min(local_noise_mm, noise_mm), noise_mm}; }
  /// What the best fit leaves, in mm.
  double left_mm() const {
    double least_mm = std::numeric_limits<double>::infinity();
    for (const auto& refined : fit) least_mm = std::min(least_mm, refined.rms_mm);
    return least_mm;
  }
};

/// What the best fits leave is the frame's noise; what others leave beyond that speaks against them. By the square law
/// of triangulation it grows with the distance: over its square. Of the likeliest first; the median of the sure ones.
double noise_left(const std::vector<Target>& targets) {
  std::vector<double> left_per_mm2;
  for (const auto& target : targets) {
    const double left_mm = target.left_mm(), z_mm = target.view.all.centre_mm().z();
    const bool counts = &target == &targets[0] || target.best_score > Target::strong;
    if (counts && std::isfinite(left_mm)) left_per_mm2.push_back(left_mm / (z_mm * z_mm));
  }
  return left_per_mm2.empty() ? 0 : upper_median(std::move(left_per_mm2));
}

/// A frame no larger than a part may be one: then its pieces are the part's, and nothing else is in it.
bool may_be_one_part(const FramePieces& frame) {
  return std::any_of(frame.objects.begin(), frame.objects.end(), [](const FrameObject& o) { return o.whole_frame; });
}

/// Labels of the frame's pieces that a part explains, well or not.
struct ExplainedLabels {
  std::bitset<256> well, weakly;
};

DepthImage object_depth(const LabelledDepth& frame) {
  DepthImage depth = frame.depth;
  for (std::size_t p = 0; p < depth.z_mm.size(); ++p)
    if (frame.label[p] != PixelLabel::object) depth.z_mm[p] = 0;
  return depth;
}

/// So that about `wanted` of the object's pixels are looked at.
int stride_for(const ObjectView& view, int wanted) {
  return std::max(1, static_cast<int>(std::lround(std::sqrt(view.object->pixels / double(wanted)))));
}

/// Where a part is seen however it is turned about its middle, in pixels.
Eigen::AlignedBox2d covered_at_any_turn(const Intrinsics& camera, const PartModel& model,
                                        const Eigen::Isometry3d& camera_from_model) {
  const Eigen::Vector3d middle = camera_from_model * model.middle_mm;
  const double radius_mm = 0.5 * model.box_mm.diagonal().norm();
  if (middle.z() - radius_mm < 1) return model.covered(camera, camera_from_model);
  const Eigen::Vector2d reach = Eigen::Vector2d(camera.fx, camera.fy) * (radius_mm / (middle.z() - radius_mm));
  const Eigen::Vector2d pixel = camera.project(middle);
  return {pixel - reach, pixel + reach};
}

/// The object's and the other pixels, about `wanted` of them the object's.
FrameWindow window_about(const ObjectView& view, Eigen::AlignedBox2d pixels, int wanted) {
  const Intrinsics& camera = view.frame->camera;
  pixels.extend(Eigen::Vector2d(view.object->u0, view.object->v0));
  pixels.extend(Eigen::Vector2d(view.object->u1, view.object->v1));
  const int stride = stride_for(view, wanted);
  // Beyond the frame nothing is known; some pixels of that will do.
  const auto pixel = [&](double x, double most) { return static_cast<int>(std::clamp(x, -40.0, most + 40)); };
  return window(*view.frame, *view.object, pixel(pixels.min().x() - 2 * stride, camera.width),
                pixel(pixels.min().y() - 2 * stride, camera.height), pixel(pixels.max().x() + 2 * stride, camera.width),
                pixel(pixels.max().y() + 2 * stride, camera.height), stride);
}

constexpr double hopeless = 0.02;                         ///< such a score of the coarse comparison becomes no good one
constexpr std::size_t few_parts = 32;                     ///< so many can be looked at closely
constexpr int coarse_pixels = 800, most_pixels = 10'000;  ///< at first, and where there are rivals
constexpr std::size_t most_contenders = 6;

/// So much less likely than the best, by the coarse comparison, a closer look may still put first.
double contender_margin(double best_log_likelihood) { return 0.15 * std::abs(best_log_likelihood) + 30; }

/// Of those in order the contenders first, so that every part among them is heard before any is a third time.
std::vector<Hypothesis> contenders_first(std::vector<Hypothesis> sorted) {
  std::map<int, int> of_part;
  std::vector<Hypothesis> first, rest;
  for (auto& h : sorted) {
    const bool contends = h.cost < sorted[0].cost + contender_margin(sorted[0].cost);
    const bool heard = contends && ++of_part[h.part] <= 2 && first.size() < most_contenders;
    (heard ? first : rest).push_back(h);
  }
  first.insert(first.end(), std::make_move_iterator(rest.begin()), std::make_move_iterator(rest.end()));
  return first;
}

}  // namespace

void EngineOptions::check() const {
  if (!(min_score >= 0 && min_score <= 1)) throw Error("min_score {}: must be 0 to 1", min_score);
}

struct Engine::Impl {
  Catalogue catalogue;
  EngineOptions options;
  std::vector<std::shared_ptr<const PartModel>> models;
  std::vector<const PartModel*> model_of;  ///< the same
  FramePiecesOptions pieces;
  double smallest_view_mm2 = 0;  ///< what is seen of the smallest part, from its median side

  void models_changed();
  /// Finds the parts and poses that explain the object best, and polishes them where they are in doubt.
  void examine(Target& target, const ShortlistOptions& options, StageTimes& time) const;
  /// The same from given starts. `one_part`: as of `verify`.
  void examine(Target& target, std::vector<Hypothesis> starts, bool one_part, StageTimes& time) const;
  /// The frame's objects that may be parts, but for pieces of what is explained as a whole.
  std::vector<Target> examine_all(const FramePieces& frame, ExplainedLabels& labels, StageTimes& time) const;
  /// Polishes and decides where the coarse comparison is in doubt, not above `strong`: a pose that is still a little
  /// off explains little.
  void reconsider(Target& target, double strong, StageTimes& time) const;
  /// Looks more closely at what is weakly explained. The parts that it finds become targets, which refer to them.
  std::vector<SeparatedPart> search_closely(std::vector<Target>& targets, FramePieces& frame, ExplainedLabels& labels,
                                            StageTimes& time) const;
  /// What lies beside a part and is none may be all that speaks against it: the candidates of what is weakly explained
  /// that are sure where nothing but their own pixels counts. They become targets, which refer to them.
  std::vector<SeparatedPart> look_at_own_pixels(std::vector<Target>& targets, FramePieces& frame,
                                                ExplainedLabels& labels, StageTimes& time) const;
  /// Of parts found one by one in what is weakly explained.
  std::vector<Target> targets_of(const FramePieces& frame, const std::vector<SeparatedPart>& parts,
                                 StageTimes& time) const;
  /// Adds them to the targets, and drops those of the same pixels that explain less than they.
  void add_separated(std::vector<Target>& targets, std::vector<Target> separated) const;
  /// Whether a closer look may find a part, or another one. `beside_another`: of which the part is known.
  bool is_worth_a_search(const Target& target, bool beside_another) const;
  /// Pixels that the smallest part shows where the target is, when three quarters of it are hidden.
  double least_part_px(const Target& target) const;
  bool shows_enough(const Target& target) const { return target.view.object->pixels >= least_part_px(target); }
  /// Whether the best leaves as much of its object in one piece as a part shows.
  bool leaves_a_part(const Target& target) const;
  /// The models for a search that looks at every part; of a large catalogue only those heard, null for the others.
  std::vector<const PartModel*> models_to_search(const std::set<int>& heard) const;
  /// `one_part`: all of the object's points are expected on one part, so that what leaves more of them than another
  /// hypothesis need not be rendered.
  void verify(Target& target, std::vector<Hypothesis> hypotheses, bool one_part) const;
  /// Moves the contenders onto the data.
  void polish(Target& target) const;
  void decide(Target& target) const;
  /// Where each pixel errs for itself, all of them tell where the part is: moves the best candidate onto all.
  void finish(Target& target) const;
  /// `stride`: of the window's pixels.
  ProjectiveRefinement move_onto(const DepthImage& depth, const Target& target, const FrameWindow& window, int stride,
                                 int iterations, Candidate& candidate) const;
  /// Of the best candidate's pose. `stride`: of the pixels that it was fitted to.
  Matrix6d covariance_of(const Target& target, const ProjectiveRefinement& fit, int stride) const;
  void describe(Target& target, const std::vector<std::pair<double, std::size_t>>& order) const;
  std::size_t contenders_of(const Target& target) const;
  /// For a comparison of every `stride`-th pixel.
  SensorModel sensor(const Target& target, int stride) const {
    const double z_mm = target.view.all.centre_mm().z();
    return {.noise_mm = target.noise_mm,
            .outline_px = (outline_px + stride - 1) / stride,
            .growth_px = target.view.frame->foreground_growth_px / stride,
            .edge_mm = target.view.frame->edge_mm(z_mm),
            .size_mm = target.extent_mm};
  }
  PartInFrame in_frame(const Target& target, int part, const Eigen::Isometry3d& camera_from_model) const {
    PartInFrame out{.noise_mm = target.noise_mm,
                    .local_noise_mm = target.local_noise_mm,
                    .relief_mm = target.relief_mm,
                    .extent_mm = target.extent_mm,
                    .diameter_mm = models[part]->diameter_mm,
                    .height_mm = {}};
    if (!target.view.object->whole_frame)
      out.height_mm = height_above_table_mm(*target.view.frame, *models[part], camera_from_model);
    return out;
  }
  Candidate candidate_of(const Hypothesis& hypothesis, int id) const;
  Hypothesis hypothesis_of(const Candidate& candidate) const;
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
  impl_->models.resize(parts.size());
  parallel_for(parts.size(),
               [&](std::size_t i) { impl_->models[i] = std::make_shared<const PartModel>(parts[i].mesh); });
  impl_->models_changed();
#ifdef __GLIBC__
  malloc_trim(0);  // what the making needed is as much as the models themselves
#endif
}

Engine::Engine(const std::vector<NamedMesh>& parts, EngineOptions options) : Engine(mesh_catalogue(parts), options) {}

Engine::~Engine() = default;

void Engine::Impl::models_changed() {
  model_of.clear();
  pieces.largest_part_mm = 0;
  pieces.smallest_part_mm = std::numeric_limits<float>::infinity();
  smallest_view_mm2 = std::numeric_limits<double>::infinity();
  for (const auto& model : models) {
    const auto size = static_cast<float>(model->diameter_mm);
    pieces.largest_part_mm = std::max(pieces.largest_part_mm, size);
    pieces.smallest_part_mm = std::min(pieces.smallest_part_mm, size);
    model_of.push_back(model.get());
    std::vector<float> seen_mm2;
    for (const auto& view : model->views) seen_mm2.push_back(view.seen_mm2);
    if (!seen_mm2.empty()) smallest_view_mm2 = std::min<double>(smallest_view_mm2, upper_median(std::move(seen_mm2)));
  }
}

void Engine::add(const NamedMesh& part) {
  Catalogue& catalogue = impl_->catalogue;
  int id = 1;
  for (const auto& other : catalogue.parts) {
    if (other.name == part.name) throw Error("part {}: the catalogue has one of that name", part.name);
    id = std::max(id, other.id + 1);
  }
  auto model = std::make_shared<const PartModel>(part.mesh);
  Catalogue one = mesh_catalogue({part});
  one.parts[0].id = id;
  one.views[0].part = static_cast<int>(catalogue.parts.size());
  catalogue.parts.push_back(std::move(one.parts[0]));
  catalogue.views.push_back(std::move(one.views[0]));
  impl_->models.push_back(std::move(model));
  impl_->models_changed();
}

void Engine::remove(const std::string& name) {
  Catalogue without = without_part(impl_->catalogue, name);
  const auto& parts = impl_->catalogue.parts;
  const auto gone = std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.name == name; });
  impl_->models.erase(impl_->models.begin() + (gone - parts.begin()));
  impl_->catalogue = std::move(without);
  impl_->models_changed();
}

std::size_t Engine::memory_bytes(int part) const { return impl_->models.at(part)->memory_bytes(); }

Catalogue mesh_catalogue(const std::vector<NamedMesh>& parts) {
  Catalogue catalogue;
  for (const auto& [name, mesh, file, unit] : parts) {
    CataloguePart part;
    part.id = static_cast<int>(catalogue.parts.size()) + 1;
    part.name = name;
    part.mesh = mesh;
    part.T1 = centred_from_model(mesh);
    CatalogueView view;
    view.part = static_cast<int>(catalogue.parts.size());
    view.T2.translation() = Eigen::Vector3d(0, 0, 5 * bounding_box_diagonal(mesh));
    DatasetModel model;
    model.T1 = part.T1;
    model.id = part.id;
    model.name = name;
    catalogue.dataset.out.models.push_back(std::move(model));
    catalogue.parts.push_back(std::move(part));
    catalogue.views.push_back(std::move(view));
  }
  return catalogue;
}

const Catalogue& Engine::catalogue() const { return impl_->catalogue; }

Recognition Engine::recognize(const Scene& scene) const {
  return scene.depth ? recognize(*scene.depth, *scene.intrinsics) : recognize(scene.cloud);
}

Recognition Engine::recognize(const PointCloud& cloud) const {
  Recognition nothing;
  nothing.result.timestamp = make_timestamp();
  nothing.num_of_points_input = static_cast<int>(cloud.size());
  const PointCloud seen = before_camera(cloud);
  // Of a cloud that was thinned so much that its pixels hardly touch, as by a voxel grid, a coarser camera sees more.
  constexpr double least_touching = 0.45;
  auto camera = pixel_grid_of(seen);
  if (!camera || share_of_neighbours(to_depth_image(seen, *camera)) < least_touching) camera = intrinsics_of(seen);
  if (!camera || seen.size() < static_cast<std::size_t>(impl_->pieces.min_pixels)) {
    nothing.reason = fmt::format(
        "{} of the scene's {} points lie before the camera (x right, y down, z forward), too few "
        "or too near together to recognize anything",
        seen.size(), cloud.size());
    return nothing;
  }
  const DepthImage depth = to_depth_image(seen, *camera);
  Recognition recognition = recognize(depth, *camera);
  recognition.num_of_points_input = static_cast<int>(cloud.size());
  if (recognition.accepted < 0) recognition.reason += hint_of_thinning(depth);
  return recognition;
}

void Engine::Impl::examine(Target& target, const ShortlistOptions& options, StageTimes& time) const {
  examine(target, time("templates", [&] { return shortlist(model_of, target.view, options); }), !options.look_behind,
          time);
}

void Engine::Impl::examine(Target& target, std::vector<Hypothesis> hypotheses, bool one_part, StageTimes& time) const {
  if (hypotheses.empty()) return;
  // Among many parts those that sink into the table would leave no room for others.
  const auto drop_impossible = [&](double share) {
    if (models.size() > few_parts) drop_sunk(hypotheses, model_of, target.view, share);
  };
  time("refine_1", [&] {
    refine(hypotheses, model_of, target.view, target.view.few, 6);
    drop_impossible(0.08);
    std::size_t kept = std::max<std::size_t>(24, hypotheses.size() / 4);
    if (models.size() > few_parts)  // the right one may have many before it
      kept = std::max(kept, static_cast<std::size_t>(9 * std::sqrt(static_cast<double>(models.size()))));
    hypotheses = best_of(std::move(hypotheses), kept, 2);
  });
  std::set<int> promising;  // half of what can be looked at closely: an object may be examined twice
  for (auto h = hypotheses.begin(); h != hypotheses.end() && promising.size() < few_parts / 2; ++h)
    promising.insert(h->part);
  target.heard.insert(promising.begin(), promising.end());
  time("refine_2", [&] {
    refine(hypotheses, model_of, target.view, target.view.many, 8);
    drop_impossible(0.05);
    const std::size_t kept = std::max<std::size_t>(6, hypotheses.size() / 5);
    hypotheses = best_of(distinct(std::move(hypotheses), model_of), kept, 1);
    if (hypotheses.size() > 2 * kept) hypotheses.resize(2 * kept);
  });
  time("verify", [&] { verify(target, std::move(hypotheses), one_part); });
  reconsider(target, Target::strong, time);
}

void Engine::Impl::reconsider(Target& target, double strong, StageTimes& time) const {
  if (target.best_score > strong || target.best_score < hopeless || target.polished) return;
  time("polish", [&] { polish(target); });
  time("decision", [&] { decide(target); });
}

std::vector<Target> Engine::Impl::examine_all(const FramePieces& frame, ExplainedLabels& labels,
                                              StageTimes& time) const {
  std::vector<Target> targets;
  for (const auto& object : frame.objects) {
    if ((object.labels & ~labels.well).none()) continue;
    if (object.larger_than_a_part) {
      labels.weakly |= object.labels;
      continue;
    }
    Target target = time("points", [&] { return Target(frame, object); });
    if (target.view.points.points_mm.size() < 30) continue;
    constexpr double blurred_share = 0.08;  // noise beyond it hides what any part looks like
    if (target.view.noise_mm > blurred_share * pieces.largest_part_mm) continue;
    examine(target, {}, time);
    // Among many parts what is like the object may not be what it is.
    if (models.size() > few_parts && target.best_score < Target::weak_when_hidden)
      examine(target, {.every_part = true}, time);
    if (target.is_weak())
      examine(target, time("at_rest", [&] { return at_rest(models_to_search(target.heard), target.view); }), true,
              time);
    target.partly_hidden = is_partly_hidden(target.view);
    // However sure it is: a wrong pose may explain all that shows.
    if (target.partly_hidden) examine(target, {.look_behind = true}, time);
    // A part may be explained well with a piece of another one.
    constexpr double strong_with_others = 0.95;
    const bool of_several = object.labels.count() > 1 && !object.whole_frame;
    const double strong = of_several ? strong_with_others : Target::strong;
    reconsider(target, strong, time);
    if (target.best_score > strong) labels.well |= object.labels;
    targets.push_back(std::move(target));
  }
  return targets;
}

std::vector<SeparatedPart> Engine::Impl::search_closely(std::vector<Target>& targets, FramePieces& frame,
                                                        ExplainedLabels& labels, StageTimes& time) const {
  for (auto& target : targets) {
    const FrameObject& object = *target.view.object;
    if (may_be_one_part(frame)) continue;
    // However sure it is, as where it is looked behind; beside other parts such starts reach over these.
    const bool alone_and_hidden = target.partly_hidden && shows_enough(target) && (labels.well & ~object.labels).none();
    if (!alone_and_hidden && (!is_worth_a_search(target, labels.well.any()) || (object.labels & labels.well).any()))
      continue;
    if (frame.shadow_of.empty()) time("anchored", [&] { find_shadows(frame); });
    auto hypotheses =
        time("anchored", [&] { return anchored_hypotheses(models_to_search(target.heard), frame, object); });
    time("verify", [&] { verify(target, std::move(hypotheses), false); });
    target.polished = false;  // with the shadows it may look different
    reconsider(target, Target::strong, time);
    if (target.is_weak()) labels.weakly |= object.labels;
    if (target.best_score > Target::strong) labels.well |= object.labels;
  }
  for (const auto& target : targets) {
    if (target.best_score < Target::weak || may_be_one_part(frame) || !leaves_a_part(target)) continue;
    labels.weakly |= target.view.object->labels;
    labels.well &= ~target.view.object->labels;
  }
  // Beside what is weakly explained what is in doubt may have pixels of another part.
  std::set<int> heard;
  std::vector<KnownPart> known;
  if ((labels.weakly & ~labels.well).any()) {
    for (const auto& target : targets)
      if (target.best_score < Target::strong && shows_enough(target)) labels.weakly |= target.view.object->labels;
    for (const auto& target : targets) {
      const FrameObject& object = *target.view.object;
      if ((object.labels & labels.weakly).any()) heard.insert(target.heard.begin(), target.heard.end());
      if (target.best_score > Target::strong) {
        known.push_back({hypothesis_of(target.candidates[0]), object.labels});
        heard.insert(known.back().hypothesis.part);
      }
    }
  }
  std::erase_if(targets, [](const Target& target) { return target.candidates.empty(); });
  const std::bitset<256> unexplained = labels.weakly & ~labels.well;
  if (unexplained.none() || may_be_one_part(frame)) return {};
  if (frame.shadow_of.empty()) time("separation", [&] { find_shadows(frame); });
  std::vector<SeparatedPart> parts =
      time("separation", [&] { return separate(models_to_search(heard), frame, unexplained, known); });
  add_separated(targets, targets_of(frame, parts, time));
  return parts;
}

std::vector<SeparatedPart> Engine::Impl::look_at_own_pixels(std::vector<Target>& targets, FramePieces& frame,
                                                            ExplainedLabels& labels, StageTimes& time) const {
  constexpr std::size_t most_of_each = 3;
  if (may_be_one_part(frame)) return {};
  std::bitset<256> weak;
  std::vector<Hypothesis> known;
  for (const auto& target : targets) {
    const auto& candidates = target.candidates;
    if (candidates.empty() || !is_worth_a_search(target, labels.well.any()) ||
        (target.view.object->labels & labels.well).any())
      continue;
    weak |= target.view.object->labels;
    for (std::size_t i = 0; i < std::min(candidates.size(), most_of_each); ++i)
      known.push_back(hypothesis_of(candidates[i]));
  }
  if (known.empty()) return {};
  const auto label = frame.label;
  const auto objects = frame.objects;
  std::vector<SeparatedPart> parts =
      time("separation", [&] { return separate_known(model_of, frame, weak & ~labels.well, known); });
  std::vector<Target> found = targets_of(frame, parts, time);
  // What is left is too little to be another part.
  constexpr double most_left = 0.35;  // of the pixels found
  const std::bitset<256> left = weak & ~labels.well;
  double found_pixels = 0;
  for (const auto& target : found) found_pixels += target.view.object->pixels;
  const auto left_pixels =
      std::count_if(frame.label.begin(), frame.label.end(), [&](std::uint8_t l) { return left.test(l); });
  const bool is_all = !found.empty() && static_cast<double>(left_pixels) < most_left * found_pixels &&
                      largest_left_px(frame, left, nullptr, {}, 0) <= least_part_px(found[0]);
  if (!is_all || std::any_of(found.begin(), found.end(), [](const auto& target) { return target.is_weak(); })) {
    frame.label = label;
    frame.objects = objects;
    return {};
  }
  for (const auto& target : found)
    if (target.best_score > Target::strong) labels.well |= target.view.object->labels;
  add_separated(targets, std::move(found));
  return parts;
}

Recognition Engine::recognize(const DepthImage& depth, const Intrinsics& camera) const {
  Recognition r;
  r.result.timestamp = make_timestamp();
  StageTimes time(r.stages);
  FramePieces frame = time("segmentation", [&] { return split_frame(depth, camera, impl_->pieces); });
  r.num_of_points_input = frame.measured_pixels;
  if (frame.objects.empty()) {
    r.reason = why_nothing_stands_out(depth);
    return r;
  }
  ExplainedLabels labels;
  std::vector<Target> targets = impl_->examine_all(frame, labels, time);
  const auto sure = impl_->look_at_own_pixels(targets, frame, labels, time);
  const auto separated = impl_->search_closely(targets, frame, labels, time);
  const auto by_evidence = [](const Target& a, const Target& b) { return a.evidence() > b.evidence(); };
  // Objects that a part hardly explains need no closer look, but for the most promising ones.
  constexpr std::size_t always = 3;
  std::stable_sort(targets.begin(), targets.end(), [&](const Target& a, const Target& b) {
    const auto promise = [&](const Target& t) {
      return (t.best_score + hopeless) * std::sqrt(double(t.view.object->pixels));
    };
    return promise(a) > promise(b);
  });
  while (targets.size() > always && targets.back().best_score < hopeless) targets.pop_back();
  for (auto& target : targets)
    if (!target.polished) time("polish", [&] { impl_->polish(target); });
  const double noise_per_mm2 = noise_left(targets);
  for (auto& target : targets) {
    const double z_mm = target.view.all.centre_mm().z();
    // Not of fits that are far beyond what is to be expected.
    target.noise_mm = std::clamp(noise_per_mm2 * z_mm * z_mm, 0.65 * target.view.noise_mm, 1.3 * target.view.noise_mm);
    time("decision", [&] { impl_->decide(target); });
    if (target.has_rivals() && stride_for(target.view, target.fine_pixels) > stride_for(target.view, most_pixels)) {
      target.fine_pixels = most_pixels;
      time("polish", [&] { impl_->polish(target); });
      time("decision", [&] { impl_->decide(target); });
    }
    time("polish", [&] { impl_->finish(target); });
  }
  std::stable_sort(targets.begin(), targets.end(), by_evidence);
  if (targets.empty()) {
    r.reason =
        "nothing that stands out is like any of the parts: another object, too few points, too much noise, or too "
        "large" +
        hint_of_unit(depth);
    return r;
  }
  r.detections = impl_->detections(targets);
  r.candidates = std::move(targets[0].candidates);
  const Candidate& best = r.candidates[0];
  if (best.score < impl_->options.min_score) {
    r.reason = fmt::format("the best candidate, {}, {}", impl_->catalogue.parts[impl_->part_of(best)].name,
                           score_below(best.score, impl_->options.min_score)) +
               hint_of_unit(depth);
  } else {
    r.accepted = 0;
    const std::string timestamp = r.result.timestamp;
    r.result = result_of(best, impl_->catalogue);
    r.result.timestamp = timestamp;
  }
  return r;
}

bool Engine::Impl::is_worth_a_search(const Target& target, bool beside_another) const {
  // Not what is hardly higher than the table where all parts that are like it sink into that, or a part lies beside it:
  // mostly it is one of the table's waves.
  if ((target.candidates.empty() || beside_another) && lies_low(target.view)) return false;
  return target.is_weak() && shows_enough(target);
}

double Engine::Impl::least_part_px(const Target& target) const {
  constexpr double least_share = 0.25;
  const double px_per_mm = target.view.frame->camera.fx / target.view.all.centre_mm().z();
  return least_share * smallest_view_mm2 * px_per_mm * px_per_mm;
}

bool Engine::Impl::leaves_a_part(const Target& target) const {
  const double least_px = least_part_px(target);
  // Of several pieces each is looked at by itself as well.
  if (target.unexplained_px < least_px || target.view.object->labels.count() > 1) return false;
  const Hypothesis best = hypothesis_of(target.candidates[0]);
  return largest_left_px(*target.view.frame, target.view.object->labels, &best, model_of, target.noise_mm) >= least_px;
}

std::vector<const PartModel*> Engine::Impl::models_to_search(const std::set<int>& heard) const {
  std::vector<const PartModel*> out = model_of;
  if (out.size() > few_parts)
    for (int part = 0; part < static_cast<int>(out.size()); ++part)
      if (!heard.count(part)) out[part] = nullptr;
  return out;
}

std::vector<Target> Engine::Impl::targets_of(const FramePieces& frame, const std::vector<SeparatedPart>& parts,
                                             StageTimes& time) const {
  std::vector<Target> targets;
  // Of several poses for the same pixels the likeliest may be one that nothing holds.
  const auto hangs = [&](const Candidate& candidate, const SeparatedPart& found) {
    const PartModel& model = *models[part_of(candidate)];
    const auto height_mm = height_above_table_mm(frame, model, candidate.camera_from_model);
    if (!height_mm || *height_mm < touch_tolerance_mm(model, 0)) return false;
    return std::none_of(parts.begin(), parts.end(), [&](const SeparatedPart& other) {
      const PartModel& other_model = *models[other.hypotheses[0].part];
      return &other != &found && touches(model, candidate.camera_from_model, other_model,
                                         other.hypotheses[0].camera_from_model, touch_tolerance_mm(other_model, 0));
    });
  };
  for (const auto& part : parts) {
    Target target = time("points", [&] { return Target(frame, part.object); });
    if (target.view.points.points_mm.size() < 30) continue;
    time("verify", [&] { verify(target, part.hypotheses, false); });
    if (target.candidates.empty() || hangs(target.candidates[0], part)) continue;
    reconsider(target, Target::strong, time);
    targets.push_back(std::move(target));
  }
  return targets;
}

void Engine::Impl::add_separated(std::vector<Target>& targets, std::vector<Target> separated) const {
  std::erase_if(targets, [&](const Target& target) {
    double explained = 0;
    for (const auto& other : separated)
      if ((target.view.object->labels & other.view.object->labels).any()) explained += other.explained();
    return target.explained() < explained;
  });
  std::move(separated.begin(), separated.end(), std::back_inserter(targets));
}

/// The best candidate of each object, those that share pixels with a likelier one left out.
std::vector<Detection> Engine::Impl::detections(const std::vector<Target>& targets) const {
  std::vector<Detection> out;
  std::bitset<256> taken;
  // Of a part in two pieces each may have found it.
  const auto is_there = [&](const Detection& found) {
    const PartModel& model = *models[found.part];
    return std::any_of(out.begin(), out.end(), [&](const Detection& other) {
      return other.part == found.part &&
             (other.camera_from_model * model.middle_mm - found.camera_from_model * model.middle_mm).norm() <
                 0.2 * model.diameter_mm;
    });
  };
  for (const auto& target : targets) {
    const Candidate& best = target.candidates[0];
    if (best.score < options.min_score || (taken & target.view.object->labels).any() || is_there(target.detection))
      continue;
    taken |= target.view.object->labels;
    out.push_back(target.detection);
  }
  return out;
}

Candidate Engine::Impl::candidate_of(const Hypothesis& h, int id) const {
  Candidate candidate;
  candidate.id = id;
  candidate.match_distance = static_cast<float>(h.template_cost);
  // The catalogue's view from the nearest side.
  double nearest = -2;
  const Eigen::Vector3d& middle = models[h.part]->middle_mm;
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

Hypothesis Engine::Impl::hypothesis_of(const Candidate& candidate) const {
  Hypothesis h;
  h.part = part_of(candidate);
  h.template_cost = candidate.match_distance;
  h.start = candidate.T4.inverse() * candidate.camera_from_model;
  h.camera_from_model = candidate.camera_from_model;
  return h;
}

void Engine::Impl::verify(Target& target, std::vector<Hypothesis> hypotheses, bool one_part) const {
  const auto settle = [&](Hypothesis& h) {
    const PartModel& model = *models[h.part];
    const double end_mm = std::max(0.005 * model.diameter_mm, target.noise_mm);
    const auto refined = refine_on_field(model.field, h.camera_from_model, target.view.all,
                                         {.start_scale_mm = std::max(0.02 * model.diameter_mm, target.noise_mm),
                                          .end_scale_mm = end_mm,
                                          .max_iterations = 6,
                                          .upright = upright_of(h, target.view),
                                          .rate_end = false});
    h.camera_from_model = refined.camera_from_model;
    h.left_mm = refined.mean_capped * end_mm;
  };
  parallel_for(hypotheses.size(), [&](std::size_t i) { settle(hypotheses[i]); });
  double least_left_mm = std::numeric_limits<double>::infinity();
  const auto drop_worse = [&](std::vector<Hypothesis>& some) {
    constexpr double most_worse = 0.7;  // in deviations of the noise: of none that came near the best was it 0.5
    for (const auto& h : some) least_left_mm = std::min(least_left_mm, h.left_mm);
    if (one_part)
      std::erase_if(some, [&](const auto& h) { return h.left_mm > least_left_mm + most_worse * target.view.noise_mm; });
  };
  // What sinks into the table is not there, however well what is seen of it fits.
  drop_sunk(hypotheses, model_of, target.view, touching_share);
  drop_worse(hypotheses);
  Eigen::AlignedBox2d pixels;
  for (const auto& h : hypotheses)
    pixels.extend(covered_at_any_turn(target.view.frame->camera, *models[h.part], h.camera_from_model));
  const FrameWindow frame = window_about(target.view, pixels, coarse_pixels);
  const DepthComparer comparer(frame, sensor(target, stride_for(target.view, coarse_pixels)));
  std::vector<DepthComparison> comparisons;
  const auto compare = [&](std::vector<Hypothesis>& some) {
    const std::size_t first = comparisons.size();
    comparisons.resize(first + some.size());
    parallel_for(some.size(), [&](std::size_t i) {
      Hypothesis& h = some[i];
      const PartModel& model = *models[h.part];
      h.comparison = first + i;
      comparisons[h.comparison] = comparer(model.outline, h.camera_from_model,
                                           model.covered(frame.camera, h.camera_from_model), model.outline.faces);
      h.cost = -comparisons[h.comparison].log_likelihood;
    });
  };
  compare(hypotheses);
  sort_by_cost(hypotheses);
  // What nearly puts the part back onto itself, of the best few.
  std::vector<Hypothesis> more;
  for (std::size_t i = 0; i < std::min<std::size_t>(hypotheses.size(), 3); ++i) {
    const auto& partners = models[hypotheses[i].part]->partners;
    const std::size_t tried = i == 0 ? partners.size() : std::min<std::size_t>(partners.size(), 3);
    for (std::size_t k = 0; k < tried; ++k) {
      more.push_back(hypotheses[i]);
      more.back().camera_from_model = hypotheses[i].camera_from_model * partners[k];
    }
    const auto turned = best_turns(hypotheses[i], *models[hypotheses[i].part], target.view, i == 0 ? 6 : 3);
    more.insert(more.end(), turned.begin(), turned.end());
  }
  if (!hypotheses.empty()) {
    const double most_difference = models.size() > few_parts ? 0.08 : 0.03;  // few are all among the starts
    const auto others = in_place_of(hypotheses[0], model_of, target.view, most_difference);
    more.insert(more.end(), others.begin(), others.end());
  }
  for (auto& h : more) h.at_rest = false;
  parallel_for(more.size(), [&](std::size_t i) { settle(more[i]); });
  drop_sunk(more, model_of, target.view, touching_share);
  drop_worse(more);
  // Most come back to a pose that is among them already.
  std::stable_sort(more.begin(), more.end(), [](const auto& a, const auto& b) { return a.left_mm < b.left_mm; });
  more = distinct(std::move(more), model_of);
  compare(more);
  hypotheses.insert(hypotheses.end(), more.begin(), more.end());
  sort_by_cost(hypotheses);
  hypotheses = contenders_first(distinct(std::move(hypotheses), model_of));
  if (hypotheses.size() > 8) hypotheses.resize(8);
  // Of two examinations the better counts.
  if (hypotheses.empty() || (!target.log_likelihoods.empty() && -hypotheses[0].cost < target.log_likelihoods[0]))
    return;
  target.candidates.clear();
  target.log_likelihoods.clear();
  target.polished = false;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    target.candidates.push_back(candidate_of(hypotheses[i], static_cast<int>(i)));
    target.log_likelihoods.push_back(-hypotheses[i].cost);
  }
  const Hypothesis& best = hypotheses[0];
  const int stride = stride_for(target.view, coarse_pixels);
  target.unexplained_px = comparisons[best.comparison].unexplained * stride * stride;
  target.best_score =
      rough_probability(comparisons[best.comparison], in_frame(target, best.part, best.camera_from_model));
}

/// Those that a closer look may still put first.
std::size_t Engine::Impl::contenders_of(const Target& target) const {
  const double margin = contender_margin(target.log_likelihoods[0]);
  std::size_t contenders = 1;
  while (contenders < std::min(target.candidates.size(), most_contenders) &&
         target.log_likelihoods[contenders] > target.log_likelihoods[0] - margin)
    ++contenders;
  return contenders;
}

void Engine::Impl::polish(Target& target) const {
  auto& candidates = target.candidates;
  const std::size_t contenders = contenders_of(target);
  target.fit.resize(contenders);
  Eigen::AlignedBox2d pixels;
  for (std::size_t i = 0; i < contenders; ++i)
    pixels.extend(models[part_of(candidates[i])]->covered(target.view.frame->camera, candidates[i].camera_from_model));
  target.fine = window_about(target.view, pixels, target.fine_pixels);
  const int stride = stride_for(target.view, target.fine_pixels);
  const DepthImage depth = object_depth(target.fine);
  parallel_for(contenders,
               [&](std::size_t i) { target.fit[i] = move_onto(depth, target, target.fine, stride, 3, candidates[i]); });
  target.polished = true;
}

ProjectiveRefinement Engine::Impl::move_onto(const DepthImage& depth, const Target& target, const FrameWindow& window,
                                             int stride, int iterations, Candidate& candidate) const {
  const PartModel& model = *models[part_of(candidate)];
  const auto refined = refine_projectively(model.surface, candidate.camera_from_model, depth, window.camera,
                                           {.gate_mm = static_cast<float>(std::max(6 * target.noise_mm, 2.0)),
                                            .max_iterations = iterations,
                                            .faces = model.surface.faces,
                                            .damping = polish_damping(target.noise(), stride, model.diameter_mm)});
  candidate.T4 = refined.camera_from_model * candidate.camera_from_model.inverse() * candidate.T4;
  candidate.camera_from_model = refined.camera_from_model;
  candidate.icp_converged = std::isfinite(refined.rms_mm);
  candidate.icp_fitness = candidate.icp_converged ? static_cast<float>(refined.rms_mm) : -1;
  return refined;
}

void Engine::Impl::finish(Target& target) const {
  constexpr double most_shared = 1.5;  // of what a pixel errs for itself
  const int all = target.view.object->pixels;
  if (stride_for(target.view, target.fine_pixels) == 1 || target.view.noise_mm > most_shared * target.local_noise_mm)
    return;
  Candidate& best = target.candidates[0];
  const Eigen::AlignedBox2d pixels = models[part_of(best)]->covered(target.view.frame->camera, best.camera_from_model);
  const FrameWindow window = window_about(target.view, pixels, all);
  const auto fit = move_onto(object_depth(window), target, window, 1, 2, best);
  if (!std::isfinite(fit.rms_mm)) return;
  target.detection.camera_from_model = best.camera_from_model;
  target.detection.covariance = covariance_of(target, fit, 1);
}

void Engine::Impl::decide(Target& target) const {
  auto& candidates = target.candidates;
  const std::size_t contenders = contenders_of(target);
  std::vector<DepthComparison> comparison(contenders);
  std::vector<Explanation> explanation(contenders);
  const int stride = stride_for(target.view, target.fine_pixels);
  constexpr double waves_px = 8;
  SensorModel with_waves = sensor(target, stride);
  with_waves.waves_px = waves_px / stride;
  const DepthComparer compare(target.fine, with_waves);
  parallel_for(contenders, [&](std::size_t i) {
    const int part = part_of(candidates[i]);
    const PartModel& model = *models[part];
    const Eigen::Isometry3d& pose = candidates[i].camera_from_model;
    comparison[i] = compare(model.surface, pose, model.covered(target.fine.camera, pose), model.surface.faces);
    explanation[i] = explanation_of(comparison[i], in_frame(target, part, pose));
    candidates[i].score = static_cast<float>(probability_of_part(explanation[i]));
  });
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < contenders; ++i)
    order.emplace_back(-pose_log_odds(comparison[i], explanation[i], target.noise(), stride), i);
  std::sort(order.begin(), order.end());
  std::vector<Candidate> decided;
  std::vector<ProjectiveRefinement> fit;
  for (const auto& [negative, i] : order) {
    decided.push_back(candidates[i]);
    fit.push_back(target.fit[i]);
  }
  decided.insert(decided.end(), candidates.begin() + static_cast<std::ptrdiff_t>(contenders), candidates.end());
  candidates = std::move(decided);
  target.fit = std::move(fit);
  target.best_score = candidates[0].score;
  describe(target, order);
  target.detection.explanation = explanation[order[0].second];
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i].verified = true;
    candidates[i].verification.accepted = i == 0 && candidates[i].score >= options.min_score;
    candidates[i].verification.reason =
        i >= contenders ? "explains the object far worse than another"
        : candidates[i].score < options.min_score
            ? score_below(candidates[i].score, options.min_score)
            : fmt::format("scores {:.2f}, but is less likely than another", candidates[i].score);
  }
}

Matrix6d Engine::Impl::covariance_of(const Target& target, const ProjectiveRefinement& fit, int stride) const {
  const Candidate& best = target.candidates[0];
  const PartModel& model = *models[part_of(best)];
  return pose_covariance(fit.hessian, fit.centre_mm, best.camera_from_model * model.middle_mm, target.noise(), stride,
                         model.diameter_mm);
}

/// The best candidate as a detection, with the others that may be right. `order`: the contenders by rising negative
/// log-odds.
void Engine::Impl::describe(Target& target, const std::vector<std::pair<double, std::size_t>>& order) const {
  const int stride = stride_for(target.view, target.fine_pixels);
  std::vector<double> log_odds;
  for (const auto& [negative, i] : order) log_odds.push_back(-negative);
  const std::vector<double> share = shares(log_odds);

  const Candidate& best = target.candidates[0];
  Detection& detection = target.detection = {};
  detection.part = part_of(best);
  detection.camera_from_model = best.camera_from_model;
  detection.score = best.score;
  const PartModel& model = *models[detection.part];
  detection.covariance = covariance_of(target, target.fit[0], stride);

  constexpr double least_share = 0.01;
  std::vector<std::size_t> others;
  for (std::size_t k = 1; k < share.size(); ++k)
    if (share[k] >= least_share) others.push_back(k);
  const auto render = [&](const Candidate& candidate) {
    const TriangleMesh& surface = models[part_of(candidate)]->surface;
    return render_depth(surface, candidate.camera_from_model, target.fine.camera);
  };
  const DepthImage seen = others.empty() ? DepthImage() : render(best);
  std::vector<std::uint8_t> symmetric(share.size()), alike(share.size());
  parallel_for(others.size(), [&](std::size_t i) {
    const std::size_t k = others[i];
    const Candidate& other = target.candidates[k];
    const Eigen::Isometry3d model_from_model = best.camera_from_model.inverse() * other.camera_from_model;
    const double tolerance_mm = std::max(0.01 * model.diameter_mm, 1.5 * target.noise_mm);
    symmetric[k] = part_of(other) == detection.part && model.is_symmetry(model_from_model, tolerance_mm);
    alike[k] = symmetric[k] || looks_the_same(seen, render(other), sensor(target, stride));
  });
  double as_good = share[0];
  for (const std::size_t k : others) {
    const Candidate& other = target.candidates[k];
    if (alike[k]) as_good += share[k];
    if (!symmetric[k])
      detection.alternatives.push_back({part_of(other), other.camera_from_model, share[k] * best.score});
  }
  detection.confidence = best.score * as_good;
}

}  // namespace partpose
