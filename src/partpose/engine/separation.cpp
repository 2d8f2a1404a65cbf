// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/separation.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/engine/anchored_search.hpp"
#include "partpose/engine/best_together.hpp"
#include "partpose/engine/part_outline.hpp"
#include "partpose/engine/verdict.hpp"
#include "partpose/registration/projective_refinement.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace partpose {

namespace {

/// Finds parts in what is left: some together, then others in what these leave.
class Separation {
 public:
  Separation(std::span<const PartModel* const> models, FramePieces& frame, const std::bitset<256>& unexplained)
      : models_(models), frame_(frame), labels_(unexplained) {
    std::bitset<256> used;
    for (const std::uint8_t label : frame.label) {
      used.set(label);
      ++pixels_[label];
    }
    while (next_label_ < last_label && used.test(next_label_)) ++next_label_;
    for (const PartModel* model : models) {
      if (!model) continue;
      largest_mm_ = std::max(largest_mm_, model->diameter_mm);
      smallest_mm_ = std::min(smallest_mm_, model->diameter_mm);
    }
  }

  /// Those that explain something of the rest are looked for again, with all that they explain. On all of them others
  /// may lie.
  void take(std::span<const KnownPart> known) {
    constexpr int least_pixels = 60;
    const FrameObject rest = object_of(frame_, labels_);
    if (known.empty() || rest.pixels == 0) return;
    set_noise(ObjectView(frame_, rest));
    for (const auto& [hypothesis, labels] : known) {
      const auto explained = explained_by(hypothesis);
      if (static_cast<int>(explained.size()) >= least_pixels) {
        labels_ |= labels;
        starts_.push_back(hypothesis);
      } else {
        known_.push_back(hypothesis);
      }
    }
  }

  /// Searches what is left until nothing good is found: beside a part that is sure also at more places.
  std::vector<SeparatedPart> search() && {
    constexpr int most_rounds = 6, more_places = 3;
    for (int k = 0; k < most_rounds && next_label_ < last_label; ++k)
      if (!round(1) && (!is_any_sure() || !round(more_places))) break;
    return std::move(*this).sure_parts();
  }

  /// Only those hypotheses that are good.
  std::vector<SeparatedPart> those_of(std::span<const Hypothesis> hypotheses) && {
    const FrameObject rest = object_of(frame_, labels_);
    set_noise(ObjectView(frame_, rest));
    accept(trials_of(hypotheses, rest), most_no_outline);
    return std::move(*this).sure_parts();
  }

 private:
  struct Trial {
    Hypothesis hypothesis;
    DepthComparison comparison;                   ///< with what is left about it
    bool may_be_covered = false;                  ///< whether what is before it counts as hiding it
    int covered = 0;                              ///< pixels of what is left that lie before it
    int conflicts = 0;                            ///< pixels where it lies on what another part explains
    int outline = 0;                              ///< measured pixels just outside its outline
    int no_outline = 0;                           ///< of them: where the surface just goes on
    int goes_on = 0;                              ///< of them: into what is not explained
    std::vector<std::uint64_t> explained_bits{};  ///< which pixels of the rest it explains, row by row in its box
    double gain = 0;                              ///< of log-likelihood, over leaving its pixels unexplained
  };

  /// A part that was found, with its pixels.
  struct Claim {
    SeparatedPart part;
    std::uint8_t label = 0;                                      ///< of its pixels, and of no others
    std::vector<std::pair<std::size_t, std::uint8_t>> pixels{};  ///< with the labels that they had
    std::array<int, 256> from{};                                 ///< their number, by these labels
    int piece = 0;                                               ///< the label that most of them had
  };

  static constexpr double most_no_outline = 0.25, most_no_outline_of_many = 0.15;
  static constexpr int last_label = 250;
  static constexpr double conflict_cost = 6;  // the comparison counts up to 3 for a pixel that was taken for the table
  static constexpr int wanted_pixels = 800, ring_px = 4, beyond_px = 24, far_beyond_px = 60;

  /// `density`: of the places that are looked at. Among many starts a wrong one is sooner good.
  bool round(int density) {
    const double no_outline = density > 1 ? most_no_outline_of_many : most_no_outline;
    const FrameObject rest = object_of(frame_, labels_);
    constexpr int least_pixels = 120;
    constexpr double least_share = 0.05;  // of the square of the diameter: what a slender part shows when half hidden
    if (rest.pixels < least_pixels) return false;
    const ObjectView view(frame_, rest);
    const double smallest_px = smallest_mm_ * frame_.camera.fx / view.all.centre_mm().z();
    if (rest.pixels < least_share * smallest_px * smallest_px) return false;
    set_noise(view);
    // About four places on each part, if all are as small as the smallest.
    constexpr double share_of_place = 0.07;  // of the square of the diameter
    const double parts = rest.pixels / (share_of_place * smallest_px * smallest_px);
    const int places = density * std::clamp(static_cast<int>(parts), 8, 32);
    std::vector<Hypothesis> hypotheses =
        anchored_hypotheses(models_, frame_, rest, {.most_seeds = places, .every_part = true});
    hypotheses.insert(hypotheses.end(), starts_.begin(), starts_.end());
    std::vector<Trial> trials = trials_of(hypotheses, rest);
    if (accept(trials, no_outline)) return true;
    // What lies before a part and is not explained may be another one that hides it. So it may before a wrong pose
    // beneath the surface: only where nothing else is left to be found.
    constexpr double least_covered = 0.02;
    std::erase_if(trials, [](const Trial& trial) { return trial.covered < least_covered * trial.comparison.object; });
    parallel_for(trials.size(), [&](std::size_t i) {
      trials[i].may_be_covered = true;
      compare(trials[i], rest);
    });
    return accept(std::move(trials), no_outline);
  }

  std::vector<Trial> trials_of(std::span<const Hypothesis> hypotheses, const FrameObject& rest) const {
    std::vector<Trial> trials(hypotheses.size());
    parallel_for(trials.size(), [&](std::size_t i) {
      trials[i].hypothesis = hypotheses[i];
      compare(trials[i], rest);
    });
    return trials;
  }

  void set_noise(const ObjectView& view) { noise_per_mm2_ = view.noise_mm / std::pow(view.all.centre_mm().z(), 2); }

  /// Takes away those that explain most together and are good beside one another. Whether there are any.
  bool accept(std::vector<Trial> trials, double no_outline) {
    constexpr double least_explained = 0.2;  // of those below it none became good
    std::erase_if(trials, [](const Trial& trial) {
      return !(trial.gain > 0) || trial.comparison.explained < least_explained * trial.comparison.model;
    });
    constexpr std::size_t most_trials = 100;
    if (trials.size() > most_trials) {
      const auto gains_more = [](const Trial& a, const Trial& b) { return a.gain > b.gain; };
      std::stable_sort(trials.begin(), trials.end(), gains_more);
      trials.resize(most_trials);
    }
    const Eigen::MatrixXd shared = shared_gain(trials);
    Eigen::VectorXd gain(trials.size());
    for (std::size_t i = 0; i < trials.size(); ++i) gain[static_cast<Eigen::Index>(i)] = trials[i].gain;
    const std::size_t before = claims_.size();
    while (true) {
      const std::vector<int> chosen = best_together(gain, shared);
      if (chosen.empty()) return false;
      const std::vector<int> wrong = claim_those(chosen, trials, no_outline);
      if (wrong.empty()) return true;
      while (claims_.size() > before) release_last();
      for (const int i : wrong) gain[i] = 0;
    }
  }

  /// How much less two trials explain together than each for itself; infinite where they explain the same.
  Eigen::MatrixXd shared_gain(const std::vector<Trial>& trials) const {
    constexpr double most_shared = 0.15;  // of the pixels that one of them explains
    const auto count = static_cast<Eigen::Index>(trials.size());
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(count, count);
    std::vector<int> explained_px;
    for (const auto& trial : trials) {
      explained_px.push_back(0);
      for (const std::uint64_t bits : trial.explained_bits) explained_px.back() += std::popcount(bits);
      explained_px.back() = std::max(explained_px.back(), 1);
    }
    parallel_for(trials.size(), [&](std::size_t i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Trial &a = trials[i], &b = trials[j];
        const double reach_mm = models_[a.hypothesis.part]->diameter_mm + models_[b.hypothesis.part]->diameter_mm;
        if ((middle_of(a.hypothesis) - middle_of(b.hypothesis)).norm() > 0.5 * reach_mm) continue;
        int px = 0;
        for (std::size_t k = 0; k < a.explained_bits.size(); ++k)
          px += std::popcount(a.explained_bits[k] & b.explained_bits[k]);
        const int fewer_px = std::min(explained_px[i], explained_px[j]);
        const double gain_per_px = std::min(a.gain / explained_px[i], b.gain / explained_px[j]);
        out(i, j) =
            px > most_shared * fewer_px ? std::numeric_limits<double>::infinity() : px * (gain_per_px + conflict_cost);
      }
    });
    return out.selfadjointView<Eigen::Lower>();
  }

  /// Those that are not good beside the others; where there are none, all are found.
  std::vector<int> claim_those(std::vector<int> chosen, std::vector<Trial>& trials, double no_outline) {
    const std::size_t before = claims_.size();
    std::vector<int> claimed;
    // One after the other, since one may hold another.
    constexpr double before_polish = 1.5;  // it moves little: of those farther off none became good
    const auto is_next = [&](int i) { return is_held(trials[i].hypothesis, before_polish); };
    for (auto next = chosen.begin(); next_label_ < last_label; chosen.erase(next)) {
      next = std::find_if(chosen.begin(), chosen.end(), is_next);
      if (next == chosen.end()) break;
      claim(with_rivals(*next, trials));
      claimed.push_back(*next);
    }
    std::vector<int> wrong = std::move(chosen);  // which nothing holds
    std::vector<Trial> now(claimed.size());
    parallel_for(claimed.size(), [&](std::size_t k) {
      FrameObject own;
      own.labels = labels_;
      own.labels.set(claims_[before + k].label);
      now[k].hypothesis = trials[claimed[k]].hypothesis;
      now[k].may_be_covered = trials[claimed[k]].may_be_covered;
      compare(now[k], own);
      if (!is_good(now[k], no_outline)) polish(now[k], own);
    });
    std::vector<std::pair<double, int>> doubtful;
    for (std::size_t k = 0; k < claimed.size(); ++k) {
      const Hypothesis& h = now[k].hypothesis;
      trials[claimed[k]].hypothesis = claims_[before + k].part.hypotheses[0] = h;
      if (!is_held(h))
        wrong.push_back(claimed[k]);
      else if (!is_good(now[k], no_outline))
        doubtful.emplace_back(probability(now[k]), claimed[k]);
    }
    // What is wrong speaks against what is right beside it: the worst first.
    std::sort(doubtful.begin(), doubtful.end());
    constexpr double hopeless = 0.2;
    for (const auto& [probability, i] : doubtful)
      if (wrong.empty() || probability < hopeless) wrong.push_back(i);
    return wrong;
  }

  /// One of the trials, and others for about the same pixels.
  SeparatedPart with_rivals(int found, const std::vector<Trial>& trials) const {
    constexpr std::size_t most = 9;
    const Hypothesis& best = trials[found].hypothesis;
    SeparatedPart part;
    part.hypotheses.push_back(best);
    for (int i = 0; i < static_cast<int>(trials.size()) && part.hypotheses.size() < most; ++i) {
      const double off_mm = (middle_of(trials[i].hypothesis) - middle_of(best)).norm();
      if (i != found && off_mm < 0.3 * models_[best.part]->diameter_mm) part.hypotheses.push_back(trials[i].hypothesis);
    }
    return part;
  }

  /// Of another object than what is left.
  static bool is_piece(const PartWindow& window, std::size_t p) {
    return window.frame.label[p] == PixelLabel::background && !window.frame.before_table_mm.empty() &&
           window.frame.before_table_mm[p] == FrameWindow::not_table_mm;
  }
  /// By the square law of triangulation.
  double noise_at(const Hypothesis& h) const { return noise_per_mm2_ * std::pow(middle_of(h).z(), 2); }
  Eigen::Vector3d middle_of(const Hypothesis& h) const { return h.camera_from_model * models_[h.part]->middle_mm; }

  /// Only what is near the part counts as the object, and where the surface goes on beyond the part's outline.
  void compare(Trial& trial, const FrameObject& rest) const {
    const PartModel& model = *models_[trial.hypothesis.part];
    const Eigen::Isometry3d& pose = trial.hypothesis.camera_from_model;
    PartWindow window = part_window(frame_, rest, model, pose, wanted_pixels, beyond_px + 1);
    const int reach = (outline_px + window.stride - 1) / window.stride;
    const int ring = (ring_px + window.stride - 1) / window.stride;
    const DepthImage rendered = render_depth(model.outline, pose, window.frame.camera, model.outline.faces);
    const std::vector<std::uint8_t> is_near = near_rendered(rendered, reach);
    const BeyondOutline beyond = beyond_outline(rendered, beyond_px, window.stride);
    const int box_width = rest.u1 - rest.u0 + 1, box_height = rest.v1 - rest.v0 + 1;
    trial.explained_bits.assign((static_cast<std::size_t>(std::max(box_width * box_height, 0)) + 63) / 64, 0);
    trial.conflicts = trial.outline = trial.no_outline = trial.goes_on = trial.covered = 0;
    for (int v = 0; v < rendered.height; ++v)
      for (int u = 0; u < rendered.width; ++u) {
        const std::size_t p = static_cast<std::size_t>(v) * rendered.width + u;
        PixelLabel& label = window.frame.label[p];
        if (rendered.z_mm[p] > 0 && label == PixelLabel::object &&
            std::abs(rendered.z_mm[p] - window.frame.depth.z_mm[p]) < 4 * noise_at(trial.hypothesis)) {
          const int first_u = window.u0 + u * window.stride - rest.u0,
                    first_v = window.v0 + v * window.stride - rest.v0;
          for (int vv = std::max(first_v, 0); vv < std::min(first_v + window.stride, box_height); ++vv)
            for (int uu = std::max(first_u, 0); uu < std::min(first_u + window.stride, box_width); ++uu) {
              const std::size_t bit = static_cast<std::size_t>(vv) * box_width + uu;
              trial.explained_bits[bit / 64] |= std::uint64_t{1} << (bit % 64);
            }
        }
        if (rendered.z_mm[p] > 0 && label == PixelLabel::object &&
            rendered.z_mm[p] - window.frame.depth.z_mm[p] > 4 * noise_at(trial.hypothesis)) {
          ++trial.covered;
          if (trial.may_be_covered) label = PixelLabel::background;
        }
        if (rendered.z_mm[p] > 0 && is_piece(window, p))
          trial.conflicts += std::abs(rendered.z_mm[p] - window.frame.depth.z_mm[p]) < 4 * noise_at(trial.hypothesis);
        const bool is_ring = beyond.step[p] > reach && beyond.step[p] <= reach + ring;
        trial.outline += is_ring && window.frame.depth.z_mm[p] > 0;
        const auto lies_on = [&](const DepthImage& surface) {
          return surface.z_mm[p] > 0 &&
                 std::abs(surface.z_mm[p] - window.frame.depth.z_mm[p]) < 3 * noise_at(trial.hypothesis);
        };
        const bool straight_on = lies_on(beyond.depth), goes_on = straight_on || lies_on(beyond.within_edge);
        trial.no_outline += is_ring && goes_on && (label == PixelLabel::object || is_piece(window, p));
        trial.goes_on += is_ring && goes_on && label == PixelLabel::object;
        if (label == PixelLabel::object && !straight_on && !is_near[p]) label = PixelLabel::nothing;
      }
    const SensorModel sensor{.noise_mm = noise_at(trial.hypothesis),
                             .outline_px = reach,
                             .growth_px = frame_.foreground_growth_px / window.stride,
                             .edge_mm = frame_.edge_mm(middle_of(trial.hypothesis).z()),
                             .size_mm = largest_mm_};
    trial.comparison = DepthComparer(window.frame, sensor)(
        model.outline, pose, model.covered(window.frame.camera, pose), model.outline.faces);
    trial.gain = (trial.comparison.log_likelihood - trial.comparison.object * std::log(sensor.outlier) -
                  conflict_cost * trial.conflicts) *
                 window.stride * window.stride;
  }

  /// What it stands on is asked when it is found.
  double probability(const Trial& trial) const {
    const Hypothesis& h = trial.hypothesis;
    return rough_probability(trial.comparison,
                             {.noise_mm = noise_at(h), .diameter_mm = models_[h.part]->diameter_mm, .height_mm = {}});
  }

  /// Moves the part onto the pixels themselves, where that may help.
  void polish(Trial& trial, const FrameObject& rest) const {
    constexpr double hopeless = 0.003;  // of those below it none became good
    if (trial.comparison.explained < 0.2 * trial.comparison.model || probability(trial) < hopeless) return;
    const PartModel& model = *models_[trial.hypothesis.part];
    PartWindow window = part_window(frame_, rest, model, trial.hypothesis.camera_from_model, wanted_pixels, outline_px);
    for (std::size_t p = 0; p < window.frame.label.size(); ++p)
      if (window.frame.label[p] != PixelLabel::object) window.frame.depth.z_mm[p] = 0;
    const double noise_mm = noise_at(trial.hypothesis);
    const DepthNoise noise{.local_mm = 0.5 * noise_mm, .total_mm = noise_mm};  // about as of a stereo camera
    const auto refined =
        refine_projectively(model.surface, trial.hypothesis.camera_from_model, window.frame.depth, window.frame.camera,
                            {.gate_mm = static_cast<float>(std::max(6 * noise_mm, 2.0)),
                             .max_iterations = 3,
                             .faces = model.surface.faces,
                             .damping = polish_damping(noise, window.stride, model.diameter_mm)});
    if (!std::isfinite(refined.rms_mm)) return;
    trial.hypothesis.camera_from_model = refined.camera_from_model;
    compare(trial, rest);
  }

  /// `no_outline`: so much of what lies beside its outline may just go on; among several parts more, where it goes on
  /// into one of them.
  bool is_good(const Trial& trial, double no_outline) const {
    constexpr double least_score = 0.5, least_seen = 0.3, most_conflicts = 0.1, into_others = 0.15;
    constexpr std::size_t several = 4;  // two or three may together be one that is not known
    const double no_outline_at_all = claims_.size() < several ? no_outline : no_outline + into_others;
    const DepthComparison& c = trial.comparison;
    return c.explained > least_seen * c.model && trial.conflicts < most_conflicts * c.model &&
           trial.no_outline < no_outline_at_all * trial.outline && trial.goes_on < no_outline * trial.outline &&
           probability(trial) > least_score;
  }

  std::vector<std::size_t> explained_by(const Hypothesis& h) const {
    return explained_pixels(*models_[h.part], h.camera_from_model, frame_, labels_, noise_at(h));
  }

  /// Gives what the part explains a label of its own.
  void claim(SeparatedPart part) {
    Claim claim;
    claim.label = static_cast<std::uint8_t>(next_label_++);
    for (const std::size_t pixel : explained_by(part.hypotheses[0])) {
      std::uint8_t& label = frame_.label[pixel];
      claim.pixels.emplace_back(pixel, label);
      ++claim.from[label];
      label = claim.label;
    }
    constexpr double edge_share = 0.1;  // so much of an object is lost to a neighbour without its being another's
    for (auto& object : frame_.objects) {
      int taken = 0;
      for (int label = 0; label < 256; ++label)
        if (object.labels.test(label)) taken += claim.from[label];
      if (taken > edge_share * object.pixels) object.labels.set(claim.label);
    }
    for (int k = 0; k < 256; ++k) explained_[k] += claim.from[k];
    claim.piece = static_cast<int>(std::max_element(claim.from.begin(), claim.from.end()) - claim.from.begin());
    claim.part = std::move(part);
    claims_.push_back(std::move(claim));
  }

  void release_last() {
    const Claim& claim = claims_.back();
    for (const auto& [pixel, label] : claim.pixels) frame_.label[pixel] = label;
    for (int k = 0; k < 256; ++k) explained_[k] -= claim.from[k];
    for (auto& object : frame_.objects) object.labels.reset(claim.label);
    next_label_ = claim.label;
    claims_.pop_back();
  }

  double tolerance_mm(const Hypothesis& h) const { return touch_tolerance_mm(*models_[h.part], noise_at(h)); }

  /// Whether the part stands on the table, or touches a part that does: nothing hangs in the air, nor reaches into the
  /// table, up to so many tolerances. All, where no table is seen.
  bool is_held(const Hypothesis& h, double tolerances = 1) const {
    if (sinks_into_table(frame_, *models_[h.part], h.camera_from_model, tolerances * tolerance_mm(h))) return false;
    const auto height_mm = height_above_table_mm(frame_, *models_[h.part], h.camera_from_model);
    if (!height_mm || *height_mm < tolerances * tolerance_mm(h)) return true;
    const auto holds = [&](const Hypothesis& other) {
      return touches(*models_[h.part], h.camera_from_model, *models_[other.part], other.camera_from_model,
                     tolerances * tolerance_mm(other));
    };
    return std::any_of(known_.begin(), known_.end(), holds) ||
           std::any_of(claims_.begin(), claims_.end(),
                       [&](const Claim& claim) { return holds(claim.part.hypotheses[0]); });
  }

  /// What is left where a part's surface goes on beyond its outline is its: unexplained.
  void share_rest() {
    FrameObject rest;
    rest.labels = labels_;
    for (const Claim& claim : claims_) {
      const Hypothesis& h = claim.part.hypotheses[0];
      const PartModel& model = *models_[h.part];
      const PartWindow window = part_window(frame_, rest, model, h.camera_from_model, 0, far_beyond_px + 1);
      const DepthImage rendered =
          render_depth(model.surface, h.camera_from_model, window.frame.camera, model.surface.faces);
      const DepthImage beyond = beyond_outline(rendered, far_beyond_px, 1).depth;
      for (int v = 0; v < beyond.height; ++v)
        for (int u = 0; u < beyond.width; ++u)
          if (window.frame.label[static_cast<std::size_t>(v) * beyond.width + u] == PixelLabel::object &&
              beyond.at(u, v) > 0 && std::abs(beyond.at(u, v) - window.frame.depth.at(u, v)) < 3 * noise_at(h))
            frame_.label[static_cast<std::size_t>(window.v0 + v) * frame_.depth->width + window.u0 + u] = claim.label;
    }
    for (Claim& claim : claims_) {
      std::bitset<256> own;
      own.set(claim.label);
      claim.part.object = object_of(frame_, own);
    }
  }

  /// Of each part whether to drop it. What a part that is dropped explains is unexplained again, which may make another
  /// doubtful.
  std::vector<bool> which_are_doubtful() const {
    std::bitset<256> large;
    for (const auto& object : frame_.objects)
      if (object.larger_than_a_part) large |= object.labels;
    std::array<int, 256> explained = explained_, count{};
    for (const Claim& claim : claims_) ++count[claim.piece];
    std::vector<bool> doubtful(claims_.size(), false);
    // Nothing of the pieces that it has no pixel of.
    const auto rest_of = [&](std::size_t i) {
      FrameObject rest;
      for (int k = 0; k < 256; ++k) {
        if (claims_[i].from[k] == 0) continue;
        rest.labels[k] = labels_[k];
        for (std::size_t other = 0; other < claims_.size(); ++other)
          if (doubtful[other] && claims_[other].from[k] > 0) rest.labels.set(claims_[other].label);
      }
      return rest;
    };
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < claims_.size(); ++i) {
        const int piece = claims_[i].piece;
        if (doubtful[i] ||
            !is_doubtful(claims_[i].part.hypotheses[0], rest_of(i),
                         static_cast<double>(explained[piece]) / pixels_[piece], large.test(piece), count[piece] == 1))
          continue;
        doubtful[i] = changed = true;
        for (int k = 0; k < 256; ++k) explained[k] -= claims_[i].from[k];
        --count[piece];
      }
    }
    return doubtful;
  }

  /// A piece of which the parts leave much is something else, with faces like theirs; so is one with a part that just
  /// goes on beyond its outline, or that lies beneath what nothing explains. More is asked of a single part, and of
  /// what is no larger than a part: it may be one that is not known. `explained`: the share of the piece.
  bool is_doubtful(const Hypothesis& h, const FrameObject& rest, double explained, bool is_large, bool single) const {
    Trial now;
    now.hypothesis = h;
    compare(now, rest);
    const double least_explained = is_large ? 0.35 : single ? 0.65 : 0.45;
    const double most_going_on = !is_large ? single ? 0.1 : 0.2 : single ? 0.2 : 1;
    const double most_covered = is_large ? 1 : single ? 0.05 : 0.15;
    const auto share = [](int part, int whole) { return part / std::max(1.0, static_cast<double>(whole)); };
    return explained < least_explained || share(now.goes_on, now.outline) > most_going_on ||
           share(now.covered, now.comparison.model) > most_covered;
  }

  bool is_any_sure() const {
    const std::vector<bool> doubtful = which_are_doubtful();
    return std::count(doubtful.begin(), doubtful.end(), false) > 0;
  }

  /// With their pixels, but for those in doubt.
  std::vector<SeparatedPart> sure_parts() && {
    const std::vector<bool> doubtful = which_are_doubtful();
    share_rest();
    std::vector<SeparatedPart> sure;
    for (std::size_t i = 0; i < claims_.size(); ++i)
      if (!doubtful[i]) sure.push_back(std::move(claims_[i].part));
    return sure;
  }

  std::span<const PartModel* const> models_;
  FramePieces& frame_;
  std::bitset<256> labels_;
  std::vector<Hypothesis> starts_, known_;
  std::vector<Claim> claims_;
  int next_label_ = FramePieces::first_piece;
  std::array<int, 256> pixels_{}, explained_{};  ///< by the label of a piece
  double noise_per_mm2_ = 1e-6, largest_mm_ = 0, smallest_mm_ = 1e9;
};

}  // namespace

std::vector<SeparatedPart> separate(std::span<const PartModel* const> models, FramePieces& frame,
                                    const std::bitset<256>& unexplained, std::span<const KnownPart> known) {
  Separation separation(models, frame, unexplained);
  separation.take(known);
  return std::move(separation).search();
}

std::vector<SeparatedPart> separate_known(std::span<const PartModel* const> models, FramePieces& frame,
                                          const std::bitset<256>& unexplained, std::span<const Hypothesis> known) {
  return Separation(models, frame, unexplained).those_of(known);
}

}  // namespace partpose
