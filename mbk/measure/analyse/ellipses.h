#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/identification.h"

namespace mbk::analyse {

/// The ellipse of one matrix and its antisymmetry, with 95 % intervals by the delta method.
/// @param Z 2×2    @param covariance of [z_xx, z_xy, z_yx, z_yy]
[[nodiscard]] EllipseFinding ellipse_finding(const Matrix& Z, const Eigen::Matrix4d& covariance);
[[nodiscard]] AntisymmetryFinding antisymmetry_finding(const Matrix& Z, const Eigen::Matrix4d& covariance);

/// Ellipses of M, B and K and the antisymmetry of M and K, with 95 % intervals by the delta method from the
/// covariance of the parameters. If a symmetric part is not positive definite, there is no ellipse: its area and shape
/// are NaN.
/// @fails one axis (there is no ellipse).
[[nodiscard]] Result<Findings> analyse_ellipses(const Identification& identification);

}  // namespace mbk::analyse
