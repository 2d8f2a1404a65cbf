// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/report/report.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  fs::path folder, output;
  double most_mb = 28;
  bool json = false;
  ReportOptions options;
};

void make_report(const ReportArguments& arguments, const Common& common) {
  const fs::path file = arguments.output.empty() ? arguments.folder / "report.html" : arguments.output;
  ReportOptions options = arguments.options;
  options.most_bytes = static_cast<std::size_t>(arguments.most_mb * 1e6);
  const ReportSummary summary = write_report(arguments.folder, file, options, terminal_progress(common));
  for (const auto& problem : summary.problems) complain(fmt::format("left out: {}", problem));
  if (arguments.json)
    print_json({{"report", file.string()},
                {"frames", summary.frames},
                {"bytes", summary.bytes},
                {"thinned", summary.thinned},
                {"left_out", summary.problems}});
  else if (!common.quiet)
    fmt::print("{}: {}, {:.1f} MB{}\n", file.string(), counted(summary.frames, "frame"),
               static_cast<double>(summary.bytes) / 1e6,
               summary.thinned ? ", points thinned to keep it small (--max-mb)" : "");
}

}  // namespace

void add_report_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<ReportArguments>();
  auto* report =
      app.add_subcommand("report", "Make one HTML page of an output folder: every frame, every step, in 3-D");
  report->add_option("folder", arguments->folder, "What --output of recognize, evaluate, captured or experiment wrote")
      ->required();
  report->add_option("-o,--output", arguments->output, "File to write (default: report.html in the folder)");
  report->add_option("--title", arguments->options.title, "Heading (default: the folder's name)");
  report
      ->add_option("--limit-deg", arguments->options.limit_deg,
                   "Where poses are judged in degrees and mm: right below this rotation error")
      ->capture_default_str();
  report
      ->add_option("--limit-mm", arguments->options.limit_mm,
                   "Where poses are judged in degrees and mm: right below this translation error")
      ->capture_default_str();
  report->add_option("--max-mb", arguments->most_mb, "Points and depth images are thinned until the file is smaller")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  report->add_flag("--json", arguments->json, "Print what was made as JSON");
  report->footer(
      "Example:\n  partpose evaluate --dataset dataset/ --test dataset/ --output evaluated/\n"
      "  partpose report evaluated/ --output report.html\n"
      "The page needs no network. What the folder does not hold (see the configuration's \"debug\") is shown as\n"
      "not saved.");
  report->callback([arguments, &common] { make_report(*arguments, common); });
}

}  // namespace partpose::apps
