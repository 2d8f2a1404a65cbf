// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/evaluation/experiment.hpp"
#include "partpose/io/png.hpp"

#include <optional>
#include <string>

namespace partpose {

/// What went wrong in a frame, the graver first.
enum class Failure { wrong_part, not_refused, nothing_recognized, wrong_pose, object_missed, extra_detection };

/// "names another part", ...
const char* name_of(Failure failure);

/// Nothing when the frame is right as far as its camera can tell: the part and MSSD below 10 % of the diameter, or no
/// difference to be seen; each object that is asked for found and right; no detection of a part that is not there.
std::optional<Failure> failure_of(const FrameRecord& record);

/// What the failing frame showed, cut to where the objects are: the measured depth as a relief, the outline of each
/// object in green where it truly is, that of each detection (or of the result) in orange. 320 x 240 px.
ColourImage picture_of_failure(const FrameRecord& record, const std::vector<ObjectTruth>& truths,
                               const PoseJudge& judge, const JudgedFrame& frame);

}  // namespace partpose
