#pragma once

#include <Eigen/Core>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::impedance {

/// (Z + Zᵀ)/2: the part whose forces come from a potential (Dyck 2013, eq. 3.11).
[[nodiscard]] Matrix symmetric_part(const Matrix& Z);

/// z_a = (z_xy − z_yx)/2, signed: the rotational part. @param Z 2×2
[[nodiscard]] double antisymmetric_part(const Matrix& Z);

/// z_a of a 3×3 matrix: (Z − Zᵀ)/2 · u = z_a × u. Its direction is the axis about which the part rotates; in the plane
/// only its z component is left, with the opposite sign of antisymmetric_part.
[[nodiscard]] Eigen::Vector3d antisymmetric_vector(const Matrix& Z);

/// Its derivative by the elements of Z, row by row.
[[nodiscard]] Eigen::Matrix<double, 3, 9> antisymmetric_vector_gradient();

/// z_mean = 100 |z_a|/√(λ_max λ_min) [%], relative to the symmetric part (Dyck 2013, eq. 3.26).
/// NaN where the symmetric part is not positive definite. @param Z 2×2
[[nodiscard]] double antisymmetry_percent(const Matrix& Z);

/// The curve of the force for a unit motion around a circle (Dyck 2013, eq. 3.12–3.17).
struct Ellipse {
  double lambda_max = 0, lambda_min = 0;  ///< eigenvalues of the symmetric part, in its unit
  double area = 0;                        ///< π λ_max λ_min; NaN where λ_min ≤ 0
  double shape = 0;                       ///< λ_max/λ_min ≥ 1; NaN where λ_min ≤ 0
  double orientation = 0;                 ///< of the major axis from the x axis [rad], in [0, π)
};

/// θ = ½ atan2(2 z_s, z_xx − z_yy) mod π, in place of (3.17), which is 0/0 for z_s = 0. @param Z 2×2
[[nodiscard]] Ellipse ellipse(const Matrix& Z);

/// Derivatives of an ellipse's numbers by [z_xx, z_xy, z_yx, z_yy], for the delta method.
struct EllipseGradient {
  Eigen::RowVector4d lambda_max, lambda_min, area, shape, orientation;
};

///   dλ = vᵀ dZ v;  dA = π(λ_max dλ_min + λ_min dλ_max);  dR = dλ_max/λ_min − R dλ_min/λ_min
///   dθ = ((z_xx − z_yy) dz_s − z_s (dz_xx − dz_yy))/((z_xx − z_yy)² + 4 z_s²)
/// Not defined (division by zero) for a circle, where the orientation is undefined. @param Z 2×2
[[nodiscard]] EllipseGradient ellipse_gradient(const Matrix& Z);

}  // namespace mbk::impedance
