// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/pipeline/config.hpp"
#include "partpose/pipeline/recognition.hpp"
#include "partpose/preprocess/segmentation.hpp"

#include <memory>
#include <string>
#include <vector>

namespace partpose {

/// What the Recognizer may be told; the defaults are meant for all parts and cameras.
struct RecognizerOptions {
  float min_score = 0.72f;    ///< a candidate whose render-and-compare score is lower is not believed, 0 to 1
  int shortlist_views = 400;  ///< views that go on from the descriptor's matching
  int rolls = 12;             ///< turns about the line of sight that each is tried at

  void check() const;
};

/// The pipeline without a configuration: finds the objects in a frame, shortlists views by VFH, tries each at many
/// turns, refines the best and decides by rendering them and comparing the depth with what was measured, in both
/// directions. Immutable after construction and thread-safe.
class Recognizer final : public PartRecognizer {
 public:
  /// The pipeline configuration that the Recognizer's catalogue is to be made with.
  static GlobalPipelineConfig catalogue_config();

  explicit Recognizer(Catalogue catalogue, RecognizerOptions options = {});
  ~Recognizer() override;

  /// A full depth frame, or a part of one. The frame's best object; `result` is empty when nothing is recognized.
  Recognition recognize(const DepthImage& depth, const Intrinsics& camera) const;
  /// A cloud in mm, taken by a camera at the origin that looks along z: the part alone, or with the table in it.
  Recognition recognize(const PointCloud& cloud) const;
  /// The depth image where the scene has one, its cloud otherwise.
  Recognition recognize(const Scene& scene) const override;

  const Catalogue& catalogue() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partpose
