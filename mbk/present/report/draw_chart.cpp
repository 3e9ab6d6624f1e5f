#include "mbk/present/report/draw_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/present/report/braille.h"
#include "mbk/present/report/picture.h"
#include "mbk/present/report/text.h"

namespace mbk::report {
namespace {

// ---- What text and SVG share: ranges and ticks

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double size() const { return high - low; }
  [[nodiscard]] bool holds(double value) const { return value >= low && value <= high; }
};

/// A little wider than what is shown, and never empty.
Range with_room(Range range) {
  if (range.low > range.high) return {0.0, 1.0};
  const double room = range.size() > 1e-9 * std::max(std::abs(range.low), std::abs(range.high))
                          ? 0.04 * range.size()
                          : std::max(0.1 * std::abs(range.low), 1e-12);
  return {range.low - room, range.high + room};
}

struct Ranges {
  Range x, y;
};

bool drawable(const ChartSeries& series, std::size_t k) {
  return k < series.y.size() && std::isfinite(series.x[k]) && std::isfinite(series.y[k]);
}

bool finite(const std::pair<double, double>& interval) {
  return std::isfinite(interval.first) && std::isfinite(interval.second);
}

/// Those whose value is a number.
std::vector<ChartReference> shown(std::vector<ChartReference> lines) {
  std::erase_if(lines, [](const ChartReference& line) { return !std::isfinite(line.value); });
  return lines;
}

Ranges ranges_of(const Chart& chart) {
  Ranges ranges;
  for (const ChartSeries& series : chart.series) {
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      if (!drawable(series, k)) continue;
      ranges.x.take(series.x[k]);
      ranges.y.take(series.y[k]);
      if (k < series.intervals.size() && finite(series.intervals[k])) {
        ranges.y.take(series.intervals[k].first);
        ranges.y.take(series.intervals[k].second);
      }
    }
  }
  for (const ChartReference& line : chart.horizontal) ranges.y.take(line.value);
  for (const ChartReference& line : chart.vertical) ranges.x.take(line.value);
  if (chart.identity) {
    ranges.x.take(ranges.y.low);
    ranges.x.take(ranges.y.high);
    ranges.y = ranges.x;
  }
  return {with_room(ranges.x), with_room(ranges.y)};
}

void take_logarithm(double& value) {
  value = value > 0.0 ? std::log10(value) : std::numeric_limits<double>::quiet_NaN();
}

/// The chart with the decimal logarithms of what its logarithmic axes show.
Chart on_even_axes(Chart chart) {
  for (ChartSeries& series : chart.series) {
    if (chart.x.logarithmic) std::ranges::for_each(series.x, take_logarithm);
    if (!chart.y.logarithmic) continue;
    std::ranges::for_each(series.y, take_logarithm);
    for (auto& [low, high] : series.intervals) {
      take_logarithm(low);
      take_logarithm(high);
    }
  }
  if (chart.x.logarithmic) std::ranges::for_each(chart.vertical, take_logarithm, &ChartReference::value);
  if (chart.y.logarithmic) std::ranges::for_each(chart.horizontal, take_logarithm, &ChartReference::value);
  return chart;
}

struct Tick {
  double value = 0;
  std::string label;
};

/// Multiples of 1, 2 or 5 × 10ᵏ within a range, about `expected` of them, with the decimals that distinguish them.
std::vector<Tick> ticks_of(const Range& range, int expected) {
  const double raw = range.size() / expected, power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= raw) step = factor * power;
  }
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  const bool plain = decimals <= 5 && std::max(std::abs(range.low), std::abs(range.high)) < 1e6;
  std::vector<Tick> ticks;
  for (double i = std::ceil(range.low / step); i * step <= range.high; i += 1.0) {
    const double value = i == 0.0 ? 0.0 : i * step;  // no −0
    ticks.push_back({value, plain ? fmt::format("{:.{}f}", value, decimals) : fmt::format("{:.6g}", value)});
  }
  return ticks;
}

/// Powers of ten within a range of logarithms, and twice and five times these where there is room.
std::vector<Tick> logarithmic_ticks_of(const Range& range, int expected) {
  const double every = std::max(1.0, std::ceil(range.size() / expected));
  const bool between = 3.0 * range.size() <= expected;
  std::vector<Tick> ticks;
  for (double power = every * std::floor(range.low / every); power <= range.high; power += every) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = power + std::log10(factor);
      if (!range.holds(value) || (factor > 1.0 && !between)) continue;
      ticks.push_back({value, fmt::format("{:g}", factor * std::pow(10.0, power))});
    }
  }
  return ticks;
}

std::vector<Tick> ticks_of(const Range& range, int expected, const ChartAxis& axis) {
  return axis.logarithmic ? logarithmic_ticks_of(range, expected) : ticks_of(range, expected);
}

std::string with_unit(const ChartAxis& axis) {
  return axis.unit.empty() ? axis.label : fmt::format("{} [{}]", axis.label, axis.unit);
}

// ---- Text

constexpr std::array<char, 6> kLetters = {'o', 'x', '+', '*', '#', '@'};

struct Dash {
  int on = 0, period = 1;
};
constexpr std::array<Dash, 3> kDashes = {{{1, 1}, {6, 9}, {1, 3}}};  // dots of the terminal; whole where on = period
constexpr std::array<const char*, 3> kDashSamples = {"⠒⠒⠒⠒", "⠒⠒⠀⠒", "⠐⠐⠐⠐"};
constexpr Dash kReferenceDash = {1, 4};

/// The area of the plot in dots.
class Plot {
 public:
  Plot(const Ranges& ranges, int columns, int rows) : ranges_(ranges), canvas_(columns, rows) {}

  [[nodiscard]] double column(double x) const {
    return (x - ranges_.x.low) / ranges_.x.size() * (canvas_.dots_wide() - 1);
  }
  [[nodiscard]] double row(double y) const {
    return (ranges_.y.high - y) / ranges_.y.size() * (canvas_.dots_high() - 1);
  }

  /// A line between two places; `done` counts its dots, so that dashes run on from line to line.
  void line(double x0, double y0, double x1, double y1, Dash dash, int& done) {
    const double c0 = column(x0), r0 = row(y0), c1 = column(x1), r1 = row(y1);
    const int steps = std::max(1, static_cast<int>(std::ceil(std::max(std::abs(c1 - c0), std::abs(r1 - r0)))));
    for (int i = 0; i < steps; ++i, ++done) {
      if (done % dash.period >= dash.on) continue;
      const double t = static_cast<double>(i) / steps;
      canvas_.dot(static_cast<int>(std::lround(c0 + t * (c1 - c0))), static_cast<int>(std::lround(r0 + t * (r1 - r0))));
    }
  }

  void letter(double x, double y, char sign) {
    letters_.push_back({static_cast<int>(std::lround(column(x))) / 2, static_cast<int>(std::lround(row(y))) / 4, sign});
  }

  [[nodiscard]] std::string text(int row) const {
    std::vector<std::string> cells = canvas_.cells(row);
    for (const Letter& letter : letters_) {
      if (letter.row == row) cells[static_cast<std::size_t>(letter.column)] = letter.sign;
    }
    std::string line;
    for (const std::string& cell : cells) line += cell;
    return line;
  }

 private:
  struct Letter {
    int column, row;
    char sign;
  };
  Ranges ranges_;
  BrailleCanvas canvas_;
  std::vector<Letter> letters_;
};

void draw_series(Plot& plot, const ChartSeries& series, char letter, Dash dash) {
  int done = 0;
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    if (!drawable(series, k)) continue;
    if (k < series.intervals.size() && finite(series.intervals[k])) {
      int dots = 0;
      plot.line(series.x[k], series.intervals[k].first, series.x[k], series.intervals[k].second, kDashes[0], dots);
    }
    if (series.drawn == ChartSeries::Drawn::marks) {
      plot.letter(series.x[k], series.y[k], letter);
    } else if (k > 0 && drawable(series, k - 1)) {
      plot.line(series.x[k - 1], series.y[k - 1], series.x[k], series.y[k], dash, done);
    }
  }
}

void draw_references(Plot& plot, const Chart& chart, const Ranges& ranges) {
  int done = 0;
  for (const ChartReference& at : shown(chart.horizontal)) {
    plot.line(ranges.x.low, at.value, ranges.x.high, at.value, kReferenceDash, done);
  }
  for (const ChartReference& at : shown(chart.vertical)) {
    plot.line(at.value, ranges.y.low, at.value, ranges.y.high, kReferenceDash, done);
  }
  if (chart.identity) plot.line(ranges.x.low, ranges.x.low, ranges.x.high, ranges.x.high, kReferenceDash, done);
}

/// Numbers under the axis, each in the middle under its tick, omitted where the one before stands too near.
std::string under_axis(const std::vector<Tick>& ticks, const Plot& plot, std::size_t indent, std::size_t width) {
  std::string line(indent + width + 8, ' ');
  std::size_t free_from = 0;
  for (const Tick& tick : ticks) {
    const auto middle = indent + static_cast<std::size_t>(std::lround(plot.column(tick.value))) / 2;
    const std::size_t half = tick.label.size() / 2, begin = middle > half ? middle - half : 0;
    if (begin < free_from || begin + tick.label.size() > line.size()) continue;
    line.replace(begin, tick.label.size(), tick.label);
    free_from = begin + tick.label.size() + 1;
  }
  return line;
}

std::string trimmed(std::string line) {
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line + "\n";
}

std::string references_sentence(const Chart& chart) {
  std::string text;
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : "; ") + what; };
  const auto named = [&](const ChartReference& at, const ChartAxis& axis) {
    const std::string value = fmt::format("{:.4g}{}{}", at.value, axis.unit.empty() ? "" : " ", axis.unit);
    return at.name.empty() ? fmt::format("{} = {}", axis.label, value) : fmt::format("{} ({})", at.name, value);
  };
  for (const ChartReference& at : shown(chart.horizontal)) {
    const bool zero = at.value == 0.0 && (at.name.empty() || at.name == "0");
    add(zero ? "horizontal: zero line" : "horizontal: " + named(at, chart.y));
  }
  for (const ChartReference& at : shown(chart.vertical)) add("vertical: " + named(at, chart.x));
  if (chart.identity) add("diagonal: identity line");
  return text;
}

std::string text_legend(const Chart& chart) {
  std::string text;
  std::size_t marks = 0, lines = 0;
  const auto entry = [&](const std::string& sign, const std::string& what) {
    text += "  " + sign + "  ";
    const std::size_t indent = 4 + columns(sign);
    for (const char c : wrapped(what, kLineColumns - indent)) {
      text += c;
      if (c == '\n') text.append(indent, ' ');
    }
    text += "\n";
  };
  for (const ChartSeries& series : chart.series) {
    const bool line = series.drawn == ChartSeries::Drawn::line;
    entry(line ? kDashSamples[lines++ % kDashSamples.size()] : std::string(1, kLetters[marks++ % kLetters.size()]),
          series.name);
  }
  const std::string references = references_sentence(chart);
  if (!references.empty()) entry("⠄⠄", references);
  for (const std::string& note : chart.notes) entry(" ", note);
  return text;
}

// ---- SVG

constexpr std::array<const char*, 7> kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                 "#E69F00", "#56B4E9", "#000000"};  // Okabe & Ito 2008
constexpr std::array<const char*, 4> kSvgDashes = {"", "9 4", "2 3", "9 3 2 3"};

/// Text and attribute values; control characters, which XML does not allow, become blanks.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20u ? ' ' : c;
    }
  }
  return out;
}

/// The mark of series k, about 9 wide, around a place.
std::string mark(std::size_t k, double x, double y) {
  const char* const colour = kColours[k % kColours.size()];
  const std::string filled = fmt::format(R"(fill="{}" stroke="#fff" stroke-width="0.6")", colour);
  const std::string hollow = fmt::format(R"(fill="none" stroke="{}" stroke-width="2")", colour);
  switch (k % 6) {
    case 0:
      return fmt::format(R"(<circle cx="{:.2f}" cy="{:.2f}" r="4.5" {}/>)", x, y, filled);
    case 1:
      return fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="8" height="8" {}/>)", x - 4.0, y - 4.0, filled);
    case 2:
      return fmt::format(R"(<path d="M{:.2f} {:.2f}l5.2 9h-10.4z" {}/>)", x, y - 5.5, filled);
    case 3:
      return fmt::format(R"(<path d="M{:.2f} {:.2f}l5.5 5.5l-5.5 5.5l-5.5 -5.5z" {}/>)", x, y - 5.5, filled);
    case 4:
      return fmt::format(R"(<path d="M{:.2f} {:.2f}l8 8m0 -8l-8 8" {}/>)", x - 4.0, y - 4.0, hollow);
    default:
      return fmt::format(R"(<circle cx="{:.2f}" cy="{:.2f}" r="4" {}/>)", x, y, hollow);
  }
}

constexpr double kText = 13.0, kSmallText = 12.0, kLine = 15.0, kCharacter = 7.4;  // of text in SVG's units
constexpr double kTextPt = 8.0, kMillimetresPerPoint = 25.4 / 72.0;                // of kText; of a point

/// About the width of a text in SVG's units.
double width_of(const std::string& text, double size = kText) {
  return kCharacter * size / kText * static_cast<double>(columns(text));
}

std::vector<std::string> lines_of(const std::string& text, double width, double size = kText) {
  const std::string all = wrapped(text, static_cast<std::size_t>(std::max(8.0, width * kText / (kCharacter * size))));
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin <= all.size();) {
    const std::size_t end = std::min(all.find('\n', begin), all.size());
    lines.push_back(all.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

/// Where the plot stands in the drawing, in SVG's units.
struct Frame {
  Ranges ranges;
  double left = 0, top = 12, width = 0, height = 0;
  std::vector<std::string> x_label, y_label;
  std::vector<Tick> up;
  [[nodiscard]] double x(double value) const { return left + (value - ranges.x.low) / ranges.x.size() * width; }
  [[nodiscard]] double y(double value) const { return top + (ranges.y.high - value) / ranges.y.size() * height; }
};

/// At least three, so that a small drawing has a scale.
std::vector<Tick> svg_ticks(const Range& range, double expected, const ChartAxis& axis) {
  constexpr int kMax = 12;
  int n = std::max(2, static_cast<int>(expected));
  std::vector<Tick> ticks = ticks_of(range, n, axis);
  while (ticks.size() < 3 && n < kMax) ticks = ticks_of(range, ++n, axis);
  return ticks;
}

/// @param page  the width of the drawing
Frame frame_of(const Chart& chart, double page, bool with_y_label) {
  constexpr double kProportion = 0.64, kGap = 9.0, kEvery = 45.0;
  Frame frame{ranges_of(chart)};
  const bool equal = chart.equal_scale || chart.identity;
  frame.height = kProportion * page * (equal ? 1.0 : 0.8);
  frame.up = svg_ticks(frame.ranges.y, frame.height / kEvery, chart.y);
  double widest = 0.0;
  for (const Tick& tick : frame.up) widest = std::max(widest, width_of(tick.label));
  if (with_y_label) frame.y_label = lines_of(with_unit(chart.y), frame.height);
  frame.left = kLine * static_cast<double>(frame.y_label.size()) + 6.0 + widest + kGap;
  frame.width = page - frame.left - 12.0;
  if (equal) {
    const double highest = 0.85 * page;
    const double scale = std::min(frame.width / frame.ranges.x.size(), highest / frame.ranges.y.size());
    frame.width = scale * frame.ranges.x.size();
    frame.height = scale * frame.ranges.y.size();
  }
  frame.x_label = lines_of(with_unit(chart.x), frame.width);
  return frame;
}

/// Series k; lines have a dash of their own, counted among the lines, so that the first is whole.
std::string line_style(const Chart& chart, std::size_t k) {
  const auto before = std::ranges::count(chart.series.begin(), chart.series.begin() + static_cast<std::ptrdiff_t>(k),
                                         ChartSeries::Drawn::line, &ChartSeries::drawn);
  const char* const dash = kSvgDashes[static_cast<std::size_t>(before) % kSvgDashes.size()];
  return fmt::format(R"(fill="none" stroke="{}" stroke-width="2" stroke-linejoin="round"{})",
                     kColours[k % kColours.size()],
                     *dash == '\0' ? std::string() : fmt::format(R"( stroke-dasharray="{}")", dash));
}

std::string svg_series(const Chart& chart, std::size_t k, const Frame& frame) {
  const ChartSeries& series = chart.series[k];
  std::string intervals, marks, path;
  bool pen_down = false;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!drawable(series, i)) {
      pen_down = false;
      continue;
    }
    const double x = frame.x(series.x[i]), y = frame.y(series.y[i]);
    if (i < series.intervals.size() && finite(series.intervals[i])) {
      const auto [low, high] = series.intervals[i];
      intervals += fmt::format("M{0:.2f} {1:.2f}V{2:.2f}M{3:.2f} {1:.2f}h7M{3:.2f} {2:.2f}h7", x, frame.y(low),
                               frame.y(high), x - 3.5);
    }
    if (series.drawn == ChartSeries::Drawn::line) {
      path += fmt::format("{}{:.2f} {:.2f}", pen_down ? "L" : "M", x, y);
      pen_down = true;
    } else {
      marks += mark(k, x, y);
    }
  }
  std::string text;
  if (!intervals.empty()) {
    text += fmt::format(R"(<path d="{}" fill="none" stroke="{}" stroke-width="1.3"/>)", intervals,
                        kColours[k % kColours.size()]);
  }
  if (!path.empty()) text += fmt::format(R"(<path d="{}" {}/>)", path, line_style(chart, k));
  return text + marks + "\n";
}

/// Under the plot, without those that would touch the one before.
std::string svg_numbers_along(const Chart& chart, const Frame& frame, std::string& grid) {
  constexpr double kEvery = 70.0, kGap = 6.0;
  const double bottom = frame.top + frame.height;
  double free_from = -std::numeric_limits<double>::infinity();
  std::string numbers;
  for (const Tick& tick : svg_ticks(frame.ranges.x, frame.width / kEvery, chart.x)) {
    const double x = frame.x(tick.value), half = 0.5 * width_of(tick.label);
    grid += fmt::format("M{:.2f} {:.2f}V{:.2f}", x, frame.top, bottom + 5.0);
    if (x - half < free_from) continue;
    free_from = x + half + kGap;
    numbers +=
        fmt::format(R"(<text x="{:.2f}" y="{:.2f}" text-anchor="middle">{}</text>)", x, bottom + 20.0, tick.label);
  }
  return numbers;
}

std::string svg_axes(const Chart& chart, const Frame& frame) {
  const double right = frame.left + frame.width, bottom = frame.top + frame.height;
  std::string grid, numbers = svg_numbers_along(chart, frame, grid);
  double last = std::numeric_limits<double>::infinity();
  for (const Tick& tick : frame.up) {
    const double y = frame.y(tick.value);
    grid += fmt::format("M{:.2f} {:.2f}H{:.2f}", frame.left - 5.0, y, right);
    if (last - y < kText) continue;
    last = y;
    numbers += fmt::format(R"(<text x="{:.2f}" y="{:.2f}" text-anchor="end">{}</text>)", frame.left - 9.0, y + 4.5,
                           tick.label);
  }
  std::string text = fmt::format(R"(<path d="{}" fill="none" stroke="#dcdcdc"/>)", grid) + "\n";
  text += fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" fill="none" stroke="#444"/>)",
                      frame.left, frame.top, frame.width, frame.height);
  text += numbers + "\n";
  double y = bottom + 38.0, x = kLine;
  for (const std::string& line : frame.x_label) {
    text += fmt::format(R"(<text x="{:.2f}" y="{:.2f}" text-anchor="middle">{}</text>)", 0.5 * (frame.left + right), y,
                        escaped(line));
    y += kLine;
  }
  for (const std::string& line : frame.y_label) {
    text +=
        fmt::format(R"svg(<text transform="translate({:.2f} {:.2f}) rotate(-90)" text-anchor="middle">{}</text>)svg", x,
                    0.5 * (frame.top + bottom), escaped(line));
    x += kLine;
  }
  return text + "\n";
}

/// Whether a name beside its line at `place` would cover one that was written; otherwise it is noted.
bool is_taken(double place, std::vector<double>& taken) {
  if (std::ranges::any_of(taken, [&](double other) { return std::abs(place - other) < kText; })) return true;
  taken.push_back(place);
  return false;
}

/// Lines with their names, each on the first side of its line that is free; a name that has none is in <desc> only.
std::string svg_references(const Chart& chart, const Frame& frame) {
  const double right = frame.left + frame.width, bottom = frame.top + frame.height;
  std::string path, names;
  std::vector<double> taken;
  const auto side = [&](double line, double before, double after) -> std::optional<double> {
    for (const double place : {line + before, line + after}) {
      if (!is_taken(place, taken)) return place;
    }
    return std::nullopt;
  };
  for (const ChartReference& at : shown(chart.horizontal)) {
    path += fmt::format("M{:.2f} {:.2f}H{:.2f}", frame.left, frame.y(at.value), right);
    if (at.name.empty()) continue;
    if (const auto y = side(frame.y(at.value), -5.0, 13.0)) {
      names +=
          fmt::format(R"(<text x="{:.2f}" y="{:.2f}" text-anchor="end">{}</text>)", right - 6.0, *y, escaped(at.name));
    }
  }
  taken.clear();
  for (const ChartReference& at : shown(chart.vertical)) {
    path += fmt::format("M{:.2f} {:.2f}V{:.2f}", frame.x(at.value), frame.top, bottom);
    if (at.name.empty()) continue;
    if (const auto x = side(frame.x(at.value), -5.0, 13.0)) {
      names += fmt::format(R"svg(<text transform="translate({:.2f} {:.2f}) rotate(-90)">{}</text>)svg", *x,
                           bottom - 6.0, escaped(at.name));
    }
  }
  if (chart.identity) path += fmt::format("M{:.2f} {:.2f}L{:.2f} {:.2f}", frame.left, bottom, right, frame.top);
  if (path.empty()) return "";
  return fmt::format(R"(<path d="{}" fill="none" stroke="#555" stroke-width="1.2" stroke-dasharray="5 4"/>)", path) +
         fmt::format(R"(<g fill="#444" font-size="{:.0f}">{}</g>)", kSmallText, names) + "\n";
}

/// Entries side by side as far as they fit; `y` moves down by what they take.
std::string svg_legend(const Chart& chart, double left, double right, double& y) {
  constexpr double kRow = 20.0, kSample = 34.0;
  std::string text;
  double x = left;
  const auto entry = [&](const std::string& sample, const std::string& name) {
    const double width = kSample + width_of(name) + 14.0;
    if (x > left && x + width > right) {
      x = left;
      y += kRow;
    }
    text += fmt::format(R"svg(<g transform="translate({:.2f} {:.2f})">{}<text x="{:.0f}" y="4.5">{}</text></g>)svg", x,
                        y, sample, kSample, escaped(name));
    x += width;
  };
  for (std::size_t k = 0; k < chart.series.size(); ++k) {
    const bool line = chart.series[k].drawn == ChartSeries::Drawn::line;
    entry(line ? fmt::format(R"(<path d="M0 0h28" {}/>)", line_style(chart, k)) : mark(k, 14.0, 0.0),
          chart.series[k].name);
  }
  if (chart.identity) {
    entry(R"(<path d="M0 0h28" stroke="#555" stroke-width="1.2" stroke-dasharray="5 4"/>)", "identity line");
  }
  y += kRow;
  return text + "\n";
}

std::string description(const Chart& chart) {
  std::string text = fmt::format("{} over {}. ", with_unit(chart.y), with_unit(chart.x));
  for (const ChartSeries& series : chart.series) {
    text += fmt::format("{}: {} points. ", series.name, series.x.size());
  }
  const std::string references = references_sentence(chart);
  return references.empty() ? text : text + "Lines " + references + ".";
}

}  // namespace

std::string chart_text(const Chart& given) {
  const Chart chart = on_even_axes(given);
  const Ranges ranges = ranges_of(chart);
  int width = 72, height = 18;
  if (chart.equal_scale || chart.identity) {
    constexpr double kWidest = 144.0, kHighest = 104.0;  // dots
    const double scale = std::min(kWidest / ranges.x.size(), kHighest / ranges.y.size());
    width = std::max(8, static_cast<int>(std::lround(0.5 * scale * ranges.x.size())));
    height = std::max(4, static_cast<int>(std::lround(0.25 * scale * ranges.y.size())));
  }
  Plot plot(ranges, width, height);
  draw_references(plot, chart, ranges);
  std::size_t marks = 0, lines = 0;
  for (const ChartSeries& series : chart.series) {
    const bool line = series.drawn == ChartSeries::Drawn::line;
    draw_series(plot, series, line ? ' ' : kLetters[marks++ % kLetters.size()],
                line ? kDashes[lines++ % kDashes.size()] : Dash());
  }

  const std::vector<Tick> up = ticks_of(ranges.y, std::max(2, height / 3), chart.y);
  const std::vector<Tick> along = ticks_of(ranges.x, std::max(2, width / 11), chart.x);
  std::vector<std::string> numbers(static_cast<std::size_t>(height));
  std::size_t widest = 0;
  for (const Tick& tick : up) {
    numbers[static_cast<std::size_t>(std::lround(plot.row(tick.value))) / 4] = tick.label;
    widest = std::max(widest, tick.label.size());
  }
  std::string text = "  " + chart.title + "\n  " + with_unit(chart.y) + "\n";
  for (int row = 0; row < height; ++row) {
    const std::string& number = numbers[static_cast<std::size_t>(row)];
    text += trimmed(std::string(2 + widest - number.size(), ' ') + number + (number.empty() ? " │" : " ┤") +
                    plot.text(row));
  }
  std::vector<std::string> axis(static_cast<std::size_t>(width), "─");
  for (const Tick& tick : along) axis[static_cast<std::size_t>(std::lround(plot.column(tick.value))) / 2] = "┬";
  text += std::string(3 + widest, ' ') + "└";
  for (const std::string& cell : axis) text += cell;
  text += "\n" + trimmed(under_axis(along, plot, 4 + widest, static_cast<std::size_t>(width)));
  const std::string label = with_unit(chart.x);
  const std::size_t middle = 4 + widest + static_cast<std::size_t>(width) / 2, half = columns(label) / 2;
  text += std::string(middle > half ? middle - half : 0, ' ') + label + "\n";
  return text + text_legend(given);
}

namespace {

/// One chart in a column of the drawing; `bottom` becomes what it takes.
std::string svg_column(const Chart& given, double page, bool with_y_label, bool with_notes, double& bottom) {
  const Chart chart = on_even_axes(given);
  const Frame frame = frame_of(chart, page, with_y_label);
  std::string text = svg_axes(chart, frame) + svg_references(chart, frame);
  for (std::size_t k = 0; k < chart.series.size(); ++k) text += svg_series(chart, k, frame);
  double y = frame.top + frame.height + 42.0 + kLine * static_cast<double>(frame.x_label.size());
  text += svg_legend(chart, 8.0, page - 4.0, y);
  for (const std::string& note : with_notes ? chart.notes : std::vector<std::string>()) {
    for (const std::string& line : lines_of(note, page - 16.0, kSmallText)) {
      text += fmt::format(R"(<text x="8" y="{:.2f}" font-size="{:.0f}" fill="#444">{}</text>)", y, kSmallText,
                          escaped(line));
      y += kLine;
    }
  }
  bottom = y - 4.0;
  return text;
}

}  // namespace

std::string charts_svg(const std::string& title, std::span<const Chart> charts, double width_mm) {
  const double unit_mm = kTextPt * kMillimetresPerPoint / kText, page = width_mm / unit_mm;
  const double column = page / static_cast<double>(std::max<std::size_t>(1, charts.size()));
  constexpr double kNarrow = 200.0;  // the name of the y axis would be longer than the axis
  const bool named = charts.size() == 1 || column > kNarrow;
  std::string body, words;
  double height = 0.0;
  for (std::size_t k = 0; k < charts.size(); ++k) {
    double bottom = 0.0;
    const std::string drawn = svg_column(charts[k], column, k == 0 && named, charts.size() == 1, bottom);
    body += k == 0 ? drawn
                   : fmt::format(R"svg(<g transform="translate({:.2f} 0)">{}</g>)svg", column * static_cast<double>(k),
                                 drawn);
    height = std::max(height, bottom);
    words += (k == 0 ? "" : " ") + description(charts[k]);
  }
  std::string text = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {:.2f} {:.2f}" width="{:.2f}mm" height="{:.2f}mm" )"
      R"(role="img" aria-labelledby="title description" font-family="Helvetica, Arial, sans-serif" font-size="{:.0f}">)"
      "\n",
      page, height, width_mm, unit_mm * height, kText);
  text += fmt::format("<title id=\"title\">{}</title>\n<desc id=\"description\">{}</desc>\n", escaped(title),
                      escaped(words));
  return text + R"(<rect width="100%" height="100%" fill="#fff"/>)" + "\n" + body + "</svg>\n";
}

std::string chart_svg(const Chart& chart, double width_mm) {
  return charts_svg(chart.title, std::span(&chart, 1), width_mm);
}

}  // namespace mbk::report
