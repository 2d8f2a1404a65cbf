// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/progress.hpp"
#include "partpose/pipeline/config.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace partpose {

/// Which steps of a frame the report shows.
struct ReportStages {
  bool input = true;  ///< the scene as it came
  bool preprocessed = true;
  bool normals = true;
  bool coarse = true;      ///< candidates after the coarse alignment
  bool fine = true;        ///< candidates after the refinement
  bool verdict = true;     ///< the result
  bool candidates = true;  ///< with the result: the candidates that fell
};

/// The steps that a configuration's debug.visualize selects: preprocess is input and preprocessed,
/// result_with_candidates is verdict and candidates.
ReportStages stages_of(const VisualizeOptions& visualize);

struct ReportOptions {
  std::string title = {};  ///< empty: the folder's name
  ReportStages stages = {};
  double limit_deg = 15;                ///< in degrees and mm a pose is right below this; can be changed on the page
  double limit_mm = 15;                 ///< and below this translation error
  std::size_t most_bytes = 28'000'000;  ///< of the file: points and depth images are thinned to stay below

  void check() const;
};

struct ReportSummary {
  int frames = 0;
  std::size_t bytes = 0;
  bool thinned = false;               ///< some frame's points or depth are not shown in full
  std::vector<std::string> problems;  ///< files that could not be read
};

/// Makes one self-contained HTML page of an output folder: all frames in numbers, each frame in 3-D. The same folder
/// gives the same bytes. Throws Error when the folder holds no frame, and when the file cannot be written.
ReportSummary write_report(const std::filesystem::path& folder, const std::filesystem::path& file,
                           const ReportOptions& options = {}, const Progress& progress = {});

}  // namespace partpose
