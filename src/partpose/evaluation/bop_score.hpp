// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/progress.hpp"
#include "partpose/io/bop.hpp"

#include <map>
#include <optional>
#include <span>
#include <vector>

/// Scores of the BOP benchmark's localization task (Hodan et al., BOP Challenge 2020, section 2.3; bop_toolkit,
/// eval_bop19_pose.py): each image says which objects it shows and how many instances of each, and the recall is the
/// share of them whose pose was found.
namespace partpose {

struct BopScoreOptions {
  bool vsd = true;           ///< where there are depth images
  double vsd_delta_mm = 15;  ///< 5 for ITODD
  int image_width = 0;       ///< px; 0: of camera.json, or else of the depth images

  void check() const;
};

/// The errors of an estimate towards one ground truth.
struct BopErrors {
  double mssd_mm = 0;       ///< infinite when it is farther off than the diameter
  double mspd_px = 0;       ///< px of this camera
  std::vector<double> vsd;  ///< for each tau of bop_fractions(); empty without depth images
};

/// A target with its valid ground truths, the `inst_count` most visible ones, and its estimates, the `inst_count` of
/// highest score.
struct BopTargetErrors {
  struct Estimate {
    int est_id = 0;  ///< position in the file among the estimates of this scene, image and object
    double score = 0;
    std::map<int, BopErrors> errors;  ///< to each ground truth of the object, by its id: valid or not
  };

  BopTarget target;
  std::vector<int> gt_ids;          ///< of the valid ground truths
  std::vector<Estimate> estimates;  ///< by falling score
};

/// Estimates of what is not asked for are left out. Throws Error when a target's truth is not known, and when VSD is
/// asked for of cameras with skew, or with some depth images missing.
std::vector<BopTargetErrors> bop_errors(const BopDataset& dataset, std::span<const BopEstimate> estimates,
                                        const BopScoreOptions& options = {}, const Progress& progress = {});

/// Kept estimates, as above, of scores in the file's order: positions by falling score, of equal ones the first first.
std::vector<int> bop_kept_estimates(std::span<const double> scores, int inst_count);
/// The positions of the `inst_count` highest visibilities, of equal ones the first, in rising order.
std::vector<int> bop_valid_ground_truths(std::span<const double> visib_fracts, int inst_count);

/// The greedy matching of one target: the estimates in the order given take each the free ground truth of smallest
/// error that is below the threshold, of equal ones the first. errors[estimate][ground truth]. Returns the ground truth
/// of each estimate, -1: none.
std::vector<int> bop_matching(std::span<const std::vector<double>> errors, double threshold);

struct BopMatch {
  int scene_id = 0;
  int im_id = 0;
  int gt_id = 0;
  int est_id = 0;
};

/// What is found at one threshold.
struct BopRecall {
  double threshold = 0;
  int targets_count = 0;  ///< valid ground truths
  int tp_count = 0;
  double recall = 0;           ///< of all targets together
  double mean_obj_recall = 0;  ///< mean of the objects' recalls
  double mean_scene_recall = 0;
  std::map<int, double> obj_recall;    ///< by obj_id
  std::map<int, double> scene_recall;  ///< by scene_id
  std::vector<BopMatch> matches;
};

enum class BopErrorType { vsd, mssd, mspd };

struct BopScore {
  std::vector<BopRecall> recalls;    ///< by threshold; of VSD by tau, then by threshold
  double average_recall = 0;         ///< AR_VSD, AR_MSSD or AR_MSPD
  std::map<int, double> obj_recall;  ///< the same of each object alone
};

/// Objects and scenes without a valid ground truth have recall 0 in the means, as in the toolkit, when they are listed
/// in `obj_ids` and `scene_ids`; those of the targets always are.
struct BopScoreBasis {
  std::map<int, double> diameter_mm;  ///< by obj_id
  int image_width = 640;              ///< px
  std::vector<int> obj_ids, scene_ids;
};

/// Recalls at all thresholds of that error: 10, and of VSD 10 for each of 10 taus.
BopScore bop_score(std::span<const BopTargetErrors> targets, BopErrorType type, const BopScoreBasis& basis);

/// Everything about a results file.
struct BopScores {
  int targets_count = 0;        ///< instances to be found
  int estimates_kept = 0;       ///< of them the best `inst_count` of each target count
  std::optional<BopScore> vsd;  ///< none without depth images
  BopScore mssd, mspd;
  std::optional<double> average_recall;  ///< AR: mean of AR_VSD, AR_MSSD and AR_MSPD
  double average_time_per_image_s = -1;  ///< mean of the images that have estimates; -1: not known
};

BopScores score_bop(const BopDataset& dataset, std::span<const BopEstimate> estimates,
                    const BopScoreOptions& options = {}, const Progress& progress = {});

/// -1 when a time is negative, or there are no estimates.
double bop_average_time_s(std::span<const BopEstimate> estimates);

}  // namespace partpose
