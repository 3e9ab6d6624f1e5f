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

/// The names of INTERFACE for the three matrices.
inline constexpr std::array<const char*, 3> kMatrixNames = {"inertia", "damping", "stiffness"};

}  // namespace mbk
