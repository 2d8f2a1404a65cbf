// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/hypothesis.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/descriptor/crh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace partpose {

namespace {

constexpr int rolls = 24;

std::vector<Eigen::Vector3f> spread(const std::vector<Eigen::Vector3f>& points, int count) {
  if (static_cast<int>(points.size()) <= count) return points;
  std::vector<Eigen::Vector3f> out;
  for (int i = 0; i < count; ++i) out.push_back(points[(2 * i + 1) * points.size() / (2 * count)]);
  return out;
}

/// The object's templates at each turn, for parts of one size.
struct TurnedTemplates {
  std::vector<DepthTemplate> full;
  std::vector<SmallTemplate> small;
};

/// A view of a part at a turn.
struct Look {
  float cost;  ///< in mm3, so that parts of different size compare: each cell stands for its area
  std::int32_t part;
  std::int16_t view, roll;

  bool operator<(const Look& other) const {
    return std::tuple(cost, part, view, roll) < std::tuple(other.cost, other.part, other.view, other.roll);
  }
};

void keep_lowest(std::vector<Look>& looks, std::size_t count) {
  if (looks.size() <= count) return;
  std::nth_element(looks.begin(), looks.begin() + static_cast<std::ptrdiff_t>(count), looks.end());
  looks.resize(count);
}

float cost_of_step(const TemplateScale& scale) {
  return static_cast<float>(scale.depth_unit_mm * scale.cell_mm * scale.cell_mm);
}

/// How badly what a view shows falls into the frame, 0 to 1 for each point.
double reverse_cost(const Hypothesis& hypothesis, const PartModel& model, const ObjectView& view,
                    double tolerance_mm) {
  const DepthImage& depth = *view.frame->depth;
  const Intrinsics& camera = view.frame->camera;
  const Eigen::Isometry3f camera_from_model = hypothesis.camera_from_model.cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const auto tolerance = static_cast<float>(tolerance_mm);
  float cost = 0;
  for (const auto& p : model.views[hypothesis.view].visible_mm) {
    const Eigen::Vector3f q = camera_from_model * p;
    if (!(q.z() > 1)) return 10;
    const float per_z = 1 / q.z();
    const int u = static_cast<int>(std::floor(fx * q.x() * per_z + cx + 0.5f));
    const int v = static_cast<int>(std::floor(fy * q.y() * per_z + cy + 0.5f));
    if (u < 0 || v < 0 || u >= depth.width || v >= depth.height) {
      cost += 0.4f;
      continue;
    }
    const std::size_t pixel = static_cast<std::size_t>(v) * depth.width + u;
    const std::uint8_t label = view.frame->label[pixel];
    const float before_mm = depth.z_mm[pixel] - q.z();
    if (label == FramePieces::not_measured)
      cost += 0.5f;
    else if (view.object->labels.test(label))
      cost += std::min(std::abs(before_mm) / tolerance, 1.0f);
    else
      cost += before_mm > tolerance ? 1.0f : 0.4f;
  }
  return cost / PartView::visible_points;
}

}  // namespace

ObjectView::ObjectView(const FramePieces& pieces, const FrameObject& frame_object)
    : frame(&pieces),
      object(&frame_object),
      points(object_points(pieces, frame_object, 500)),
      few(spread(points.points_mm, 64)),
      many(spread(points.points_mm, 192)),
      all(spread(points.points_mm, 512)),
      noise_mm(std::max(local_noise_mm(pieces, frame_object), 0.1)) {}

std::vector<Hypothesis> shortlist(std::span<const PartModel* const> models, const ObjectView& view,
                                  const ShortlistOptions& options) {
  const Eigen::Vector3d& centre = view.all.centre_mm();
  const Eigen::Matrix3d sight = sight_frame(centre);
  std::vector<Eigen::Vector3f> relative;
  for (const auto& p : view.points.points_mm)
    relative.push_back((sight * (p.cast<double>() - centre)).cast<float>());
  const double spacing_mm = view.points.block_px * centre.norm() / view.frame->camera.fx;

  std::map<double, TurnedTemplates> turned;  // by the cells' size
  for (const PartModel* model : models) {
    auto& templates = turned[model->scale.cell_mm];
    if (!templates.full.empty()) continue;
    for (int k = 0; k < rolls; ++k) {
      templates.full.push_back(make_template(relative, 2 * std::numbers::pi * k / rolls, spacing_mm, model->scale));
      templates.small.push_back(halved(templates.full.back()));
    }
  }

  // All small templates, some parts side by side; each keeps its best.
  std::vector<std::vector<Look>> of_part(models.size());
  constexpr std::size_t kept_small_per_part = 200;
  parallel_for(
      models.size(),
      [&](std::size_t part) {
        const PartModel& model = *models[part];
        const auto& templates = turned.at(model.scale.cell_mm).small;
        const float per_step = 4 * cost_of_step(model.scale);  // a cell covers four
        std::vector<Look>& looks = of_part[part];
        looks.reserve(model.views.size() * rolls);
        for (std::size_t v = 0; v < model.views.size(); ++v)
          for (int k = 0; k < rolls; ++k)
            looks.push_back({per_step * static_cast<float>(capped_difference(model.small_templates[v], templates[k],
                                                                             model.scale.cap)),
                             static_cast<std::int32_t>(part), static_cast<std::int16_t>(v),
                             static_cast<std::int16_t>(k)});
        keep_lowest(looks, kept_small_per_part);
      },
      4);
  std::vector<Look> looks;
  for (const auto& some : of_part) looks.insert(looks.end(), some.begin(), some.end());
  keep_lowest(looks, std::max<std::size_t>(options.small_kept, 0));

  for (Look& look : looks) {
    const PartModel& model = *models[look.part];
    const auto& templates = turned.at(model.scale.cell_mm).full;
    look.cost = cost_of_step(model.scale) *
                static_cast<float>(capped_difference(model.templates[look.view], templates[look.roll], model.scale.cap));
  }
  std::sort(looks.begin(), looks.end());

  std::map<int, int> taken;
  std::vector<Hypothesis> out;
  for (const Look& look : looks) {
    const auto found = taken.find(look.part);
    const bool of_few_parts = found != taken.end() ? found->second < options.kept_per_part
                                                   : static_cast<int>(taken.size()) < options.most_parts;
    if (static_cast<int>(out.size()) >= options.kept && !of_few_parts) continue;
    ++taken[look.part];
    const PartModel& model = *models[look.part];
    Hypothesis h;
    h.part = look.part;
    h.view = look.view;
    h.cost = look.cost;
    h.template_cost = look.cost / cost_of_step(model.scale) / (model.scale.cap * DepthTemplate::cells);
    const Eigen::AngleAxisd roll_back(-2 * std::numbers::pi * look.roll / rolls, Eigen::Vector3d::UnitZ());
    Eigen::Isometry3d camera_from_sight = Eigen::Isometry3d::Identity();
    camera_from_sight.linear() = sight.transpose() * roll_back.toRotationMatrix();
    camera_from_sight.translation() = centre;
    h.start = h.camera_from_model = camera_from_sight * model.views[look.view].sight_from_model.cast<double>();
    out.push_back(h);
  }
  return out;
}

void refine(std::vector<Hypothesis>& hypotheses, std::span<const PartModel* const> models, const ObjectView& view,
            const ProbePoints& probes, int iterations) {
  // One part's after the other's, so that its field stays in the cache.
  std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const auto& a, const auto& b) { return a.part < b.part; });
  parallel_for(
      hypotheses.size(),
      [&](std::size_t i) {
        Hypothesis& h = hypotheses[i];
        const PartModel& model = *models[h.part];
        const double end_mm = std::max(0.01 * model.diameter_mm, view.noise_mm);
        const auto refined = refine_on_field(model.field, h.camera_from_model, probes,
                                             {.start_scale_mm = std::max(0.06 * model.diameter_mm, end_mm),
                                              .end_scale_mm = end_mm,
                                              .max_iterations = iterations});
        h.camera_from_model = refined.camera_from_model;
        h.cost = refined.mean_capped / 3 + reverse_cost(h, model, view, 3 * end_mm);
      },
      8);
  sort_by_cost(hypotheses);
}

std::vector<Hypothesis> distinct(std::vector<Hypothesis> sorted, std::span<const PartModel* const> models) {
  std::vector<Hypothesis> kept;
  for (const auto& h : sorted) {
    const PartModel& model = *models[h.part];
    const bool seen = std::any_of(kept.begin(), kept.end(), [&](const Hypothesis& k) {
      return k.part == h.part &&
             (k.camera_from_model * model.middle_mm - h.camera_from_model * model.middle_mm).norm() <
                 0.05 * model.diameter_mm &&
             rotation_error_deg(k.camera_from_model, h.camera_from_model) < 8;
    });
    if (!seen) kept.push_back(h);
  }
  return kept;
}

std::vector<Hypothesis> best_of(std::vector<Hypothesis> all, std::size_t count, int per_part) {
  sort_by_cost(all);
  std::map<int, int> taken;
  std::vector<Hypothesis> kept;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (taken[all[i].part]++ < per_part || i < count) kept.push_back(all[i]);
  return kept;
}

void sort_by_cost(std::vector<Hypothesis>& hypotheses) {
  std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
}

}  // namespace partpose
