#include "mbk/present/report/braille.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mbk::report {

BrailleCanvas::BrailleCanvas(int columns, int rows)
    : columns_(columns), rows_(rows), cells_(static_cast<std::size_t>(columns * rows), 0u) {}

void BrailleCanvas::dot(int column, int row) {
  if (column < 0 || column >= dots_wide() || row < 0 || row >= dots_high()) return;
  constexpr unsigned kBits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
  cells_[static_cast<std::size_t>((row / 4) * columns_ + column / 2)] |= kBits[row % 4][column % 2];
}

std::vector<std::string> BrailleCanvas::cells(int row) const {
  std::vector<std::string> characters;
  for (int column = 0; column < columns_; ++column) {
    const unsigned bits = cells_[static_cast<std::size_t>(row * columns_ + column)];
    const unsigned code = 0x2800u + bits;  // Braille patterns, U+2800 …
    std::string& text = characters.emplace_back(" ");
    if (bits != 0) {
      text = static_cast<char>(0xE0u | (code >> 12));
      text += static_cast<char>(0x80u | ((code >> 6) & 0x3Fu));
      text += static_cast<char>(0x80u | (code & 0x3Fu));
    }
  }
  return characters;
}

std::string BrailleCanvas::line(int row) const {
  std::string text;
  for (const std::string& cell : cells(row)) text += cell;
  return text;
}

std::string sparkline(const Vector& values, int characters) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  BrailleCanvas canvas(characters, 1);
  const int columns = canvas.dots_wide(), lowest = canvas.dots_high() - 1;
  std::vector<double> low(static_cast<std::size_t>(columns), kInfinity), high(low.size(), -kInfinity);
  for (Index k = 0; k < values.size(); ++k) {
    if (!std::isfinite(values[k])) continue;
    const auto at = static_cast<std::size_t>(k * columns / values.size());
    low[at] = std::min(low[at], values[k]);
    high[at] = std::max(high[at], values[k]);
  }
  const double least = *std::ranges::min_element(low), size = *std::ranges::max_element(high) - least;
  const auto row = [&](double value) {
    return size > 0.0 ? static_cast<int>(std::lround(lowest * (1.0 - (value - least) / size))) : lowest / 2;
  };
  for (int column = 0; column < columns; ++column) {
    const auto at = static_cast<std::size_t>(column);
    if (low[at] > high[at]) continue;
    for (int k = row(high[at]); k <= row(low[at]); ++k) canvas.dot(column, k);
  }
  return canvas.line(0);
}

}  // namespace mbk::report
