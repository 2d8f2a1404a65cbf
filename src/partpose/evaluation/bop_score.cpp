// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/bop_score.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/evaluation/pose_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <set>
#include <tuple>

namespace partpose {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// What the errors of an object's poses need.
struct Object {
  TriangleMesh mesh;
  std::vector<Eigen::Isometry3d> symmetries;
  double diameter_mm = 0;
};

std::map<int, Object> objects_of(const BopDataset& dataset) {
  std::map<int, Object> objects;
  for (const auto& target : dataset.targets) {
    if (objects.contains(target.obj_id)) continue;
    const BopModelInfo& info = dataset.models.at(target.obj_id);
    objects[target.obj_id] = {dataset.read_model(target.obj_id), symmetry_transformations(info.symmetries),
                              info.diameter_mm};
  }
  return objects;
}

/// The targets of one image, as positions.
struct ImageTargets {
  const BopScene* scene = nullptr;
  const BopImage* image = nullptr;
  std::vector<std::size_t> targets;
};

std::vector<ImageTargets> by_image(const BopDataset& dataset) {
  std::map<std::pair<int, int>, ImageTargets> images;
  for (std::size_t i = 0; i < dataset.targets.size(); ++i) {
    const auto& target = dataset.targets[i];
    auto& entry = images[{target.scene_id, target.im_id}];
    entry.scene = &dataset.scene(target.scene_id);
    entry.image = &entry.scene->image(target.im_id);
    if (!entry.scene->has_ground_truth)
      throw Error("{}: no such file: the ground truth is needed to score",
                  (entry.scene->folder / "scene_gt.json").string());
    entry.targets.push_back(i);
  }
  std::vector<ImageTargets> out;
  for (auto& [ids, entry] : images) out.push_back(std::move(entry));
  return out;
}

bool has_depth(const std::vector<ImageTargets>& images) {
  return std::ranges::any_of(
      images, [](const auto& entry) { return std::filesystem::exists(entry.scene->depth_path(*entry.image)); });
}

/// Takes VSD in one image.
class ImageVsd {
 public:
  ImageVsd(const ImageTargets& image, double delta_mm) : K_(image.image->camera.K), delta_mm_(delta_mm) {
    const DepthImage depth = image.scene->read_depth(*image.image);
    try {
      camera_ = image.image->camera.intrinsics(depth.width, depth.height);
    } catch (const Error& error) {
      throw Error("{}: image {}: {}", (image.scene->folder / "scene_camera.json").string(), image.image->id,
                  error.what());
    }
    measured_ = distance_image(depth, K_);
  }

  DistanceImage rendered(const Object& object, const Eigen::Isometry3d& pose) const {
    return distance_image(render(object.mesh, pose, camera_).depth, K_);
  }

  std::vector<double> vsd(const DistanceImage& estimate, const DistanceImage& truth, double diameter_mm) const {
    return visible_surface_discrepancy(measured_, estimate, truth, diameter_mm, bop_fractions(),
                                       {.delta_mm = delta_mm_})
        .vsd;
  }

 private:
  Eigen::Matrix3d K_;
  double delta_mm_;
  Intrinsics camera_;
  DistanceImage measured_;
};

struct TargetInput {
  const Object* object = nullptr;
  std::vector<std::pair<int, const BopGroundTruth*>> truths;  ///< all of the object, by id
  std::vector<std::pair<int, const BopEstimate*>> estimates;  ///< the kept ones, by falling score
};

void add_errors(const TargetInput& input, const Eigen::Matrix3d& K, const ImageVsd* vsd, BopTargetErrors& out) {
  const Object& object = *input.object;
  std::vector<DistanceImage> true_surface;
  if (vsd && !input.estimates.empty())
    for (const auto& [gt_id, truth] : input.truths)
      true_surface.push_back(vsd->rendered(object, truth->camera_from_model));
  for (const auto& [est_id, estimate] : input.estimates) {
    const Eigen::Isometry3d& pose = estimate->camera_from_model;
    std::optional<DistanceImage> surface;
    auto& errors = out.estimates.emplace_back(BopTargetErrors::Estimate{est_id, estimate->score, {}}).errors;
    for (std::size_t i = 0; i < input.truths.size(); ++i) {
      const auto& [gt_id, truth] = input.truths[i];
      const Eigen::Isometry3d& right = truth->camera_from_model;
      BopErrors& e = errors[gt_id];
      e.mssd_mm = spheres_overlap(pose, right, object.diameter_mm)
                      ? mssd_mm(object.mesh.vertices, pose, right, object.symmetries)
                      : infinity;
      e.mspd_px = mspd_px(object.mesh.vertices, pose, right, object.symmetries, K);
      if (!vsd) continue;
      if (!sphere_projections_overlap(pose, right, object.diameter_mm)) {
        e.vsd.assign(bop_fractions().size(), 1.0);
        continue;
      }
      if (!surface) surface = vsd->rendered(object, pose);
      e.vsd = vsd->vsd(*surface, true_surface[i], object.diameter_mm);
    }
  }
}

double mean(const std::map<int, double>& values) {
  double sum = 0;
  for (const auto& [id, value] : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// What thresholds are applied to.
double comparable(const BopErrors& errors, BopErrorType type, std::size_t tau, double diameter_mm,
                  double pixel_factor) {
  if (type == BopErrorType::mssd) return errors.mssd_mm / diameter_mm;
  if (type == BopErrorType::mspd) return errors.mspd_px * pixel_factor;
  return errors.vsd.at(tau);
}

struct Count {
  int found = 0, all = 0;
  double recall() const { return all > 0 ? static_cast<double>(found) / all : 0; }
};

std::map<int, double> recalls_of(const std::map<int, Count>& counts) {
  std::map<int, double> recalls;
  for (const auto& [id, count] : counts) recalls[id] = count.recall();
  return recalls;
}

BopRecall recall_at(std::span<const BopTargetErrors> targets, BopErrorType type, std::size_t tau, double threshold,
                    const BopScoreBasis& basis) {
  BopRecall out;
  out.threshold = threshold;
  Count all;
  std::map<int, Count> of_object, of_scene;
  for (const int id : basis.obj_ids) of_object[id];
  for (const int id : basis.scene_ids) of_scene[id];
  for (const auto& target : targets) {
    const auto& t = target.target;
    std::vector<std::vector<double>> errors;
    for (const auto& estimate : target.estimates) {
      auto& row = errors.emplace_back();
      for (const int gt_id : target.gt_ids)
        row.push_back(comparable(estimate.errors.at(gt_id), type, tau, basis.diameter_mm.at(t.obj_id),
                                 bop_pixel_factor(basis.image_width)));
    }
    const auto matching = bop_matching(errors, threshold);
    for (auto* count : {&all, &of_object[t.obj_id], &of_scene[t.scene_id]}) {
      count->all += static_cast<int>(target.gt_ids.size());
      for (const int gt : matching) count->found += gt >= 0;
    }
    for (std::size_t i = 0; i < matching.size(); ++i)
      if (matching[i] >= 0)
        out.matches.push_back({t.scene_id, t.im_id, target.gt_ids[matching[i]], target.estimates[i].est_id});
  }
  out.targets_count = all.all;
  out.tp_count = all.found;
  out.recall = all.recall();
  out.obj_recall = recalls_of(of_object);
  out.scene_recall = recalls_of(of_scene);
  out.mean_obj_recall = mean(out.obj_recall);
  out.mean_scene_recall = mean(out.scene_recall);
  return out;
}

int image_width_of(const BopDataset& dataset, const std::vector<ImageTargets>& images, int given) {
  if (given > 0) return given;
  if (dataset.camera) return dataset.camera->intrinsics.width;
  for (const auto& entry : images)
    if (std::filesystem::exists(entry.scene->depth_path(*entry.image)))
      return entry.scene->read_depth(*entry.image).width;
  throw Error(
      "{}: the images' width is not known: there is neither a camera.json nor a depth image; MSPD "
      "needs it: give --image-width",
      dataset.folder.string());
}

}  // namespace

void BopScoreOptions::check() const {
  if (!(vsd_delta_mm >= 0) || !std::isfinite(vsd_delta_mm))
    throw Error("vsd_delta_mm {}: must be 0 or more", vsd_delta_mm);
  if (image_width < 0) throw Error("image_width {}: must be positive, or 0 for that of the dataset", image_width);
}

std::vector<BopTargetErrors> bop_errors(const BopDataset& dataset, std::span<const BopEstimate> estimates,
                                        const BopScoreOptions& options, const Progress& progress) {
  options.check();
  const auto objects = objects_of(dataset);
  const auto images = by_image(dataset);
  const bool with_vsd = options.vsd && has_depth(images);
  std::map<std::tuple<int, int, int>, std::vector<const BopEstimate*>> estimates_of;
  for (const auto& e : estimates) estimates_of[{e.scene_id, e.im_id, e.obj_id}].push_back(&e);

  std::vector<BopTargetErrors> out(dataset.targets.size());
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(images.size(), [&](std::size_t i) {
    const auto& [scene, image, targets] = images[i];
    std::optional<ImageVsd> vsd;
    if (with_vsd) vsd.emplace(images[i], options.vsd_delta_mm);
    for (const std::size_t t : targets) {
      const BopTarget& target = dataset.targets[t];
      TargetInput input;
      input.object = &objects.at(target.obj_id);
      std::vector<double> visibilities, scores;
      for (std::size_t id = 0; id < image->ground_truths.size(); ++id) {
        const auto& truth = image->ground_truths[id];
        if (truth.obj_id != target.obj_id) continue;
        input.truths.emplace_back(static_cast<int>(id), &truth);
        visibilities.push_back(truth.visibility ? truth.visibility->visib_fract : 1.0);
      }
      if (const auto it = estimates_of.find({target.scene_id, target.im_id, target.obj_id}); it != estimates_of.end()) {
        for (const auto* e : it->second) scores.push_back(e->score);
        for (const int k : bop_kept_estimates(scores, target.inst_count))
          input.estimates.emplace_back(k, it->second[k]);
      }
      out[t].target = target;
      for (const int k : bop_valid_ground_truths(visibilities, target.inst_count))
        out[t].gt_ids.push_back(input.truths[k].first);
      add_errors(input, image->camera.K, vsd ? &*vsd : nullptr, out[t]);
    }
    if (!progress) return;
    const std::lock_guard lock(mutex);
    progress("pose errors", ++done, images.size());
  });
  return out;
}

std::vector<int> bop_kept_estimates(std::span<const double> scores, int inst_count) {
  std::vector<int> order(scores.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return scores[a] > scores[b]; });
  order.resize(std::min<std::size_t>(order.size(), std::max(inst_count, 0)));
  return order;
}

std::vector<int> bop_valid_ground_truths(std::span<const double> visib_fracts, int inst_count) {
  std::vector<int> most_visible = bop_kept_estimates(visib_fracts, inst_count);
  std::sort(most_visible.begin(), most_visible.end());
  return most_visible;
}

std::vector<int> bop_matching(std::span<const std::vector<double>> errors, double threshold) {
  std::vector<int> taken_by;
  std::set<int> taken;
  for (const auto& of_estimate : errors) {
    int nearest = -1;
    double smallest = threshold;
    for (int gt = 0; gt < static_cast<int>(of_estimate.size()); ++gt) {
      if (taken.contains(gt) || !(of_estimate[gt] < smallest)) continue;
      nearest = gt;
      smallest = of_estimate[gt];
    }
    if (nearest >= 0) taken.insert(nearest);
    taken_by.push_back(nearest);
  }
  return taken_by;
}

BopScore bop_score(std::span<const BopTargetErrors> targets, BopErrorType type, const BopScoreBasis& basis) {
  const auto thresholds = type == BopErrorType::mspd ? bop_pixels() : bop_fractions();
  const std::size_t taus = type == BopErrorType::vsd ? bop_fractions().size() : 1;
  BopScore out;
  for (std::size_t tau = 0; tau < taus; ++tau)
    for (const double threshold : thresholds) out.recalls.push_back(recall_at(targets, type, tau, threshold, basis));
  const auto count = static_cast<double>(out.recalls.size());
  double sum = 0;
  for (const auto& recall : out.recalls) {
    sum += recall.recall;
    for (const auto& [id, value] : recall.obj_recall) out.obj_recall[id] += value;
  }
  out.average_recall = sum / count;
  for (auto& [id, value] : out.obj_recall) value /= count;
  return out;
}

BopScores score_bop(const BopDataset& dataset, std::span<const BopEstimate> estimates, const BopScoreOptions& options,
                    const Progress& progress) {
  options.check();
  if (dataset.targets.empty()) throw Error("{}: has no targets to score", dataset.folder.string());
  BopScoreBasis basis;
  basis.image_width = image_width_of(dataset, by_image(dataset), options.image_width);
  for (const auto& [id, model] : dataset.models) basis.diameter_mm[id] = model.diameter_mm;
  const auto targets = bop_errors(dataset, estimates, options, progress);

  BopScores out;
  for (const auto& target : targets) {
    out.targets_count += static_cast<int>(target.gt_ids.size());
    out.estimates_kept += static_cast<int>(target.estimates.size());
  }
  out.mssd = bop_score(targets, BopErrorType::mssd, basis);
  out.mspd = bop_score(targets, BopErrorType::mspd, basis);
  if (options.vsd && has_depth(by_image(dataset))) {
    out.vsd = bop_score(targets, BopErrorType::vsd, basis);
    out.average_recall = (out.vsd->average_recall + out.mssd.average_recall + out.mspd.average_recall) / 3;
  }
  out.average_time_per_image_s = bop_average_time_s(estimates);
  return out;
}

double bop_average_time_s(std::span<const BopEstimate> estimates) {
  std::map<std::pair<int, int>, double> time_of_image;
  for (const auto& e : estimates) {
    if (e.time_s < 0) return -1;
    time_of_image.emplace(std::pair{e.scene_id, e.im_id}, e.time_s);
  }
  double sum = 0;
  for (const auto& [image, time_s] : time_of_image) sum += time_s;
  return time_of_image.empty() ? -1 : sum / static_cast<double>(time_of_image.size());
}

}  // namespace partpose
