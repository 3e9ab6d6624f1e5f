#pragma once

#include <fmt/format.h>

#include <cmath>

#include "mbk/base/core/result.h"

namespace mbk::perturbation {

/// Random pauses between movements.   @fails  usage: not 0 ≤ shortest ≤ longest < ∞ [s]
[[nodiscard]] inline Result<void> check_pauses(double shortest, double longest) {
  if (shortest >= 0.0 && shortest <= longest && std::isfinite(longest)) return {};
  return bad_usage(fmt::format("pauses from {} s to {} s are not a range of non-negative times", shortest, longest));
}

}  // namespace mbk::perturbation
