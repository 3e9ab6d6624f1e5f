#pragma once

#include <cmath>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::recording {

/// Standard deviation of a normal distribution, in median absolute deviations.
inline constexpr double kDeviation = 1.4826;

[[nodiscard]] inline double median_of(const Vector& values) {
  return numeric::median({values.data(), values.data() + values.size()});
}

/// |value − median| of each value.
[[nodiscard]] inline Vector distances_from_median(const Vector& values) {
  return (values.array() - median_of(values)).abs().matrix();
}

/// The standard deviation, as the median absolute deviation gives it: outliers do not count.
[[nodiscard]] inline double robust_deviation(const Vector& values) {
  return kDeviation * median_of(distances_from_median(values));
}

[[nodiscard]] inline Vector differences(const Vector& values) {
  return values.tail(values.size() - 1) - values.head(values.size() - 1);
}

}  // namespace mbk::recording
