#pragma once

#include <array>
#include <cstdint>

#include "mbk/experiment/control/laws.h"
#include "mbk/experiment/control/way_prediction.h"
#include "mbk/model/perturbation/reach_schedule.h"

namespace mbk::control {

/// Leaves a hand that reaches free, τ = 0, until it passes the trigger; from there on, in the reaches that the schedule
/// displaces, holds it to its predicted way plus the displacement d(t), by the joint position control,
///   θ_r(t) = θ(x(0) + x̂(t) + d(t))
/// and lets it go (Burdet, Osu, Franklin, Yoshioka, Milner & Kawato 2000). It learns the prediction from the
/// undisturbed reaches of the same trial. A reach counts from rest at home to the trigger; slower than kMaxApproach or
/// farther from the line to the target than kMaxAside it is none. Where the prediction is not to be trusted (the reach
/// is unlike all others, or its way would leave the joints' limits) the hand is left alone, and the displacement waits
/// for the next reach. After `create` nothing allocates.
class ReachServo {
 public:
  static constexpr double kHomeRadius = 0.02;  ///< the hand is at home within it [m]
  static constexpr double kRest = 0.2;         ///< that long at home before a reach [s]: the past of the prediction
  static constexpr double kMaxApproach = 0.8;  ///< from leaving home to the trigger [s]
  static constexpr double kMaxAside = 0.06;    ///< from the line to the target, at the trigger [m]
  static constexpr double kRelease = 0.05;     ///< time in which the servo lets go [s]
  static constexpr double kMaxLeverage = 1.0;  ///< of a prediction (WayPrediction::Way::leverage)

  /// @param home  where reaches begin [m], base frame   @param sample_time  [s] > 0, of which WayPrediction::kStep is a
  /// multiple
  /// @fails  usage: a displacement lasts longer than what is predicted; home or the target is out of reach; another
  ///         sample time; as JointPositionControl.
  [[nodiscard]] static Result<ReachServo> create(const JointPositionControl::Gains& gains,
                                                 const perturbation::ReachSchedule& schedule,
                                                 const robot::Geometry& geometry, const Vector2d& home,
                                                 double sample_time);

  /// τ [N·m] of the next tick.   @param measured  θ [rad]
  Vector2d step(const Vector2d& measured) noexcept;

  /// Whether the hand passed the trigger at this tick.
  [[nodiscard]] bool triggered() const noexcept { return triggered_; }
  /// Whether the joints are to be at joint_reference().
  [[nodiscard]] bool following() const noexcept { return phase_ == Phase::displacing; }
  /// Whether the displacement is held at its full size.
  [[nodiscard]] bool holding() const noexcept { return holding_; }
  /// d(t), from the predicted way, base frame [m]; zero where the hand is free.
  [[nodiscard]] const Vector2d& displacement() const noexcept { return displacement_; }
  [[nodiscard]] const Vector2d& joint_reference() const noexcept { return angles_; }  ///< θ_r [rad]

 private:
  enum class Phase : std::uint8_t { away, at_home, leaving, watching, displacing, releasing };
  static constexpr std::size_t kHistory = 2048;  // ticks

  ReachServo(const perturbation::ReachSchedule& schedule, const robot::Geometry& geometry, const Vector2d& home,
             JointPositionControl law, double sample_time);
  [[nodiscard]] std::int64_t ticks_in(double seconds) const noexcept;
  [[nodiscard]] Vector2d past_place(double seconds) const noexcept;
  [[nodiscard]] bool passes() const noexcept;
  [[nodiscard]] bool stays_within_limits(const WayPrediction::Way& way, const Vector2d& direction) const noexcept;
  void enter(Phase phase) noexcept;
  void wait_for_reach() noexcept;
  void trigger() noexcept;
  void watch() noexcept;
  void hold_to(double t) noexcept;

  perturbation::ReachSchedule schedule_;
  robot::Geometry geometry_;
  Vector2d home_, towards_;  // towards_: unit vector to the target
  JointPositionControl law_;
  double sample_time_;
  WayPrediction prediction_;
  WayPrediction::Way way_;
  WayPrediction::Past past_;
  WayPrediction::Future future_;
  std::array<Vector2d, kHistory> places_;  // the last ones, a ring
  std::int64_t tick_ = -1, ticks_ = 0;     // in all, since the phase began
  std::size_t next_ = 0;                   // reach
  Phase phase_ = Phase::away;
  bool triggered_ = false, holding_ = false;
  Vector2d hand_, origin_;  // now, and at the trigger
  Vector2d direction_ = {0.0, 0.0}, displacement_ = {0.0, 0.0}, angles_, rates_ = {0.0, 0.0};
};

}  // namespace mbk::control
