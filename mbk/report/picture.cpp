#include "mbk/report/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mbk::report {
namespace {

constexpr int kColumns = 23, kRows = 11;                        // characters of one panel
constexpr int kDotsWide = 2 * kColumns, kDotsHigh = 4 * kRows;  // Braille: 2 × 4 dots a character

/// A panel of dots.
class Canvas {
 public:
  void dot(double x, double y) {  // in [−1, 1], y upwards; dots are taken as square
    const double radius = 0.5 * std::min(kDotsWide, kDotsHigh) - 0.5;
    const auto column = static_cast<int>(std::lround(0.5 * (kDotsWide - 1) + radius * x));
    const auto row = static_cast<int>(std::lround(0.5 * (kDotsHigh - 1) - radius * y));
    if (column < 0 || column >= kDotsWide || row < 0 || row >= kDotsHigh) return;
    constexpr unsigned kBits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    cells_[static_cast<std::size_t>((row / 4) * kColumns + column / 2)] |= kBits[row % 4][column % 2];
  }

  [[nodiscard]] std::string line(int row) const {
    std::string text;
    for (int column = 0; column < kColumns; ++column) {
      const unsigned bits = cells_[static_cast<std::size_t>(row * kColumns + column)];
      const unsigned code = 0x2800u + bits;  // Braille patterns, U+2800 …
      text += bits == 0 ? ' ' : static_cast<char>(0xE0u | (code >> 12));
      if (bits != 0) {
        text += static_cast<char>(0x80u | ((code >> 6) & 0x3Fu));
        text += static_cast<char>(0x80u | (code & 0x3Fu));
      }
    }
    return text;
  }

 private:
  std::vector<unsigned> cells_ = std::vector<unsigned>(static_cast<std::size_t>(kColumns * kRows), 0u);
};

bool exists(const impedance::Ellipse& ellipse) {
  return ellipse.lambda_min > 0.0;
}

/// The next of 1, 2, 5 × 10ᵏ at or above a value, so that the scale reads well.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.5}) {
    if (value <= step * power) return step * power;
  }
  return 10.0 * power;
}

Canvas draw(const impedance::Ellipse& ellipse, double scale) {
  Canvas canvas;
  for (int i = -20; i <= 20; i += 2) {
    canvas.dot(i / 20.0, 0.0);
    canvas.dot(0.0, i / 20.0);
  }
  const double c = std::cos(ellipse.orientation), s = std::sin(ellipse.orientation);
  constexpr int kPoints = 720;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kPoints;
    const double major = ellipse.lambda_max * std::cos(angle) / scale;
    const double minor = ellipse.lambda_min * std::sin(angle) / scale;
    canvas.dot(c * major - s * minor, s * major + c * minor);
  }
  return canvas;
}

std::string padded(std::string text, std::size_t width) {
  const std::size_t used = columns(text);
  if (used < width) text.append(width - used, ' ');
  return text;
}

}  // namespace

std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0u) != 0x80u;  // not a continuation byte
  }));
}

std::string draw_ellipses(const std::vector<EllipsePanel>& panels) {
  if (std::ranges::none_of(panels, [](const EllipsePanel& panel) { return exists(panel.ellipse); })) return "";
  constexpr std::size_t kWidth = kColumns + 3;
  std::vector<std::string> lines(kRows + 1);
  for (const EllipsePanel& panel : panels) {
    const bool drawn = exists(panel.ellipse);
    const double scale = drawn ? round_up(panel.ellipse.lambda_max) : 1.0;
    const Canvas canvas = drawn ? draw(panel.ellipse, scale) : Canvas();
    lines[0] += padded(drawn ? fmt::format("{}, radius {:g} {}", panel.title, scale, panel.unit)
                             : fmt::format("{}: no ellipse", panel.title),
                       kWidth);
    for (int row = 0; row < kRows; ++row) lines[static_cast<std::size_t>(row) + 1] += padded(canvas.line(row), kWidth);
  }
  std::string text;
  for (std::string& line : lines) {
    while (!line.empty() && line.back() == ' ') line.pop_back();
    text += "  " + line + "\n";
  }
  return text;
}

}  // namespace mbk::report
