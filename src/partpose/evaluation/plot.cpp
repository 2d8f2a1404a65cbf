// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace partpose {

namespace {

/// Colours that differ for the colour-blind as well (Okabe and Ito 2008).
constexpr std::array<const char*, 7> colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#555555"};

/// Control characters, for which XML 1.0 has no form, become question marks.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r')
      out += '?';
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string text(double x, double y, const std::string& content, const char* anchor = "middle",
                 const char* extra = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" {}>{}</text>\n", x, y, anchor, extra,
                     escaped(content));
}

std::string line(double x1, double y1, double x2, double y2, const char* colour, double width = 1) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"{}\"/>\n", x1, y1, x2,
      y2, colour, width);
}

/// 1, 2 or 5 times a power of ten, so that about five steps make `range`.
double tick_step(double range) {
  const double raw = range / 5;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= raw) return factor * power;
  return 10 * power;
}

std::string document(int width, int height, const std::string& body) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n{2}</svg>\n",
      width, height, body);
}

constexpr int left = 60, top = 40, plot_height = 260;

std::string value_axis(double largest, double step, int width, const std::string& label) {
  std::string out;
  for (int k = 0; k * step <= largest * 1.0001; ++k) {
    const double y = top + plot_height * (1 - k * step / largest);
    out += line(left, y, width - 20, y, "#dddddd") + text(left - 6, y + 4, fmt::format("{:g}", k * step), "end");
  }
  return out + text(16, top + plot_height / 2.0, label, "middle",
                    fmt::format("transform=\"rotate(-90 16 {:.1f})\"", top + plot_height / 2.0).c_str());
}

}  // namespace

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double rank = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
}

std::string box_plot_svg(const std::string& title, const std::string& value_label,
                         const std::vector<BoxSeries>& given) {
  std::vector<BoxSeries> series = given;
  for (auto& s : series) std::erase_if(s.values, [](double value) { return !std::isfinite(value); });
  constexpr int slot = 110, box = 44;
  const int width = std::max(left + slot * static_cast<int>(series.size()) + 20, 420);
  double largest = 0;
  for (const auto& s : series)
    for (const double value : s.values) largest = std::max(largest, value);
  if (largest <= 0) largest = 1;
  const double step = tick_step(largest);
  largest = step * std::ceil(largest / step);
  const auto y_of = [&](double value) { return top + plot_height * (1 - value / largest); };

  std::string body =
      text(width / 2.0, 20, title, "middle", "font-weight=\"bold\"") + value_axis(largest, step, width, value_label);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double x = left + slot * (static_cast<double>(i) + 0.5);
    const auto& values = series[i].values;
    body += text(x, top + plot_height + 18, series[i].name) +
            text(x, top + plot_height + 34, fmt::format("n = {}", values.size()), "middle", "fill=\"#666666\"");
    if (values.empty()) continue;
    const double q1 = quantile(values, 0.25), q2 = quantile(values, 0.5), q3 = quantile(values, 0.75);
    const double reach = 1.5 * (q3 - q1);
    double low = q1, high = q3;
    for (const double value : values) {
      if (value >= q1 - reach) low = std::min(low, value);
      if (value <= q3 + reach) high = std::max(high, value);
    }
    const char* colour = colours[i % colours.size()];
    body += line(x, y_of(low), x, y_of(q1), colour) + line(x, y_of(q3), x, y_of(high), colour) +
            line(x - 10, y_of(low), x + 10, y_of(low), colour) + line(x - 10, y_of(high), x + 10, y_of(high), colour) +
            fmt::format(
                "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" fill=\"{}\" fill-opacity=\"0.2\" "
                "stroke=\"{}\"/>\n",
                x - box / 2.0, y_of(q3), box, y_of(q1) - y_of(q3), colour, colour) +
            line(x - box / 2.0, y_of(q2), x + box / 2.0, y_of(q2), colour, 2);
    for (const double value : values)
      if (value < low || value > high)
        body += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"none\" stroke=\"{}\"/>\n", x,
                            y_of(value), colour);
  }
  return document(width, top + plot_height + 50, body);
}

std::string percent_plot_svg(const std::string& title, const std::string& x_label, const std::string& y_label,
                             const std::vector<LineSeries>& series) {
  constexpr int plot_width = 360, width = left + plot_width + 220;
  const auto x_of = [&](double value) { return left + plot_width * value / 100; };
  const auto y_of = [&](double value) { return top + plot_height * (1 - value / 100); };
  std::string body = text(left + plot_width / 2.0, 20, title, "middle", "font-weight=\"bold\"") +
                     value_axis(100, 20, left + plot_width + 20, y_label) +
                     text(left + plot_width / 2.0, top + plot_height + 36, x_label);
  for (int k = 0; k <= 100; k += 20)
    body += line(x_of(k), top, x_of(k), top + plot_height, "#dddddd") +
            text(x_of(k), top + plot_height + 18, fmt::format("{}", k));
  for (std::size_t i = 0; i < series.size(); ++i) {
    const char* colour = colours[i % colours.size()];
    std::string points;
    for (const auto& [x, y] : series[i].points) points += fmt::format("{:.1f},{:.1f} ", x_of(x), y_of(y));
    body += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", points, colour);
    const double y = top + 10 + 18.0 * static_cast<double>(i);
    body += line(left + plot_width + 12, y, left + plot_width + 30, y, colour, 2) +
            text(left + plot_width + 36, y + 4, series[i].name, "start", "font-size=\"10\"");
  }
  return document(width, top + plot_height + 50, body);
}

}  // namespace partpose
