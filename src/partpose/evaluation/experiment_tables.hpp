// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/evaluation/experiment.hpp"

namespace partpose {

/// Objects of which less is seen are not asked for.
inline constexpr double counted_visibility = 0.6;

/// What the frames of one run came to.
struct RunSummary {
  std::string run, group, protocol, configuration, descriptor;
  bool left_out = false;
  int frames = 0, correct = 0, wrong = 0, none = 0;
  int pose_right = 0;  ///< correct, and within both limits
  int mssd_10 = 0;     ///< correct, and MSSD below 10 % of the diameter
  int mssd_5 = 0;      ///< correct, and MSSD below 5 % of the diameter
  int seen_right = 0;  ///< correct and MSSD below 10 %, or part and pose that the camera cannot tell from the truth
  std::vector<double> rotation_errors_deg, translation_errors_mm;  ///< of the correct ones
  std::vector<double> times_ms;
  std::map<std::string, std::vector<double>> stage_ms;
  int objects = 0;             ///< of the catalogue, seen by `counted_visibility` at least
  int objects_found = 0;       ///< of them, those that a detection names where they are
  int objects_pose_right = 0;  ///< of them, those whose pose is right, or that cannot be told from the detection
  int detections = 0;
  int wrong_detections = 0;                          ///< of them, those that name a part that is not there
  std::vector<std::pair<double, bool>> confidences;  ///< of each detection, and whether it is right
  int accepted = 0;                                  ///< frames in which something was recognized
  int bounds_undetermined = 0;                       ///< right frames whose ranges do not determine the pose
  std::vector<double> rotation_bounds_deg, translation_bounds_mm;   ///< of the other right frames
  std::vector<double> rotation_over_bound, translation_over_bound;  ///< their errors, in shares of the bound
  std::map<std::pair<std::string, std::string>, int> confusion;     ///< shown, recognized as ("": none)

  double percent(int count) const { return frames ? 100.0 * count / frames : 0; }
};

/// By group, protocol, configuration and descriptor as the spec has them, then by frame: whatever the order in which
/// the frames were finished.
std::vector<FrameRecord> in_order_of(const ExperimentSpec& spec, std::vector<FrameRecord> records);

/// One for each run, in the order of their first records.
std::vector<RunSummary> summarize_runs(const std::vector<FrameRecord>& records, const ExperimentSpec& spec);

/// A point of the curve of false against true accepts: what an acceptance threshold on the score would give.
struct AcceptPoint {
  double threshold = 0;
  double true_accepts_percent = 0;   ///< of the scenes whose part is in the catalogue: recognized as that part
  double false_accepts_percent = 0;  ///< of the scenes whose part is not in the catalogue: recognized as something
};
/// Thresholds from above the highest score to 0. The scores of rejected best candidates count as well.
std::vector<AcceptPoint> accept_curve(const std::vector<const FrameRecord*>& known,
                                      const std::vector<const FrameRecord*>& left_out);

/// Writes tables.md (in the form of the reference's chapter 6.3), tables.json, recognition.csv, poses.csv,
/// confusion.csv, errors.csv, times.csv, accepts.csv, and box plots and curves as SVG, into `output`.
void write_tables(const std::vector<FrameRecord>& records, const ExperimentSpec& spec,
                  const std::filesystem::path& output);

}  // namespace partpose
