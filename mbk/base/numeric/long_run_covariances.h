#pragma once

#include <functional>
#include <vector>

#include "mbk/base/numeric/least_squares.h"

namespace mbk::numeric {

/// long_run_covariance of several kinds of scores in one pass: Ω of each kind by itself.
/// @param k scores of a kind and sample    @param scores_of n×(kinds·k), kind after kind
[[nodiscard]] std::vector<Matrix> long_run_covariances(Index kinds, Index k, const std::vector<RowRange>& ranges,
                                                       Index lags,
                                                       const std::function<Matrix(const RowRange&)>& scores_of);

}  // namespace mbk::numeric
