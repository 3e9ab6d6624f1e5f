#include "mbk/experiment/safety/gate.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mbk/base/core/option_limits.h"
#include "mbk/model/robot/workspace.h"

namespace mbk::safety {
namespace {

constexpr double kHistory = 2.0;  // [s]

/// Least |det J| with which a torque is turned into a force: a quarter of a percent of d₁d₂ is out of reach anyway.
constexpr double kMinDeterminant = 1e-4;

/// What encoders and accelerometer say is also compared over a longer time, against how much the hand moves at all:
///   rms(encoders' − accelerometer's) ≤ kShare rms(accelerometer's) + kFloor limit,
/// the mean taken over kMeanTime. So an encoder that counts backwards is found in motions far below the limit.
constexpr double kMeanTime = 0.5, kShare = 0.5, kFloor = 0.05;  // [s], [1], [1]

/// Of the time that the controller was cut, so much is forgiven for each tick that it is not.
constexpr double kForgiven = 0.25;

/// Over so long the torque that the motion shows is averaged before it is held against the command [s].
constexpr double kTorqueTime = 0.1;
/// For so long the drives may measure another torque than that of the last commands that they had [s].
constexpr double kDrivesTime = 0.05;
constexpr std::uint64_t kDrivesCommands = 4;

/// A gap between states behind which checks of motion begin anew [ticks].
constexpr double kGapTicks = 8.0;

/// Whether encoders or force sensor caused the trip, so that they cannot confirm the motors off either.
bool distrusts_sensors(Reason reason) noexcept {
  switch (reason) {
    case Reason::encoder_not_finite:
    case Reason::force_not_finite:
    case Reason::encoder_jump:
    case Reason::force_jump:
    case Reason::encoder_frozen:
    case Reason::force_frozen:
    case Reason::accelerometer_disagrees:
    case Reason::measured_force:
    case Reason::sensor_missing:
      return true;
    default:
      return false;
  }
}

}  // namespace

Gate::Gate(const Limits& limits, const robot::PlanarRobot& robot, const Vector2d& home, double sample_time)
    : limits_(limits),
      robot_(robot),
      home_(home),
      sample_time_(sample_time),
      reports_(limits, sample_time),
      history_(static_cast<std::size_t>(std::max(1.0, std::round(kHistory / sample_time)))) {
  told_.fill(Vector2d::Zero());  // before the first command nothing is told
}

Result<Gate> Gate::create(const Limits& limits, const robot::PlanarRobot& robot, const Vector2d& home,
                          double sample_time) {
  MBK_TRY(safety::check(limits));
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}}));
  return Gate(limits, robot, home, sample_time);
}

void Gate::Stillness::see(const Vector2d& value) noexcept {
  ticks = begun && value == last ? ticks + 1 : 0;
  last = value;
  begun = true;
}

void Gate::forget() noexcept {
  sent_.setZero();
  cut_for_ = 0.0;
  seen_before_ = false;
  force_still_ = acceleration_still_ = {};
  encoder_still_ = {0, 0};
  reports_.forget();
  motion_.forget();
  disagreement_ = liveliness_ = 0.0;
  unexplained_.setZero();
  drives_wrong_ = 0.0;
  motors_ = {};
  released_ = false;
}

void Gate::see_idle(bool stop_button, bool confirmed_off) noexcept {
  stop_pressed_ = stop_button;
  if (confirmed_off && motors_.state == MotorsOff::State::missing) motors_.state = MotorsOff::State::confirmed;
}

Result<void> Gate::reset() {
  if (!tripped()) return {};
  if (ramp_left_ > 0) return bad_usage("the motors are still being ramped down", "reset a moment later");
  if (stop_pressed_) return bad_usage("the stop button is still pressed", "release it, then reset");
  if (motors_.state == MotorsOff::State::missing) {
    return bad_usage("the robot still does not confirm that its motors are off",
                     "cut the motors' power with the hardware stop button, check the robot, then start mbk again");
  }
  trip_ = {};
  forget();
  return {};
}

std::vector<Gate::Moment> Gate::history() const {
  std::vector<Moment> moments;
  moments.reserve(moments_);
  for (std::size_t i = 0; i < moments_; ++i) {
    moments.push_back(history_[(next_moment_ + history_.size() - moments_ + i) % history_.size()]);
  }
  return moments;
}

void Gate::trip(Reason reason, const Observation& seen, double value, double limit) noexcept {
  trip_ = {reason, seen.time, ticks_, value, limit};
  ramp_from_ = sent_;
  ramp_left_ = kRampTicks;
}

bool Gate::beyond(Reason reason, const Observation& seen, double value, double limit) noexcept {
  if (value <= limit) return false;
  trip(reason, seen, value, limit);
  return true;
}

const Vector2d& Gate::told(std::uint64_t command) const noexcept {
  return told_[static_cast<std::size_t>(command % kTold)];
}

Gate::Decision Gate::step(const Observation& seen, const Vector2d& asked) noexcept {
  ++ticks_;
  stop_pressed_ = seen.state.stop;
  if (!off() && !tripped()) check(seen, asked);
  Decision decision;
  if (released_ && !tripped()) {
    confirm_off(seen);
  } else if (!tripped()) {
    decision.torque = cut(asked, decision.cut);
    decision.enabled = true;
    // not reset by a tick that is not cut: a controller that swings between its limits asks for little in between
    cut_for_ = std::max(0.0, cut_for_ + (decision.cut ? 1.0 : -kForgiven) * sample_time_);
    beyond(Reason::limited_too_long, seen, cut_for_, limits_.max_saturation_time);
  } else if (off()) {
    confirm_off(seen);
  }
  if (tripped()) {
    if (ramp_left_ > 0) --ramp_left_;
    decision.torque = ramp_from_ * (static_cast<double>(ramp_left_) / kRampTicks);
    decision.enabled = ramp_left_ > 0;
  }
  if (!decision.enabled && motors_.state == MotorsOff::State::not_asked) {
    motors_.state = MotorsOff::State::waiting;
    off_command_ = ticks_;
    off_at_ = seen.time;
    motion_.forget();
  }
  sent_ = decision.torque;
  told_[static_cast<std::size_t>(ticks_ % kTold)] = decision.torque;
  history_[next_moment_] = {seen, asked, decision};
  next_moment_ = (next_moment_ + 1) % history_.size();
  moments_ = std::min(moments_ + 1, history_.size());
  return decision;
}

void Gate::check(const Observation& seen, const Vector2d& asked) noexcept {
  if (seen.state.stop) return trip(Reason::stop_button, seen);
  if (seen.operator_stop) return trip(Reason::operator_stop, seen);
  if (seen.fresh) fresh_at_ = seen.time;
  const double silent = seen.time - fresh_at_;
  if (!seen.link || silent > limits_.link_silence + 0.5 * sample_time_) {
    return trip(Reason::link_lost, seen, silent, limits_.link_silence);
  }
  const bool may_be_late = !seen.robot.keeps_time || limits_.lateness == 0.0;  // a robot may wait for its commands
  if (!may_be_late && beyond(Reason::late, seen, seen.late, limits_.lateness)) return;
  if (!seen.recording) return trip(Reason::recording_failed, seen);
  if (seen.fresh) {
    if (const Violation found = reports_.check(seen.state, seen.robot, seen.time, ticks_ - 1)) {
      return trip(found.reason, seen, found.value, found.limit);
    }
    step_ = seen_before_ ? seen.state.time - stamp_ : 0.0;
    if (!check_readings(seen)) return;
  }
  if (!asked.allFinite()) return trip(Reason::controller_not_finite, seen);
  if (seen.fresh && check_stillness(seen, asked) && check_drives(seen)) check_motion(seen);
}

bool Gate::check_readings(const Observation& seen) noexcept {
  if (!seen.state.joint.allFinite()) return trip(Reason::encoder_not_finite, seen), false;
  if (seen.robot.has_force && !seen.state.force.allFinite()) return trip(Reason::force_not_finite, seen), false;
  if (seen.robot.has_acceleration && !seen.state.acceleration.allFinite()) {
    return trip(Reason::accelerometer_not_finite, seen), false;
  }
  if (seen_before_) {
    // where states between were lost, a joint may have turned as far as the hand's speed allows
    const double lost = std::max(0.0, step_ - 1.5 * sample_time_);
    const double fastest = 2.0 * limits_.speed / std::min(robot_.geometry.d1, robot_.geometry.d2);
    const double turned = (seen.state.joint - joint_).cwiseAbs().maxCoeff();
    if (beyond(Reason::encoder_jump, seen, turned, limits_.encoder_jump + fastest * lost)) return false;
    const double most = limits_.force_jump * std::max(1.0, std::round(step_ / sample_time_));
    if (seen.robot.has_force && beyond(Reason::force_jump, seen, (seen.state.force - force_).norm(), most))
      return false;
  }
  return !(seen.robot.has_force &&
           beyond(Reason::measured_force, seen, seen.state.force.norm(), limits_.measured_force));
}

bool Gate::check_stillness(const Observation& seen, const Vector2d& asked) noexcept {
  for (Eigen::Index i = 0; i < 2; ++i) {
    int& ticks = encoder_still_[static_cast<std::size_t>(i)];
    if (!seen_before_ || seen.state.joint[i] != joint_[i]) {
      ticks = 0;
      torque_low_[i] = torque_high_[i] = asked[i];
    } else {
      ++ticks;
      torque_low_[i] = std::min(torque_low_[i], asked[i]);
      torque_high_[i] = std::max(torque_high_[i], asked[i]);
    }
  }
  joint_ = seen.state.joint;
  force_ = seen.state.force;
  seen_before_ = true;
  if (seen.robot.has_force) force_still_.see(seen.state.force);
  if (seen.robot.has_acceleration) acceleration_still_.see(seen.state.acceleration);
  if (limits_.frozen_sensor == 0.0) return true;
  for (Eigen::Index i = 0; i < 2; ++i) {
    if (torque_high_[i] - torque_low_[i] > limits_.frozen_sensor_torque &&
        beyond(Reason::encoder_frozen, seen, encoder_still_[static_cast<std::size_t>(i)] * sample_time_,
               limits_.frozen_sensor)) {
      return false;
    }
  }
  return !beyond(Reason::force_frozen, seen, force_still_.ticks * sample_time_, limits_.frozen_sensor) &&
         !beyond(Reason::accelerometer_frozen, seen, acceleration_still_.ticks * sample_time_, limits_.frozen_sensor);
}

bool Gate::add_motion(const Observation& seen, double time) noexcept {
  const double gap = time - stamp_;
  stamp_ = time;
  if (!(gap > 0.0 && gap < kGapTicks * sample_time_)) motion_.forget();
  const std::uint64_t obeyed = seen.robot.acknowledges ? seen.state.answered : ticks_ - 1;
  if (ticks_ - obeyed >= kTold) motion_.forget();  // what it was told is no longer known
  motion_.add({time, seen.state.joint, robot::hand_position(robot_.geometry, seen.state.joint), seen.state.acceleration,
               seen.state.force, told(obeyed)});
  return motion_.full();
}

bool Gate::check_motion(const Observation& seen) noexcept {
  add_motion(seen, seen.state.time);
  const Vector2d& hand = motion_.before(0).hand;
  const double margin = robot::margin(robot_.geometry.limits, seen.state.joint);
  if (margin < limits_.joint_margin) return trip(Reason::joint_margin, seen, margin, limits_.joint_margin), false;
  const double outside =
      std::max((limits_.workspace_low - hand).maxCoeff(), (hand - limits_.workspace_high).maxCoeff());
  if (beyond(Reason::workspace, seen, outside, 0.0)) return false;
  if (seen.perturbing && limits_.excursion > 0.0 &&
      beyond(Reason::excursion, seen, (hand - home_).norm(), limits_.excursion)) {
    return false;
  }
  if (seen.follows && beyond(Reason::tracking, seen, (seen.joint_reference - seen.state.joint).cwiseAbs().maxCoeff(),
                             limits_.tracking)) {
    return false;
  }
  if (motion_.half() && beyond(Reason::speed, seen, motion_.speed(), limits_.speed)) return false;
  if (!motion_.full()) return true;
  const MotionWindow::Means means = motion_.means();
  if (beyond(Reason::acceleration, seen, means.hand_acceleration.norm(), limits_.acceleration)) return false;
  return check_accelerometer(seen, means) && check_torque(seen, means);
}

bool Gate::check_accelerometer(const Observation& seen, const MotionWindow::Means& means) noexcept {
  if (!seen.robot.has_acceleration || limits_.accelerometer == 0.0) return true;
  const Vector2d difference = means.hand_acceleration - means.acceleration;
  if (beyond(Reason::accelerometer_disagrees, seen, difference.norm(), limits_.accelerometer)) return false;
  const double weight = std::min(1.0, step_ / kMeanTime);
  disagreement_ += weight * (difference.squaredNorm() - disagreement_);
  liveliness_ += weight * (means.acceleration.squaredNorm() - liveliness_);
  return !beyond(Reason::accelerometer_disagrees, seen, std::sqrt(disagreement_),
                 kShare * std::sqrt(liveliness_) + kFloor * limits_.accelerometer);
}

Vector2d Gate::torque_shown(const MotionWindow::Means& means) const noexcept {
  const Vector2d& joint = motion_.before(MotionWindow::kHalf).joint;
  return robot_.motor_torque(joint, means.joint_rate, means.joint_acceleration, means.force);
}

bool Gate::check_torque(const Observation& seen, const MotionWindow::Means& means) noexcept {
  if (!seen.robot.has_force || limits_.torque_error == 0.0) return true;
  unexplained_ += std::min(1.0, step_ / kTorqueTime) * (torque_shown(means) - means.torque - unexplained_);
  return !beyond(Reason::torque_disagrees, seen, unexplained_.cwiseAbs().maxCoeff(), limits_.torque_error);
}

bool Gate::check_drives(const Observation& seen) noexcept {
  const device::State& state = seen.state;
  if (!state.drives_measure || limits_.torque_error == 0.0) return true;
  Vector2d low = told(state.answered), high = low;
  for (std::uint64_t k = 1; k <= std::min(kDrivesCommands, state.answered); ++k) {
    low = low.cwiseMin(told(state.answered - k));
    high = high.cwiseMax(told(state.answered - k));
  }
  const double beside = (low - state.drive_torque).cwiseMax(state.drive_torque - high).maxCoeff();
  drives_wrong_ = beside > limits_.torque_error ? drives_wrong_ + step_ : 0.0;
  if (drives_wrong_ <= kDrivesTime) return true;
  return trip(Reason::torque_disagrees, seen, beside, limits_.torque_error), false;
}

MotorsOff::Why Gate::missing_for_off(const Observation& seen) noexcept {
  using Why = MotorsOff::Why;
  const device::State& state = seen.state;
  if (!seen.link || !seen.fresh) return Why::no_state;
  if (state.answered < off_command_ || state.answered >= ticks_) return Why::not_answered;
  if (state.motors != Motors::off) return Why::flag;
  motors_.torque = state.drives_measure ? state.drive_torque.cwiseAbs().maxCoeff() : 0.0;
  if (state.drives_measure && !(motors_.torque <= limits_.off_torque)) return Why::drives;
  motors_.by_motion = limits_.torque_error > 0.0 && seen.robot.has_force && !distrusts_sensors(trip_.reason);
  motors_.limit = limits_.torque_error;
  if (!motors_.by_motion) return Why::nothing;
  if (!seen.state.joint.allFinite() || !seen.state.force.allFinite()) return Why::motion;
  const double time = state.time > stamp_ ? state.time : stamp_ + sample_time_;
  if (!add_motion(seen, time)) return Why::motion;
  motors_.torque = torque_shown(motion_.means()).cwiseAbs().maxCoeff();
  return motors_.torque <= limits_.torque_error ? Why::nothing : Why::motion;
}

void Gate::confirm_off(const Observation& seen) noexcept {
  if (motors_.state != MotorsOff::State::waiting) return;
  motors_.after = seen.time - off_at_;
  if (!seen.robot.acknowledges) {
    motors_.state = MotorsOff::State::cannot_say;
    return;
  }
  const MotorsOff::Why why = missing_for_off(seen);
  if (why != MotorsOff::Why::no_state || motors_.why == MotorsOff::Why::nothing) motors_.why = why;
  if (why == MotorsOff::Why::nothing) {
    motors_.state = MotorsOff::State::confirmed;
  } else if (motors_.after > limits_.motors_off) {
    motors_.state = MotorsOff::State::missing;
    if (!tripped()) {
      trip(Reason::motors_on, seen);
      ramp_from_.setZero();
      ramp_left_ = 0;
    }
  }
}

Vector2d Gate::cut(const Vector2d& asked, bool& was_cut) const noexcept {
  Vector2d torque = asked.cwiseMax(-limits_.joint_torque).cwiseMin(limits_.joint_torque);
  const double step = limits_.torque_rate * sample_time_;
  torque = torque.cwiseMax(sent_ - Vector2d::Constant(step)).cwiseMin(sent_ + Vector2d::Constant(step));
  const Eigen::Matrix2d jacobian = robot::jacobian(robot_.geometry, joint_);
  if (std::abs(jacobian.determinant()) > kMinDeterminant) {
    const double force = (jacobian.transpose().inverse() * torque).norm();
    if (force > limits_.handle_force) torque *= limits_.handle_force / force;
  } else {
    torque.setZero();
  }
  was_cut = !torque.isApprox(asked, 1e-12) && (torque - asked).norm() > 1e-12;
  return torque;
}

}  // namespace mbk::safety
