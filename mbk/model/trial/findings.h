#pragma once

#include <array>
#include <optional>
#include <utility>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk {

using Interval = std::pair<double, double>;  ///< 95 %

/// An ellipse with its uncertainty. Area and shape by the delta method on their logarithms; the orientation by
/// Fieller's set (1954) of [(z_xx − z_yy)/2, z_s], which contains every angle if that vector may be zero: a circle has
/// no orientation. Then the intervals also contain shape 1 and equal eigenvalues.
struct EllipseFinding {
  Matrix symmetric;  ///< (Z + Zᵀ)/2, whose ellipse it is
  impedance::Ellipse ellipse;
  Interval area95, shape95;
  Interval orientation95;  ///< [rad]; may extend outside [0, π), as the angle is defined mod π; width π: any angle
  Interval lambda_min95, lambda_max95;
  bool round = false;  ///< whether a circle is not rejected (χ² with 2 degrees of freedom, 5 %)
};

/// Asymmetry of a matrix.
struct AntisymmetryFinding {
  double value = 0;  ///< z_a = (z_xy − z_yx)/2, signed, in the matrix's unit
  Interval value95;
  double zmean_percent = 0;
  Interval zmean95;  ///< [%], bottom 0
};

/// Numbers with intervals that follow from an Identification with two axes.
struct Findings {
  std::array<EllipseFinding, 3> ellipses;           ///< inertia, damping, stiffness
  std::array<AntisymmetryFinding, 2> antisymmetry;  ///< inertia, stiffness
};

/// A principal direction of a 3×3 matrix.
struct PrincipalDirection {
  double value = 0;           ///< eigenvalue λ of the symmetric part, in the matrix's unit
  Interval value95;           ///< also contains the mean with each eigenvalue that may be equal
  Eigen::Vector3d direction;  ///< unit vector, base frame; its largest component is positive
  double half_angle95 = 0;  ///< [rad] of the cone around it that contains the true axis; π/2: no direction, as λ may
                            ///< equal another eigenvalue; NaN without a covariance
};

/// The ellipsoid of a 3×3 matrix: the forces (Z + Zᵀ)/2 · u to unit motions u in all directions. The interval of each
/// axis is that of two axes, in the plane that it spans with each of the others.
struct EllipsoidFinding {
  Matrix symmetric;                             ///< (Z + Zᵀ)/2
  std::array<PrincipalDirection, 3> principal;  ///< largest first
  double volume = 0, shape = 0;                 ///< 4π/3 λ₁λ₂λ₃ and λ₁/λ₃; NaN if λ₃ ≤ 0
  Interval volume95, shape95;
  bool closed = false;  ///< λ₃ is positive beyond its interval: there is an ellipsoid to draw
};

/// Asymmetry of a 3×3 matrix: (Z − Zᵀ)/2 · u = z_a × u.
struct CirculationFinding {
  Eigen::Vector3d vector;            ///< z_a, base frame, in the matrix's unit
  std::array<Interval, 3> vector95;  ///< of each component
  double size = 0;                   ///< |z_a|
  Interval size95;                   ///< bottom 0 if z_a may be zero
  bool significant = false;          ///< z_a = 0 is rejected (χ² with 3 degrees of freedom, 5 %)
  double percent = 0;                ///< 100 |z_a| over the geometric mean of the eigenvalues; NaN if λ₃ ≤ 0
};

/// Numbers with intervals that follow from an Identification with three axes.
struct SpatialFindings {
  std::array<EllipsoidFinding, 3> ellipsoids;      ///< inertia, damping, stiffness
  std::array<CirculationFinding, 2> antisymmetry;  ///< inertia, stiffness
};

/// The names of INTERFACE for the three matrices.
inline constexpr std::array<const char*, 3> kMatrixNames = {"inertia", "damping", "stiffness"};

}  // namespace mbk
