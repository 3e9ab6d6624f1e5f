#include "mbk/safety/gate.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mbk/core/option_limits.h"
#include "mbk/robot/workspace.h"

namespace mbk::safety {
namespace {

constexpr double kHistory = 2.0;  // [s]

/// Least |det J| with which a torque is turned into a force: a quarter of a percent of d₁d₂ is out of reach anyway.
constexpr double kLeastDeterminant = 1e-4;

/// What encoders and accelerometer say is also compared over a longer time, against how much the hand moves at all:
///   rms(encoders' − accelerometer's) ≤ kShare rms(accelerometer's) + kFloor limit,
/// the mean taken over kMeanTime. So an encoder that counts backwards is found in motions far below the limit.
constexpr double kMeanTime = 0.5, kShare = 0.5, kFloor = 0.05;  // [s], [1], [1]

/// Of the time that the controller was cut, so much is forgiven for each tick that it is not.
constexpr double kForgiven = 0.25;

}  // namespace

Gate::Gate(const Limits& limits, const robot::Geometry& geometry, const Vector2d& home, double sample_time)
    : limits_(limits),
      geometry_(geometry),
      home_(home),
      sample_time_(sample_time),
      history_(static_cast<std::size_t>(std::max(1.0, std::round(kHistory / sample_time)))) {}

Result<Gate> Gate::create(const Limits& limits, const robot::Geometry& geometry, const Vector2d& home,
                          double sample_time) {
  if (auto ok = safety::check(limits); !ok) return tl::unexpected(ok.error());
  if (auto ok = above_zero({{"sample time", sample_time, "s"}}); !ok) return tl::unexpected(ok.error());
  return Gate(limits, geometry, home, sample_time);
}

void Gate::Stillness::see(const Vector2d& value) noexcept {
  ticks = begun && value == last ? ticks + 1 : 0;
  last = value;
  begun = true;
}

void Gate::forget() noexcept {
  sent_.setZero();
  cut_for_ = 0.0;
  silent_ticks_ = 0;
  seen_before_ = false;
  force_still_ = acceleration_still_ = {};
  encoder_still_ = {0, 0};
  at_ = filled_ = 0;
  disagreement_ = liveliness_ = 0.0;
}

Result<void> Gate::reset() {
  if (!tripped()) return {};
  if (ramp_left_ > 0) return bad_usage("the motors are still being ramped down", "reset a moment later");
  if (stop_pressed_) return bad_usage("the stop button is still pressed", "release it, then reset");
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

Gate::Decision Gate::step(const Observation& seen, const Vector2d& asked) noexcept {
  ++ticks_;
  stop_pressed_ = seen.stop_button;
  if (!tripped()) check(seen, asked);
  Decision decision;
  if (!tripped()) {
    decision.torque = cut(asked, decision.cut);
    decision.enabled = true;
    // not reset by a tick that is not cut: a controller that swings between its limits asks for little in between
    cut_for_ = std::max(0.0, cut_for_ + (decision.cut ? 1.0 : -kForgiven) * sample_time_);
    beyond(Reason::limited_too_long, seen, cut_for_, limits_.limited_for);
  }
  if (tripped()) {
    if (ramp_left_ > 0) --ramp_left_;
    decision.torque = ramp_from_ * (static_cast<double>(ramp_left_) / kRampTicks);
    decision.enabled = ramp_left_ > 0;
  }
  sent_ = decision.torque;
  history_[next_moment_] = {seen, asked, decision};
  next_moment_ = (next_moment_ + 1) % history_.size();
  moments_ = std::min(moments_ + 1, history_.size());
  return decision;
}

void Gate::check(const Observation& seen, const Vector2d& asked) noexcept {
  if (seen.stop_button) return trip(Reason::stop_button, seen);
  if (seen.operator_stop) return trip(Reason::operator_stop, seen);
  silent_ticks_ = seen.fresh ? 0 : silent_ticks_ + 1;
  if (!seen.link || silent_ticks_ * sample_time_ > limits_.link_silence) {
    return trip(Reason::link_lost, seen, silent_ticks_ * sample_time_, limits_.link_silence);
  }
  if (limits_.lateness > 0.0 && beyond(Reason::late, seen, seen.late, limits_.lateness)) return;
  if (!seen.recording) return trip(Reason::recording_failed, seen);
  if (seen.fresh && !check_readings(seen)) return;
  if (!asked.allFinite()) return trip(Reason::controller_not_finite, seen);
  if (seen.fresh && check_stillness(seen, asked)) check_motion(seen);
}

bool Gate::check_readings(const Observation& seen) noexcept {
  if (!seen.joint.allFinite()) return trip(Reason::encoder_not_finite, seen), false;
  if (seen.has_force && !seen.force.allFinite()) return trip(Reason::force_not_finite, seen), false;
  if (seen.has_acceleration && !seen.acceleration.allFinite()) {
    return trip(Reason::accelerometer_not_finite, seen), false;
  }
  if (seen_before_) {
    const double turned = (seen.joint - joint_).cwiseAbs().maxCoeff();
    if (beyond(Reason::encoder_jump, seen, turned, limits_.encoder_jump)) return false;
    if (seen.has_force && beyond(Reason::force_jump, seen, (seen.force - force_).norm(), limits_.force_jump)) {
      return false;
    }
  }
  return !(seen.has_force && beyond(Reason::measured_force, seen, seen.force.norm(), limits_.measured_force));
}

bool Gate::check_stillness(const Observation& seen, const Vector2d& asked) noexcept {
  for (Eigen::Index i = 0; i < 2; ++i) {
    int& ticks = encoder_still_[static_cast<std::size_t>(i)];
    if (!seen_before_ || seen.joint[i] != joint_[i]) {
      ticks = 0;
      torque_low_[i] = torque_high_[i] = asked[i];
    } else {
      ++ticks;
      torque_low_[i] = std::min(torque_low_[i], asked[i]);
      torque_high_[i] = std::max(torque_high_[i], asked[i]);
    }
  }
  joint_ = seen.joint;
  force_ = seen.force;
  seen_before_ = true;
  if (seen.has_force) force_still_.see(seen.force);
  if (seen.has_acceleration) acceleration_still_.see(seen.acceleration);
  if (limits_.frozen == 0.0) return true;
  for (Eigen::Index i = 0; i < 2; ++i) {
    if (torque_high_[i] - torque_low_[i] > limits_.frozen_torque &&
        beyond(Reason::encoder_frozen, seen, encoder_still_[static_cast<std::size_t>(i)] * sample_time_,
               limits_.frozen)) {
      return false;
    }
  }
  return !beyond(Reason::force_frozen, seen, force_still_.ticks * sample_time_, limits_.frozen) &&
         !beyond(Reason::accelerometer_frozen, seen, acceleration_still_.ticks * sample_time_, limits_.frozen);
}

bool Gate::check_motion(const Observation& seen) noexcept {
  const Vector2d hand = robot::hand_position(geometry_, seen.joint);
  constexpr int kSize = 2 * kWindow + 1;
  at_ = (at_ + 1) % kSize;
  hand_[static_cast<std::size_t>(at_)] = hand;
  accelerometer_[static_cast<std::size_t>(at_)] = seen.acceleration;
  filled_ = std::min(filled_ + 1, kSize);
  const auto before = [&](const std::array<Vector2d, kSize>& ring, int ticks) -> const Vector2d& {
    return ring[static_cast<std::size_t>((at_ - ticks + kSize) % kSize)];
  };

  const double margin = robot::margin(geometry_.limits, seen.joint);
  if (margin < limits_.joint_margin) return trip(Reason::joint_margin, seen, margin, limits_.joint_margin), false;
  const double outside =
      std::max((limits_.workspace_low - hand).maxCoeff(), (hand - limits_.workspace_high).maxCoeff());
  if (beyond(Reason::workspace, seen, outside, 0.0)) return false;
  if (seen.perturbing && limits_.excursion > 0.0 &&
      beyond(Reason::excursion, seen, (hand - home_).norm(), limits_.excursion)) {
    return false;
  }
  if (seen.follows &&
      beyond(Reason::tracking, seen, (seen.joint_reference - seen.joint).cwiseAbs().maxCoeff(), limits_.tracking)) {
    return false;
  }
  if (filled_ > kWindow) {
    const double speed = (hand - before(hand_, kWindow)).norm() / (kWindow * sample_time_);
    if (beyond(Reason::speed, seen, speed, limits_.speed)) return false;
  }
  if (filled_ < kSize) return true;
  // the second difference over 2N ticks is the acceleration's mean under a triangle, exactly: so is the other one
  const double span = kWindow * sample_time_;
  const Vector2d by_encoders = (hand - 2.0 * before(hand_, kWindow) + before(hand_, 2 * kWindow)) / (span * span);
  if (beyond(Reason::acceleration, seen, by_encoders.norm(), limits_.acceleration)) return false;
  if (!seen.has_acceleration || limits_.accelerometer == 0.0) return true;
  Vector2d measured = Vector2d::Zero();
  for (int k = 1; k < 2 * kWindow; ++k) measured += (kWindow - std::abs(k - kWindow)) * before(accelerometer_, k);
  measured /= kWindow * kWindow;
  const Vector2d difference = by_encoders - measured;
  if (beyond(Reason::accelerometer_disagrees, seen, difference.norm(), limits_.accelerometer)) return false;
  const double weight = sample_time_ / kMeanTime;
  disagreement_ += weight * (difference.squaredNorm() - disagreement_);
  liveliness_ += weight * (measured.squaredNorm() - liveliness_);
  return !beyond(Reason::accelerometer_disagrees, seen, std::sqrt(disagreement_),
                 kShare * std::sqrt(liveliness_) + kFloor * limits_.accelerometer);
}

Vector2d Gate::cut(const Vector2d& asked, bool& was_cut) const noexcept {
  Vector2d torque = asked.cwiseMax(-limits_.joint_torque).cwiseMin(limits_.joint_torque);
  const double step = limits_.torque_rate * sample_time_;
  torque = torque.cwiseMax(sent_ - Vector2d::Constant(step)).cwiseMin(sent_ + Vector2d::Constant(step));
  const Eigen::Matrix2d jacobian = robot::jacobian(geometry_, joint_);
  if (std::abs(jacobian.determinant()) > kLeastDeterminant) {
    const double force = (jacobian.transpose().inverse() * torque).norm();
    if (force > limits_.handle_force) torque *= limits_.handle_force / force;
  } else {
    torque.setZero();
  }
  was_cut = !torque.isApprox(asked, 1e-12) && (torque - asked).norm() > 1e-12;
  return torque;
}

}  // namespace mbk::safety
