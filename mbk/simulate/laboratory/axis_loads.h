#pragma once

#include <Eigen/Core>

#include "mbk/simulate/participant/load.h"
#include "mbk/simulate/participant/one_axis_load.h"

namespace mbk::laboratory {

/// A mass, a damper and a spring to the ground at x = 0, m ẍ + b ẋ + k x = −reaction. A negative b generates.
class MassSpringDamper : public participant::OneAxisLoad {
 public:
  MassSpringDamper(double mass, double damping, double stiffness)
      : mass_(mass), damping_(damping), stiffness_(stiffness) {}

  void tick(double, double, const participant::JointState&, double) override {}
  [[nodiscard]] participant::OneAxisDynamics dynamics(const participant::JointState& state) const override {
    return {mass_, damping_ * state.velocity + stiffness_ * state.position};
  }
  [[nodiscard]] impedance::Model impedance(double position) const override;

 private:
  double mass_, damping_, stiffness_;
};

/// A load of the planar handle that is led along a line without friction, p = p₀ + u x: along it the load takes
///   (uᵀ Λ u) ẍ + uᵀ h
/// and the guide takes the rest.
class AlongLine : public participant::OneAxisLoad {
 public:
  /// @param load  must outlive this   @param origin  p₀ [m]   @param angle  of u from +x [rad]
  AlongLine(participant::Load& load, const Eigen::Vector2d& origin, double angle);

  void tick(double t, double sample_time, const participant::JointState& state, double reaction) override;
  [[nodiscard]] participant::OneAxisDynamics dynamics(const participant::JointState& state) const override;
  [[nodiscard]] impedance::Model impedance(double position) const override;

 private:
  [[nodiscard]] participant::HandState hand(const participant::JointState& state) const;
  participant::Load* load_;
  Eigen::Vector2d origin_, direction_;
};

}  // namespace mbk::laboratory
