#include "mbk/present/report/draw_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/present/report/picture.h"
#include "mbk/present/report/text.h"

namespace mbk::report {
namespace draw_chart_test {

using testing::HasSubstr;
using testing::Not;
using Drawn = ChartSeries::Drawn;

Chart chart() {
  Chart c;
  c.title = "Stiffness";
  c.x = {"made", "N/m"};
  c.y = {"found", "N/m"};
  c.series.push_back({"k_xx", {100.0, 200.0, 300.0}, {110.0, 190.0, 320.0}, {}, Drawn::marks});
  return c;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Row and column of every character `sign` inside the frame of the plot.
std::vector<std::pair<int, int>> places_of(const std::string& text, char sign) {
  std::vector<std::pair<int, int>> places;
  int row = 0;
  for (const std::string& line : lines_of(text)) {
    const std::size_t wall = std::min(line.find("│"), line.find("┤"));
    if (wall == std::string::npos) continue;
    ++row;
    for (std::size_t i = wall; i < line.size(); ++i) {
      if (line[i] == sign) places.emplace_back(row, static_cast<int>(columns(line.substr(wall, i - wall))));
    }
  }
  return places;
}

struct Place {
  double x, y;
};

std::vector<Place> circles_of(const std::string& svg) {
  std::vector<Place> places;
  const std::string plot = svg.substr(0, svg.find("<g transform"));  // the legend has one of its own
  const std::regex circle(R"re(<circle cx="([-\d.]+)" cy="([-\d.]+)")re");
  for (std::sregex_iterator it(plot.begin(), plot.end(), circle), end; it != end; ++it) {
    places.push_back({std::stod((*it)[1]), std::stod((*it)[2])});
  }
  return places;
}

TEST(ChartText, MarksRiseToTheRightAsTheirNumbersDo) {
  const auto places = places_of(chart_text(chart()), 'o');
  ASSERT_EQ(places.size(), 3u);  // from the top
  EXPECT_GT(places[0].second, places[1].second);
  EXPECT_GT(places[1].second, places[2].second);
  // x is evenly spaced; a character is half of what its place can be off
  EXPECT_NEAR(places[0].second - places[1].second, places[1].second - places[2].second, 1);
}

TEST(ChartText, TicksStandBesideTheValuesThatTheyName) {
  Chart c = chart();
  c.series[0] = {"exact", {0.0, 50.0, 100.0}, {0.0, 50.0, 100.0}, {}, Drawn::marks};
  for (const std::string& line : lines_of(chart_text(c))) {
    if (line.find("┤") == std::string::npos) continue;
    const double tick = std::stod(line);
    const bool marked = line.find('o') != std::string::npos;
    EXPECT_EQ(marked, tick == 0.0 || tick == 50.0 || tick == 100.0) << line;
  }
}

TEST(ChartText, HasTitleUnitsLegendReferencesAndNotes) {
  Chart c = chart();
  c.series.push_back({"theory", {100.0, 300.0}, {100.0, 300.0}, {}, Drawn::line});
  c.horizontal.push_back({200.0, "expected"});
  c.vertical.push_back({150.0, ""});
  c.identity = true;
  c.notes.emplace_back("Twenty seeds.");
  const std::string text = chart_text(c);
  for (const char* words : {"Stiffness", "found [N/m]", "made [N/m]", "o  k_xx", "⠒⠒⠒⠒  theory", "expected (200 N/m)",
                            "made = 150 N/m", "diagonal", "Twenty seeds."}) {
    EXPECT_THAT(text, HasSubstr(words));
  }
}

TEST(ChartText, FitsTheTerminalWithoutTrailingBlanks) {
  for (const bool equal : {false, true}) {
    Chart c = chart();
    c.equal_scale = equal;
    c.notes.emplace_back(std::string(50, 'n') + " " + std::string(60, 'm') + " and more");
    for (const std::string& line : lines_of(chart_text(c))) {
      EXPECT_LE(columns(line), kLineColumns) << line;
      EXPECT_FALSE(line.ends_with(' ')) << '"' << line << '"';
    }
  }
}

TEST(ChartText, EqualScaleDrawsACircleAsWideAsHigh) {
  Chart c;
  c.equal_scale = true;
  ChartSeries circle{"circle", {}, {}, {}, Drawn::marks};
  for (int i = 0; i < 360; ++i) {
    circle.x.push_back(std::cos(0.0174533 * i));
    circle.y.push_back(std::sin(0.0174533 * i));
  }
  c.series.push_back(circle);
  int left = 1000, right = 0, top = 1000, bottom = 0;
  for (const auto& [row, column] : places_of(chart_text(c), 'o')) {
    left = std::min(left, column);
    right = std::max(right, column);
    top = std::min(top, row);
    bottom = std::max(bottom, row);
  }
  EXPECT_NEAR(2 * (right - left), 4 * (bottom - top), 6);  // dots; each end is known to a character
}

TEST(Charts, NumbersThatAreNoneAreLeftOut) {
  Chart c = chart();
  const std::string without = chart_text(c), svg_without = chart_svg(c);
  c.series[0].x.push_back(250.0);
  c.series[0].y.push_back(kNaN);
  c.horizontal.push_back({kNaN, ""});
  EXPECT_EQ(places_of(chart_text(c), 'o'), places_of(without, 'o'));
  EXPECT_EQ(circles_of(chart_svg(c)).size(), 3u);
  c.series[0].intervals.assign(4, {kNaN, kNaN});
  c.series[0].intervals[0] = {100.0, std::numeric_limits<double>::infinity()};
  EXPECT_EQ(places_of(chart_text(c), 'o'), places_of(without, 'o'));
  EXPECT_THAT(chart_svg(c).substr(svg_without.find("<rect")), Not(testing::ContainsRegex("[^a-z]nan|[^a-z]inf[^a-z]")));
}

TEST(Charts, OneOfNothingAndOneOfASinglePointAreDrawn) {
  Chart c;
  c.title = "Nothing";
  EXPECT_THAT(chart_text(c), HasSubstr("Nothing"));
  EXPECT_THAT(chart_svg(c), HasSubstr("</svg>"));
  c.series.push_back({"one", {5.0}, {0.0}, {}, Drawn::marks});
  EXPECT_EQ(places_of(chart_text(c), 'o').size(), 1u);
  EXPECT_EQ(circles_of(chart_svg(c)).size(), 1u);
  c.series[0].y[0] = 1e9;
  EXPECT_EQ(places_of(chart_text(c), 'o').size(), 1u);
}

TEST(ChartSvg, MarksStandWhereTheAxesSay) {
  const auto circles = circles_of(chart_svg(chart()));
  ASSERT_EQ(circles.size(), 3u);
  constexpr double kRounding = 0.02;  // two decimals
  EXPECT_NEAR(circles[1].x - circles[0].x, circles[2].x - circles[1].x, kRounding);
  EXPECT_NEAR((circles[0].y - circles[1].y) / (circles[0].y - circles[2].y), 80.0 / 210.0, 1e-3);
  EXPECT_LT(circles[2].y, circles[0].y);  // y grows upwards on the page
}

TEST(Charts, LogarithmicAxesShowPowersOfTenAndLeaveOutWhatHasNoLogarithm) {
  Chart c = chart();
  c.x = {"frequency", "Hz", true};
  c.y = {"magnitude", "", true};
  c.series[0] = {"model", {0.01, 0.1, 1.0, 10.0, -1.0}, {1.0, 10.0, 100.0, 1000.0, 5.0}, {}, Drawn::marks};
  c.vertical = {{0.1, "end"}};
  const std::string svg = chart_svg(c), text = chart_text(c);
  for (const char* tick : {">0.01<", ">0.1<", ">1<", ">10<", ">1000<"}) EXPECT_THAT(svg, HasSubstr(tick));
  EXPECT_THAT(text, HasSubstr("end (0.1 Hz)"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(ChartSvg, EqualScaleAndIdentityHaveOneScaleForBothAxes) {
  for (const bool identity : {false, true}) {
    Chart c = chart();
    c.series[0].y = {0.0, 100.0, 200.0};
    (identity ? c.identity : c.equal_scale) = true;
    const auto circles = circles_of(chart_svg(c));
    EXPECT_NEAR(circles[1].x - circles[0].x, circles[0].y - circles[1].y, 0.02);
  }
}

TEST(ChartSvg, IntervalsSpanTheirEnds) {
  Chart c = chart();
  c.series[0].intervals = {{100.0, 120.0}, {150.0, 230.0}, {310.0, 330.0}};
  const std::string svg = chart_svg(c);
  const std::regex bar(R"re(M[\d.]+ ([\d.]+)V([\d.]+)M[\d.]+ [\d.]+h7)re");
  std::vector<double> lengths;
  for (std::sregex_iterator it(svg.begin(), svg.end(), bar), end; it != end; ++it) {
    lengths.push_back(std::stod((*it)[1]) - std::stod((*it)[2]));
  }
  ASSERT_EQ(lengths.size(), 3u);
  EXPECT_NEAR(lengths[1] / lengths[0], 4.0, 0.01);
  EXPECT_NEAR(lengths[2], lengths[0], 0.03);
}

TEST(ChartSvg, SeriesDifferInMarkDashAndColour) {
  Chart c = chart();
  for (const char* name : {"two", "three"}) c.series.push_back({name, {1.0, 2.0}, {3.0, 4.0}, {}, Drawn::marks});
  for (const char* name : {"line", "dashed", "dotted"}) {
    c.series.push_back({name, {1.0, 2.0}, {3.0, 4.0}, {}, Drawn::line});
  }
  const std::string svg = chart_svg(c);
  for (const char* part : {"<circle", "width=\"8\" height=\"8\"", "l5.2 9h-10.4z", "stroke-dasharray=\"9 4\"",
                           "stroke-dasharray=\"2 3\"", "#0072B2", "#D55E00", "#009E73"}) {
    EXPECT_THAT(svg, HasSubstr(part));
  }
}

TEST(ChartSvg, NamesAreTextAndNeverMarkup) {
  Chart c = chart();
  c.title = "a < b & \"c\" > d";
  c.series[0].name = "</svg><script>\x01";
  c.notes = {"<b>"};
  const std::string svg = chart_svg(c);
  EXPECT_THAT(svg, HasSubstr("a &lt; b &amp; &quot;c&quot; &gt; d"));
  EXPECT_THAT(svg, Not(HasSubstr("<script")));
  EXPECT_THAT(svg, Not(HasSubstr("<b>")));
  EXPECT_THAT(svg, Not(HasSubstr("\x01")));
  EXPECT_EQ(svg.find("</svg>"), svg.rfind("</svg>"));
}

/// Of every font-size, the smallest in mm.
double smallest_text_mm(const std::string& svg) {
  const std::regex size(R"re(viewBox="0 0 ([\d.]+) [\d.]+" width="([\d.]+)mm")re"), font(R"re(font-size="([\d.]+)")re");
  std::smatch found;
  if (!std::regex_search(svg, found, size)) return 0.0;
  const double unit = std::stod(found[2]) / std::stod(found[1]);
  double smallest = 1e9;
  for (std::sregex_iterator it(svg.begin(), svg.end(), font), end; it != end; ++it) {
    smallest = std::min(smallest, unit * std::stod((*it)[1]));
  }
  return smallest;
}

TEST(ChartSvg, IsAsWideAsAskedWithTextOfAtLeast7Points) {
  constexpr double kMillimetresPerPoint = 25.4 / 72.0, kSmallestPoints = 7.0;
  Chart c = chart();
  c.horizontal.push_back({200.0, "expected"});
  c.notes.emplace_back(std::string("a note that is longer than one column of a page is wide, so that it is wrapped"));
  for (const double width : {kOneColumnMm, kTwoColumnsMm, 60.0}) {
    const std::string svg = chart_svg(c, width);
    EXPECT_THAT(svg, HasSubstr("width=\"" + std::to_string(static_cast<int>(width)) + ".00mm\""));
    EXPECT_GE(smallest_text_mm(svg), kSmallestPoints * kMillimetresPerPoint) << width;
    const std::vector<Chart> three(3, c);
    EXPECT_GE(smallest_text_mm(charts_svg("three", three, width)), kSmallestPoints * kMillimetresPerPoint) << width;
  }
}

TEST(ChartSvg, HasItsTitleForReadersOfTheFileOnly) {
  const std::string svg = chart_svg(chart());
  EXPECT_EQ(svg.find("Stiffness"), svg.rfind("Stiffness"));
  EXPECT_THAT(svg, HasSubstr("<title id=\"title\">Stiffness</title>"));
}

TEST(ChartSvg, NumbersUnderTheAxisDoNotTouch) {
  Chart c = chart();
  c.x = {"frequency", "rad/s", true};
  c.series[0].x = {1e-18, 1.0, 1e4};
  const std::string svg = chart_svg(c, 60.0);
  const std::regex number(R"re(<text x="([\d.]+)" y="[\d.]+" text-anchor="middle">([^<]+)</text>)re");
  double free_from = 0.0;
  int count = 0;
  for (std::sregex_iterator it(svg.begin(), svg.end(), number), end; it != end; ++it, ++count) {
    if ((*it)[2].str().find("frequency") != std::string::npos) continue;
    constexpr double kCharacter = 7.4;  // of 13 units high, about
    const double half = 0.5 * kCharacter * static_cast<double>((*it)[2].length());
    EXPECT_GE(std::stod((*it)[1]) - half, free_from) << (*it)[2];
    free_from = std::stod((*it)[1]) + half;
  }
  EXPECT_GE(count, 3);
}

TEST(ChartSvg, NamesOfLinesThatAreCloseDoNotCoverEachOther) {
  Chart c = chart();
  c.vertical = {{200.0, "measured, low"}, {201.0, "measured, high"}, {300.0, "far"}};
  const std::string svg = chart_svg(c, kOneColumnMm);
  const std::regex name(R"re(translate\(([\d.]+) [\d.]+\) rotate\(-90\)">(measured|far))re");
  std::vector<double> places;
  for (std::sregex_iterator it(svg.begin(), svg.end(), name), end; it != end; ++it) {
    places.push_back(std::stod((*it)[1]));
  }
  ASSERT_EQ(places.size(), 3u);
  EXPECT_GE(std::abs(places[0] - places[1]), 12.0);
}

TEST(ChartSvg, SeveralStandSideBySide) {
  const std::vector<Chart> three(3, chart());
  const std::string svg = charts_svg("all three", three, kTwoColumnsMm);
  EXPECT_THAT(svg, HasSubstr("<title id=\"title\">all three</title>"));
  EXPECT_EQ(svg.find("</svg>"), svg.rfind("</svg>"));
  const std::regex column(R"re(<g transform="translate\(([\d.]+) 0\)">)re");
  std::vector<double> left;
  for (std::sregex_iterator it(svg.begin(), svg.end(), column), end; it != end; ++it) {
    left.push_back(std::stod((*it)[1]));
  }
  ASSERT_EQ(left.size(), 2u);
  EXPECT_NEAR(left[1], 2.0 * left[0], 0.02);
}

TEST(ChartSvg, SaysInWordsWhatItShows) {
  Chart c = chart();
  c.horizontal.push_back({200.0, "expected"});
  const std::string svg = chart_svg(c);
  EXPECT_THAT(svg, HasSubstr("<title id=\"title\">Stiffness</title>"));
  EXPECT_THAT(svg, AllOf(HasSubstr("found [N/m]"), HasSubstr("made [N/m]"), HasSubstr("3 points"),
                         HasSubstr("expected (200 N/m)")));
  EXPECT_THAT(svg, HasSubstr("aria-labelledby=\"title description\""));
}

}  // namespace draw_chart_test
}  // namespace mbk::report
