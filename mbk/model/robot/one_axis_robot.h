#pragma once

#include <array>
#include <cmath>

#include "mbk/base/core/axes.h"
#include "mbk/base/core/result.h"
#include "mbk/model/robot/friction.h"

namespace mbk::robot {

/// A robot of one axis, which turns or slides,
///   m ẍ + F_r(ẋ) = u + F_h                                           [N·m or N]
/// with the interface of the planar robot (kinematics.h, dynamics.h), so that the code that moves a robot is shared.
/// Its hand is where its joint is: J = 1.
struct OneAxisGeometry {
  [[nodiscard]] friend AxisVector<1> hand_position(const OneAxisGeometry& /*none*/, const AxisVector<1>& joint) {
    return joint;
  }

  [[nodiscard]] friend AxisMatrix<1> jacobian(const OneAxisGeometry& /*none*/, const AxisVector<1>& /*joint*/) {
    return AxisMatrix<1>::Identity();
  }

  [[nodiscard]] friend AxisMatrix<1> jacobian_rate(const OneAxisGeometry& /*none*/, const AxisVector<1>& /*joint*/,
                                                   const AxisVector<1>& /*joint_rate*/) {
    return AxisMatrix<1>::Zero();
  }

  /// @fails  usage: the position is not finite.
  [[nodiscard]] friend Result<AxisVector<1>> joint_angles(const OneAxisGeometry& /*none*/, const AxisVector<1>& hand) {
    if (!std::isfinite(hand[0])) return bad_usage("the machine's position is not finite");
    return hand;
  }
};

/// The same in every posture.
struct OneAxisInertia {
  double mass = 0.02;  ///< m, or moment of inertia for rotation [kg or kg·m²] > 0

  [[nodiscard]] AxisMatrix<1> matrix(const AxisVector<1>& /*joint*/) const { return AxisMatrix<1>(mass); }
  [[nodiscard]] AxisMatrix<1> coriolis(const AxisVector<1>& /*joint*/, const AxisVector<1>& /*joint_rate*/) const {
    return AxisMatrix<1>::Zero();
  }
};

struct OneAxisRobot {
  OneAxisGeometry geometry;
  OneAxisInertia inertia;
  std::array<JointFriction, 1> friction;

  /// F_r(ẋ) [N·m or N].
  [[nodiscard]] AxisVector<1> friction_torque(const AxisVector<1>& joint_rate) const {
    return AxisVector<1>(friction[0].torque(joint_rate[0]));
  }
};

}  // namespace mbk::robot
