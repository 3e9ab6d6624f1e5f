#pragma once

#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/present/result/json_parts.h"

/// Parts of an exploration, one function each in a source of its own. For the sources of this module only.
namespace mbk::result {

[[nodiscard]] Json frequency_response_json(const FrequencyResponseEstimate& found);

}  // namespace mbk::result
