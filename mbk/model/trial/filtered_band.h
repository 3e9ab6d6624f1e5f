#pragma once

#include <algorithm>

#include "mbk/model/trial/prepared_trial.h"

namespace mbk {

/// Up to where the excited band passes the filter [Hz].
[[nodiscard]] inline double passed_band(const Preparation& how) {
  return how.cutoff ? std::min(how.band_high, *how.cutoff).value : how.band_high.value;
}

/// A filter below half of the excited band hides the inertia, and with it what damping and stiffness are.
[[nodiscard]] inline bool cuts_into_band(const Preparation& how) {
  constexpr double kHalf = 0.5;
  return passed_band(how) < kHalf * how.band_high.value;
}

}  // namespace mbk
