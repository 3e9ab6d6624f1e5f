#include "mbk/experiment/control/trial_control.h"

#include <Eigen/LU>

#include "mbk/model/robot/workspace.h"

namespace mbk::control {

using perturbation::Quantity;
using perturbation::ReachSchedule;
using perturbation::Schedule;
using perturbation::Space;

TrialControl::TrialControl(const Schedule& schedule, const robot::Geometry& geometry, const Vector2d& home,
                           const Vector2d& home_angles)
    : schedule_(schedule),
      geometry_(geometry),
      home_(home),
      home_angles_(home_angles),
      angles_(home_angles),
      law_(ForceControl(geometry)) {}

Result<TrialControl> TrialControl::create(const Mode& mode, const Schedule& schedule, const robot::Geometry& geometry,
                                          const Vector2d& home, double sample_time) {
  const auto home_angles = robot::check_hand(geometry, home);
  if (!home_angles) return tl::unexpected(home_angles.error().in("home"));
  const bool position = std::holds_alternative<PositionMode>(mode);
  if (position != (schedule.quantity() == Quantity::position)) {
    return bad_usage(position ? "position control cannot follow a force perturbation"
                              : "force control cannot follow a position perturbation",
                     "use the same quantity for control and perturbation");
  }
  if (!position && schedule.space() == Space::joint) {
    return bad_usage("a perturbation of joint torques cannot be exerted at the hand", "give it as a force");
  }
  TrialControl control(schedule, geometry, home, *home_angles);
  if (const ReachSchedule* reaches = schedule.reaches()) {
    control.law_ =
        MBK_TRY(ReachServo::create(std::get<PositionMode>(mode).gains, *reaches, geometry, home, sample_time));
  } else if (const auto* follow = std::get_if<PositionMode>(&mode)) {
    control.law_ = MBK_TRY(JointPositionControl::create(follow->gains, sample_time));
    perturbation::Limits limits;
    limits.reachable = [&](const Vector2d& displacement) -> Result<void> {
      const auto reached = robot::check_hand(geometry, control.displaced(displacement));
      if (reached) return {};
      Error error = reached.error();
      error.remedy = "reduce the amplitude, or move the test location";
      return tl::unexpected(std::move(error));
    };
    if (auto ok = schedule.check(limits); !ok) return tl::unexpected(ok.error().in("perturbation"));
  } else if (const auto* along = std::get_if<LineMode>(&mode)) {
    LineConstraint::Options line = along->line;
    line.through = home;
    control.law_ = MBK_TRY(LineConstraint::create(line, geometry, sample_time));
  }
  return control;
}

Vector2d TrialControl::torque(double t, const Vector2d& measured) noexcept {
  if (auto* servo = std::get_if<ReachServo>(&law_)) {
    const Vector2d torque = servo->step(measured);
    angles_ = servo->joint_reference();
    return torque;
  }
  const perturbation::Jet<perturbation::AxesVector> now = schedule_.at(t);
  if (auto* follow = std::get_if<JointPositionControl>(&law_)) {
    if (schedule_.space() == Space::joint) {
      angles_ = home_angles_ + now.value;
      return follow->step(measured, angles_, now.first);
    }
    const auto angles = robot::joint_angles(geometry_, home_ + now.value);
    if (angles) angles_ = *angles;  // the schedule was checked to stay within reach
    return follow->step(measured, angles_, robot::jacobian(geometry_, angles_).inverse() * now.first);
  }
  if (auto* line = std::get_if<LineConstraint>(&law_)) return line->step(measured, now.value);
  return std::get<ForceControl>(law_).step(measured, now.value);
}

Vector2d TrialControl::reference(double t) const noexcept {
  if (reaches() != nullptr) return reaches()->displacement();
  const Vector2d value = schedule_.reference(t);
  return schedule_.quantity() == Quantity::force ? value : displaced(value);
}

Vector2d TrialControl::place(double t) const noexcept {
  if (schedule_.quantity() == Quantity::force) return home_;
  const Vector2d place = displaced(schedule_.at(t).value);
  return schedule_.reaches() != nullptr ? Vector2d(place + schedule_.reaches()->way(t)) : place;
}

Vector2d TrialControl::displaced(const Vector2d& displacement) const {
  return schedule_.space() == Space::hand ? Vector2d(home_ + displacement)
                                          : robot::hand_position(geometry_, home_angles_ + displacement);
}

}  // namespace mbk::control
