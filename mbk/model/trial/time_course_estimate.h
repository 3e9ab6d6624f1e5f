#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk {

/// M, B or K along a variable.
struct MatrixCourse {
  Matrix value, half_width;  ///< P×n²: column i + j n is entry (i, j); half widths of pointwise 95 % intervals
  Matrix mean;               ///< n×n, of one that does not change
  Matrix mean_half_width;    ///< n×n
  double change = 0;  ///< √(mean |Z(s) − Z̄|²)/|Z̄| over the range, Frobenius norms, without the part of the noise
};

/// M, B and K as functions of time or of another variable s,
///   −F_h = M(s) ẍ + B(s) ẋ + K(s) x + c(s),
/// each entry a linear or cubic spline.
struct TimeCourseEstimate {
  int axes = 1;
  std::string variable, unit;  ///< "time", "s"
  double from = 0, to = 0;     ///< range of s that was fitted
  Index repetitions = 1;       ///< of that range: trials, or events that were aligned
  Index rows = 0;              ///< behind the low-pass
  double rate_hz = 0;          ///< of the rows
  bool instruments = false;    ///< the reference stood for the motion
  bool changes = false;        ///< the verdict
  std::string why;             ///< in words
  Index functions = 1;         ///< of the chosen basis; 1: a constant
  int degree = 0;              ///< of the splines: 1 or 3; fewer where they are one polynomial
  std::string varying;         ///< which of M, B and K vary; empty: none
  std::vector<double> knots;   ///< interior ones, in the unit of s
  double bic_gain = 0;         ///< BIC of constant M, B and K less that of the chosen ones
  double p_value = 1;          ///< of such a change where there is none
  Vector at;                   ///< P, values of s; one where nothing changes
  MatrixCourse M, B, K;
};

}  // namespace mbk
