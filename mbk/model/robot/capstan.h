#pragma once

#include "mbk/base/core/axes.h"
#include "mbk/base/core/linear_algebra.h"

namespace mbk::robot {

/// Elasticity of cable drives: each motor, with its share of the inertia, turns its joint through a cable,
///   I_m θ̈_m = τ − F_r(θ̇_m) − s,   s = k e + c (θ̇_m − θ̇),   e = θ_m − θ
/// and the joints feel the torque s. With backlash g, e is the amount by which θ_m − θ exceeds ±g/2: inside the gap s =
/// 0, and in contact s pushes but never pulls (Nordin & Gutman 2002). The encoders are on the motors. All angles are
/// joint angles.
template <int Joints>
struct ElasticDrive {
  using PerJoint = AxisVector<Joints>;
  PerJoint stiffness = PerJoint::Constant(400.0);      ///< k [N·m/rad] > 0
  PerJoint damping = PerJoint::Constant(0.2);          ///< c [N·m·s/rad] ≥ 0
  PerJoint motor_inertia = PerJoint::Constant(0.015);  ///< I_m, part of the joint inertia [kg·m²] > 0
  PerJoint backlash = PerJoint::Zero();                ///< g, from contact to contact [rad] ≥ 0

  /// e, elastic deflection of the drive [rad].
  [[nodiscard]] PerJoint bend(const PerJoint& twist) const {
    return twist - twist.cwiseMax(-0.5 * backlash).cwiseMin(0.5 * backlash);
  }

  /// s [N·m], torque of the cables on the joints.
  [[nodiscard]] PerJoint torque(const PerJoint& twist, const PerJoint& twist_rate) const {
    const PerJoint bent = bend(twist);
    PerJoint s = stiffness.cwiseProduct(bent) + damping.cwiseProduct(twist_rate);
    for (Index joint = 0; joint < s.size(); ++joint) {
      if (backlash[joint] > 0.0 && !(s[joint] * bent[joint] > 0.0)) s[joint] = 0.0;
    }
    return s;
  }
};

/// The capstan drives of the planar robot: discs turned by cables. The inertia of the motors is part of α₁ and α₃.
using Capstan = ElasticDrive<2>;

}  // namespace mbk::robot
