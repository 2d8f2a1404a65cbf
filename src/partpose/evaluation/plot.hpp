// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

/// Plots as SVG text, for the tables of an experiment.
namespace partpose {

/// Names that are drawn as text, and the numbers behind a box or a line.
struct BoxSeries {
  std::string name;
  std::vector<double> values;
};
struct LineSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x, y, in the order in which they are joined
};

/// Box from the first to the third quartile with the median; whiskers to the farthest values within 1.5 box lengths of
/// it; beyond them one dot each (Tukey 1977). The axis starts at 0. A series without values has no box;
/// values that are not finite are left out.
std::string box_plot_svg(const std::string& title, const std::string& value_label,
                         const std::vector<BoxSeries>& series);

/// Lines in the square 0 to 100 by 0 to 100 (per cent).
std::string percent_plot_svg(const std::string& title, const std::string& x_label, const std::string& y_label,
                             const std::vector<LineSeries>& series);

/// Linear interpolation between the closest ranks; 0 for no values. `share` 0 to 1.
double quantile(std::vector<double> values, double share);

}  // namespace partpose
