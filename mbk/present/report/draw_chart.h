#pragma once

#include <span>
#include <string>

#include "mbk/model/trial/chart.h"

namespace mbk::report {

/// The chart in Braille dots with its axes, a legend and its notes, for the terminal. Lines are whole, dashed or
/// dotted, marks are letters; where two marks fall on one place the later covers the earlier.
[[nodiscard]] std::string chart_text(const Chart& chart);

inline constexpr double kOneColumnMm = 85.0, kTwoColumnsMm = 180.0;  ///< of a journal's page

/// The chart as one self-contained SVG file of that width, with text of 8 pt (names of lines and notes: 7.4 pt) at that
/// width: no script, no outside font, readable in black and white. The title is not drawn, a caption has it; it is the
/// file's title element. Colours are those of Okabe & Ito (2008), and each series has a mark or dash of its own
/// besides.
[[nodiscard]] std::string chart_svg(const Chart& chart, double width_mm = kTwoColumnsMm);

/// Several charts side by side, without their notes. The y axis is named at the first, if there is room.
[[nodiscard]] std::string charts_svg(const std::string& title, std::span<const Chart> charts,
                                     double width_mm = kTwoColumnsMm);

}  // namespace mbk::report
