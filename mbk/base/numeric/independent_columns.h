#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::numeric {

/// Which columns of a regression can be distinguished, and what the others are made of.
struct IndependentColumns {
  std::vector<Index> kept;  ///< in order
  Matrix combination;       ///< kept×p: column j is Z(:, kept) · combination.col(j), to the tolerance
};

/// From left to right: a column is kept if its distance from the span of the kept columns before it is more than
/// `tolerance` of its length (modified Gram–Schmidt, twice). A column of zeros is never kept, nor one whose length is
/// at most `negligible` of the longest's: what rounding leaves of zeros.
[[nodiscard]] IndependentColumns independent_columns(const Matrix& Z, double tolerance, double negligible = 0.0);

}  // namespace mbk::numeric
