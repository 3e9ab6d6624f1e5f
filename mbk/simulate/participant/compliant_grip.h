#pragma once

#include "mbk/simulate/participant/arm.h"

namespace mbk::participant {

/// Firmness of the grip.
struct GripOptions {
  double stiffness = 0.0;      ///< k_g [N/m] > 0, the same in all directions
  double damping_ratio = 0.1;  ///< ζ ≥ 0, of the arm's mean inertia on k_g
};

/// An arm with a compliant grip: handle and hand have different positions, and the force measured at the handle is
///   F_h = k_g (x_a − x) + d_g (ẋ_a − ẋ),   M ẍ_a + h(x_a, ẋ_a) = −F_h
/// The hand motion is integrated over each tick in small steps along that of the handle; between ticks the force
/// corresponds to the hand position in the middle of the tick. Decisions of the arm use its own motion.
class CompliantGrip : public Load<2> {
 public:
  /// @fails  usage: the stiffness is not above zero, the damping ratio below zero, or a number not finite.
  [[nodiscard]] static Result<CompliantGrip> create(const GripOptions& options, Arm arm);

  void tick(double t, double sample_time, const HandState<2>& handle, const Vector2d& force_on_robot) override;
  [[nodiscard]] LoadDynamics<2> dynamics(const HandState<2>& handle) const override;
  [[nodiscard]] impedance::Model impedance(const Vector2d& hand) const override { return arm_.impedance(hand); }

 private:
  CompliantGrip(const GripOptions& options, Arm arm) : options_(options), arm_(std::move(arm)) {}
  [[nodiscard]] Vector2d force_on_hand(const HandState<2>& handle, const HandState<2>& hand) const;
  void move(HandState<2>& hand, const HandState<2>& from, const HandState<2>& to, double duration) const;

  GripOptions options_;
  Arm arm_;
  HandState<2> handle_, hand_, middle_;  // at the last tick, and of the hand half a tick later
  double damping_ = 0.0;
  bool begun_ = false;
};

}  // namespace mbk::participant
