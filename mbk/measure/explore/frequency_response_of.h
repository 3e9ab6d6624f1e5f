#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/local_polynomial.h"
#include "mbk/measure/explore/periodic_response.h"
#include "mbk/measure/explore/welch_response.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/warning.h"

namespace mbk::explore {

struct FrequencyResponseOptions {
  std::optional<FrequencyResponseMethod> method;  ///< absent: by the data
  std::optional<double> period_s;                 ///< of the perturbation; absent: found
  double segment_s = 2.0;                         ///< of averaged spectra; the bandwidth of local polynomials is 1/that
  double max_frequency_hz = 50.0;
};

/// The frequency response by the requested method or, by default, the first of these that the data allow:
/// periods and realisations (robust), periods of one realisation (fast), local polynomials, averaged spectra. Pulses,
/// whose reference rests most of the time, are not searched for a period. `method_rule` says why.
/// @fails  as the method; data: the data do not allow the requested method.
[[nodiscard]] Result<FrequencyResponseEstimate> frequency_response(std::span<const ExplorationTrial> trials,
                                                                   const FrequencyResponseOptions& options = {});

/// What a user must know of a response: at most of its frequencies less than half of an output is explained; the
/// intervals rest on fewer than three degrees of freedom of realisations; realisations or empty lines show distortion.
[[nodiscard]] std::vector<Warning> warnings_of(const FrequencyResponseEstimate& found);

}  // namespace mbk::explore
