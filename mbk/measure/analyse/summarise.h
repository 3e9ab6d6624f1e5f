#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/summary.h"

namespace mbk::analyse {

/// Mean over trials and its standard error, s/√n with s the (n − 1)-normalised deviation between the trials. It says
/// how well the measurement repeats, which no interval from within one trial can.
/// @fails fewer than two trials; one and two axes mixed.
[[nodiscard]] Result<Summary> summarise(const std::vector<Identification>& identifications);

}  // namespace mbk::analyse
