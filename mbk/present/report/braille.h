#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::report {

/// A grid of dots for the terminal, 2 × 4 of them in each character (Unicode's Braille patterns). Column and row are
/// counted from the top left corner.
class BrailleCanvas {
 public:
  BrailleCanvas(int columns, int rows);  ///< in characters

  [[nodiscard]] int dots_wide() const { return 2 * columns_; }
  [[nodiscard]] int dots_high() const { return 4 * rows_; }

  /// A dot beyond the canvas is not drawn.
  void dot(int column, int row);

  /// One row of characters, blank where there is no dot; every code point takes one column.
  [[nodiscard]] std::vector<std::string> cells(int row) const;
  [[nodiscard]] std::string line(int row) const;

 private:
  int columns_, rows_;
  std::vector<unsigned> cells_;
};

/// The values over the width of one line of characters, from their least to their greatest finite value. Samples that
/// share a column of dots are drawn as their range.
[[nodiscard]] std::string sparkline(const Vector& values, int characters);

}  // namespace mbk::report
