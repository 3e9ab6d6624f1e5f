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

Violation ReportCheck::check(const RobotReport& report, double now, bool keeps_time, std::uint64_t sent) noexcept {
  if (report.fault != 0) return {Reason::robot_fault, static_cast<double>(report.fault), 0.0};
  if (report.watchdog_expired) return {Reason::robot_watchdog};
  measured_ = measured_ || report.drives_measure;
  const bool torque_missing = measured_ && !(report.drives_measure && report.drive_torque.allFinite());
  if (!report.force_sensor || !report.accelerometer || torque_missing) return {Reason::sensor_missing};
  if (const Violation found = check_clock(report, now, keeps_time)) return found;
  return report.acknowledges ? check_answer(report, now, sent) : Violation{};
}

Violation ReportCheck::check_clock(const RobotReport& report, double now, bool keeps_time) noexcept {
  if (!std::isfinite(report.time)) return {Reason::robot_clock, report.time, 0.0};
  const double step = report.time - last_, step_now = now - last_now_;
  if (begun_ && !(step > 0.0)) return {Reason::robot_clock, step, 0.0};
  const double behind = now - report.time;
  if (!begun_) {
    began_ = now;
    fastest_ = behind;
  }
  // the two clocks are compared from the state on that came fastest in the first kSettle: those of before the trial may
  // have waited for the loop to begin
  const bool settling = now - began_ < kSettle;
  if (!begun_ || (settling && behind <= window_now_ - window_) || now - window_now_ > kRateWindow) {
    window_ = report.time;
    window_now_ = now;
  }
  last_ = report.time;
  last_now_ = now;
  const bool first = !begun_;
  begun_ = true;
  if (!keeps_time || first) return {};
  if (!settling) {
    const double jump = step - step_now, max_jump = kClockStep + limits_.link_silence;
    if (jump > max_jump) return {Reason::robot_clock, jump, max_jump};
    const double ahead = (report.time - window_) - (now - window_now_);
    if (const double most = kClockStep + kFasterBy * (now - window_now_); ahead > most) {
      return {Reason::robot_clock, ahead, most};
    }
  }
  fastest_ = std::min(fastest_ + kClockDrift * step_now, behind);
  const double age = behind - fastest_;
  if (limits_.state_age > 0.0 && age > limits_.state_age) return {Reason::state_old, age, limits_.state_age};
  return {};
}

Violation ReportCheck::check_answer(const RobotReport& report, double now, std::uint64_t sent) noexcept {
  if (report.answered > sent || report.answered < answered_) return {Reason::answer_wrong};
  answered_ = report.answered;
  const double lag = static_cast<double>(sent - report.answered) * sample_time_;
  if (limits_.answer_lag > 0.0 && lag > limits_.answer_lag) return {Reason::answer_late, lag, limits_.answer_lag};
  const bool wrong = report.answered > 0 && report.motors == Motors::off;
  if (wrong && !motors_wrong_) motors_wrong_since_ = now;
  motors_wrong_ = wrong;
  const double wrong_for = wrong ? now - motors_wrong_since_ : 0.0;
  if (wrong_for > limits_.motors_reply) return {Reason::motors_off, wrong_for, limits_.motors_reply};
  return {};
}

}  // namespace mbk::safety
