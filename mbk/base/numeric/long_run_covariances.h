#pragma once

#include <functional>
#include <vector>

#include "mbk/base/numeric/least_squares.h"

namespace mbk::numeric {

/// Scores that are products: of each kind k columns, kind after kind; column j is left[j]·right[j], from the first row
/// that was asked for on.
struct ScoreProducts {
  std::vector<const double*> left, right;
};

/// long_run_covariance of several kinds of scores in one pass: Ω of each kind separately.
/// @param k scores of a kind and sample
/// @param products_of the factors of some rows of a range, which follow each other; each row is asked for again with
/// the `lags` + 1 behind it. What it points to must stay until the next call.
[[nodiscard]] std::vector<Matrix> long_run_covariances(
    Index kinds, Index k, const std::vector<RowRange>& ranges, Index lags,
    const std::function<ScoreProducts(const RowRange&)>& products_of);

}  // namespace mbk::numeric
