#pragma once

#include <Eigen/Geometry>

#include "mbk/base/core/axes.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::laboratory {

using robot::link_axes;

/// The reading of v by a sensor on the last link, rotated back to the base frame with the encoder angle θ̂₂:
///   R_BS(θ̂₂) [v_S + e_S] = turn(θ̂₂ − θ₂) v_B + R_BS(θ̂₂) e_S,   v_S = R_BS(θ₂)ᵀ v_B
/// e_S is the sensor error in its axes. The right-hand side is used; it is free of rounding for e_S = 0 and θ̂₂ = θ₂.
/// @param added  e_S as a function of v_S
template <class Added>
[[nodiscard]] AxisVector<2> read_on_link(const AxisVector<2>& v, double theta2, double measured_theta2,
                                         const Added& added) {
  const AxisVector<2> e = added(link_axes(theta2).transpose() * v);
  return Eigen::Rotation2Dd(measured_theta2 - theta2).toRotationMatrix() * v + link_axes(measured_theta2) * e;
}

/// On a machine of one axis the sensors move with it: v + e.
template <class Added>
[[nodiscard]] AxisVector<1> read_on_link(const AxisVector<1>& v, double /*angle*/, double /*measured_angle*/,
                                         const Added& added) {
  return v + added(v);
}

}  // namespace mbk::laboratory
