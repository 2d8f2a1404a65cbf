// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/recognizer.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/distance_grid.hpp"
#include "partpose/geometry/voxel_grid.hpp"
#include "partpose/pipeline/stage_times.hpp"
#include "partpose/registration/projective_refinement.hpp"
#include "partpose/verification/render_compare.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace partpose {

namespace {

/// A view at a pose, with a cost by which hypotheses of one stage are compared: the lower the better.
struct Hypothesis {
  int view_row = -1;
  float match_distance = -1;
  Eigen::Isometry3d scene_from_view = Eigen::Isometry3d::Identity();
  double cost = 0;
};

/// The `count` of lowest cost, and besides them the best `per_part` of each part.
std::vector<Hypothesis> best_of(std::vector<Hypothesis> all, std::size_t count, int per_part,
                                const Catalogue& catalogue) {
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  std::vector<int> taken(catalogue.parts.size(), 0);
  std::vector<Hypothesis> kept;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (taken[catalogue.views[all[i].view_row].part]++ < per_part || i < count) kept.push_back(all[i]);
  return kept;
}

/// Without those that lie where a better one of the same part lies already, to a twentieth of the part's size.
std::vector<Hypothesis> distinct(std::vector<Hypothesis> sorted, const Catalogue& catalogue) {
  std::vector<Hypothesis> kept;
  const auto pose = [&](const Hypothesis& h) {
    const auto& view = catalogue.views[h.view_row];
    return h.scene_from_view * view.T2;  // of the part's centre
  };
  for (const auto& h : sorted) {
    const int part = catalogue.views[h.view_row].part;
    const double size_mm = bounding_box_diagonal(catalogue.parts[part].mesh);
    const bool seen = std::any_of(kept.begin(), kept.end(), [&](const Hypothesis& k) {
      return catalogue.views[k.view_row].part == part && translation_error_mm(pose(h), pose(k)) < 0.05 * size_mm &&
             rotation_error_deg(pose(h), pose(k)) < 6;
    });
    if (!seen) kept.push_back(h);
  }
  return kept;
}

PointCloud about(const PointCloud& cloud, std::size_t points) {
  return every_nth(cloud, std::max<std::size_t>(cloud.size() / points, 1));
}

double root_mean_square_radius(const PointCloud& cloud, const Eigen::Vector3d& centre) {
  double sum = 0;
  for (const auto& p : cloud.points) sum += (p.cast<double>() - centre).squaredNorm();
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(cloud.size(), 1)));
}

/// The neighbourhood of a segment, every `stride`-th pixel of the frame.
/// Wide enough that the largest part shows wholly wherever it meets the segment.
LabelledDepth cut_out(const DepthImage& depth, const Intrinsics& camera, const Segment& segment, float largest_part_mm,
                      int wanted_pixels) {
  std::vector<bool> is_object(depth.z_mm.size(), false);
  int u0 = depth.width, u1 = -1, v0 = depth.height, v1 = -1;
  double z_sum = 0;
  for (const int p : segment.pixels) {
    z_sum += depth.z_mm[p];
    is_object[p] = true;
    u0 = std::min(u0, p % depth.width), u1 = std::max(u1, p % depth.width);
    v0 = std::min(v0, p / depth.width), v1 = std::max(v1, p / depth.width);
  }
  const double pixels_per_mm = std::max(camera.fx, camera.fy) * static_cast<double>(segment.pixels.size()) / z_sum;
  const int margin =
      4 + static_cast<int>(std::max(0.0, largest_part_mm * pixels_per_mm - std::min(u1 - u0, v1 - v0) / 2.0));
  // Coarse enough for the pixels wanted of the object, and for a bounded image where the largest part is much larger.
  constexpr double most_pixels = 250000;
  const double area = static_cast<double>(u1 - u0 + 2 * margin) * (v1 - v0 + 2 * margin);
  const int stride =
      static_cast<int>(std::max({1L, std::lround(std::sqrt(segment.pixels.size() / double(wanted_pixels))),
                                 std::lround(std::ceil(std::sqrt(area / most_pixels)))}));
  u0 -= margin, v0 -= margin;

  LabelledDepth out;
  out.camera.width = (u1 + margin - u0) / stride + 1;
  out.camera.height = (v1 + margin - v0) / stride + 1;
  out.camera.fx = camera.fx / stride;
  out.camera.fy = camera.fy / stride;
  out.camera.cx = (camera.cx - u0) / stride;
  out.camera.cy = (camera.cy - v0) / stride;
  out.depth = DepthImage(out.camera.width, out.camera.height);
  out.label.assign(out.depth.z_mm.size(), PixelLabel::nothing);
  for (int v = 0; v < out.depth.height; ++v) {
    for (int u = 0; u < out.depth.width; ++u) {
      const int full_u = u0 + u * stride, full_v = v0 + v * stride;
      if (full_u < 0 || full_v < 0 || full_u >= depth.width || full_v >= depth.height) continue;
      const float z = depth.at(full_u, full_v);
      if (!(z > 0)) continue;
      out.depth.at(u, v) = z;
      out.label[static_cast<std::size_t>(v) * out.depth.width + u] =
          is_object[static_cast<std::size_t>(full_v) * depth.width + full_u] ? PixelLabel::object
                                                                             : PixelLabel::background;
    }
  }
  return out;
}

/// The depths of the object alone, for the refinement.
DepthImage object_depth(const LabelledDepth& frame) {
  DepthImage depth = frame.depth;
  for (std::size_t p = 0; p < depth.z_mm.size(); ++p)
    if (frame.label[p] != PixelLabel::object) depth.z_mm[p] = 0;
  return depth;
}

void sort_by_score(std::vector<Candidate>& candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
}

/// Those that may be right, of candidates by falling score.
std::span<const Candidate> contenders_of(const std::vector<Candidate>& candidates) {
  constexpr float share = 0.75f;
  std::size_t count = 0;
  while (count < candidates.size() && candidates[count].score >= share * candidates[0].score) ++count;
  return {candidates.data(), count};
}

}  // namespace

struct Recognizer::Impl {
  Catalogue catalogue;
  RecognizerOptions options;
  GlobalPipelineConfig config;
  std::unique_ptr<GlobalDescriptor> descriptor;
  std::vector<KdTree> view_trees;
  std::vector<PointCloud> view_probes;  ///< some 60 points of each view
  std::vector<double> view_radius_mm;   ///< root mean square distance from the centroid
  SegmentationOptions segmentation;

  /// One segment's clouds and what was found for it.
  struct OfSegment {
    const Segment* segment = nullptr;
    PointCloud cloud, with_normals, refinement_scene;
    std::vector<Candidate> candidates;  ///< best score first

    double best_score = 0;  ///< of the best candidate; from the decision on, at its close tolerance

    /// By which segments are compared: how well the best candidate explains it, and, less, how large it is.
    double evidence() const {
      return best_score * best_score * std::pow(static_cast<double>(segment->pixels.size()), 0.25);
    }
  };

  OfSegment recognize(const DepthImage& depth, const Intrinsics& camera, const Segment& segment,
                      StageTimes& time) const;
  std::vector<Hypothesis> shortlist(const PointCloud& cloud) const;
  std::vector<Hypothesis> turn(const std::vector<Hypothesis>& views, const PointCloud& scene) const;
  void compare_both_ways(std::vector<Hypothesis>& hypotheses, const PointCloud& scene, const KdTree& tree) const;
  void register_to(const PointCloud& scene, const KdTree& tree, std::vector<Hypothesis>& hypotheses) const;
  Candidate candidate_of(const Hypothesis& hypothesis, int id) const;
  /// Moves a candidate to where its rendering meets `depth`, a depth image of the frame's camera.
  void fit_to_depth(Candidate& candidate, const LabelledDepth& frame, const DepthImage& depth) const;
  RenderComparison compare(const Candidate& candidate, const LabelledDepth& frame,
                           const RenderCompareOptions& compare_options) const;
  /// Decides the segments that may be the frame's best object, and puts the best one first.
  void decide_among(std::vector<OfSegment>& found, const DepthImage& depth, const Intrinsics& camera) const;
  /// Orders the candidates, given by falling score, by how closely they agree at `close_tolerance_mm`, and gives each
  /// its verdict. Returns the best one's score at that tolerance.
  double decide(std::vector<Candidate>& candidates, const LabelledDepth& frame, float close_tolerance_mm) const;
  const TriangleMesh& mesh_of(const Candidate& candidate) const {
    return catalogue.parts[catalogue.views[candidate.view_row].part].mesh;
  }
};

GlobalPipelineConfig Recognizer::catalogue_config() {
  GlobalPipelineConfig config;
  config.database.noise_levels_mm = {0};  // its shortlist is long enough without
  config.debug.save_extras_json = true;
  config.debug.save_point_clouds = true;
  return config;
}

void RecognizerOptions::check() const {
  if (!(min_score >= 0 && min_score <= 1)) throw Error("min_score {}: must be 0 to 1", min_score);
  if (shortlist_views < 1) throw Error("shortlist_views {}: must be 1 or more", shortlist_views);
  if (rolls < 1) throw Error("rolls {}: must be 1 or more", rolls);
}

Recognizer::Recognizer(Catalogue catalogue, RecognizerOptions options) : impl_(std::make_unique<Impl>()) {
  options.check();
  impl_->catalogue = std::move(catalogue);
  impl_->options = options;
  impl_->config = catalogue_config();
  impl_->descriptor = make_global_descriptor(impl_->config.global_descriptor, impl_->config.descriptors);
  const auto& views = impl_->catalogue.views;
  for (const auto& view : views) {
    impl_->view_trees.emplace_back(view.cloud.points);
    impl_->view_probes.push_back(about(view.cloud, 60));
    impl_->view_radius_mm.push_back(root_mean_square_radius(view.cloud, view.features.centroid_mm));
  }
  impl_->segmentation.largest_part_mm = 0;
  impl_->segmentation.smallest_part_mm = std::numeric_limits<float>::infinity();
  for (const auto& part : impl_->catalogue.parts) {
    const auto diagonal = static_cast<float>(bounding_box_diagonal(part.mesh));
    impl_->segmentation.largest_part_mm = std::max(impl_->segmentation.largest_part_mm, diagonal);
    impl_->segmentation.smallest_part_mm = std::min(impl_->segmentation.smallest_part_mm, diagonal);
  }
}

Recognizer::~Recognizer() = default;

const Catalogue& Recognizer::catalogue() const { return impl_->catalogue; }

Recognition Recognizer::recognize(const Scene& scene) const {
  return scene.depth ? recognize(*scene.depth, *scene.intrinsics) : recognize(scene.cloud);
}

Recognition Recognizer::recognize(const PointCloud& cloud) const {
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

Recognition Recognizer::recognize(const DepthImage& depth, const Intrinsics& camera) const {
  Recognition r;
  r.result.timestamp = make_timestamp();
  r.num_of_points_input =
      static_cast<int>(std::count_if(depth.z_mm.begin(), depth.z_mm.end(), [](float z) { return z > 0; }));
  StageTimes time(r.stages);
  const auto segments = time("segmentation", [&] { return segment(depth, camera, impl_->segmentation); });
  if (segments.empty()) {
    r.reason = why_nothing_stands_out(depth);
    return r;
  }
  std::vector<Impl::OfSegment> found;
  for (const auto& segment : segments) {
    auto of_segment = impl_->recognize(depth, camera, segment, time);
    if (!of_segment.candidates.empty()) found.push_back(std::move(of_segment));
  }
  time("decision", [&] { impl_->decide_among(found, depth, camera); });
  if (!found.empty()) {
    r.candidates = std::move(found[0].candidates);
    r.preprocessed = std::move(found[0].cloud);
    r.with_normals = std::move(found[0].with_normals);
    r.refinement_scene = std::move(found[0].refinement_scene);
  }
  if (r.candidates.empty()) {
    r.reason = "no segment has enough points with normals to be described";
  } else if (r.candidates[0].score < impl_->options.min_score) {
    const auto& best = r.candidates[0];
    r.reason = fmt::format("the best candidate, {}, {}",
                           impl_->catalogue.parts[impl_->catalogue.views[best.view_row].part].name,
                           score_below(best.score, impl_->options.min_score));
  } else {
    r.accepted = 0;
    const std::string timestamp = r.result.timestamp;
    r.result = result_of(r.candidates[0], impl_->catalogue);
    r.result.timestamp = timestamp;
  }
  return r;
}

Recognizer::Impl::OfSegment Recognizer::Impl::recognize(const DepthImage& depth, const Intrinsics& camera,
                                                        const Segment& segment, StageTimes& time) const {
  OfSegment out;
  out.segment = &segment;
  time("preprocessing", [&] {
    for (const int p : segment.pixels)
      out.cloud.points.push_back(camera.unproject(p % depth.width, p / depth.width, depth.z_mm[p]));
    out.cloud = voxel_grid(out.cloud, config.preprocessing.voxel_size);
  });
  time("normal_estimation", [&] { out.with_normals = with_normals(out.cloud, config.normal_estimation); });
  if (out.with_normals.size() < static_cast<std::size_t>(segmentation.min_pixels)) return out;
  out.refinement_scene = voxel_grid(out.with_normals, config.pose_refinement.voxel_size);
  const PointCloud& scene = out.refinement_scene;
  const KdTree tree(scene.points);

  auto hypotheses = time("matching", [&] { return shortlist(out.with_normals); });
  time("coarse_alignment", [&] {
    hypotheses = best_of(turn(hypotheses, scene), 150, 8, catalogue);
    compare_both_ways(hypotheses, scene, tree);
    hypotheses = best_of(std::move(hypotheses), 24, 3, catalogue);
  });
  time("pose_refinement", [&] {
    register_to(scene, tree, hypotheses);
    std::stable_sort(hypotheses.begin(), hypotheses.end(),
                     [](const auto& a, const auto& b) { return a.cost < b.cost; });
    hypotheses = best_of(distinct(std::move(hypotheses), catalogue), 10, 1, catalogue);
  });
  time("hypothesis_verification", [&] {
    const LabelledDepth coarse = cut_out(depth, camera, segment, segmentation.largest_part_mm, 1500);
    out.candidates.resize(hypotheses.size());
    parallel_for(hypotheses.size(), [&](std::size_t i) {
      out.candidates[i] = candidate_of(hypotheses[i], static_cast<int>(i));
      fit_to_depth(out.candidates[i], coarse, object_depth(coarse));
      out.candidates[i].score = static_cast<float>(compare(out.candidates[i], coarse, {}).score());
    });
    sort_by_score(out.candidates);
    out.best_score = out.candidates[0].score;
  });
  return out;
}

void Recognizer::Impl::fit_to_depth(Candidate& candidate, const LabelledDepth& frame, const DepthImage& depth) const {
  const auto refined =
      refine_projectively(mesh_of(candidate), candidate.camera_from_model, depth, frame.camera, {.gate_mm = 10});
  candidate.T4 = refined.camera_from_model * candidate.camera_from_model.inverse() * candidate.T4;
  candidate.camera_from_model = refined.camera_from_model;
  candidate.icp_converged = std::isfinite(refined.rms_mm);
  candidate.icp_fitness = candidate.icp_converged ? static_cast<float>(refined.rms_mm) : -1;
}

RenderComparison Recognizer::Impl::compare(const Candidate& candidate, const LabelledDepth& frame,
                                           const RenderCompareOptions& compare_options) const {
  return render_and_compare(mesh_of(candidate), candidate.camera_from_model, frame, compare_options);
}

void Recognizer::Impl::decide_among(std::vector<OfSegment>& found, const DepthImage& depth,
                                    const Intrinsics& camera) const {
  constexpr double least_share = 0.4;  // of the best one's evidence so far: a closer look changes it, but not by more
  const auto by_evidence = [](const OfSegment& a, const OfSegment& b) { return a.evidence() > b.evidence(); };
  std::stable_sort(found.begin(), found.end(), by_evidence);
  while (!found.empty() && found.back().evidence() < least_share * found.front().evidence()) found.pop_back();
  // Three deviations of the noise that the best fit of all leaves: a tolerance that tells look-alikes, and what merely
  // resembles a part, from the part.
  float noise_mm = std::numeric_limits<float>::infinity();
  for (const auto& of_segment : found)
    for (const auto& candidate : contenders_of(of_segment.candidates))
      if (candidate.icp_converged) noise_mm = std::min(noise_mm, candidate.icp_fitness);
  const float close_tolerance_mm = std::clamp(3 * noise_mm, 1.5f, RenderCompareOptions{}.tolerance_mm);
  for (auto& of_segment : found)
    of_segment.best_score =
        decide(of_segment.candidates, cut_out(depth, camera, *of_segment.segment, segmentation.largest_part_mm, 6000),
               close_tolerance_mm);
  std::stable_sort(found.begin(), found.end(), by_evidence);
}

double Recognizer::Impl::decide(std::vector<Candidate>& candidates, const LabelledDepth& frame,
                                float close_tolerance_mm) const {
  const std::size_t contenders = contenders_of(candidates).size();
  const RenderCompareOptions close{.tolerance_mm = close_tolerance_mm};
  std::vector<std::pair<double, std::size_t>> close_score(contenders);
  std::vector<RenderComparison> comparison(contenders);
  parallel_for(contenders, [&](std::size_t i) {
    Candidate& candidate = candidates[i];
    fit_to_depth(candidate, frame, object_depth(frame));
    // What the segmentation lost of the part helps the pose, unless it is not the part.
    Candidate wider = candidate;
    fit_to_depth(wider, frame, frame.depth);
    if (compare(wider, frame, close).score() > compare(candidate, frame, close).score()) candidate = wider;
    close_score[i] = {-compare(candidate, frame, close).score(), i};
    comparison[i] = compare(candidate, frame, {});
  });
  std::sort(close_score.begin(), close_score.end());
  const double best_close_score = contenders > 0 ? -close_score[0].first : 0.0;
  std::vector<Candidate> decided;
  for (const auto& [negative_score, i] : close_score) {
    candidates[i].score = static_cast<float>(comparison[i].score());
    decided.push_back(candidates[i]);
  }
  decided.insert(decided.end(), candidates.begin() + static_cast<std::ptrdiff_t>(contenders), candidates.end());
  candidates = std::move(decided);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Candidate& candidate = candidates[i];
    candidate.verified = true;
    candidate.verification.accepted = i == 0 && candidate.score >= options.min_score;
    candidate.verification.reason =
        candidate.score < options.min_score
            ? score_below(candidate.score, options.min_score)
            : fmt::format("scores {:.2f}, but agrees less closely than another", candidate.score);
  }
  return best_close_score;
}

std::vector<Hypothesis> Recognizer::Impl::shortlist(const PointCloud& cloud) const {
  std::vector<Hypothesis> views;
  for (const auto& description : descriptor->describe(cloud))
    for (const auto& match : catalogue.index.nearest(description.histogram, options.shortlist_views))
      views.push_back({catalogue.descriptions[match.row].view, match.distance});
  return views;
}

std::vector<Hypothesis> Recognizer::Impl::turn(const std::vector<Hypothesis>& views, const PointCloud& scene) const {
  const Eigen::Vector3d centre = centroid(scene);
  const Eigen::Matrix3d sight_from_scene = sight_frame(centre);
  const double radius_mm = root_mean_square_radius(scene, centre);
  const DistanceGrid distance(scene.points, static_cast<float>(0.5 * radius_mm));
  std::vector<Hypothesis> turned(views.size() * options.rolls);
  parallel_for(
      views.size(),
      [&](std::size_t i) {
        const auto& view = catalogue.views[views[i].view_row];
        const PointCloud& probes = view_probes[views[i].view_row];
        const Eigen::Matrix3d sight_from_view = sight_frame(view.features.centroid_mm);
        const double size_difference = std::abs(view_radius_mm[views[i].view_row] - radius_mm);
        for (int k = 0; k < options.rolls; ++k) {
          Hypothesis h = views[i];
          const Eigen::AngleAxisd roll(2 * std::numbers::pi * k / options.rolls, Eigen::Vector3d::UnitZ());
          h.scene_from_view.linear() = sight_from_scene.transpose() * roll.toRotationMatrix() * sight_from_view;
          h.scene_from_view.translation() = centre - h.scene_from_view.linear() * view.features.centroid_mm;
          const Eigen::Isometry3f pose = h.scene_from_view.cast<float>();
          for (const auto& p : probes.points) h.cost += distance.at(pose * p);
          h.cost = h.cost / static_cast<double>(std::max<std::size_t>(probes.size(), 1)) + 0.5 * size_difference;
          turned[i * options.rolls + k] = h;
        }
      },
      8);
  return turned;
}

void Recognizer::Impl::compare_both_ways(std::vector<Hypothesis>& hypotheses, const PointCloud& scene,
                                         const KdTree& tree) const {
  const PointCloud scene_probes = about(scene, 60);
  parallel_for(hypotheses.size(), [&](std::size_t i) {
    Hypothesis& h = hypotheses[i];
    h.cost = mean_nearest_distance_mm(view_probes[h.view_row], h.scene_from_view, tree) +
             mean_nearest_distance_mm(scene_probes, h.scene_from_view.inverse(), view_trees[h.view_row]);
  });
}

void Recognizer::Impl::register_to(const PointCloud& scene, const KdTree& tree,
                                   std::vector<Hypothesis>& hypotheses) const {
  PoseRefinementOptions icp_options;
  icp_options.max_iterations = 30;
  icp_options.transformation_epsilon = 0.2f;
  parallel_for(hypotheses.size(), [&](std::size_t i) {
    Hypothesis& h = hypotheses[i];
    const auto& view = catalogue.views[h.view_row];
    const auto refined = icp(transformed(about(view.cloud, 250), h.scene_from_view), scene, tree, icp_options);
    h.scene_from_view = refined.target_from_source * h.scene_from_view;
  });
  compare_both_ways(hypotheses, scene, tree);
}

Candidate Recognizer::Impl::candidate_of(const Hypothesis& hypothesis, int id) const {
  const auto& view = catalogue.views[hypothesis.view_row];
  Candidate candidate;
  candidate.id = id;
  candidate.view_row = hypothesis.view_row;
  candidate.match_distance = hypothesis.match_distance;
  candidate.T3 = hypothesis.scene_from_view;
  candidate.camera_from_model = hypothesis.scene_from_view * view.T2 * catalogue.parts[view.part].T1;
  return candidate;
}

}  // namespace partpose
