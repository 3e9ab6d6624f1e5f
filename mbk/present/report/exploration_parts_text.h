#pragma once

#include <string>

#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/impulse_response_estimate.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/model/trial/prepared_trial.h"

/// @file
/// Parts of an exploration, one function each in a source of its own. For the sources of this module only.
namespace mbk::report {

[[nodiscard]] std::string frequency_response_text(const FrequencyResponseEstimate& found);
[[nodiscard]] std::string impulse_response_text(const ImpulseResponseEstimate& found, Motion motion);
[[nodiscard]] std::string parallel_cascade_text(const ParallelCascadeEstimate& found, Motion motion);

}  // namespace mbk::report
