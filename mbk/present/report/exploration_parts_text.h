#pragma once

#include <string>

#include "mbk/model/trial/frequency_response_estimate.h"

/// @file
/// Parts of an exploration, one function each in a source of its own. For the sources of this module only.
namespace mbk::report {

[[nodiscard]] std::string frequency_response_text(const FrequencyResponseEstimate& found);

}  // namespace mbk::report
