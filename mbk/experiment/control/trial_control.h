#pragma once

#include <variant>

#include "mbk/base/core/result.h"
#include "mbk/experiment/control/laws.h"
#include "mbk/experiment/control/reach_servo.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::control {

/// The joints follow a reference; the schedule commands positions. In a schedule of reaches they follow it where the
/// hand is displaced, and are free where it is not.
struct PositionMode {
  JointPositionControl::Gains gains;
};

/// The motors exert a force, open loop; the schedule commands forces.
struct ForceMode {};

/// Force along one line, held on it; the schedule commands forces. The line goes through home.
struct LineMode {
  LineConstraint::Options line;
};

using Mode = std::variant<PositionMode, ForceMode, LineMode>;

/// One control law with the schedule behind it: from measured angles to torques, and what is recorded as reference.
/// After `create` nothing allocates.
class TrialControl {
 public:
  /// @param home  about which the schedule perturbs [m], base frame
  /// @param sample_time  [s] > 0
  /// @fails  usage: mode and schedule speak of different quantities; the schedule is of torques, or leaves the
  ///         workspace; home is out of reach; as the control laws.
  [[nodiscard]] static Result<TrialControl> create(const Mode& mode, const perturbation::Schedule& schedule,
                                                   const robot::Geometry& geometry, const Vector2d& home,
                                                   double sample_time);

  /// τ [N·m] at the time t of the schedule [s].
  [[nodiscard]] Vector2d torque(double t, const Vector2d& measured) noexcept;

  /// What stands in the recording: the hand's place behind a position, or the force [m or N]. In a schedule of reaches
  /// the displacement from the predicted way at the last tick [m].
  [[nodiscard]] Vector2d reference(double t) const noexcept;

  /// Where the schedule wants the hand at t [m], or expects it in a reach; home where it commands a force.
  [[nodiscard]] Vector2d place(double t) const noexcept;

  /// The angles that the law last held the joints to [rad]; home's where it does not follow a position.
  [[nodiscard]] const Vector2d& joint_reference() const { return angles_; }

  /// Whether the joints follow a position throughout.
  [[nodiscard]] bool follows_position() const { return std::holds_alternative<JointPositionControl>(law_); }

  /// Whether the last torque held them to joint_reference().
  [[nodiscard]] bool following() const noexcept {
    return reaches() != nullptr ? reaches()->following() : follows_position();
  }

  /// What displaces a hand that reaches; null if the schedule has no reaches.
  [[nodiscard]] const ReachServo* reaches() const noexcept { return std::get_if<ReachServo>(&law_); }
  [[nodiscard]] const perturbation::Schedule& schedule() const { return schedule_; }
  [[nodiscard]] const Vector2d& home_angles() const { return home_angles_; }  ///< [rad]

 private:
  TrialControl(const perturbation::Schedule& schedule, const robot::Geometry& geometry, const Vector2d& home,
               const Vector2d& home_angles);
  [[nodiscard]] Vector2d displaced(const Vector2d& displacement) const;

  perturbation::Schedule schedule_;
  robot::Geometry geometry_;
  Vector2d home_, home_angles_, angles_;
  std::variant<ForceControl, JointPositionControl, LineConstraint, ReachServo> law_;
};

}  // namespace mbk::control
