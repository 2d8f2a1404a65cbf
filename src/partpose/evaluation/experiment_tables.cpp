// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/experiment_tables.hpp"

#include "partpose/evaluation/calibration.hpp"
#include "partpose/evaluation/plot.hpp"
#include "partpose/evaluation/pose_judge.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"

#include <algorithm>
#include <set>
#include <tuple>

namespace partpose {

namespace {

namespace fs = std::filesystem;

/// A table that is written as Markdown for people and as CSV for programs.
class Table {
 public:
  explicit Table(std::vector<std::string> columns) : rows_{std::move(columns)} {}
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  bool has_rows() const { return rows_.size() > 1; }

  std::string markdown() const {
    std::string out;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      for (const auto& cell : rows_[r]) out += fmt::format("| {} ", cell);
      out += "|\n";
      if (r > 0) continue;
      for (std::size_t c = 0; c < rows_[0].size(); ++c) out += c == 0 ? "|---" : "|---:";
      out += "|\n";
    }
    return out;
  }
  std::string csv() const {
    std::string out;
    for (const auto& row : rows_) {
      for (std::size_t c = 0; c < row.size(); ++c) {
        if (c > 0) out += ',';
        out += quoted(row[c]);
      }
      out += "\n";
    }
    return out;
  }

 private:
  static std::string quoted(const std::string& cell) {
    if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
    std::string out = "\"";
    for (const char c : cell) {
      if (c == '"') out += c;
      out += c;
    }
    out += '"';
    return out;
  }
  std::vector<std::vector<std::string>> rows_;
};

std::string number(double value) { return fmt::format("{:.2f}", value); }
std::string number(int value) { return fmt::format("{}", value); }
double share_percent(int part_of, int all) { return all ? 100.0 * part_of / all : 0; }

/// How a run is named within its group and protocol.
std::string short_name(const RunSummary& run) {
  return run.descriptor == "-" ? run.configuration : run.configuration + " " + run.descriptor;
}

std::string file_name_of(const std::string& name) {
  std::string out;
  for (const char c : name) out += std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
  return out;
}

using Runs = std::vector<const RunSummary*>;

/// The runs of each group and protocol, most correct ones first, as in the reference's tables.
std::vector<Runs> by_group_and_protocol(const std::vector<RunSummary>& summaries) {
  std::vector<Runs> out;
  for (const auto& run : summaries) {
    const auto it = std::find_if(out.begin(), out.end(), [&](const Runs& runs) {
      return runs[0]->group == run.group && runs[0]->protocol == run.protocol;
    });
    if (it == out.end())
      out.push_back({&run});
    else
      it->push_back(&run);
  }
  for (auto& runs : out)
    std::stable_sort(runs.begin(), runs.end(), [](const auto* a, const auto* b) { return a->correct > b->correct; });
  return out;
}

Table recognition_table(const Runs& runs) {
  Table table(
      {"Configuration", "Total", "Correct", "Of total [%]", "Incorrect", "Of total [%]", "No result", "Of total [%]"});
  for (const auto* run : runs)
    table.add({short_name(*run), number(run->frames), number(run->correct), number(run->percent(run->correct)),
               number(run->wrong), number(run->percent(run->wrong)), number(run->none),
               number(run->percent(run->none))});
  return table;
}

Table pose_table(const Runs& runs) {
  Table table({"Configuration", "Under both", "Of correct [%]", "Of total [%]", "MSSD < 10 % [%]", "MSSD < 5 % [%]",
               "MSSD < 10 % or not to be told apart [%]", "Rotation median [deg]", "Translation median [mm]"});
  for (const auto* run : runs)
    table.add({short_name(*run), number(run->pose_right), number(share_percent(run->pose_right, run->correct)),
               number(run->percent(run->pose_right)), number(run->percent(run->mssd_10)),
               number(run->percent(run->mssd_5)), number(run->percent(run->seen_right)),
               number(quantile(run->rotation_errors_deg, 0.5)), number(quantile(run->translation_errors_mm, 0.5))});
  return table;
}

/// Rows: the part shown. Columns: what it was recognized as.
Table confusion_table(const RunSummary& run) {
  std::set<std::string> shown, named;
  for (const auto& [pair, count] : run.confusion) {
    shown.insert(pair.first);
    if (!pair.second.empty()) named.insert(pair.second);
  }
  named.insert(shown.begin(), shown.end());
  named.erase("");
  std::vector<std::string> columns = {"shown"};
  columns.insert(columns.end(), named.begin(), named.end());
  columns.emplace_back("none");
  Table table(columns);
  for (const auto& part : shown) {
    std::vector<std::string> row = {part.empty() ? "(none of them)" : part};
    const auto cell = [&](const std::string& as) {
      const auto it = run.confusion.find({part, as});
      return it == run.confusion.end() ? std::string("0") : number(it->second);
    };
    for (const auto& name : named) row.push_back(cell(name));
    row.push_back(cell(""));
    table.add(row);
  }
  return table;
}

Table time_table(const Runs& runs) {
  std::vector<std::string> steps;
  for (const auto* run : runs)
    for (const auto& [step, times] : run->stage_ms)
      if (std::find(steps.begin(), steps.end(), step) == steps.end()) steps.push_back(step);
  std::vector<std::string> columns = {"Configuration", "frame, median [ms]", "frame, p95 [ms]"};
  columns.insert(columns.end(), steps.begin(), steps.end());
  Table table(columns);
  for (const auto* run : runs) {
    std::vector<std::string> row = {short_name(*run), number(quantile(run->times_ms, 0.5)),
                                    number(quantile(run->times_ms, 0.95))};
    for (const auto& step : steps) {
      const auto it = run->stage_ms.find(step);
      row.push_back(it == run->stage_ms.end() ? "-" : number(quantile(it->second, 0.5)));
    }
    table.add(row);
  }
  return table;
}

/// Each object asked for, and each detection.
Table objects_table(const Runs& runs) {
  Table table({"Configuration", "Objects", "Found", "Found [%]", "Pose right [%]", "Detections", "Wrong", "Wrong [%]"});
  for (const auto* run : runs)
    table.add({short_name(*run), number(run->objects), number(run->objects_found),
               number(share_percent(run->objects_found, run->objects)),
               number(share_percent(run->objects_pose_right, run->objects)), number(run->detections),
               number(run->wrong_detections), number(share_percent(run->wrong_detections, run->detections))});
  return table;
}

Table bounds_table(const Runs& runs) {
  Table table({"Configuration", "Frames", "Left out", "Rotation bound [deg]", "Rotation error / bound",
               "Translation bound [mm]", "Translation error / bound"});
  for (const auto* run : runs)
    table.add({short_name(*run), number(static_cast<int>(run->rotation_bounds_deg.size())),
               number(run->bounds_undetermined), fmt::format("{:.3f}", quantile(run->rotation_bounds_deg, 0.5)),
               number(quantile(run->rotation_over_bound, 0.5)),
               fmt::format("{:.3f}", quantile(run->translation_bounds_mm, 0.5)),
               number(quantile(run->translation_over_bound, 0.5))});
  return table;
}

Table reliability_table(const Reliability& stated) {
  Table table({"Confidence", "Detections", "Right", "Right [%]", "Mean confidence [%]"});
  for (const auto& bin : stated.bins)
    table.add({fmt::format("{:.1f} to {:.1f}", bin.from, bin.to), number(bin.count), number(bin.right),
               bin.count ? number(100 * bin.share_right()) : "-", bin.count ? number(100 * bin.mean_confidence) : "-"});
  return table;
}

/// What the recognizer accepts by its own decision: of parts that it knows, and of parts that it does not.
Table decision_table(const std::vector<RunSummary>& summaries) {
  Table table(
      {"Group", "Protocol", "Configuration", "Part", "Frames", "Accepted", "Accepted [%]", "As the right part [%]"});
  for (const auto& run : summaries)
    table.add({run.group, run.protocol, short_name(run), run.left_out ? "not in the catalogue" : "known",
               number(run.frames), number(run.accepted), number(run.percent(run.accepted)),
               run.left_out ? "-" : number(run.percent(run.correct))});
  return table;
}

struct AcceptCurve {
  std::string name;
  std::vector<AcceptPoint> points;
};

/// One for each pair of a run with known parts and one with the same parts left out.
std::vector<AcceptCurve> accept_curves(const std::vector<FrameRecord>& records,
                                       const std::vector<RunSummary>& summaries) {
  std::map<std::string, std::vector<const FrameRecord*>> of_run;
  for (const auto& record : records) of_run[record.run].push_back(&record);
  std::vector<AcceptCurve> curves;
  for (const auto& known : summaries)
    for (const auto& unknown : summaries)
      if (!known.left_out && unknown.left_out && known.group == unknown.group &&
          known.configuration == unknown.configuration && known.descriptor == unknown.descriptor)
        curves.push_back(
            {fmt::format("{}: {} against {}, {}", known.group, known.protocol, unknown.protocol, short_name(known)),
             accept_curve(of_run[known.run], of_run[unknown.run])});
  return curves;
}

}  // namespace

std::vector<RunSummary> summarize_runs(const std::vector<FrameRecord>& records, const ExperimentSpec& spec) {
  std::vector<RunSummary> summaries;
  for (const auto& record : records) {
    auto it = std::find_if(summaries.begin(), summaries.end(), [&](const auto& s) { return s.run == record.run; });
    if (it == summaries.end()) {
      RunSummary run;
      run.run = record.run;
      run.group = record.group;
      run.protocol = record.protocol;
      run.configuration = record.configuration;
      run.descriptor = record.descriptor;
      run.left_out = record.left_out;
      it = summaries.insert(summaries.end(), std::move(run));
    }
    ++it->frames;
    const Evaluation& evaluation = record.evaluation;
    const bool recognized_something = record.result.candidate_id >= 0;
    const bool near = evaluation.recognized_correctly && mssd_below(evaluation, 0.10);
    it->mssd_10 += near;
    it->mssd_5 += evaluation.recognized_correctly && mssd_below(evaluation, 0.05);
    it->seen_right += near || evaluation.indistinguishable.value_or(false);
    it->accepted += recognized_something;
    if (record.objects) {
      for (const auto& object : record.objects->objects) {
        if (object.visible_fraction < counted_visibility) continue;
        ++it->objects;
        it->objects_found += object.detection >= 0;
        it->objects_pose_right += object.pose_right;
      }
      for (const auto& detection : record.objects->detections) {
        ++it->detections;
        it->wrong_detections += !detection.part_right;
        it->confidences.emplace_back(detection.confidence, detection.right);
      }
    }
    if (record.bound && !record.bound->determined) ++it->bounds_undetermined;
    if (record.bound && record.bound->determined) {
      it->rotation_bounds_deg.push_back(record.bound->rotation_deg);
      it->translation_bounds_mm.push_back(record.bound->translation_mm);
      it->rotation_over_bound.push_back(record.bound->rotation_error_deg / record.bound->rotation_deg);
      it->translation_over_bound.push_back(record.bound->translation_error_mm / record.bound->translation_mm);
    }
    ++it->confusion[{evaluation.ground_truth_model_name, recognized_something ? record.result.model_name : ""}];
    it->times_ms.push_back(record.time_ms);
    for (const auto& stage : record.stages) it->stage_ms[stage.tag].push_back(stage.measure_ms);
    if (!evaluation.recognized_correctly) {
      ++(recognized_something ? it->wrong : it->none);
      continue;
    }
    ++it->correct;
    if (!recognized_something) {  // rightly so: no pose to be judged
      ++it->pose_right;
      ++it->mssd_10;
      ++it->mssd_5;
      ++it->seen_right;
      continue;
    }
    it->pose_right += evaluation.rotation_error_deg < spec.limit_deg && evaluation.translation_error_mm < spec.limit_mm;
    it->rotation_errors_deg.push_back(evaluation.rotation_error_deg);
    it->translation_errors_mm.push_back(evaluation.translation_error_mm);
  }
  return summaries;
}

std::vector<AcceptPoint> accept_curve(const std::vector<const FrameRecord*>& known,
                                      const std::vector<const FrameRecord*>& left_out) {
  const auto shows_a_part = [](const FrameRecord* r) { return !r->evaluation.ground_truth_model_name.empty(); };
  std::set<double, std::greater<>> thresholds = {0.0};
  for (const auto* records : {&known, &left_out})
    for (const auto* record : *records)
      if (record->score >= 0) thresholds.insert(record->score);
  const auto percent = [](const std::vector<const FrameRecord*>& records, std::ptrdiff_t of, const auto& counts) {
    return of ? 100.0 * static_cast<double>(std::count_if(records.begin(), records.end(), counts)) /
                    static_cast<double>(of)
              : 0.0;
  };
  const auto known_count = std::count_if(known.begin(), known.end(), shows_a_part);
  const auto left_out_count = static_cast<std::ptrdiff_t>(left_out.size());
  std::vector<AcceptPoint> curve = {{*thresholds.begin() + 1, 0, 0}};
  for (const double threshold : thresholds) {
    const auto accepted = [&](const FrameRecord* r) { return r->score >= 0 && r->score >= threshold; };
    curve.push_back({threshold,
                     percent(known, known_count, [&](const FrameRecord* r) { return accepted(r) && r->best_is_right; }),
                     percent(left_out, left_out_count, accepted)});
  }
  return curve;
}

std::vector<FrameRecord> in_order_of(const ExperimentSpec& spec, std::vector<FrameRecord> records) {
  const auto place = [](const auto& items, const auto& is_it) {
    return std::find_if(items.begin(), items.end(), is_it) - items.begin();
  };
  const auto rank = [&](const FrameRecord& r) {
    const auto named = [](const std::string& name) { return [&name](const auto& item) { return item.name == name; }; };
    return std::tuple(place(spec.groups, named(r.group)), place(spec.protocols, named(r.protocol)),
                      place(spec.configurations, named(r.configuration)),
                      place(spec.descriptors, [&](const auto& descriptor) { return descriptor == r.descriptor; }));
  };
  std::stable_sort(records.begin(), records.end(), [&](const auto& a, const auto& b) {
    return std::tuple(rank(a), std::tie(a.run, a.frame)) < std::tuple(rank(b), std::tie(b.run, b.frame));
  });
  return records;
}

void write_tables(const std::vector<FrameRecord>& unsorted, const ExperimentSpec& spec, const fs::path& output) {
  const std::vector<FrameRecord> records = in_order_of(spec, unsorted);
  const auto summaries = summarize_runs(records, spec);

  std::string page = "# " + spec.name + "\n";
  Table recognition({"group", "protocol", "configuration", "descriptor", "total", "correct", "incorrect", "no_result"});
  Table poses({"group", "protocol", "configuration", "descriptor", "under_limits", "of_correct_percent",
               "of_total_percent", "mssd_10_of_total_percent", "mssd_5_of_total_percent",
               "mssd_10_or_indistinguishable_of_total_percent", "rotation_median_deg", "translation_median_mm"});
  Table confusion({"group", "protocol", "configuration", "descriptor", "shown", "recognized_as", "frames"});
  Table times({"group", "protocol", "configuration", "descriptor", "step", "median_ms", "p95_ms"});
  Json json;
  json["name"] = spec.name;
  json["runs"] = Json::array();
  for (const auto& run : summaries) {
    const auto row = [&](std::vector<std::string> cells) {
      cells.insert(cells.begin(), {run.group, run.protocol, run.configuration, run.descriptor});
      return cells;
    };
    recognition.add(row({number(run.frames), number(run.correct), number(run.wrong), number(run.none)}));
    poses.add(row({number(run.pose_right), number(share_percent(run.pose_right, run.correct)),
                   number(run.percent(run.pose_right)), number(run.percent(run.mssd_10)),
                   number(run.percent(run.mssd_5)), number(run.percent(run.seen_right)),
                   number(quantile(run.rotation_errors_deg, 0.5)), number(quantile(run.translation_errors_mm, 0.5))}));
    for (const auto& [pair, count] : run.confusion) confusion.add(row({pair.first, pair.second, number(count)}));
    times.add(row({"frame", number(quantile(run.times_ms, 0.5)), number(quantile(run.times_ms, 0.95))}));
    for (const auto& [step, ms] : run.stage_ms)
      times.add(row({step, number(quantile(ms, 0.5)), number(quantile(ms, 0.95))}));
    Json entry;
    for (const auto& [key, value] : {std::pair{"group", run.group},
                                     {"protocol", run.protocol},
                                     {"configuration", run.configuration},
                                     {"descriptor", run.descriptor}})
      entry[key] = value;
    entry["frames"] = run.frames;
    entry["correct"] = run.correct;
    entry["incorrect"] = run.wrong;
    entry["no_result"] = run.none;
    entry["pose_under_limits"] = run.pose_right;
    entry["mssd_under_10_percent"] = run.mssd_10;
    entry["mssd_under_5_percent"] = run.mssd_5;
    entry["mssd_under_10_percent_or_indistinguishable"] = run.seen_right;
    entry["accepted"] = run.accepted;
    entry["objects"] = run.objects;
    entry["objects_found"] = run.objects_found;
    entry["objects_pose_right"] = run.objects_pose_right;
    entry["detections"] = run.detections;
    entry["wrong_detections"] = run.wrong_detections;
    entry["expected_calibration_error"] = reliability(run.confidences).expected_error;
    if (!run.rotation_bounds_deg.empty() || run.bounds_undetermined > 0) {
      entry["bound"]["frames"] = run.rotation_bounds_deg.size();
      entry["bound"]["frames_left_out"] = run.bounds_undetermined;
      entry["bound"]["rotation_error_over_bound"] = quantile(run.rotation_over_bound, 0.5);
      entry["bound"]["translation_error_over_bound"] = quantile(run.translation_over_bound, 0.5);
    }
    entry["median_ms"] = quantile(run.times_ms, 0.5);
    json["runs"].push_back(entry);
  }

  std::set<std::string> plots;
  const auto plot_name = [&](const std::string& title) {
    std::string name = file_name_of(title);
    for (int k = 2; !plots.insert(name).second; ++k) name = fmt::format("{}-{}", file_name_of(title), k);
    return name;
  };
  for (const auto& runs : by_group_and_protocol(summaries)) {
    const RunSummary& best = *runs[0];
    const std::string title = best.group + ", " + best.protocol;
    page += fmt::format("\n## {}\n\nRecognition{}:\n\n{}", title,
                        best.left_out ? " (the part shown is not in the catalogue: correct is no result)" : "",
                        recognition_table(runs).markdown());
    if (!best.left_out) {
      std::vector<BoxSeries> rotation, translation;
      for (const auto* run : runs) {
        rotation.push_back({short_name(*run), run->rotation_errors_deg});
        translation.push_back({short_name(*run), run->translation_errors_mm});
      }
      const std::string plot = plot_name(title), rotation_file = plot + "-rotation.svg",
                        translation_file = plot + "-translation.svg";
      write_file_atomically(output / rotation_file, box_plot_svg("Rotation error: " + title, "deg", rotation));
      write_file_atomically(output / translation_file, box_plot_svg("Translation error: " + title, "mm", translation));
      page += fmt::format(
          "\nPoses: under {:g} deg and {:g} mm with symmetry ignored, and by the symmetry-aware MSSD in shares of the "
          "diameter, of the total:\n\n{}\n![rotation errors]({}) ![translation "
          "errors]({})\n",
          spec.limit_deg, spec.limit_mm, pose_table(runs).markdown(), rotation_file, translation_file);
    }
    if (std::any_of(runs.begin(), runs.end(), [](const auto* run) { return run->detections > 0 || run->objects > 0; }))
      page += fmt::format(
          "\nObjects: all parts of the catalogue of which {:.0f} % or more are seen, each to be found by a detection "
          "of "
          "its own; a detection is wrong when it names a part that is not there:\n\n{}",
          100 * counted_visibility, objects_table(runs).markdown());
    if (std::any_of(runs.begin(), runs.end(),
                    [](const auto* run) { return run->bounds_undetermined > 0 || !run->rotation_bounds_deg.empty(); }))
      page += fmt::format(
          "\nThe physical limit: medians over the frames with the right part of the Cramer-Rao bound, and of error / "
          "bound; frames whose ranges do not determine the pose are left out:\n\n{}",
          bounds_table(runs).markdown());
    page += fmt::format("\nConfusion of {}:\n\n{}\nTime per step, median [ms]{}:\n\n{}", short_name(best),
                        confusion_table(best).markdown(),
                        spec.parallel_frames ? " (frames side by side, each on what the others leave)" : "",
                        time_table(runs).markdown());
  }

  for (const auto& configuration : spec.configurations) {
    std::vector<std::pair<double, bool>> all;
    for (const auto& run : summaries)
      if (run.configuration == configuration.name)
        all.insert(all.end(), run.confidences.begin(), run.confidences.end());
    if (all.empty()) continue;
    const Reliability stated = reliability(all);
    page += fmt::format(
        "\n## Confidence of {}\n\nHow often detections are right (part and pose, up to what the camera can tell) that "
        "are stated to be so with this probability; all protocols together, parts that are not in the catalogue among "
        "them. Expected calibration error: {:.2f} points, of {} detections.\n\n{}",
        configuration.name, 100 * stated.expected_error, stated.count, reliability_table(stated).markdown());
  }

  const auto curves = accept_curves(records, summaries);
  if (!curves.empty()) {
    Table accepts({"curve", "threshold", "true_accepts_percent", "false_accepts_percent"});
    std::vector<LineSeries> lines;
    for (const auto& curve : curves) {
      lines.push_back({curve.name, {}});
      for (const auto& point : curve.points) {
        accepts.add({curve.name, fmt::format("{:.4f}", point.threshold), number(point.true_accepts_percent),
                     number(point.false_accepts_percent)});
        lines.back().points.emplace_back(point.false_accepts_percent, point.true_accepts_percent);
      }
    }
    write_file_atomically(output / "accepts.csv", accepts.csv());
    write_file_atomically(output / "accepts.svg",
                          percent_plot_svg("Accepting above a score", "false accepts, parts not in the catalogue [%]",
                                           "true accepts, right part [%]", lines));
    page += fmt::format(
        "\n## Parts that are not in the catalogue\n\nBy the recognizer's own decision:\n\n{}\nBy other thresholds on "
        "its "
        "score:\n\n![false against true accepts](accepts.svg)\n",
        decision_table(summaries).markdown());
  }

  Table errors(
      {"run", "frame", "shown", "recognized_as", "rotation_error_deg", "translation_error_mm", "score", "time_ms"});
  for (const auto& record : records)
    errors.add({record.run, record.frame, record.evaluation.ground_truth_model_name, record.result.model_name,
                number(record.evaluation.rotation_error_deg), number(record.evaluation.translation_error_mm),
                number(record.score), number(record.time_ms)});
  for (const auto& [file, table] : {std::pair{"recognition.csv", &recognition},
                                    {"poses.csv", &poses},
                                    {"confusion.csv", &confusion},
                                    {"times.csv", &times},
                                    {"errors.csv", &errors}})
    write_file_atomically(output / file, table->csv());
  write_json_file(output / "tables.json", json);
  write_file_atomically(output / "tables.md", page);
}

}  // namespace partpose
