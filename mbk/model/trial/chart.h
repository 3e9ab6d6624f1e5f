#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/words.h"

namespace mbk {

/// What an axis shows: "stiffness K_xx", in "N/m". The unit may be empty.
struct ChartAxis {
  std::string label;
  std::string unit;
  bool logarithmic = false;  ///< what is not above 0 is left out
};

/// Points that belong together. A point with a value that is not finite is left out, and breaks a line.
struct ChartSeries {
  enum class Drawn { line, marks };
  std::string name;
  std::vector<double> x, y;                          ///< as long as each other, in the units of the axes
  std::vector<std::pair<double, double>> intervals;  ///< of y, low and high; none, or one for each point
  Drawn drawn = Drawn::marks;
};

[[nodiscard]] constexpr auto word_table(ChartSeries::Drawn) {
  using enum ChartSeries::Drawn;
  return std::to_array<Word<ChartSeries::Drawn>>({{line, "line"}, {marks, "marks"}});
}

/// A value that is marked across the whole chart.
struct ChartReference {
  double value = 0;
  std::string name;
};

/// A drawing of numbers, as a plain value; report/chart.h turns it into text or SVG.
struct Chart {
  std::string title;
  ChartAxis x, y;
  std::vector<ChartSeries> series;
  std::vector<ChartReference> horizontal, vertical;  ///< at values of y, at values of x
  bool identity = false;                             ///< the line y = x, and both axes over the same range
  bool equal_scale = false;                          ///< a unit of x is as long as a unit of y
  std::vector<std::string> notes;                    ///< sentences below the drawing
};

}  // namespace mbk
