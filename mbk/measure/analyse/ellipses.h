#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/measurement.h"

namespace mbk::analyse {

/// The ellipse of one matrix and its antisymmetry, with 95 % intervals by the delta method.
/// @param Z 2×2    @param covariance of [z_xx, z_xy, z_yx, z_yy]
[[nodiscard]] EllipseFinding ellipse_finding(const Matrix& Z, const Eigen::Matrix4d& covariance);
[[nodiscard]] AntisymmetryFinding antisymmetry_finding(const Matrix& Z, const Eigen::Matrix4d& covariance);

/// The same in space.   @param Z 3×3    @param covariance 9×9, of its elements row by row
[[nodiscard]] EllipsoidFinding ellipsoid_finding(const Matrix& Z, const Matrix& covariance);
[[nodiscard]] CirculationFinding circulation_finding(const Matrix& Z, const Matrix& covariance);

/// Ellipses of M, B and K and the antisymmetry of M and K, with 95 % intervals by the delta method from the
/// covariance of the parameters. If a symmetric part is not positive definite, there is no ellipse: its area and shape
/// are NaN.
/// @fails not two axes.
[[nodiscard]] Result<Findings> analyse_ellipses(const Identification& identification);

/// The same for three axes.   @fails not three axes.
[[nodiscard]] Result<SpatialFindings> analyse_ellipsoids(const Identification& identification);

/// Ellipses or ellipsoids of a result.   @fails one axis.
[[nodiscard]] Result<void> add_ellipses(Measurement& measured);

}  // namespace mbk::analyse
