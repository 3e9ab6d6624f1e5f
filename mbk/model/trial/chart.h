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
  bool logarithmic = false;  ///< values not above 0 are omitted
};

/// A series of points. A point with a non-finite value is omitted and interrupts the line.
struct ChartSeries {
  enum class Drawn { line, marks };
  std::string name;
  std::vector<double> x, y;                          ///< of equal length, in the units of the axes
  std::vector<std::pair<double, double>> intervals;  ///< of y, low and high; none, or one for each point
  Drawn drawn = Drawn::marks;
};

[[nodiscard]] constexpr auto word_table(ChartSeries::Drawn) {
  using enum ChartSeries::Drawn;
  return std::to_array<Word<ChartSeries::Drawn>>({{line, "line"}, {marks, "marks"}});
}

/// A value marked across the whole chart.
struct ChartReference {
  double value = 0;
  std::string name;
};

/// A chart as data; report/chart.h renders it as text or SVG.
struct Chart {
  std::string title;
  ChartAxis x, y;
  std::vector<ChartSeries> series;
  std::vector<ChartReference> horizontal, vertical;  ///< at values of y, at values of x
  bool identity = false;                             ///< the line y = x, and both axes over the same range
  bool equal_scale = false;                          ///< equal scales of x and y
  std::vector<std::string> notes;                    ///< sentences below the drawing
};

}  // namespace mbk
