#pragma once

#include <Eigen/Core>

namespace mbk {

using Index = Eigen::Index;
using Vector = Eigen::VectorXd;  ///< a column of numbers; a signal has one entry per sample
using Matrix = Eigen::MatrixXd;  ///< columns are contiguous; signals stand in columns, one row per sample

/// Finite numbers only. `allFinite` of Eigen says the same, but not where.
[[nodiscard]] inline Index first_non_finite(const Eigen::Ref<const Vector>& values) {
  const auto nothing = [&](Index i) { return values[i] - values[i]; };
  Index i = 0;
  while (i + 4 <= values.size() && nothing(i) + nothing(i + 1) + nothing(i + 2) + nothing(i + 3) == 0.0) i += 4;
  for (; i < values.size(); ++i) {
    if (!(nothing(i) == 0.0)) return i;
  }
  return -1;
}

}  // namespace mbk
