#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/bootstrap_findings.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/passivity.h"

namespace mbk::analyse {

/// Parameters; areas, shapes and orientations of the ellipses; eigenvalues of the symmetric parts; antisymmetry; excess
/// of passivity: each with its interval from the replicates. Quantiles of the bootstrap, moved for the median's bias,
/// and stretched from the estimate by newey_west_widening(1/blocks), since few blocks make the spread too small.
/// Orientations are relative to the estimate, so that no jump of 180° splits an interval. Replicates in which a number
/// is undefined (an area with a negative eigenvalue) make its interval undefined.
/// @fails  the identification was made without bootstrap.
[[nodiscard]] Result<BootstrapFindings> bootstrap_findings(const Identification& identification);

}  // namespace mbk::analyse
