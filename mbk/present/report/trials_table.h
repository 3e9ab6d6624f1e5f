#pragma once

#include <span>
#include <string>

#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/summary.h"

namespace mbk::report {

/// One row a result: file, protocol, method, state, codes of warnings, then each number with the ends of its 95 %
/// interval: M, B, K and x₀ [SI], VAF [%] and, where there are findings, area, shape and orientation [°] of the
/// ellipses, or principal values and directions, volume and shape of the ellipsoids. The header has the units. A result
/// that is not usable has a row without numbers of its model, and what could not be measured a row that says why.
[[nodiscard]] std::string trials_csv(std::span<const Measurement> measured, const SeveralTrials& together);

/// For LaTeX. Of several results a table (booktabs): one row a result with M, B and K ± the half width of the 95 %
/// interval, and VAF, units in the header; below a rule the mean of the trials where there is one. Two axes stand
/// sideways on the page; of three axes each matrix has a table. Of one result equations (amsmath): M, B, K and x₀ as
/// matrices ± the same, then VAF.
[[nodiscard]] std::string trials_latex(std::span<const Measurement> measured, const SeveralTrials& together);

}  // namespace mbk::report
