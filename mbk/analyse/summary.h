#pragma once

#include <vector>

#include "mbk/core/result.h"
#include "mbk/trial/identification.h"
#include "mbk/trial/summary.h"

namespace mbk::analyse {

/// Mean over trials and its standard error, s/√n with s the (n − 1)-normalised deviation between the trials. It says
/// how well the measurement repeats, which no interval from within one trial can.
/// @fails fewer than two trials; one and two axes mixed.
[[nodiscard]] Result<Summary> summarise(const std::vector<Identification>& identifications);

}  // namespace mbk::analyse
