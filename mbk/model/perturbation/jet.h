#pragma once

namespace mbk::perturbation {

/// A function of time and its first two derivatives at one instant: f, ḟ, f̈ [u, u/s, u/s²]. `Value` is a double, or
/// a fixed-size column for several axes.
template <class Value>
struct Jet {
  Value value;
  Value first;
  Value second;
};

}  // namespace mbk::perturbation
