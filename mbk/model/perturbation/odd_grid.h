#pragma once

#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::perturbation {

/// The odd harmonics 1, 3, 5 … up to `highest`, of which one at random is left out of every `group` that follow each
/// other. At a line that is left out, and at every even one, what is perturbed answers by distortion alone: even lines
/// show even distortion, empty odd ones odd distortion (Pintelon & Schoukens 2012, §4.3; Vanhoenacker, Dobrowiecki &
/// Schoukens 2001). A remainder of fewer than `group` lines stays whole.
/// @param group  0: none is left out; else ≥ 2    @param seed  of what is left out, the same for all realisations
/// @fails  highest < 1 or above Multisine::kHighestHarmonic; group of 1 or below 0.
[[nodiscard]] Result<std::vector<int>> odd_grid(int highest, int group, std::uint64_t seed);

}  // namespace mbk::perturbation
