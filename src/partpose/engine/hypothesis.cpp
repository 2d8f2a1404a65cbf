// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/hypothesis.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/descriptor/crh.hpp"
#include "partpose/engine/template_scan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

namespace partpose {

namespace {

constexpr double table_off_mm = 8;  ///< of a camera that bends it where a part hides it

double tolerance_mm(const PartModel& model, double share, double noise_mm) {
  return std::max(share * model.diameter_mm, 3 * noise_mm);
}

std::vector<Eigen::Vector3f> spread(const std::vector<Eigen::Vector3f>& points, int count) {
  if (static_cast<int>(points.size()) <= count) return points;
  std::vector<Eigen::Vector3f> out;
  for (int i = 0; i < count; ++i) out.push_back(points[(2 * i + 1) * points.size() / (2 * count)]);
  return out;
}

/// Where something nearer hides a part of the object, if anything does: the middle of the outline there, camera frame.
std::optional<Eigen::Vector3d> hidden_side(const ObjectView& view) {
  const DepthImage& depth = *view.frame->depth;
  constexpr int near_px = 6, reach_px = 36;
  constexpr double least_share = 0.08;
  const FrameObject& object = *view.object;
  const int step = std::max(1, view.points.block_px / 2);
  const auto is_object = [&](int u, int v) {
    return object.labels.test(view.frame->label[static_cast<std::size_t>(v) * depth.width + u]);
  };
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int hidden = 0, outline = 0;
  for (int v = std::max(object.v0, near_px); v <= std::min(object.v1, depth.height - 1 - near_px); v += step)
    for (int u = std::max(object.u0, near_px); u <= std::min(object.u1, depth.width - 1 - near_px); u += step) {
      if (!is_object(u, v)) continue;
      const float z = depth.at(u, v);
      for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        // Beside what is in front a stereo camera sees nothing for some pixels.
        if (is_object(u + du * near_px, v + dv * near_px)) continue;
        ++outline;
        for (int away = near_px; away <= reach_px; away += near_px) {
          const int uu = u + du * away, vv = v + dv * away;
          if (uu < 0 || vv < 0 || uu >= depth.width || vv >= depth.height) break;
          const float beside = depth.at(uu, vv);
          if (!(beside > 0)) continue;
          // Seen at a slant, the table before an object is nearer to the camera.
          if (!is_object(uu, vv) && beside < z - 8 && !is_on_table(*view.frame, vv * depth.width + uu)) {
            ++hidden;
            sum += view.frame->camera.unproject(u, v, z).cast<double>();
          }
          if (away > near_px) break;
        }
      }
    }
  if (hidden < 6 || hidden < least_share * outline) return std::nullopt;
  return Eigen::Vector3d(sum / hidden);
}

/// Cells that no point fell into are background only where something farther was measured.
void mark_unknown(DepthTemplate& cells, const ObjectView& view, const Eigen::Vector3d& centre_mm,
                  const Eigen::Matrix3d& camera_from_cells, double cell_mm) {
  const DepthImage& depth = *view.frame->depth;
  const Intrinsics& camera = view.frame->camera;
  for (int i = 0; i < DepthTemplate::cells; ++i) {
    if (cells.cell[i] != DepthTemplate::background) continue;
    const double x = (i % DepthTemplate::side + 0.5 - DepthTemplate::side / 2) * cell_mm;
    const double y = (i / DepthTemplate::side + 0.5 - DepthTemplate::side / 2) * cell_mm;
    const Eigen::Vector3d place = centre_mm + camera_from_cells * Eigen::Vector3d(x, y, 0);
    if (!(place.z() > 1)) continue;
    const int u = static_cast<int>(std::floor(camera.fx * place.x() / place.z() + camera.cx + 0.5));
    const int v = static_cast<int>(std::floor(camera.fy * place.y() / place.z() + camera.cy + 0.5));
    const bool outside = u < 0 || v < 0 || u >= depth.width || v >= depth.height;
    if (outside || !(depth.at(u, v) > 0) || depth.at(u, v) < place.z() - 2 * cell_mm)
      cells.cell[i] = DepthTemplate::unknown;
  }
}

TurnedTemplates turned_templates(const ObjectView& view, const Eigen::Vector3d& centre_mm, const TemplateScale& scale,
                                 bool with_unknown) {
  const Eigen::Matrix3d sight = sight_frame(centre_mm);
  std::vector<Eigen::Vector3f> relative;
  relative.reserve(view.points.points_mm.size());
  for (const auto& p : view.points.points_mm)
    relative.push_back((sight * (p.cast<double>() - centre_mm)).cast<float>());
  const double spacing_mm = view.points.block_px * centre_mm.norm() / view.frame->camera.fx;
  TurnedTemplates out;
  out.centre_mm = centre_mm;
  constexpr int quarter = rolls / 4;
  for (int k = 0; k < quarter; ++k) {
    const double roll_rad = 2 * std::numbers::pi * k / rolls;
    DepthTemplate cells = make_template(relative, roll_rad, spacing_mm, scale);
    if (with_unknown) {
      const Eigen::AngleAxisd roll_back(-roll_rad, Eigen::Vector3d::UnitZ());
      mark_unknown(cells, view, centre_mm, sight.transpose() * roll_back.toRotationMatrix(), scale.cell_mm);
    }
    out.full.push_back(cells);
    out.small.push_back(halved(cells));
  }
  for (int k = quarter; k < rolls; ++k) {
    out.full.push_back(quarter_turned(out.full[k - quarter]));
    out.small.push_back(quarter_turned(out.small[k - quarter]));
  }
  const double reach_mm = DepthTemplate::side / 2 * scale.cell_mm;
  for (const auto& p : relative)
    if (p.head<2>().norm() > reach_mm) out.beyond_mm2 += static_cast<float>(spacing_mm * spacing_mm);
  const auto unknown = std::count(out.full[0].cell.begin(), out.full[0].cell.end(), DepthTemplate::unknown);
  out.known = 1 - static_cast<float>(unknown) / DepthTemplate::cells;
  return out;
}

/// About the centroid of what is visible; of an object that is partly hidden also about where the centroid of the whole
/// may be.
std::vector<TurnedTemplates> all_turned_templates(const ObjectView& view, const TemplateScale& scale,
                                                  const std::optional<Eigen::Vector3d>& hidden) {
  const Eigen::Vector3d& centre = view.all.centre_mm();
  std::vector<TurnedTemplates> out;
  out.push_back(turned_templates(view, centre, scale, hidden.has_value()));
  if (!hidden) return out;
  const double size_mm = 12 * scale.cell_mm;
  const Eigen::Vector3d sight = centre.normalized();
  Eigen::Vector3d aside = *hidden - centre;
  aside -= sight.dot(aside) * sight;
  if (!(aside.norm() > 1e-3)) return out;
  aside.normalize();
  for (const double across : {0.1, 0.2, 0.32})
    for (const double along : {-0.08, 0.0, 0.08})
      out.push_back(turned_templates(view, centre + size_mm * (across * aside + along * sight), scale, true));
  return out;
}

/// How badly what a view shows falls into the frame, 0 to 1 for each point.
double reverse_cost(const Hypothesis& hypothesis, const PartModel& model, const ObjectView& view, double tolerance_mm) {
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

/// The most of what is known of it: what neighbouring pixels show, what the table shows (slow waves are in it; by the
/// square law of triangulation it grows with the distance), and what no stereo camera falls below.
double expected_noise_mm(const FramePieces& frame, const FrameObject& object, const Eigen::Vector3d& centre_mm,
                         double local_noise_mm) {
  constexpr double disparity_px = 0.1, near_mm = 0.4;
  const double z_mm = centre_mm.z();
  double noise_mm = std::max(
      local_noise_mm, std::hypot(near_mm, z_mm * z_mm * disparity_px / (frame.camera.fx * FramePieces::baseline_mm)));
  if (frame.table && !object.whole_frame) {
    const Eigen::Vector3d ray = centre_mm / z_mm, q = frame.table->q.cast<double>();
    const double inverse_table_z = q.dot(ray);
    const double along_ray = inverse_table_z / q.norm();  // of a height's change, for each of depth
    if (along_ray > 0.2)
      noise_mm = std::max(noise_mm, frame.table->rms_mm / along_ray * std::pow(z_mm * inverse_table_z, 2));
  }
  return noise_mm;
}

}  // namespace

ObjectView::ObjectView(const FramePieces& pieces, const FrameObject& frame_object)
    : frame(&pieces),
      object(&frame_object),
      points(object_points(pieces, frame_object, 500)),
      few(spread(points.points_mm, 64)),
      many(spread(points.points_mm, 192)),
      all(spread(points.points_mm, 512)),
      local_noise_mm(partpose::local_noise_mm(pieces, frame_object)),
      noise_mm(expected_noise_mm(pieces, frame_object, all.centre_mm(), local_noise_mm)) {}

std::optional<double> height_above_table_mm(const FramePieces& frame, const PartModel& model,
                                            const Eigen::Isometry3d& camera_from_model) {
  if (!frame.table) return std::nullopt;
  const Eigen::Isometry3f pose = camera_from_model.cast<float>();
  const auto fx = static_cast<float>(frame.camera.fx), fy = static_cast<float>(frame.camera.fy);
  const auto cx = static_cast<float>(frame.camera.cx), cy = static_cast<float>(frame.camera.cy);
  const FlatSurface& table = *frame.table;
  const float offset_mm = 1 / table.q.norm(), most_bend_mm = table.most_bend_mm(frame.camera);
  const Eigen::Vector3f normal = table.q * offset_mm, normal_in_model = pose.linear().transpose() * normal;
  const float origin_on_plane_mm = offset_mm - normal.dot(pose.translation());
  std::optional<double> lowest_mm;
  // What is higher above the plane than the lowest by more than the bend can make up for is not the lowest.
  float highest_on_plane_mm = std::numeric_limits<float>::infinity();
  for (const auto& p : model.samples_mm) {
    const float on_plane_mm = origin_on_plane_mm - normal_in_model.dot(p);
    if (on_plane_mm > highest_on_plane_mm) continue;
    const Eigen::Vector3f q = pose * p;
    if (!(q.z() > 1)) continue;
    const float ray_x = q.x() / q.z(), ray_y = q.y() / q.z();
    const float u = fx * ray_x + cx, v = fy * ray_y + cy;
    if (!(u >= 0 && v >= 0 && u < frame.camera.width && v < frame.camera.height)) continue;
    highest_on_plane_mm = std::min(highest_on_plane_mm, on_plane_mm + 2 * most_bend_mm);
    const double height_mm = on_plane_mm - table.bend_mm_at(ray_x, ray_y);
    if (!lowest_mm || height_mm < *lowest_mm) lowest_mm = height_mm;
  }
  return lowest_mm;
}

double touch_tolerance_mm(const PartModel& model, double noise_mm) {
  return tolerance_mm(model, touching_share, noise_mm);
}

bool touches(const PartModel& a, const Eigen::Isometry3d& camera_from_a, const PartModel& b,
             const Eigen::Isometry3d& camera_from_b, double tolerance_mm) {
  const Eigen::Isometry3f b_from_a = (camera_from_b.inverse() * camera_from_a).cast<float>();
  return std::any_of(a.samples_mm.begin(), a.samples_mm.end(),
                     [&](const auto& p) { return b.field.at(b_from_a * p).distance_mm < tolerance_mm; });
}

bool sinks_into_table(const FramePieces& frame, const PartModel& model, const Eigen::Isometry3d& camera_from_model,
                      double tolerance_mm) {
  const auto height_mm = height_above_table_mm(frame, model, camera_from_model);
  return height_mm && *height_mm < -std::max(tolerance_mm, table_off_mm);
}

void drop_sunk(std::vector<Hypothesis>& hypotheses, std::span<const PartModel* const> models, const ObjectView& view,
               double share) {
  if (view.object->whole_frame) return;
  std::vector<std::uint8_t> sunk(hypotheses.size());
  parallel_for(
      hypotheses.size(),
      [&](std::size_t i) {
        const Hypothesis& h = hypotheses[i];
        const PartModel& model = *models[h.part];
        sunk[i] = sinks_into_table(*view.frame, model, h.camera_from_model, tolerance_mm(model, share, view.noise_mm));
      },
      8);
  std::vector<Hypothesis> kept;
  for (std::size_t i = 0; i < hypotheses.size(); ++i)
    if (sunk[i] == 0) kept.push_back(hypotheses[i]);
  hypotheses = std::move(kept);
}

bool lies_low(const ObjectView& view) {
  constexpr double most_high = 0.1;  // of the points
  const auto& points = view.points.points_mm;
  if (!view.frame->table) return false;
  const auto high = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3f& p) {
    return view.frame->table->height_mm(p / p.z(), p.z()) > table_off_mm;
  });
  return static_cast<double>(high) < most_high * static_cast<double>(points.size());
}

bool is_partly_hidden(const ObjectView& view) { return hidden_side(view).has_value(); }

std::vector<Hypothesis> shortlist(std::span<const PartModel* const> models, const ObjectView& view,
                                  const ShortlistOptions& options) {
  const auto hidden = options.look_behind ? hidden_side(view) : std::nullopt;
  const int parts = static_cast<int>(models.size());
  const int places = hidden ? 5 : 1;  // what is partly hidden looks like more
  // Among many parts the right one has more before it, but nearly always it is the best of its own looks.
  const int before = std::clamp(static_cast<int>(std::sqrt(parts / 20.0)), 1, 8);
  TurnedByScale turned;
  std::vector<std::pair<const TemplateScale*, std::vector<TurnedTemplates>*>> scales;
  for (const PartModel* model : models)
    if (const auto [found, is_new] = turned.try_emplace(model->scale.cell_mm); is_new)
      scales.emplace_back(&model->scale, &found->second);
  parallel_for(scales.size(),
               [&](std::size_t i) { *scales[i].second = all_turned_templates(view, *scales[i].first, hidden); });

  const int small_per_part = places * std::max(16, 1200 / std::max(parts, 1));
  const int small_kept = options.every_part ? parts * small_per_part : places * std::max(1000, 400 * before);
  std::vector<Look> looks = best_looks(models, turned, small_per_part, small_kept);
  constexpr std::size_t looks_at_once = 256;
  parallel_for(
      looks.size(),
      [&](std::size_t i) {
        Look& look = looks[i];
        const PartModel& model = *models[look.part];
        const TurnedTemplates& templates = turned.at(model.scale.cell_mm)[look.place];
        const int steps = capped_difference(model.templates[look.view], templates.full[look.roll], model.scale.cap);
        look.cost = templates.beyond_mm2 + cost_of_step(model.scale) / templates.known * static_cast<float>(steps);
      },
      looks_at_once);
  std::sort(looks.begin(), looks.end());

  const int kept = options.every_part ? 0 : 60 * places * before;
  const int kept_per_part = options.every_part ? 3 : 8;
  const int most_parts = options.every_part ? parts : 12;
  struct Taken {
    int rank, count = 0;
  };
  std::map<int, Taken> taken;
  std::vector<Hypothesis> out;
  for (const Look& look : looks) {
    Taken& of_part = taken.try_emplace(look.part, Taken{static_cast<int>(taken.size())}).first->second;
    const bool in_any_case = of_part.rank < most_parts && of_part.count < kept_per_part;
    if (static_cast<int>(out.size()) >= kept && !in_any_case) continue;
    ++of_part.count;
    const PartModel& model = *models[look.part];
    Hypothesis h;
    h.part = look.part;
    h.view = look.view;
    h.cost = look.cost;
    h.template_cost = look.cost / (model.scale.cell_mm * model.scale.cell_mm * DepthTemplate::cells);
    const Eigen::AngleAxisd roll_back(-2 * std::numbers::pi * look.roll / rolls, Eigen::Vector3d::UnitZ());
    Eigen::Isometry3d camera_from_sight = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d& centre = turned.at(model.scale.cell_mm)[look.place].centre_mm;
    camera_from_sight.linear() = sight_frame(centre).transpose() * roll_back.toRotationMatrix();
    camera_from_sight.translation() = centre;
    h.start = h.camera_from_model = camera_from_sight * model.views[look.view].sight_from_model.cast<double>();
    out.push_back(h);
  }
  return out;
}

std::vector<Hypothesis> at_rest(std::span<const PartModel* const> models, const ObjectView& view) {
  constexpr int turns = 24, least_high = 4;  // of a view's visible points
  constexpr std::size_t kept_per_part = 16;
  if (!view.frame->table) return {};
  const FlatSurface& table = *view.frame->table;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  int high = 0;
  for (const auto& p : view.points.points_mm)
    if (table.height_mm(p / p.z(), p.z()) > table_off_mm) centre += p.cast<double>(), ++high;
  if (high < least_high) return {};
  centre /= high;
  const Eigen::Vector3d down = table.q.cast<double>().normalized(), sight = centre.normalized();
  const Eigen::Vector3f ray = (centre / centre.z()).cast<float>();
  const double table_mm = 1 / table.q.cast<double>().norm() - table.bend_mm_at(ray.x(), ray.y());  // along `down`

  std::vector<std::vector<Hypothesis>> of_part(models.size());
  parallel_for(models.size(), [&](std::size_t part) {
    if (!models[part]) return;
    const PartModel& model = *models[part];
    const double cap_mm = std::max(0.06 * model.diameter_mm, 3 * view.noise_mm);
    for (const auto& rest : model.rests)
      for (int k = 0; k < turns; ++k) {
        Hypothesis h;
        h.part = static_cast<int>(part);
        h.at_rest = true;
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(2 * std::numbers::pi * k / turns, down).toRotationMatrix() *
                                     Eigen::Quaterniond::FromTwoVectors(rest.down, down).toRotationMatrix();
        h.view = model.view_from(turn.transpose() * sight);
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of what of the part is high, model frame
        int high_places = 0;
        for (const auto& p : model.views[h.view].visible_mm)
          if (rest.origin_height_mm - rest.down.dot(p.cast<double>()) > table_off_mm)
            middle += p.cast<double>(), ++high_places;
        if (high_places < least_high) continue;
        middle /= high_places;
        h.camera_from_model.linear() = turn;
        Eigen::Vector3d origin = centre - turn * middle;
        origin += (table_mm - rest.origin_height_mm - down.dot(origin)) * down;
        h.camera_from_model.translation() = origin;
        h.start = h.camera_from_model;
        h.cost = mean_distance_mm(model.field, h.camera_from_model, view.few, cap_mm) / cap_mm;
        of_part[part].push_back(h);
      }
    sort_by_cost(of_part[part]);
    if (of_part[part].size() > kept_per_part) of_part[part].resize(kept_per_part);
  });
  std::vector<Hypothesis> out;
  for (auto& some : of_part) out.insert(out.end(), some.begin(), some.end());
  sort_by_cost(out);
  return out;
}

std::optional<Eigen::Vector3d> upright_of(const Hypothesis& hypothesis, const ObjectView& view) {
  if (!hypothesis.at_rest) return std::nullopt;
  return view.frame->table->q.cast<double>().normalized();
}

void refine(std::vector<Hypothesis>& hypotheses, std::span<const PartModel* const> models, const ObjectView& view,
            const ProbePoints& probes, int iterations) {
  move_each(hypotheses, [&](Hypothesis& h) {
    const PartModel& model = *models[h.part];
    const double end_mm = std::max(0.01 * model.diameter_mm, view.noise_mm);
    const auto refined = refine_on_field(model.field, h.camera_from_model, probes,
                                         {.start_scale_mm = std::max(0.06 * model.diameter_mm, end_mm),
                                          .end_scale_mm = end_mm,
                                          .max_iterations = iterations,
                                          .upright = upright_of(h, view)});
    h.camera_from_model = refined.camera_from_model;
    h.cost = refined.mean_capped / 3 + reverse_cost(h, model, view, 3 * end_mm);
  });
}

void move_each(std::vector<Hypothesis>& hypotheses, const std::function<void(Hypothesis&)>& move) {
  std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const auto& a, const auto& b) { return a.part < b.part; });
  constexpr std::size_t at_once = 8;
  parallel_for(
      hypotheses.size(), [&](std::size_t i) { move(hypotheses[i]); }, at_once);
  sort_by_cost(hypotheses);
}

std::vector<Hypothesis> distinct(std::vector<Hypothesis> sorted, std::span<const PartModel* const> models) {
  std::vector<Hypothesis> kept;
  for (const auto& h : sorted) {
    const bool seen = std::any_of(kept.begin(), kept.end(), [&](const Hypothesis& k) {
      return k.part == h.part && models[h.part]->is_about_the_same(k.camera_from_model, h.camera_from_model);
    });
    if (!seen) kept.push_back(h);
  }
  return kept;
}

std::vector<Hypothesis> best_turns(const Hypothesis& hypothesis, const PartModel& model, const ObjectView& view,
                                   std::size_t most) {
  constexpr int turns = 72;
  const double cap_mm = 3 * std::max(0.005 * model.diameter_mm, view.noise_mm);
  std::vector<Hypothesis> out;
  for (const auto& axis : model.nearly_round) {
    std::array<Hypothesis, turns> turned;
    parallel_for(turns, [&](std::size_t k) {
      turned[k] = hypothesis;
      turned[k].camera_from_model =
          hypothesis.camera_from_model * axis.turn(2 * std::numbers::pi * static_cast<double>(k) / turns);
      turned[k].cost = mean_distance_mm(model.field, turned[k].camera_from_model, view.many, cap_mm);
    });
    std::vector<Hypothesis> best;
    for (int k = 1; k < turns; ++k)
      if (turned[k].cost <= turned[k - 1].cost && turned[k].cost <= turned[(k + 1) % turns].cost)
        best.push_back(turned[k]);
    sort_by_cost(best);
    if (best.size() > most) best.resize(most);
    out.insert(out.end(), best.begin(), best.end());
  }
  return out;
}

std::vector<Hypothesis> in_place_of(const Hypothesis& hypothesis, std::span<const PartModel* const> models,
                                    const ObjectView& view, double most_difference) {
  constexpr std::size_t most = 24;
  static const std::vector<Eigen::Matrix3d> axis_turns = [] {
    std::vector<Eigen::Matrix3d> turns;
    std::array<int, 3> axis = {0, 1, 2};
    do
      for (int signs = 0; signs < 8; ++signs) {
        Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
        for (int k = 0; k < 3; ++k) turn(axis[k], k) = signs >> k & 1 ? -1 : 1;
        if (turn.determinant() > 0) turns.push_back(turn);
      }
    while (std::next_permutation(axis.begin(), axis.end()));
    return turns;
  }();
  const PartModel& brother = *models[hypothesis.part];
  const Eigen::Vector3d size_mm = brother.box_mm.sizes();
  std::vector<Hypothesis> found;
  for (int part = 0; part < static_cast<int>(models.size()); ++part) {
    const PartModel& model = *models[part];
    const double most_mm = most_difference * brother.diameter_mm;
    if (part == hypothesis.part || std::abs(model.diameter_mm - brother.diameter_mm) > 2 * most_mm) continue;
    for (const auto& turn : axis_turns) {
      const double differs_mm = (turn.cwiseAbs() * model.box_mm.sizes() - size_mm).cwiseAbs().maxCoeff();
      if (differs_mm > most_mm) continue;
      Hypothesis h = hypothesis;
      h.part = part;
      h.view = 0;
      Eigen::Isometry3d brother_from_model = Eigen::Isometry3d::Identity();
      brother_from_model.linear() = turn;
      brother_from_model.translation() = brother.middle_mm - turn * model.middle_mm;
      h.start = h.camera_from_model = hypothesis.camera_from_model * brother_from_model;
      const double cap_mm = std::max(most_mm, 3 * view.noise_mm);
      h.cost = mean_distance_mm(model.field, h.camera_from_model, view.many, cap_mm);
      found.push_back(h);
    }
  }
  sort_by_cost(found);
  if (found.size() > most) found.resize(most);
  return found;
}

std::vector<Hypothesis> best_of(std::vector<Hypothesis> all, std::size_t count, int per_part) {
  sort_by_cost(all);
  constexpr std::size_t most_parts = 12;
  std::map<int, int> taken;
  std::vector<Hypothesis> kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i >= count && taken.size() >= most_parts && !taken.count(all[i].part)) continue;
    if (taken[all[i].part]++ < per_part || i < count) kept.push_back(all[i]);
  }
  return kept;
}

void sort_by_cost(std::vector<Hypothesis>& hypotheses) {
  std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
}

}  // namespace partpose
