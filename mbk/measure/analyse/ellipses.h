#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/identification.h"

namespace mbk::analyse {

/// Ellipses of M, B and K and the antisymmetry of M and K, with 95 % intervals by the delta method from the
/// covariance of the parameters. Where a symmetric part is not positive definite there is no ellipse: its area and
/// shape are NaN.
/// @fails one axis (there is no ellipse).
[[nodiscard]] Result<Findings> analyse_ellipses(const Identification& identification);

}  // namespace mbk::analyse
