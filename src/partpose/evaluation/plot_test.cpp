// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/plot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace partpose {
namespace {

struct Element {
  std::string tag, text;
  std::map<std::string, std::string> attributes;
  double number(const std::string& key) const { return std::stod(attributes.at(key)); }
};

/// As much of XML 1.0 as a plot needs, strictly: every tag is closed, every attribute quoted and given once, every &
/// the beginning of one of the five entities, one root. Throws std::runtime_error otherwise.
class Xml {
 public:
  explicit Xml(const std::string& text) : text_(text) {
    for (const char c : text)
      if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' && c != '\r') fail("a control character");
    element();
    space();
    if (at_ != text_.size()) fail("something after the root");
  }
  std::vector<Element> elements;

  std::vector<Element> all(const std::string& tag) const {
    std::vector<Element> out;
    std::copy_if(elements.begin(), elements.end(), std::back_inserter(out),
                 [&](const Element& e) { return e.tag == tag; });
    return out;
  }
  bool shows(const std::string& text) const {
    return std::any_of(elements.begin(), elements.end(),
                       [&](const Element& e) { return e.tag == "text" && e.text == text; });
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(what + " at byte " + std::to_string(at_));
  }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  bool skip(const std::string& token) {
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }
  void space() {
    while (std::isspace(static_cast<unsigned char>(peek()))) ++at_;
  }
  std::string name() {
    const std::size_t begin = at_;
    while (std::isalnum(static_cast<unsigned char>(peek())) || peek() == '-') ++at_;
    if (at_ == begin) fail("no name");
    return text_.substr(begin, at_ - begin);
  }
  std::string until(char stop) {
    std::string out;
    while (peek() != stop) {
      if (peek() == '\0' || peek() == '<') fail("text that does not end");
      if (peek() != '&') {
        out += text_[at_++];
        continue;
      }
      if (skip("&lt;"))
        out += '<';
      else if (skip("&gt;"))
        out += '>';
      else if (skip("&amp;"))
        out += '&';
      else if (skip("&quot;"))
        out += '"';
      else if (skip("&apos;"))
        out += '\'';
      else
        fail("a bare &");
    }
    return out;
  }
  void element() {
    if (!skip("<")) fail("no element");
    const std::size_t index = elements.size();
    elements.push_back({name(), {}, {}});
    for (space(); peek() != '>' && peek() != '/'; space()) {
      const std::string key = name();
      if (!skip("=\"")) fail("an attribute without a quoted value");
      if (!elements[index].attributes.emplace(key, until('"')).second) fail("an attribute that is there twice");
      ++at_;
    }
    if (skip("/>")) return;
    if (!skip(">")) fail("no >");
    while (!skip("</")) {
      if (peek() == '<')
        element();
      else
        elements[index].text += until('<');
    }
    if (name() != elements[index].tag || !skip(">")) fail("another tag is closed");
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

/// Values by their height in the image, read off the labels of the axis.
class Axis {
 public:
  explicit Axis(const Xml& svg) {
    for (const auto& e : svg.all("text"))
      if (e.attributes.at("text-anchor") == "end") ticks_.emplace_back(e.number("y") - 4, std::stod(e.text));
    if (ticks_.size() < 2) throw std::runtime_error("an axis without labels");
  }
  double value_at(double y) const {
    const auto [y0, v0] = ticks_.front();
    const auto [y1, v1] = ticks_.back();
    return v0 + (y - y0) / (y1 - y0) * (v1 - v0);
  }
  double largest() const { return ticks_.back().second; }
  std::size_t ticks() const { return ticks_.size(); }

 private:
  std::vector<std::pair<double, double>> ticks_;
};

/// The boxes alone: the first rectangle is the paper.
std::vector<Element> boxes(const Xml& svg) {
  auto all = svg.all("rect");
  all.erase(all.begin());
  return all;
}

/// Values of the horizontal strokes of a box plot that are `length_px` long.
std::vector<double> strokes(const Xml& svg, double length_px) {
  const Axis axis(svg);
  std::vector<double> values;
  for (const auto& e : svg.all("line"))
    if (e.number("y1") == e.number("y2") && std::abs(e.number("x2") - e.number("x1") - length_px) < 0.11)
      values.push_back(axis.value_at(e.number("y1")));
  std::sort(values.begin(), values.end());
  return values;
}

TEST(XmlOfTheTests, RefusesWhatIsNotWellFormed) {
  for (const char* bad : {"<a>", "<a></b>", "<a b=1/>", "<a b=\"1\" b=\"2\"/>", "<a>&</a>", "<a/><a/>", "a", ""})
    EXPECT_THROW(Xml{std::string(bad)}, std::runtime_error) << bad;
  EXPECT_EQ(Xml{std::string("<a>x &lt; y<b c=\"d\"/></a>")}.elements.size(), 2u);
}

TEST(Quantile, InterpolatesBetweenTheClosestRanks) {
  EXPECT_EQ(quantile({}, 0.5), 0);
  EXPECT_EQ(quantile({7}, 0), 7);
  EXPECT_EQ(quantile({7}, 0.95), 7);
  const std::vector<double> values = {40, 10, 30, 20};  // in any order
  EXPECT_DOUBLE_EQ(quantile(values, 0), 10);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25), 17.5);
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 25);
  EXPECT_DOUBLE_EQ(quantile(values, 0.75), 32.5);
  EXPECT_DOUBLE_EQ(quantile(values, 0.95), 38.5);
  EXPECT_DOUBLE_EQ(quantile(values, 1), 40);
  EXPECT_DOUBLE_EQ(quantile({5, 5, 5}, 0.3), 5);
}

TEST(BoxPlot, BoxWhiskersAndOutliers) {
  // Quartiles 2.25, 3.5, 4.75: whiskers reach 3.75 beyond the box at most, to 1 and 5; 20 is an outlier.
  const std::string text = box_plot_svg("Errors", "mm", {{"vfh", {5, 3, 1, 20, 2, 4}}});
  const Xml svg(text);
  const Axis axis(svg);
  EXPECT_GE(axis.largest(), 20);
  EXPECT_LE(axis.largest(), 40);
  ASSERT_EQ(boxes(svg).size(), 1u);
  const Element box = boxes(svg)[0];
  constexpr double tolerance = 0.02;  // a tenth of a pixel
  EXPECT_NEAR(axis.value_at(box.number("y")), 4.75, tolerance);
  EXPECT_NEAR(axis.value_at(box.number("y") + box.number("height")), 2.25, tolerance);
  const auto median = strokes(svg, box.number("width"));
  ASSERT_EQ(median.size(), 1u);
  EXPECT_NEAR(median[0], 3.5, tolerance);
  const auto ends = strokes(svg, 20);
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_NEAR(ends[0], 1, tolerance);
  EXPECT_NEAR(ends[1], 5, tolerance);
  const auto dots = svg.all("circle");
  ASSERT_EQ(dots.size(), 1u);
  EXPECT_NEAR(axis.value_at(dots[0].number("cy")), 20, tolerance);
  EXPECT_NEAR(dots[0].number("cx"), box.number("x") + box.number("width") / 2, 0.11);
  for (const char* shown : {"Errors", "mm", "vfh", "n = 6"}) EXPECT_TRUE(svg.shows(shown)) << shown;
}

TEST(BoxPlot, AValueAtTheEndOfTheReachIsNoOutlier) {
  // Quartiles 1 and 3 of {0 x 1, 1, 2, 3, 6}: the reach ends at 6.
  const std::string text = box_plot_svg("", "", {{"a", {0, 1, 2, 3, 6}}});
  const Xml svg(text);
  EXPECT_TRUE(svg.all("circle").empty());
  EXPECT_NEAR(strokes(svg, 20).back(), 6, 0.01);
  const std::string beyond = box_plot_svg("", "", {{"a", {0, 1, 2, 3, 6.1}}});
  EXPECT_EQ(Xml(beyond).all("circle").size(), 1u);
}

TEST(BoxPlot, SeriesStandSideBySideInTheImage) {
  const std::string text = box_plot_svg("t", "mm", {{"a", {1, 2}}, {"none", {}}, {"c", {3, 4}}, {"d", {5}}});
  const Xml svg(text);
  ASSERT_EQ(boxes(svg).size(), 3u) << "a series without values has no box";
  EXPECT_TRUE(svg.shows("none"));
  EXPECT_TRUE(svg.shows("n = 0"));
  for (std::size_t i = 1; i < 3; ++i)
    EXPECT_GT(boxes(svg)[i].number("x"), boxes(svg)[i - 1].number("x") + boxes(svg)[i - 1].number("width"));
  const double width = svg.elements[0].number("width"), height = svg.elements[0].number("height");
  for (const auto& e : svg.all("line"))
    for (const char* key : {"x1", "x2", "y1", "y2"}) {
      EXPECT_GE(e.number(key), 0);
      EXPECT_LE(e.number(key), key[0] == 'x' ? width : height);
    }
}

TEST(BoxPlot, NothingToShow) {
  for (const auto& series : {std::vector<BoxSeries>{}, {{"a", {}}}}) {
    const std::string text = box_plot_svg("t", "mm", series);
    const Xml svg(text);
    EXPECT_TRUE(boxes(svg).empty());
    EXPECT_TRUE(svg.all("circle").empty());
    EXPECT_GE(Axis(svg).ticks(), 2u);
  }
}

TEST(BoxPlot, AllValuesEqual) {
  for (const double value : {0.0, 3.0, 1e-7, 4e9}) {
    const std::string text = box_plot_svg("t", "mm", {{"a", {value, value, value}}});
    const Xml svg(text);
    const Axis axis(svg);
    ASSERT_EQ(boxes(svg).size(), 1u) << value;
    EXPECT_EQ(boxes(svg)[0].number("height"), 0) << value;
    EXPECT_NEAR(axis.value_at(boxes(svg)[0].number("y")), value, 1e-3 * axis.largest()) << value;
    EXPECT_TRUE(svg.all("circle").empty()) << value;
    EXPECT_GE(axis.largest(), value);
    EXPECT_LE(axis.ticks(), 12u) << value;
  }
}

TEST(BoxPlot, OtherThanNumbersAreLeftOut) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const std::string text = box_plot_svg("t", "mm", {{"a", {1, std::nan(""), 3, inf, 2}}, {"b", {inf}}});
  const Xml svg(text);
  ASSERT_EQ(boxes(svg).size(), 1u);
  EXPECT_TRUE(svg.shows("n = 3"));
  EXPECT_NEAR(strokes(svg, boxes(svg)[0].number("width"))[0], 2, 0.01);
}

TEST(PercentPlot, PointsAreWhereTheAxesSay) {
  const std::string text = percent_plot_svg("Curve", "false [%]", "true [%]", {{"a", {{0, 0}, {25, 75}, {100, 100}}}});
  const Xml svg(text);
  const Axis axis(svg);
  EXPECT_EQ(axis.largest(), 100);
  std::map<double, double> x_of;  // from the labels of the x axis
  for (const auto& e : svg.all("text"))
    if (e.attributes.at("text-anchor") == "middle" && e.text.find_first_not_of("0123456789") == std::string::npos)
      x_of[std::stod(e.text)] = e.number("x");
  ASSERT_TRUE(x_of.count(0) && x_of.count(100));
  ASSERT_EQ(svg.all("polyline").size(), 1u);
  std::vector<std::pair<double, double>> points;
  const std::string list = svg.all("polyline")[0].attributes.at("points");
  double x = 0, y = 0;
  int used = 0;
  for (const char* at = list.c_str(); std::sscanf(at, "%lf,%lf%n", &x, &y, &used) == 2; at += used)
    points.emplace_back((x - x_of[0]) / (x_of[100] - x_of[0]) * 100, axis.value_at(y));
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[1].first, 25, 0.1);
  EXPECT_NEAR(points[1].second, 75, 0.1);
  EXPECT_NEAR(points[2].first, 100, 0.1);
  EXPECT_NEAR(points[2].second, 100, 0.1);
  const std::string empty = percent_plot_svg("t", "x", "y", {}),
                    no_points = percent_plot_svg("t", "x", "y", {{"a", {}}});
  EXPECT_TRUE(Xml(empty).all("polyline").empty());
  EXPECT_TRUE(Xml(no_points).shows("a"));
}

TEST(Plots, TextIsEscaped) {
  const std::string odd = "<b> & \"quoted\" 'single' </text> \xC3\xA4";
  const std::string box = box_plot_svg(odd, odd, {{odd, {1, 2}}}), curve = percent_plot_svg(odd, odd, odd, {{odd, {}}});
  for (const auto* text : {&box, &curve}) {
    const Xml svg(*text);
    EXPECT_GE(std::count_if(svg.elements.begin(), svg.elements.end(), [&](const Element& e) { return e.text == odd; }),
              3);
    EXPECT_TRUE(svg.all("b").empty());
  }
  // XML 1.0 has no way to write these.
  const std::string control = box_plot_svg(std::string("a\x01") + "b\x1f", "", {});
  EXPECT_TRUE(Xml(control).shows("a?b?"));
}

}  // namespace
}  // namespace partpose
