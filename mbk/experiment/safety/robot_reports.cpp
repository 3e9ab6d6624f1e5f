#include "mbk/experiment/safety/robot_reports.h"

#include <algorithm>
#include <cmath>

namespace mbk::safety {
namespace {

/// How much faster the robot's clock may run than this one: a share of the time that it is looked at, and a step.
constexpr double kFasterBy = 0.02, kClockStep = 0.02;  // [1], [s]
constexpr double kRateWindow = 1.0, kSettle = 0.1;     // [s]

}  // namespace

void ReportCheck::forget() noexcept {
  *this = ReportCheck(limits_, sample_time_);
}

Violation ReportCheck::check(const device::State& state, const device::Abilities& robot, double now,
                             std::uint64_t sent) noexcept {
  if (state.fault != 0) return {Reason::robot_fault, static_cast<double>(state.fault), 0.0};
  if (state.watchdog_expired) return {Reason::robot_watchdog};
  measured_ = measured_ || state.drives_measure;
  const bool torque_missing = measured_ && !(state.drives_measure && state.drive_torque.allFinite());
  const bool force_missing = robot.has_force && !state.has_force;
  const bool accelerometer_missing = robot.has_acceleration && !state.has_acceleration;
  if (force_missing || accelerometer_missing || torque_missing) return {Reason::sensor_missing};
  if (const Violation found = check_clock(state, now, robot.keeps_time)) return found;
  return robot.acknowledges ? check_answer(state, now, sent) : Violation{};
}

Violation ReportCheck::check_clock(const device::State& state, double now, bool keeps_time) noexcept {
  if (!std::isfinite(state.time)) return {Reason::robot_clock, state.time, 0.0};
  const double step = state.time - last_, step_now = now - last_now_;
  if (begun_ && !(step > 0.0)) return {Reason::robot_clock, step, 0.0};
  const double behind = now - state.time;
  if (!begun_) {
    began_ = now;
    fastest_ = behind;
  }
  // the two clocks are compared from the state on that came fastest in the first kSettle: those of before the trial may
  // have waited for the loop to begin
  const bool settling = now - began_ < kSettle;
  if (!begun_ || (settling && behind <= window_now_ - window_) || now - window_now_ > kRateWindow) {
    window_ = state.time;
    window_now_ = now;
  }
  last_ = state.time;
  last_now_ = now;
  const bool first = !begun_;
  begun_ = true;
  if (!keeps_time || first) return {};
  if (!settling) {
    const double jump = step - step_now, max_jump = kClockStep + limits_.link_silence;
    if (jump > max_jump) return {Reason::robot_clock, jump, max_jump};
    const double ahead = (state.time - window_) - (now - window_now_);
    if (const double most = kClockStep + kFasterBy * (now - window_now_); ahead > most) {
      return {Reason::robot_clock, ahead, most};
    }
  }
  fastest_ = std::min(fastest_ + kClockDrift * step_now, behind);
  const double age = behind - fastest_;
  if (limits_.state_age > 0.0 && age > limits_.state_age) return {Reason::state_old, age, limits_.state_age};
  return {};
}

Violation ReportCheck::check_answer(const device::State& state, double now, std::uint64_t sent) noexcept {
  if (state.answered > sent || state.answered < answered_) return {Reason::answer_wrong};
  answered_ = state.answered;
  const double lag = static_cast<double>(sent - state.answered) * sample_time_;
  if (limits_.answer_lag > 0.0 && lag > limits_.answer_lag) return {Reason::answer_late, lag, limits_.answer_lag};
  const bool wrong = state.answered > 0 && state.motors == Motors::off;
  if (wrong && !motors_wrong_) motors_wrong_since_ = now;
  motors_wrong_ = wrong;
  const double wrong_for = wrong ? now - motors_wrong_since_ : 0.0;
  if (wrong_for > limits_.motors_reply) return {Reason::motors_off, wrong_for, limits_.motors_reply};
  return {};
}

}  // namespace mbk::safety
