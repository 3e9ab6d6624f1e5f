#pragma once

#include "mbk/simulate/participant/load.h"

namespace mbk::laboratory {

/// A mass, a damper and a spring to the ground at x = 0, m ẍ + b ẋ + k x = −reaction. A negative b generates.
class MassSpringDamper : public participant::Load<1> {
 public:
  MassSpringDamper(double mass, double damping, double stiffness)
      : mass_(mass), damping_(damping), stiffness_(stiffness) {}

  [[nodiscard]] participant::LoadDynamics<1> dynamics(const participant::HandState<1>& state) const override {
    return {AxisMatrix<1>(mass_), damping_ * state.velocity + stiffness_ * state.position, 0.0};
  }
  [[nodiscard]] impedance::Model impedance(const AxisVector<1>& position) const override;

 private:
  double mass_, damping_, stiffness_;
};

/// A load of the planar handle guided along a line without friction, p = p₀ + u x: along it the load takes
///   (uᵀ Λ u) ẍ + uᵀ h
/// and the guide takes the rest.
class AlongLine : public participant::Load<1> {
 public:
  /// @param load  must outlive this   @param origin  p₀ [m]   @param angle  of u from +x [rad]
  AlongLine(participant::Load<2>& load, const Eigen::Vector2d& origin, double angle);

  void tick(double t, double sample_time, const participant::HandState<1>& state,
            const AxisVector<1>& reaction) override;
  [[nodiscard]] participant::LoadDynamics<1> dynamics(const participant::HandState<1>& state) const override;
  [[nodiscard]] impedance::Model impedance(const AxisVector<1>& position) const override;

 private:
  [[nodiscard]] participant::HandState<2> hand(const participant::HandState<1>& state) const;
  participant::Load<2>* load_;
  Eigen::Vector2d origin_, direction_;
};

}  // namespace mbk::laboratory
