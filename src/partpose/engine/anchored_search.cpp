// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/anchored_search.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/descriptor/crh.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace partpose {

namespace {

constexpr int rolls = 24;

/// The surroundings of a place at each turn, for parts of one size.
struct TurnedWindow {
  Eigen::Vector3d centre_mm;  ///< camera frame
  std::array<SceneCells, rolls> cells;
  std::array<CellSet, rolls> seen;                           ///< where there is a surface
  std::array<int, rolls> unknown;                            ///< number of cells
  std::array<int, SmallTemplate::cells + 1> most_explained;  ///< by the number of a model's surface cells, at any turn
};

/// What is measured around the place: the table counts as background, and what is another part's as so much nearer that
/// it explains nothing.
TurnedWindow turned_window(const FramePieces& frame, const FrameObject& rest, const Eigen::Vector3d& centre_mm,
                           const TemplateScale& scale) {
  const DepthImage& depth = *frame.depth;
  const Intrinsics& camera = frame.camera;
  const Eigen::Matrix3d sight = sight_frame(centre_mm);
  const Eigen::Vector2d middle_px = camera.project(centre_mm);
  const double px_per_mm = camera.fx / centre_mm.z();
  const double reach_px = 1.1 * std::numbers::sqrt2 * DepthTemplate::side / 2 * scale.cell_mm * px_per_mm;
  const int step = std::max(1, static_cast<int>(scale.cell_mm * px_per_mm / 2));
  const auto clamped = [](double x, int count) { return std::clamp(static_cast<int>(x), 0, count - 1); };
  const int u0 = clamped(middle_px.x() - reach_px, depth.width), u1 = clamped(middle_px.x() + reach_px, depth.width);
  const int v0 = clamped(middle_px.y() - reach_px, depth.height), v1 = clamped(middle_px.y() + reach_px, depth.height);
  const double nearer_mm = scale.cap * scale.depth_unit_mm;
  std::vector<Eigen::Vector3f> relative;
  for (int v = v0; v <= v1; v += step)
    for (int u = u0; u <= u1; u += step) {
      const std::size_t p = static_cast<std::size_t>(v) * depth.width + u;
      const std::uint8_t label = frame.label[p];
      const float z = depth.z_mm[p];
      if (label == FramePieces::not_measured) continue;
      const bool unexplained = rest.labels.test(label);
      if (!unexplained && is_on_table(frame, static_cast<std::int32_t>(p))) continue;
      Eigen::Vector3d place = sight * (camera.unproject(u, v, z).cast<double>() - centre_mm);
      if (!unexplained && label != FramePieces::background) place.z() -= nearer_mm;
      relative.push_back(place.cast<float>());
    }
  TurnedWindow out;
  out.centre_mm = centre_mm;
  constexpr int quarter = rolls / 4;
  std::array<SmallTemplate, rolls> turned;
  for (int k = 0; k < quarter; ++k) {
    const double roll_rad = 2 * std::numbers::pi * k / rolls;
    DepthTemplate cells = make_template(relative, roll_rad, step / px_per_mm, scale);
    const Eigen::Matrix3d camera_from_cells =
        sight.transpose() * Eigen::AngleAxisd(-roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    for (int i = 0; i < DepthTemplate::cells; ++i) {
      if (cells.cell[i] != DepthTemplate::background) continue;
      const double x = (i % DepthTemplate::side + 0.5 - DepthTemplate::side / 2) * scale.cell_mm;
      const double y = (i / DepthTemplate::side + 0.5 - DepthTemplate::side / 2) * scale.cell_mm;
      const Eigen::Vector2d pixel = camera.project(centre_mm + camera_from_cells * Eigen::Vector3d(x, y, 0));
      const int u = static_cast<int>(std::floor(pixel.x() + 0.5)), v = static_cast<int>(std::floor(pixel.y() + 0.5));
      if (u < 0 || v < 0 || u >= depth.width || v >= depth.height || !(depth.at(u, v) > 0))
        cells.cell[i] = DepthTemplate::unknown;
    }
    turned[k] = halved(cells);
  }
  for (int k = quarter; k < rolls; ++k) turned[k] = quarter_turned(turned[k - quarter]);
  out.most_explained.fill(0);
  for (int k = 0; k < rolls; ++k) {
    out.cells[k] = SceneCells(turned[k], scale.cap);
    out.seen[k] = cells_with_surface(turned[k]);
    const auto& cells = turned[k].cell;
    out.unknown[k] = static_cast<int>(std::count(cells.begin(), cells.end(), SmallTemplate::unknown));
    for (int surface = 0; surface <= SmallTemplate::cells; ++surface)
      out.most_explained[surface] =
          std::max(out.most_explained[surface],
                   most_explained_cells(surface, std::min(surface, std::popcount(out.seen[k])), out.unknown[k]));
  }
  return out;
}

/// Where so many cells of a model with this surface may be explained: a bit for each turn.
std::uint32_t promising_turns(const TurnedWindow& window, CellSet surface, int least_cells) {
  const int count = std::popcount(surface);
  if (window.most_explained[count] < least_cells) return 0;
  std::uint32_t turns = 0;
  for (int k = 0; k < rolls; ++k) {
    const int seen = std::popcount(surface & window.seen[k]);
    turns |= std::uint32_t{most_explained_cells(count, seen, window.unknown[k]) >= least_cells} << k;
  }
  return turns;
}

/// An anchored view at a turn.
struct Look {
  float mm2;  ///< of surface that it explains, less what speaks against it
  std::int32_t part, anchor;
  std::int16_t seed;
  std::int8_t roll;

  bool operator<(const Look& other) const {
    return std::tuple(-mm2, part, anchor, seed, roll) <
           std::tuple(-other.mm2, other.part, other.anchor, other.seed, other.roll);
  }
};

void keep_best(std::vector<Look>& looks, std::size_t count) {
  if (looks.size() <= count) return;
  std::nth_element(looks.begin(), looks.begin() + static_cast<std::ptrdiff_t>(count), looks.end());
  looks.resize(count);
}

/// The best `per_part` of each part, and of what is left the best, up to `count`: lest what shows much of a large part
/// crowds out what shows little of a small one. Changes the order of `of_part`.
std::vector<Look> best_of_each_part(std::vector<std::vector<Look>>& of_part, std::size_t per_part, std::size_t count) {
  std::vector<Look> kept, others;
  for (auto& looks : of_part) {
    std::sort(looks.begin(), looks.end());
    const auto first_other = looks.begin() + static_cast<std::ptrdiff_t>(std::min(per_part, looks.size()));
    kept.insert(kept.end(), looks.begin(), first_other);
    others.insert(others.end(), first_other, looks.end());
  }
  keep_best(others, count > kept.size() ? count - kept.size() : 0);
  kept.insert(kept.end(), others.begin(), others.end());
  return kept;
}

Hypothesis start_of(const Look& look, const PartModel& model, const Eigen::Vector3d& centre_mm) {
  const AnchoredViews::Anchor& anchor = model.anchored.anchors[look.anchor];
  const Eigen::AngleAxisd roll_back(-2 * std::numbers::pi * look.roll / rolls, Eigen::Vector3d::UnitZ());
  Eigen::Isometry3d camera_from_sight = Eigen::Isometry3d::Identity();
  camera_from_sight.linear() = sight_frame(centre_mm).transpose() * roll_back.toRotationMatrix();
  camera_from_sight.translation() = centre_mm;
  Hypothesis h;
  h.part = look.part;
  h.view = anchor.view;
  h.seed = look.seed;
  h.cost = -look.mm2;
  h.start = h.camera_from_model = camera_from_sight * anchor.sight_from_model.cast<double>();
  return h;
}

/// Mm2 of `rest` that what the view shows of the part explains, less where the part cannot be.
double explained_mm2(const Hypothesis& h, const PartModel& model, const FramePieces& frame, const FrameObject& rest,
                     float tolerance_mm) {
  const DepthImage& depth = *frame.depth;
  const Intrinsics& camera = frame.camera;
  const Eigen::Isometry3f camera_from_model = h.camera_from_model.cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const PartView& view = model.views[h.view];
  float sum = 0;
  for (const auto& p : view.visible_mm) {
    const Eigen::Vector3f q = camera_from_model * p;
    if (!(q.z() > 1)) return -1e9;
    const int u = static_cast<int>(std::floor(fx * q.x() / q.z() + cx + 0.5f));
    const int v = static_cast<int>(std::floor(fy * q.y() / q.z() + cy + 0.5f));
    if (u < 0 || v < 0 || u >= depth.width || v >= depth.height) continue;
    const std::size_t pixel = static_cast<std::size_t>(v) * depth.width + u;
    const std::uint8_t label = frame.label[pixel];
    if (label == FramePieces::not_measured) continue;
    const float behind_mm = depth.z_mm[pixel] - q.z();  // of what was measured
    if (rest.labels.test(label)) {
      const float share = behind_mm / tolerance_mm;
      sum += std::abs(share) < 1 ? 1 - share * share : share > 1 ? -1.0f : -0.1f;
    } else if (label == FramePieces::background && is_on_table(frame, static_cast<std::int32_t>(pixel))) {
      sum -= std::abs(behind_mm) < tolerance_mm ? 0.2f : 1.0f;
    } else {
      sum -= behind_mm > tolerance_mm ? 1.0f : behind_mm > -tolerance_mm ? 0.5f : 0.1f;
    }
  }
  return sum / PartView::visible_points * view.seen_mm2;
}

/// Of each seed the best.
std::vector<Hypothesis> best_of_each_seed(const std::vector<Hypothesis>& sorted, std::size_t count) {
  std::map<int, std::size_t> taken;
  std::vector<Hypothesis> kept;
  for (const auto& h : sorted)
    if (taken[h.seed]++ < count) kept.push_back(h);
  return kept;
}

void refine_each(std::vector<Hypothesis>& hypotheses, std::span<const PartModel* const> models,
                 const FramePieces& frame, const FrameObject& rest, const std::vector<Eigen::Vector3f>& points,
                 double noise_mm, std::size_t probes, double start_share, double end_share, int iterations) {
  move_each(hypotheses, [&](Hypothesis& h) {
    const PartModel& model = *models[h.part];
    const Eigen::Vector3f middle = (h.camera_from_model * model.middle_mm).cast<float>();
    const auto reach = static_cast<float>(0.55 * model.diameter_mm);
    std::vector<int> near(points.size());
    std::size_t count = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      near[count] = static_cast<int>(p);
      count += (points[p] - middle).squaredNorm() < reach * reach;
    }
    const std::size_t taken = std::min(count, probes);
    std::vector<Eigen::Vector3f> some(taken);
    for (std::size_t k = 0; k < taken; ++k) some[k] = points[near[(2 * k + 1) * count / (2 * taken)]];
    const double end_mm = std::max(end_share * model.diameter_mm, noise_mm);
    const auto refined = refine_on_field(model.field, h.camera_from_model, ProbePoints(some),
                                         {.start_scale_mm = std::max(start_share * model.diameter_mm, end_mm),
                                          .end_scale_mm = end_mm,
                                          .max_iterations = iterations});
    h.camera_from_model = refined.camera_from_model;
    h.cost = -explained_mm2(h, model, frame, rest, static_cast<float>(3 * end_mm));
  });
}

}  // namespace

std::vector<Hypothesis> anchored_hypotheses(std::span<const PartModel* const> models, const FramePieces& frame,
                                            const FrameObject& rest, const AnchoredSearch& search) {
  constexpr int wanted_points = 1500;
  const ObjectView view(frame, rest);
  const std::vector<Eigen::Vector3f> points = object_points(frame, rest, wanted_points).points_mm;
  if (points.size() < 20) return {};
  const std::vector<int> seeds = spread_places(points, search.most_seeds);

  std::map<double, std::vector<TurnedWindow>> windows;  // by the cells' size
  for (const PartModel* model : models) {
    if (!model) continue;
    auto& of_size = windows[model->scale.cell_mm];
    if (!of_size.empty()) continue;
    of_size.resize(seeds.size());
    parallel_for(seeds.size(), [&](std::size_t s) {
      of_size[s] = turned_window(frame, rest, local_mean(points, points[seeds[s]], model->scale.cell_mm), model->scale);
    });
  }

  constexpr std::size_t kept_per_seed = 40, of_all_parts = 72, most_per_part = 12, least_per_part = 2;
  const auto parts =
      static_cast<std::size_t>(std::count_if(models.begin(), models.end(), [](const auto* m) { return m; }));
  const std::size_t kept_per_part =
      search.every_part ? std::clamp(of_all_parts / std::max<std::size_t>(parts, 1), least_per_part, most_per_part) : 0;
  std::vector<std::vector<Look>> of_seed(seeds.size());
  parallel_for(seeds.size(), [&](std::size_t s) {
    std::vector<std::vector<Look>> of_part;
    for (std::size_t part = 0; part < models.size(); ++part) {
      if (!models[part]) continue;
      const PartModel& model = *models[part];
      const auto mm2_per_step = static_cast<float>(4 * model.scale.cell_mm * model.scale.cell_mm / model.scale.cap);
      const TurnedWindow& window = windows.at(model.scale.cell_mm)[s];
      std::vector<Look> looks;
      std::array<std::int16_t, rolls> steps;
      int least = 1;
      for (std::size_t a = 0; a < model.anchored.templates.size(); ++a) {
        const std::uint32_t promising =
            promising_turns(window, model.anchored.anchors[a].surface, (least + model.scale.cap - 1) / model.scale.cap);
        if (promising == 0) continue;
        explained_steps(model.anchored.templates[a], window.cells, promising, model.scale.cap, steps.data());
        for (int k = 0; k < rolls; ++k)
          if ((promising >> k & 1) != 0 && steps[k] >= least)
            looks.push_back({mm2_per_step * static_cast<float>(steps[k]), static_cast<std::int32_t>(part),
                             static_cast<std::int32_t>(a), static_cast<std::int16_t>(s), static_cast<std::int8_t>(k)});
        // What is worse than the best so far need not be kept.
        if (looks.size() < 4 * most_per_part) continue;
        keep_best(looks, most_per_part);
        const auto worst = std::max_element(looks.begin(), looks.end());
        least = static_cast<int>(worst->mm2 / mm2_per_step);
      }
      keep_best(looks, most_per_part);
      of_part.push_back(std::move(looks));
    }
    of_seed[s] = best_of_each_part(of_part, kept_per_part, kept_per_seed);
  });

  std::vector<Hypothesis> hypotheses;
  for (const auto& looks : of_seed)
    for (const Look& look : looks) {
      const PartModel& model = *models[look.part];
      hypotheses.push_back(start_of(look, model, windows.at(model.scale.cell_mm)[look.seed].centre_mm));
    }
  refine_each(hypotheses, models, frame, rest, points, view.noise_mm, 64, 0.06, 0.01, 6);
  drop_sunk(hypotheses, models, view, 0.12);
  constexpr std::size_t kept_at_first = 10, kept = 5;
  hypotheses = best_of_each_seed(distinct(std::move(hypotheses), models), kept_at_first);
  refine_each(hypotheses, models, frame, rest, points, view.noise_mm, 192, 0.06, 0.01, 8);
  drop_sunk(hypotheses, models, view, 0.08);
  hypotheses = best_of_each_seed(distinct(std::move(hypotheses), models), kept);
  refine_each(hypotheses, models, frame, rest, points, view.noise_mm, 512, 0.02, 0.005, 6);
  return distinct(std::move(hypotheses), models);
}

}  // namespace partpose
