#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/model/impedance/ellipse.h"

namespace mbk::report {

/// One ellipse with its caption, for the terminal.
struct EllipsePanel {
  impedance::Ellipse ellipse;
  std::string title;  ///< "inertia"
  std::string unit;   ///< "kg"
};

/// The ellipses side by side in Braille dots, each to a scale of its own with a cross for the axes; the caption says
/// what the panel's half width stands for. An ellipse that is none (λ_min ≤ 0) leaves its panel empty and says so.
/// x points right, y points up, and both have the same scale.
[[nodiscard]] std::string draw_ellipses(const std::vector<EllipsePanel>& panels);

/// Width on the terminal of UTF-8 text whose every code point takes one column.
[[nodiscard]] std::size_t columns(std::string_view text);

}  // namespace mbk::report
