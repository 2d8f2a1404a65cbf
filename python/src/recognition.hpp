// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/geometry/symmetries.hpp"
#include "partpose/pipeline/recognition.hpp"

#include <string>
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

Scene depth_scene(DepthImage depth, const Intrinsics& camera);
Recognized recognized(const PartRecognizer& recognizer, const Scene& scene);

}  // namespace partpose::python
