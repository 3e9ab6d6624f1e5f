#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/bootstrap_findings.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/passivity.h"

namespace mbk::analyse {

/// Parameters; areas, shapes and orientations of the ellipses; eigenvalues of the symmetric parts; antisymmetry; excess
/// of passivity: each with its interval from the replicates. Quantiles of the bootstrap, moved for the median's bias,
/// and stretched from the estimate by newey_west_widening(1/blocks), since few blocks make the spread too small.
/// Orientations are counted from the estimate's, so that no turn of 180° tears an interval apart. Replicates in which a
/// number is not defined (an area where an eigenvalue is negative) make its interval undefined.
/// @fails  the identification was made without a bootstrap.
[[nodiscard]] Result<BootstrapFindings> bootstrap_findings(const Identification& identification);

}  // namespace mbk::analyse
