#pragma once

#include "mbk/base/core/axes.h"

namespace mbk::robot {

/// Elasticity of cable drives: each motor, with its share of the inertia, turns its joint through a cable,
///   I_m θ̈_m = τ − F_r(θ̇_m) − s,   s = k (θ_m − θ) + c (θ̇_m − θ̇)
/// and the joints feel the torque s. The encoders sit on the motors. In angles of the joints throughout.
template <int Joints>
struct ElasticDrive {
  using PerJoint = AxisVector<Joints>;
  PerJoint stiffness = PerJoint::Constant(400.0);      ///< k [N·m/rad] > 0
  PerJoint damping = PerJoint::Constant(0.2);          ///< c [N·m·s/rad] ≥ 0
  PerJoint motor_inertia = PerJoint::Constant(0.015);  ///< I_m, taken out of that of the joint [kg·m²] > 0

  /// s [N·m], what the cables exert on the joints.
  [[nodiscard]] PerJoint torque(const PerJoint& twist, const PerJoint& twist_rate) const {
    return stiffness.cwiseProduct(twist) + damping.cwiseProduct(twist_rate);
  }
};

/// The capstan drives of the planar robot: discs turned by cables. The motors' inertia is a part of α₁ and α₃.
using Capstan = ElasticDrive<2>;

}  // namespace mbk::robot
