#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/base/dsp/butterworth.h"

namespace mbk::dsp {

/// How a signal is continued beyond its ends before it is filtered.
enum class Extension {
  odd,       ///< point reflection, 2 x[0] − x[i]: keeps value and slope
  even,      ///< mirror image, x[i]: keeps the value
  constant,  ///< the end value, held
};

[[nodiscard]] constexpr auto word_table(Extension) {
  using enum Extension;
  return std::to_array<Word<Extension>>({{odd, "odd"}, {even, "even"}, {constant, "constant"}});
}

/// The published procedure, and MATLAB's filtfilt for a filter of order five, use 15 samples of odd extension.
struct Padding {
  Extension extension = Extension::odd;
  Index samples = 15;  ///< at each end
};

/// Filters each column forward and then backward: gain |H|², no phase. Each pass starts from the filter's steady
/// state for a constant input equal to the first (extended) sample of that pass (Gustafsson's initial conditions
/// are something else). The operator is linear, so that a linear relation between columns survives it exactly.
/// @param signals N×n, evenly sampled; one signal per column    @returns N×n.   Offline: allocates.
/// @fails N ≤ padding.samples ("12 samples are too few for a padding of 15").
[[nodiscard]] Result<Matrix> filter_zero_phase(const SectionCascade& filter, const Matrix& signals,
                                               const Padding& padding = {});

}  // namespace mbk::dsp
