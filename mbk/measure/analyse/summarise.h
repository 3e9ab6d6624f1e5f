#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/summary.h"

namespace mbk::analyse {

/// Mean over trials and its standard error, s/√n with s the (n − 1)-normalised deviation between the trials. It says
/// how well the measurement repeats, which no interval from within one trial can. Trials that are not usable, and files
/// with the bytes of an earlier one, are no part of it; they are named.
/// @fails fewer than two trials are left; they differ in axes, units, participant, condition, posture, protocol, mode,
/// method, structure, force source or handle mass. What a recording does not say differs from nothing.
[[nodiscard]] Result<Summary> summarise(const std::vector<Identification>& identifications);

}  // namespace mbk::analyse
