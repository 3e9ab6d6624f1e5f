#pragma once

#include <cstdint>
#include <functional>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/validation_table.h"
#include "mbk/validate/study.h"

namespace mbk::validation {

struct CoverageOptions {
  int runs = 2000;
  std::uint64_t seed = 1;
  unsigned threads = 0;        ///< 0: as many as there are cores
  double remnant_force = 0.3;  ///< coloured force noise of the limb [N], first-order low-pass at 1.5 Hz
  std::function<void(int done, int of)> progress;  ///< called after each run, never two at a time
  Elsewhere elsewhere;                             ///< as in StudyOptions
};

/// How often do the nominal 95 % intervals of M, B, K, x₀, the ellipses, the antisymmetry and the excess of passivity
/// hold the truth, and how often is an arm called passive that is active at an end of the band? Each run makes a
/// sinusoidal recording of the relaxed arm with coloured force noise of its own and measures it by the default
/// pipeline, from raw samples to intervals. One row each: the share of runs in which it is held [%], against 92 to 98.
/// @fails runs < 1; as the laboratory and the measurement.
[[nodiscard]] Result<ValidationTable> coverage(const CoverageOptions& options);

}  // namespace mbk::validation
