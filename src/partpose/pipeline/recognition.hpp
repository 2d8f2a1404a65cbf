// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/scene.hpp"
#include "partpose/pipeline/catalogue.hpp"
#include "partpose/pipeline/records.hpp"

#include <optional>
#include <string>
#include <vector>

namespace partpose {

/// One hypothesis: a view of a part, and where it lies in the scene.
struct Candidate {
  int id = -1;        ///< rank in the matching
  int view_row = -1;  ///< index into Catalogue::views
  float match_distance = -1;
  std::vector<ReferenceFrames> reference_frames = {};    ///< of the descriptions that match, best match first
  Eigen::Isometry3d T3 = Eigen::Isometry3d::Identity();  ///< coarse alignment
  Eigen::Isometry3d T4 = Eigen::Isometry3d::Identity();  ///< refinement
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  bool icp_converged = false;
  float icp_fitness = -1;  ///< mm
  /// 0 to 1, -1: not looked at. Of the Engine: probability that the part is what is seen; of the Recognizer: of
  /// render-and-compare; of the GlobalPipeline: the share of the scene that is explained times the share of the visible
  /// model that is.
  float score = -1;
  Verification verification = {};
  bool verified = false;  ///< false: a better candidate was accepted before this one's turn
};

/// How a part at its pose and a frame explain each other: what the Engine's score is made of.
struct Explanation {
  int explained_pixels = 0;  ///< of those looked at; 0: the rest says nothing
  double agreement = 0;      ///< mean of both directions, 0 to 1
  double deviation = 0;      ///< root mean square of the depths' differences, in the noise's standard deviations
  double roughness = 0;     ///< the same from their mean within some pixels, in deviations of what neighbours differ by
  double unexplained = 0;   ///< share of the object's pixels
  double free_space = 0;    ///< share of the part's visible pixels before what was measured, or beneath the table, not
                            ///< beside an outline
  double not_measured = 0;  ///< share of them where nothing was measured
  double beside = 0;        ///< share of them that are not the object's, but next to its outline
  double narrower = 0;      ///< share of them that are beside where something else was measured
  double size_ratio = 1;    ///< pixels where the part shows, as far as anything was measured there, over the object's
  double edges = 0;         ///< of the jumps in depth within the object and within the part: the share that both have
  double fine_shape = 0;    ///< correlation of both depths' differences from their mean within three pixels
  double fine_gain = 0;     ///< so much of the part's such differences is measured, 1: all
  double noise = 0;         ///< standard deviation of a depth, over the extent of what is seen
  double local_noise = 1;   ///< of that: what neighbouring pixels differ by; 1: each errs for itself
  double relief = 0;        ///< of what is seen: from its best plane, in the noise's standard deviations
  double height = 0;        ///< of the part's lowest place above the table, in diameters; below 0 it sinks in; 0 as
                            ///< well where there is no table, or the part stands on something else
  double height_deviations = 0;  ///< the same in the noise's standard deviations

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("explained_pixels", self.explained_pixels, "of those looked at");
    visit("agreement", self.agreement, "mean of both directions, 0 to 1");
    visit("deviation", self.deviation, "rms of the depths' differences, in the noise's standard deviations");
    visit("roughness", self.roughness,
          "the same from their mean within some pixels, in standard deviations of what neighbouring pixels differ by");
    visit("unexplained", self.unexplained, "share of the object's pixels");
    visit("free_space", self.free_space,
          "share of the part's visible pixels before what was measured, or beneath the table, not beside an outline");
    visit("not_measured", self.not_measured, "share of the part's visible pixels where nothing was measured");
    visit("beside", self.beside,
          "share of the part's visible pixels that are not the object's, but next to its outline");
    visit("narrower", self.narrower,
          "share of the part's visible pixels that are beside where something else was measured");
    visit("size_ratio", self.size_ratio,
          "pixels where the part shows, as far as anything was measured there, over the object's");
    visit("edges", self.edges, "of the jumps in depth within the object and within the part: the share that both have");
    visit("fine_shape", self.fine_shape, "correlation of both depths' differences from their mean within three pixels");
    visit("fine_gain", self.fine_gain, "so much of the part's such differences is measured; 1: all");
    visit("noise", self.noise, "standard deviation of a depth, over the extent of what is seen");
    visit("local_noise", self.local_noise, "of that: what neighbouring pixels differ by; 1: each errs for itself");
    visit("relief", self.relief, "of what is seen from its best plane, in the noise's standard deviations");
    visit("height", self.height, "of the part's lowest place above the table, in diameters; below 0 it sinks in");
    visit("height_deviations", self.height_deviations, "the same in the noise's standard deviations");
  }
};

/// Another part or pose that explains an object too.
struct Alternative {
  int part = -1;  ///< index into Catalogue::parts
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  double probability = 0;  ///< 0 to 1
};

/// A part found in a frame.
struct Detection {
  int part = -1;  ///< index into Catalogue::parts
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  float score = -1;  ///< 0 to 1, as of a Candidate
  /// Probability that part and pose are right, up to what this camera cannot tell apart; 0 to 1.
  double confidence = 0;
  /// Of a small rotation vector [rad] and translation [mm] of the part, about its box's middle, in the camera's axes.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<Alternative> alternatives = {};   ///< likeliest first; poses that are the same by symmetry are not listed
  std::optional<Explanation> explanation = {};  ///< of the Engine
};

/// What happened to one scene: the one record behind everything that shows results.
struct Recognition {
  Result result;
  std::vector<Candidate> candidates;  ///< in the order of the verification
  int accepted = -1;                  ///< index into candidates
  std::vector<Detection> detections;  ///< all objects that were recognized, the result first; of the Engine only
  PointCloud preprocessed;            ///< camera frame
  PointCloud with_normals;            ///< camera frame
  PointCloud refinement_scene;        ///< camera frame
  int num_of_points_input = 0;
  std::vector<MeasuredOperation> stages;
  std::string reason;  ///< why nothing was recognized; empty when something was

  double total_ms() const;
};

/// For people: "scores 0.49, below 0.5".
std::string score_below(double score, double min_score);

/// What recognizes the part in a scene: one of the pipelines with its catalogue. Immutable and thread-safe.
class PartRecognizer {
 public:
  virtual ~PartRecognizer() = default;
  /// The camera at the origin. An empty or degenerate scene gives a Recognition without a result.
  virtual Recognition recognize(const Scene& scene) const = 0;
  virtual const Catalogue& catalogue() const = 0;
};

/// What the candidate says, without a timestamp.
Result result_of(const Candidate& candidate, const Catalogue& catalogue);

/// Extras (C.2.3) of what happened.
Extras extras_of(const Recognition& recognition, const Catalogue& catalogue);

/// Local time to the millisecond, as in 2026-01-31_14-05-09_123; each call in a process gives another one.
std::string make_timestamp();

}  // namespace partpose
