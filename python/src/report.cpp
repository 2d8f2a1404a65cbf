// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "interruptible.hpp"
#include "rooms.hpp"

#include "partpose/report/report.hpp"

namespace partpose::python {

void bind_report(nb::module_& parent) {
  auto m = room(parent, "report", "One HTML page of an output folder.");
  nb::class_<ReportSummary> summary(m, "ReportSummary", "What write_report wrote.");
  summary.def_ro("frames", &ReportSummary::frames, "That the page shows.")
      .def_ro("bytes", &ReportSummary::bytes, "Of the file.")
      .def_ro("thinned", &ReportSummary::thinned, "Some frame's points or depth are not shown in full.")
      .def_ro("problems", &ReportSummary::problems, "Files that could not be read.");
  bind_repr(summary, {"frames", "bytes", "thinned", "problems"});
  m.def(
      "write_report",
      [](const std::filesystem::path& folder, const std::filesystem::path& file, const std::string& title,
         double limit_deg, double limit_mm, std::size_t most_bytes, const Callback& progress) {
        return interruptible(progress, [&](const Progress& told) {
          return write_report(folder, file, {title, {}, limit_deg, limit_mm, most_bytes}, told);
        });
      },
      "folder"_a, "file"_a, "title"_a = "", "limit_deg"_a = ReportOptions{}.limit_deg,
      "limit_mm"_a = ReportOptions{}.limit_mm, "most_bytes"_a = ReportOptions{}.most_bytes, "progress"_a = nb::none(),
      nb::call_guard<nb::gil_scoped_release>(),
      "Makes one self-contained HTML page of an output folder: all frames in numbers, each frame in 3-D. A pose is "
      "right "
      "below both limits; points and depth images are thinned so that the file stays below `most_bytes`.");
}

}  // namespace partpose::python
