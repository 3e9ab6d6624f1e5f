#pragma once

#include <algorithm>

#include "mbk/model/trial/prepared_trial.h"

namespace mbk {

/// Upper end of the excited band after the filter [Hz].
[[nodiscard]] inline double passed_band(const Preparation& how) {
  return how.cutoff ? std::min(how.band_high, *how.cutoff).value : how.band_high.value;
}

/// Decimation factor after a low-pass without loss of information: with ten samples per cutoff period, the gain at the
/// Nyquist frequency is 1e-7.
/// @param shortest  samples of the shortest range, of which at least 1000 are kept, so that its ends are preserved
[[nodiscard]] inline Index enough_of(Hertz rate, Hertz cutoff, Index shortest) {
  constexpr double kRateOverCutoff = 10.0;
  constexpr Index kKept = 1000;
  // A clock is read to rounding only: a whole number must not fall below itself.
  const auto enough = static_cast<Index>(rate.value / (kRateOverCutoff * cutoff.value) * (1.0 + 1e-9));
  return std::max<Index>(1, std::min(enough, shortest / kKept));
}

/// A filter below half of the excited band hides the inertia and so distorts damping and stiffness.
[[nodiscard]] inline bool cuts_into_band(const Preparation& how) {
  constexpr double kHalf = 0.5;
  return passed_band(how) < kHalf * how.band_high.value;
}

}  // namespace mbk
