#include "mbk/experiment/control/sequencer.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::control {
namespace {

/// Largest speed of a minimum-jerk move of unit length in unit time.
constexpr double kPeakSpeed = 1.875;

/// Time in which the joints come to rest from the perturbation's motion [s]; the way back may take much longer.
constexpr double kBrake = 0.2;

/// From 0 to 1, with rest at both ends.
double smooth(double share) noexcept {
  const double s = std::clamp(share, 0.0, 1.0);
  return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

perturbation::MinimumJerk straight(double from, double to, double duration) {
  return {{from, 0.0, 0.0}, {to, 0.0, 0.0}, duration};
}

}  // namespace

Sequencer::Sequencer(const TrialControl& trial, const SequenceOptions& options, const robot::Geometry& geometry,
                     JointPositionControl hold, double sample_time)
    : trial_(trial),
      options_(options),
      geometry_(geometry),
      hold_(hold),
      sample_time_(sample_time),
      move_{straight(0.0, 0.0, 1.0), straight(0.0, 0.0, 1.0)},
      brake_(move_) {}

Result<Sequencer> Sequencer::create(const TrialControl& trial, const SequenceOptions& options,
                                    const robot::Geometry& geometry, double sample_time) {
  if (auto ok = above_zero({{"soft start", options.soft_start, "s"},
                            {"move speed", options.move_speed, "m/s"},
                            {"shortest move", options.shortest_move, "s"},
                            {"handover", options.handover, "s"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  MBK_TRY(not_negative({{"settling time", options.settle, "s"}}));
  constexpr double kLongest = 3600.0, kFarthest = 1.0;  // [s], [m]
  for (const Choice& time : {Choice{"soft start", options.soft_start, "s"},
                             {"shortest move", options.shortest_move, "s"},
                             {"settling time", options.settle, "s"},
                             {"handover", options.handover, "s"},
                             {"a move of 1 m at that speed", kPeakSpeed * kFarthest / options.move_speed, "s"}}) {
    if (time.value > kLongest) return bad_usage(fmt::format("{} is longer than {:g} s", time.text(), kLongest));
  }
  auto hold = MBK_TRY(JointPositionControl::create(options.hold, sample_time));
  return Sequencer(trial, options, geometry, hold, sample_time);
}

double Sequencer::move_duration(double distance) const {
  return std::max(options_.shortest_move, kPeakSpeed * distance / options_.move_speed);
}

double Sequencer::duration(double distance) const {
  return 2.0 * options_.soft_start + move_duration(distance) + options_.settle + trial_.schedule().duration() +
         options_.shortest_move;
}

void Sequencer::plan_move(const Vector2d& measured) noexcept {
  const Vector2d target = trial_.home_angles();
  const Vector2d distance = robot::hand_position(geometry_, target) - robot::hand_position(geometry_, measured);
  move_duration_ = move_duration(distance.norm());
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double rolled = 0.5 * kBrake * held_rate_[i];
    move_[static_cast<std::size_t>(i)] = straight(held_[i] + rolled, target[i], move_duration_);
    brake_[static_cast<std::size_t>(i)] = {{-rolled, held_rate_[i], 0.0}, {0.0, 0.0, 0.0}, kBrake};
  }
}

void Sequencer::enter(Phase phase, const Vector2d& measured) noexcept {
  phase_ = phase;
  ticks_ = 0;
  switch (phase) {
    case Phase::starting:
      held_ = measured;
      held_rate_.setZero();
      break;
    case Phase::moving:
      plan_move(measured);
      break;
    case Phase::returning:
      grip_again_ = !trial_.follows_position();
      if (grip_again_) {
        held_ = measured;
        held_rate_.setZero();
      }
      plan_move(measured);
      break;
    default:
      held_rate_.setZero();
  }
}

double Sequencer::phase_duration() const {
  switch (phase_) {
    case Phase::starting:
    case Phase::stopping:
      return options_.soft_start;
    case Phase::moving:
    case Phase::returning:
      return move_duration_;
    case Phase::settling:
      return options_.settle;
    case Phase::perturbing:
      return trial_.schedule().duration();
    case Phase::done:
      break;
  }
  return HUGE_VAL;
}

void Sequencer::hold_along(double t) noexcept {
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto moved = move_[static_cast<std::size_t>(i)].at(t), braked = brake_[static_cast<std::size_t>(i)].at(t);
    held_[i] = moved.value + braked.value;
    held_rate_[i] = moved.first + braked.first;
  }
}

Sequencer::Step Sequencer::step(const Vector2d& measured) noexcept {
  if (!found_) {
    found_ = true;
    enter(Phase::starting, measured);
  }
  if (ending_ && phase_ < Phase::returning) {
    ending_ = false;
    enter(phase_ == Phase::perturbing ? Phase::returning : Phase::stopping, measured);
  }
  while (phase_ != Phase::done && ticks_ >= static_cast<std::int64_t>(std::llround(phase_duration() / sample_time_))) {
    enter(static_cast<Phase>(static_cast<int>(phase_) + 1), measured);
  }
  const double t = static_cast<double>(ticks_++) * sample_time_;
  if (phase_ == Phase::moving || phase_ == Phase::returning) hold_along(t);
  const Vector2d holding = hold_.step(measured, held_, held_rate_);

  Step step;
  step.phase = phase_;
  step.joint_reference = held_;
  if (trial_.follows_position()) step.reference = robot::hand_position(geometry_, held_);
  step.follows = phase_ != Phase::done;
  switch (phase_) {
    case Phase::starting:
      step.torque = smooth(t / options_.soft_start) * holding;
      break;
    case Phase::stopping:
      step.torque = smooth(1.0 - t / options_.soft_start) * holding;
      break;
    case Phase::moving:
    case Phase::settling:
      step.torque = holding;
      break;
    case Phase::returning:
      step.torque = (grip_again_ ? smooth(t / options_.handover) : 1.0) * holding;
      break;
    case Phase::perturbing: {
      step.perturbation_time = t;
      const Vector2d torque = trial_.torque(t, measured);
      step.follows = trial_.following();
      step.triggered = trial_.reaches() != nullptr && trial_.reaches()->triggered();
      step.joint_reference = trial_.joint_reference();
      step.reference = trial_.reference(t);
      const double share = trial_.follows_position() ? 1.0 : smooth(t / options_.handover);
      step.torque = share * torque + (1.0 - share) * holding;
      if (trial_.follows_position()) {
        held_rate_ = (step.joint_reference - held_) / sample_time_;
        held_ = step.joint_reference;
      }
      break;
    }
    case Phase::done:
      break;
  }
  return step;
}

}  // namespace mbk::control
