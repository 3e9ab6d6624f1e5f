#pragma once

#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/impulse_response_estimate.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/present/result/json_parts.h"

/// Parts of an exploration, one function each in a source of its own. For the sources of this module only.
namespace mbk::result {

[[nodiscard]] Json frequency_response_json(const FrequencyResponseEstimate& found);
[[nodiscard]] Json impulse_response_json(const ImpulseResponseEstimate& found);
[[nodiscard]] Json parallel_cascade_json(const ParallelCascadeEstimate& found);

}  // namespace mbk::result
