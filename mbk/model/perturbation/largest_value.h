#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "mbk/base/numeric/golden_section.h"

namespace mbk::perturbation {

/// Time and value of the maximum of a function.
struct LargestValue {
  double time = 0.0;
  double value = 0.0;
};

/// The largest value of f ≥ 0 over the span of a grid. Every local maximum of the samples that comes within 1 % of the
/// largest is refined by golden sections between its neighbours (Kiefer 1953). It is the global maximum if the grid is
/// fine enough for its samples to be within 1 % of every peak: for sines, at least 23 per period.
/// @param grid    [s], ascending, not empty    @param values  f on the grid
template <class Function>
[[nodiscard]] LargestValue largest_value(const std::vector<double>& grid, const std::vector<double>& values,
                                         const Function& f) {
  constexpr double kCandidate = 0.99;
  constexpr int kSections = 44;  // 0.618⁴⁴ = 6e-10 of the bracket; the value's error goes with the square
  const std::size_t n = grid.size();
  const std::size_t first = static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
  LargestValue best{grid[first], values[first]};
  const double least = kCandidate * best.value;
  const auto look = [&](double time) {
    const double value = f(time);
    if (value > best.value) best = {time, value};
    return value;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1, after = i + 1 == n ? i : i + 1;
    if (values[i] < least || values[i] < values[before] || values[i] < values[after]) continue;
    int sections = 0;
    numeric::golden_section(grid[before], grid[after], look, std::greater_equal<>{},
                            [&](double, double) { return sections++ < kSections; });
  }
  return best;
}

}  // namespace mbk::perturbation
