#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::impedance {

/// Linear mechanical impedance of a limb at the hand,
///   M ẍ + B ẋ + K (x − x₀) = −F_h                                        (Dyck 2013, eq. 3.2)
/// with F_h the force that the hand exerts on the robot [N]. Base frame. For one axis every matrix is 1×1 and
/// metres and newtons may be radians and newton metres.
struct Model {
  Matrix M;   ///< inertia, n×n [kg]
  Matrix B;   ///< damping, n×n [N·s/m]
  Matrix K;   ///< stiffness, n×n [N/m]
  Vector x0;  ///< equilibrium position, n [m]; NaN where K is singular

  [[nodiscard]] Index axes() const { return M.rows(); }
};

/// All numbers of a model in one column: M, B and K row by row, then x₀; 3n² + n of them. The order of every
/// covariance matrix and of the names of parameters.
[[nodiscard]] Vector stacked(const Model& model);

/// The model whose numbers `values` are.   @param values 3n² + n of them
[[nodiscard]] Model unstacked(const Vector& values, Index axes);

}  // namespace mbk::impedance
