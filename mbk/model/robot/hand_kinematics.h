#pragma once

#include "mbk/base/core/axes.h"
#include "mbk/model/robot/kinematics.h"
#include "mbk/model/robot/one_axis_robot.h"

namespace mbk::robot {

/// The quantities of kinematics.h for one posture and joint velocity, computed with one sine and cosine per angle.
template <int Axes>
struct HandKinematics {
  AxisVector<Axes> position;  ///< hand_position [m]
  AxisMatrix<Axes> J;         ///< jacobian [m]
  AxisMatrix<Axes> J_rate;    ///< jacobian_rate [m/s]
};

[[nodiscard]] HandKinematics<1> hand_kinematics(const OneAxisGeometry& geometry, const AxisVector<1>& joint,
                                                const AxisVector<1>& joint_rate);
[[nodiscard]] HandKinematics<2> hand_kinematics(const Geometry& geometry, const Vector2d& theta,
                                                const Vector2d& theta_rate);

}  // namespace mbk::robot
