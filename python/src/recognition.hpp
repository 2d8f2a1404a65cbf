// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/geometry/symmetries.hpp"
#include "partpose/pipeline/recognition.hpp"

namespace partpose::python {

/// A Recognition with what the catalogue knows about it, so that it can be read on its own.
struct Recognized {
  Recognition recognition;
  Extras extras;
  Symmetries symmetries;
};

Scene depth_scene(DepthImage depth, const Intrinsics& camera);
Recognized recognized(const PartRecognizer& recognizer, const Scene& scene);

}  // namespace partpose::python
