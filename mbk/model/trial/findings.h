#pragma once

#include <array>
#include <optional>
#include <utility>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk {

using Interval = std::pair<double, double>;  ///< 95 %

/// An ellipse and how sure it is. Area and shape by the delta method on their logarithms, the orientation on itself.
struct EllipseFinding {
  Matrix symmetric;  ///< (Z + Zᵀ)/2, whose ellipse it is
  impedance::Ellipse ellipse;
  Interval area95, shape95;
  Interval orientation95;  ///< [rad]; may reach outside [0, π): the angle is only defined mod π
};

/// How far a matrix is from symmetric.
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
