#pragma once

#include <Eigen/Geometry>

#include "mbk/base/core/axes.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::laboratory {

using robot::link_axes;

/// What a sensor on the last link reads of v, turned back into the base frame with the encoder's angle θ̂₂:
///   R_BS(θ̂₂) [v_S + e_S] = turn(θ̂₂ − θ₂) v_B + R_BS(θ̂₂) e_S,   v_S = R_BS(θ₂)ᵀ v_B
/// e_S is what the sensor adds in its axes. The right side is used, where nothing is rounded when e_S = 0 and θ̂₂ = θ₂.
/// @param added  e_S as a function of v_S
template <class Added>
[[nodiscard]] AxisVector<2> read_on_link(const AxisVector<2>& v, double theta2, double measured_theta2,
                                         const Added& added) {
  const AxisVector<2> e = added(link_axes(theta2).transpose() * v);
  return Eigen::Rotation2Dd(measured_theta2 - theta2).toRotationMatrix() * v + link_axes(measured_theta2) * e;
}

/// A machine of one axis takes its sensors along: v + e.
template <class Added>
[[nodiscard]] AxisVector<1> read_on_link(const AxisVector<1>& v, double /*angle*/, double /*measured_angle*/,
                                         const Added& added) {
  return v + added(v);
}

}  // namespace mbk::laboratory
