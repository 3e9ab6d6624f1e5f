#pragma once

#include <span>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/dsp/zero_phase.h"

namespace mbk::dsp {

/// What a measurement passes through: Savitzky–Golay smoothing, which also gives the derivatives, and a zero-phase
/// low-pass (Dyck 2013 §3.5.1). An empty cascade is no low-pass.
struct FilterChain {
  SavitzkyGolay smoothing;
  SectionCascade lowpass;
  Padding padding;
};

/// One output of the filters: the derivative of that order of one column.
struct FilterOutput {
  Index column = 0;
  int derivative = 0;
};

using Column = Eigen::Map<const Vector>;

/// savitzky_golay and then filter_zero_phase, to rounding, in two passes over the data.
/// The Savitzky–Golay sums Σ_j C(j, k) x[i + j], k = 0…N, run from sample to sample by Pascal's rule,
///   C(j, k) = C(j + 1, k) − C(j, k − 1),
/// and start anew after each half window, so that rounding has no time to grow; an output is a sum of N + 1 of
/// them. Four columns go side by side.
///
/// If only every Nth row is requested, the outputs are accurate to kDecimationError of the signals, ends included:
/// blocks of samples are represented by a few moments, and no other row is computed (decimated_chain.h). Where blocks
/// cannot do, every row is.
/// @param columns of equal length L, evenly sampled
/// @returns ⌈(L − W + 1)/every⌉×outputs; row i belongs to sample half window + i·every.   Offline: allocates.
/// @fails as savitzky_golay and filter_zero_phase; every < 1.
[[nodiscard]] Result<Matrix> smooth_then_lowpass(const FilterChain& chain, std::span<const Column> columns,
                                                 std::span<const FilterOutput> outputs, Hertz sample_rate,
                                                 Index every = 1);
inline constexpr double kDecimationError = 1e-7;

/// The same, to where it is wanted.
/// @param to  for each output, room for one number for each row
[[nodiscard]] Result<void> smooth_then_lowpass(const FilterChain& chain, std::span<const Column> columns,
                                               std::span<const FilterOutput> outputs, Hertz sample_rate, Index every,
                                               std::span<double* const> to);

/// Number of rows that the filters leave of a number of samples.   @fails as smooth_then_lowpass
[[nodiscard]] Result<Index> rows_left(const FilterChain& chain, Index samples, Index every);

}  // namespace mbk::dsp
