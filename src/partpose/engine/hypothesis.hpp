// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/engine/field_refinement.hpp"
#include "partpose/engine/frame_pieces.hpp"
#include "partpose/engine/object_points.hpp"
#include "partpose/engine/part_model.hpp"

#include <Eigen/Geometry>

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace partpose {

/// A part at a pose, with a cost by which hypotheses of one stage are compared: the lower the better.
struct Hypothesis {
  int part = -1, view = -1;
  int seed = -1;               ///< the place in the frame that the start is about, where it is about one
  std::size_t comparison = 0;  ///< of its rendering with the frame, where the stage keeps them: which one
  bool at_rest = false;        ///< on the table by itself: it only moves and turns on it
  double cost = 0;
  double left_mm = 0;                                       ///< mean distance of the object's points, each to a limit
  double template_cost = 0;                                 ///< mean difference of the template's cells, in caps
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  ///< by the template
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
};

/// An object of a frame as the stages see it.
struct ObjectView {
  ObjectView(const FramePieces& pieces, const FrameObject& frame_object);

  const FramePieces* frame;
  const FrameObject* object;
  ObjectPoints points;
  ProbePoints few, many, all;  ///< of the points: for a first, a second and the last look
  double local_noise_mm;       ///< as neighbouring pixels show it
  double noise_mm;             ///< standard deviation of the depths to be expected about a surface that is right
};

struct ShortlistOptions {
  bool every_part = false;   ///< also those that are little like the object
  bool look_behind = false;  ///< what is hidden by something nearer may be anything there
};

/// How far above the table the part's lowest place lies that the frame covers; below 0 it sinks into it. None where
/// there is no table, or nothing of the part is before the camera.
std::optional<double> height_above_table_mm(const FramePieces& frame, const PartModel& model,
                                            const Eigen::Isometry3d& camera_from_model);

/// A part that is as near to something touches it: this share of its diameter, a turn that is off by two degrees.
constexpr double touching_share = 0.04;
double touch_tolerance_mm(const PartModel& model, double noise_mm);

/// Whether a place of part `a` is within or beside part `b`.
bool touches(const PartModel& a, const Eigen::Isometry3d& camera_from_a, const PartModel& b,
             const Eigen::Isometry3d& camera_from_b, double tolerance_mm);

/// Whether the part reaches into the table, where no part can be.
bool sinks_into_table(const FramePieces& frame, const PartModel& model, const Eigen::Isometry3d& camera_from_model,
                      double tolerance_mm);

/// Drops those that reach into the table by more than that share of the part's diameter, or by more than noise: the
/// rougher poses still are, the more some may seem to. None where the whole frame may be one part.
void drop_sunk(std::vector<Hypothesis>& hypotheses, std::span<const PartModel* const> models, const ObjectView& view,
               double share);

/// Whether hardly any of the object's points are higher than what a camera may make of the table.
bool lies_low(const ObjectView& view);

/// Whether something nearer hides a part of the object.
bool is_partly_hidden(const ObjectView& view);

/// The parts, views and turns about the line of sight whose templates are like the object's, best first.
std::vector<Hypothesis> shortlist(std::span<const PartModel* const> models, const ObjectView& view,
                                  const ShortlistOptions& options);

/// Each part as it stays on the table by itself, at each turn about the vertical, its high places where the object is:
/// for what stands out of a part whose other places lie so low that they are taken for the table. Those that come
/// nearest to the object's points, best first; none without a table, or of an object that is low itself. Models may be
/// null.
std::vector<Hypothesis> at_rest(std::span<const PartModel* const> models, const ObjectView& view);

/// The direction to the table, where the hypothesis stays on it; camera frame.
std::optional<Eigen::Vector3d> upright_of(const Hypothesis& hypothesis, const ObjectView& view);

/// Puts each hypothesis onto the surface by some of the object's points, and ranks it by how far these are from it and
/// by where what its view shows falls in the frame. Best first.
void refine(std::vector<Hypothesis>& hypotheses, std::span<const PartModel* const> models, const ObjectView& view,
            const ProbePoints& probes, int iterations);

/// Calls `move` for each, on all threads, one part's after the other's so that its field stays in the cache. Best first
/// by the cost that it gives.
void move_each(std::vector<Hypothesis>& hypotheses, const std::function<void(Hypothesis&)>& move);

/// Without those that are the same part at about the same pose as a better one, up to its symmetries. Best first, as
/// given.
std::vector<Hypothesis> distinct(std::vector<Hypothesis> sorted, std::span<const PartModel* const> models);

/// Turns of the part about the axes that are round but for a detail (`PartModel::nearly_round`) at which the object's
/// points lie nearest to it: of each axis at most `most`, best first, the hypothesis' own turn left out.
std::vector<Hypothesis> best_turns(const Hypothesis& hypothesis, const PartModel& model, const ObjectView& view,
                                   std::size_t most);

/// Other parts whose boxes are about that of the hypothesis', their edges up to `most_difference` diameters, laid into
/// it in each way in which they fit: a mirror twin is not found where its brother is like it, nor the right one of many
/// that are alike. Those that come nearest to the object's points, best first.
std::vector<Hypothesis> in_place_of(const Hypothesis& hypothesis, std::span<const PartModel* const> models,
                                    const ObjectView& view, double most_difference);

/// The `count` of lowest cost, and besides them the best `per_part` of each of the best dozen of parts.
std::vector<Hypothesis> best_of(std::vector<Hypothesis> all, std::size_t count, int per_part);

void sort_by_cost(std::vector<Hypothesis>& hypotheses);

}  // namespace partpose
