// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/geometry/symmetries.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/pipeline/recognition.hpp"

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace partpose::python {

/// An Alternative and a Detection with the part's name.
struct NamedAlternative {
  std::string part;
  Alternative alternative;
};
struct NamedDetection {
  std::string part;
  Detection detection;
  bool has_confidence = false;  ///< false: the recognizer states neither confidence nor covariance
  std::vector<NamedAlternative> alternatives = {};
};

/// A Recognition with what the catalogue knows about it, so that it can be read on its own.
struct Recognized {
  Recognition recognition;
  Extras extras;
  Symmetries symmetries;
  std::vector<NamedDetection> detections;  ///< all objects that were recognized, the result first

  /// The detection that `recognition.result` is; null: nothing was recognized.
  const NamedDetection* best() const { return recognition.accepted < 0 ? nullptr : &detections.front(); }
};

/// One file or folder, or several.
using Paths = std::variant<std::filesystem::path, std::vector<std::filesystem::path>>;
/// Their parts; what is doubtful in them is added to `doubts`.
std::vector<NamedMesh> read_parts(const Paths& paths, std::vector<std::string>& doubts);
/// By Python's warnings, of the line that called.
void warn(const std::vector<std::string>& doubts);

Scene depth_scene(DepthImage depth, const Intrinsics& camera);
Recognized recognized(const PartRecognizer& recognizer, const Scene& scene);

}  // namespace partpose::python
