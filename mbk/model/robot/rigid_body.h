#pragma once

#include <Eigen/Core>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::robot {

inline constexpr Index kCoefficientsPerBody = 10;

/// A rigid body in a frame of its own.
struct RigidBody {
  double mass = 0;          ///< m [kg]
  Eigen::Vector3d centre;   ///< c, of mass [m]
  Eigen::Matrix3d inertia;  ///< about the centre of mass, along the axes of the frame [kg·m²]
};

/// J = ∫ [r; 1] [r; 1]ᵀ dm = [½ tr(Ī) 1 − Ī, h; hᵀ, m], which is positive definite if and only if the body has mass
/// that does not lie in a plane (Wensing, Kim & Slotine 2018).
/// @param coefficients m, h = m c, Ī_xx, Ī_xy, Ī_xz, Ī_yy, Ī_yz, Ī_zz about the frame's origin
[[nodiscard]] Eigen::Matrix4d pseudo_inertia(const Eigen::Matrix<double, kCoefficientsPerBody, 1>& coefficients);
[[nodiscard]] Eigen::Matrix4d pseudo_inertia(const RigidBody& body);

/// The body of a pseudo-inertia. Centre and inertia are not finite if the mass is 0.
[[nodiscard]] RigidBody body_of(const Eigen::Matrix4d& pseudo_inertia);

}  // namespace mbk::robot
