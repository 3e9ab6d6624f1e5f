#pragma once

#include <Eigen/Core>

namespace mbk::perturbation {

/// A function of time and its first two derivatives at one instant: f, ḟ, f̈ [u, u/s, u/s²]. `Value` is a double, or
/// a column for several axes.
template <class Value>
struct Jet {
  Value value;
  Value first;
  Value second;
};

/// One number for each axis, at most three; never on the heap.
using AxesVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;

}  // namespace mbk::perturbation
