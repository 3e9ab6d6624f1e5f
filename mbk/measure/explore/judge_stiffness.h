#pragma once

#include <vector>

#include "mbk/model/trial/plateau_stiffness.h"
#include "mbk/model/trial/warning.h"

namespace mbk::explore {

/// Warnings on a stiffness estimated from displacements of the hand.
struct StiffnessVerdict {
  std::vector<Warning> warnings;
  bool usable = true;
};

/// The hand at rest on the window (warned of from a share of 2 % on, not usable above 10 %), the displacement reached
/// (within 90 to 110 %; not usable below a half or above the double), the standard error (a fifth of K; not usable
/// above a half), one K for all directions (1 %).
/// @param motion_share  as in PlateauStiffness
[[nodiscard]] StiffnessVerdict judge_stiffness(const StiffnessRegression& fit, double motion_share);

}  // namespace mbk::explore
