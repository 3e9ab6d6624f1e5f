#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/robot/velocity_estimate.h"

namespace mbk::robot {

/// Effect of the hand on a robot, at the joints and at the hand. NaN if unknown.
struct ObservedForce {
  JointVector joint_torque;        ///< Jᵀ F_h [N·m, or N where a joint slides]
  HandVector force_hand_on_robot;  ///< F_h = L Jᵀ F_h, L of `hand_from_joints`, base frame [N]
};

/// The force of the hand without a force sensor and without accelerations: the momentum not explained by motors,
/// weight, friction or Coriolis torque (De Luca & Mattone, ICRA 2003, in the signs of dynamic_model.h). With the
/// momentum p = I(q) q̇ including motor inertias, ṗ = τ + Cᵀq̇ − g − d + Jᵀ F_h, and d the other drive torques,
///   r = K_I [ p(t) − p(0) − ∫₀ᵗ (τ + Cᵀq̇ − g − d + r) ds ],   so that   ṙ = K_I (Jᵀ F_h − r)
/// and r is Jᵀ F_h after a causal first-order low-pass with delay 1/K_I.
///
/// In discrete time the recorded torque is held from one sample to the next, as motors are driven, after the delay of
/// the model; Cᵀq̇ − g − d is integrated with the trapezoidal rule; and Jᵀ F_h is assumed constant over a tick:
///   r_k = a r_{k−1} + (1 − a) s_k/T,   a = e^{−K_I T},
///   s_k = p_k − p_{k−1} − T τ̄ − ½T (b_{k−1} + b_k),   b = Cᵀq̇ − g − d
/// A constant force is estimated exactly, any smooth one with an error of order T²; it is stable for every gain.
class MomentumObserver {
 public:
  static constexpr double kLongestDelay = 1.0;  ///< of the motors [s]

  /// @param gain  K_I [1/s]    @param sample_time  T [s]
  /// @fails  usage: K_I or T is not above zero; data: the numbers of parameters and coefficients of the model differ,
  /// or its delay is negative (a torque that acts before it is recorded is unknown in time) or above kLongestDelay.
  [[nodiscard]] static Result<MomentumObserver> create(const DynamicModel& model, double gain, double sample_time);

  /// The next sample. The first returns r = 0. A non-finite one gives NaN and restarts the observer; in a singular
  /// posture only the force at the hand is NaN. Allocates only if the mechanism does.
  /// @param position, velocity  q [rad or m], q̇ [rad/s or m/s]
  /// @param torque  τ, of the motors from this sample to the next [N·m, or N where a joint slides]
  const ObservedForce& step(const JointVector& position, const JointVector& velocity,
                            const JointVector& torque) noexcept;

  /// Delay of slow forces: a T/(1 − a) + T/2 [s], which is 1/K_I + K_I T²/12
  [[nodiscard]] double lag() const;

 private:
  MomentumObserver(const DynamicModel& model, double gain, double sample_time);
  JointVector mean_torque(const JointVector& torque) noexcept;

  DynamicModel model_;
  Vector phi_;
  JointVector motor_inertia_;
  double sample_time_, memory_;
  std::vector<JointVector> held_;  // the last torques, as many as the delay reaches back
  std::size_t oldest_ = 0;         // of them
  double share_of_oldest_;         // of a tick, in which it still acts
  bool started_ = false;
  JointVector momentum_, rest_;  // p and b of the last sample
  ObservedForce observed_;
};

/// The same from encoders only. The velocity comes from VelocityEstimate, which is delayed, so position and torque are
/// delayed equally, by the mean of two neighbours and the same low-pass. Otherwise accelerations and torques would
/// belong to different times. The force is therefore later by half a tick and the low-pass.
class EncoderMomentumObserver {
 public:
  struct Options {
    double gain = 60.0;            ///< K_I [1/s] > 0
    Hertz velocity_cutoff{100.0};  ///< of the low-pass after the position differences > 0
  };
  /// @fails  as MomentumObserver; usage: the cutoff is not above zero.
  [[nodiscard]] static Result<EncoderMomentumObserver> create(const DynamicModel& model, const Options& options,
                                                              double sample_time);

  /// As MomentumObserver::step.
  const ObservedForce& step(const JointVector& position, const JointVector& torque) noexcept;

  /// Delay of slow forces [s]: close to 1/K_I + 1/(2π f_c), 18.3 ms by default.
  [[nodiscard]] double lag() const;

 private:
  EncoderMomentumObserver(MomentumObserver observer, const VelocityEstimate& velocity, double sample_time)
      : observer_(std::move(observer)), velocity_(velocity), sample_time_(sample_time) {}

  MomentumObserver observer_;
  VelocityEstimate velocity_;
  double sample_time_;
  bool started_ = false;
  JointVector last_position_, last_torque_, late_position_, late_torque_;
};

}  // namespace mbk::robot
