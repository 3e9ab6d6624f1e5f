#pragma once

#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::perturbation {

/// The odd harmonics 1, 3, 5 … up to `highest`, with one random line omitted from every `group` of consecutive ones. At
/// an omitted line, and at every even one, the response is distortion only: even lines show even distortion, empty odd
/// lines odd distortion (Pintelon & Schoukens 2012, §4.3; Vanhoenacker, Dobrowiecki & Schoukens 2001). A remainder of
/// fewer than `group` lines is kept.
/// @param group  0: none is omitted; otherwise ≥ 2    @param seed  random seed of the omitted lines, the same for all
/// realisations
/// @fails  highest < 1 or above Multisine::kHighestHarmonic; group of 1 or below 0.
[[nodiscard]] Result<std::vector<int>> odd_grid(int highest, int group, std::uint64_t seed);

}  // namespace mbk::perturbation
