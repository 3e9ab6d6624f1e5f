#pragma once

#include <algorithm>

#include "mbk/model/trial/prepared_trial.h"

namespace mbk {

/// Up to where the excited band passes the filter [Hz].
[[nodiscard]] inline double passed_band(const Preparation& how) {
  return how.cutoff ? std::min(how.band_high, *how.cutoff).value : how.band_high.value;
}

/// Of the samples that a low-pass leaves, the first of so many holds all that they hold: at ten for each period of the
/// cutoff, 1e-7 lies above half of their rate.
/// @param shortest  samples of the shortest range, of which 1000 are kept, so that its ends stay where they are
[[nodiscard]] inline Index enough_of(Hertz rate, Hertz cutoff, Index shortest) {
  constexpr double kRateOverCutoff = 10.0;
  constexpr Index kKept = 1000;
  // A clock is read to rounding only: a whole number must not fall below itself.
  const auto enough = static_cast<Index>(rate.value / (kRateOverCutoff * cutoff.value) * (1.0 + 1e-9));
  return std::max<Index>(1, std::min(enough, shortest / kKept));
}

/// A filter below half of the excited band hides the inertia, and with it what damping and stiffness are.
[[nodiscard]] inline bool cuts_into_band(const Preparation& how) {
  constexpr double kHalf = 0.5;
  return passed_band(how) < kHalf * how.band_high.value;
}

}  // namespace mbk
