#include "mbk/present/report/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/present/report/braille.h"

namespace mbk::report {
namespace {

constexpr int kColumns = 23, kRows = 11;  // characters of one panel

/// A panel of dots in [−1, 1], y upwards; dots are taken as square.
class Panel {
 public:
  void dot(double x, double y) {
    const double radius = 0.5 * std::min(canvas_.dots_wide(), canvas_.dots_high()) - 0.5;
    canvas_.dot(static_cast<int>(std::lround(0.5 * (canvas_.dots_wide() - 1) + radius * x)),
                static_cast<int>(std::lround(0.5 * (canvas_.dots_high() - 1) - radius * y)));
  }

  [[nodiscard]] std::string line(int row) const { return canvas_.line(row); }

 private:
  BrailleCanvas canvas_{kColumns, kRows};
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

Panel draw(const impedance::Ellipse& ellipse, double scale) {
  Panel panel;
  for (int i = -20; i <= 20; i += 2) {
    panel.dot(i / 20.0, 0.0);
    panel.dot(0.0, i / 20.0);
  }
  const double c = std::cos(ellipse.orientation), s = std::sin(ellipse.orientation);
  constexpr int kPoints = 720;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kPoints;
    const double major = ellipse.lambda_max * std::cos(angle) / scale;
    const double minor = ellipse.lambda_min * std::sin(angle) / scale;
    panel.dot(c * major - s * minor, s * major + c * minor);
  }
  return panel;
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
    const Panel picture = drawn ? draw(panel.ellipse, scale) : Panel();
    lines[0] += padded(drawn ? fmt::format("{}, radius {:g} {}", panel.title, scale, panel.unit)
                             : fmt::format("{}: no ellipse", panel.title),
                       kWidth);
    for (int row = 0; row < kRows; ++row) lines[static_cast<std::size_t>(row) + 1] += padded(picture.line(row), kWidth);
  }
  std::string text;
  for (std::string& line : lines) {
    while (!line.empty() && line.back() == ' ') line.pop_back();
    text += "  " + line + "\n";
  }
  return text;
}

}  // namespace mbk::report
