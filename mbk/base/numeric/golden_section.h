#pragma once

namespace mbk::numeric {

/// Narrows a bracket of the best value of f by golden sections (Kiefer 1953): each look at f leaves 0.618 of it. Where
/// f has one best value in the bracket, it stays inside; f itself remembers what it has seen.
/// @param better  better(a, b): whether the side of a is kept, as std::less for a minimum
/// @param go_on   go_on(low, high), asked before each section: whether the bracket is still too wide
template <class Function, class Better, class GoOn>
void golden_section(double low, double high, const Function& f, const Better& better, const GoOn& go_on) {
  constexpr double kGolden = 0.6180339887498949;
  double inner = high - kGolden * (high - low), outer = low + kGolden * (high - low);
  double f_inner = f(inner), f_outer = f(outer);
  while (go_on(low, high)) {
    if (better(f_inner, f_outer)) {
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

}  // namespace mbk::numeric
