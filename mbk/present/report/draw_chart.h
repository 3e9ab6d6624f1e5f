#pragma once

#include <string>

#include "mbk/model/trial/chart.h"

namespace mbk::report {

/// The chart in Braille dots with its axes, a legend and its notes, for the terminal. Lines are whole, dashed or
/// dotted, marks are letters; where two marks fall on one place the later covers the earlier.
[[nodiscard]] std::string chart_text(const Chart& chart);

/// The chart as one self-contained SVG file: no script, no outside font, readable in black and white and at A4 width.
/// Colours are those of Okabe & Ito (2008), and each series has a mark or dash of its own besides.
[[nodiscard]] std::string chart_svg(const Chart& chart);

}  // namespace mbk::report
