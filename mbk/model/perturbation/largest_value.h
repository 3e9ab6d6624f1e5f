#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace mbk::perturbation {

/// Where a function of time is largest, and its value there.
struct LargestValue {
  double time = 0.0;
  double value = 0.0;
};

/// The largest value of f ≥ 0 over the span of a grid. Every local maximum of the samples that comes within 1 % of the
/// largest is refined by golden sections between its neighbours (Kiefer 1953). It is the global maximum where the grid
/// is so fine that its samples fall short of a peak by less than 1 %: for sines, 23 to a period or more.
/// @param grid    [s], ascending, not empty    @param values  f on the grid
template <class Function>
[[nodiscard]] LargestValue largest_value(const std::vector<double>& grid, const std::vector<double>& values,
                                         const Function& f) {
  constexpr double kCandidate = 0.99, kGolden = 0.6180339887498949;
  constexpr int kSections = 45;  // 0.618⁴⁵ = 4e-10 of the bracket; the value's error goes with the square
  const std::size_t n = grid.size();
  const std::size_t first = static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
  LargestValue best{grid[first], values[first]};
  const double least = kCandidate * best.value;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1, after = i + 1 == n ? i : i + 1;
    if (values[i] < least || values[i] < values[before] || values[i] < values[after]) continue;
    double low = grid[before], high = grid[after];
    double inner = high - kGolden * (high - low), outer = low + kGolden * (high - low);
    double f_inner = f(inner), f_outer = f(outer);
    for (int k = 0; k < kSections && low < high; ++k) {
      if (f_inner > best.value) best = {inner, f_inner};
      if (f_outer > best.value) best = {outer, f_outer};
      if (f_inner >= f_outer) {
        high = outer;
        outer = inner;
        f_outer = f_inner;
        inner = high - kGolden * (high - low);
        f_inner = f(inner);
      } else {
        low = inner;
        inner = outer;
        f_inner = f_outer;
        outer = low + kGolden * (high - low);
        f_outer = f(outer);
      }
    }
  }
  return best;
}

}  // namespace mbk::perturbation
