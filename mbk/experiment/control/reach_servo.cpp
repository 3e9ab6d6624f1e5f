#include "mbk/experiment/control/reach_servo.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mbk/model/robot/workspace.h"

namespace mbk::control {
namespace {

/// From 1 to 0, at rest at both ends.
double fading(double share) noexcept {
  const double s = std::clamp(share, 0.0, 1.0);
  return 1.0 - s * s * (3.0 - 2.0 * s);
}

}  // namespace

ReachServo::ReachServo(const perturbation::ReachSchedule& schedule, const robot::Geometry& geometry,
                       const Vector2d& home, JointPositionControl law, double sample_time)
    : schedule_(schedule),
      geometry_(geometry),
      home_(home),
      towards_(schedule.options().reach.normalized()),
      law_(law),
      sample_time_(sample_time),
      past_(WayPrediction::Past::Zero()),
      future_(WayPrediction::Future::Zero()),
      hand_(home),
      origin_(home),
      angles_(Vector2d::Zero()) {
  places_.fill(home);
}

Result<ReachServo> ReachServo::create(const JointPositionControl::Gains& gains,
                                      const perturbation::ReachSchedule& schedule, const robot::Geometry& geometry,
                                      const Vector2d& home, double sample_time) {
  constexpr double kFuture = (WayPrediction::kKnots - 1) * WayPrediction::kStep;
  if (schedule.displaced_for() + kRelease > kFuture) {
    return bad_usage(fmt::format("a displacement of {:g} s lasts longer than the predicted {:g} s",
                                 schedule.displaced_for(), kFuture - kRelease),
                     "shorten ramp, hold or return");
  }
  constexpr double kPast = WayPrediction::kLags * WayPrediction::kLag;
  const double every = std::round(WayPrediction::kStep / sample_time);
  if (!(every >= 1.0 && std::abs(every * sample_time - WayPrediction::kStep) < 1e-9 &&
        kPast / sample_time < static_cast<double>(kHistory))) {
    return bad_usage(fmt::format("a reach cannot be predicted with a sample time of {:g} s", sample_time),
                     "choose a control rate that is a multiple of 100 Hz, up to 10 kHz");
  }
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const auto angles = robot::check_hand(geometry, home + share * schedule.options().reach);
    if (!angles) return tl::unexpected(angles.error().in("path of the reach"));
  }
  auto law = MBK_TRY(JointPositionControl::create(gains, sample_time));
  return ReachServo(schedule, geometry, home, law, sample_time);
}

std::int64_t ReachServo::ticks_in(double seconds) const noexcept {
  return std::llround(seconds / sample_time_);
}

Vector2d ReachServo::past_place(double seconds) const noexcept {
  return places_[static_cast<std::size_t>(std::max<std::int64_t>(0, tick_ - ticks_in(seconds))) % kHistory];
}

void ReachServo::enter(Phase phase) noexcept {
  phase_ = phase;
  ticks_ = 0;
}

bool ReachServo::passes() const noexcept {
  const Vector2d from_home = hand_ - home_;
  const double progress = towards_.dot(from_home);
  return progress >= schedule_.options().trigger && (from_home - progress * towards_).norm() <= kMaxAside;
}

/// Home, at rest for long enough, and away from it towards the target, fast enough: that is a reach.
void ReachServo::wait_for_reach() noexcept {
  const bool at_home = (hand_ - home_).norm() <= kHomeRadius;
  if (at_home && phase_ != Phase::at_home && phase_ != Phase::leaving) enter(Phase::at_home);
  if (phase_ == Phase::at_home && !at_home) enter(ticks_ >= ticks_in(kRest) ? Phase::leaving : Phase::away);
  if (phase_ != Phase::leaving) return;
  if (at_home) {
    enter(Phase::at_home);
  } else if (ticks_ > ticks_in(kMaxApproach)) {
    enter(Phase::away);
  } else if (passes() && next_ < schedule_.reaches().size()) {
    trigger();
  }
}

bool ReachServo::stays_within_limits(const WayPrediction::Way& way, const Vector2d& direction) const noexcept {
  const double end = schedule_.displaced_for() + kRelease;
  constexpr int kPlaces = 16;
  for (int i = 0; i <= kPlaces; ++i) {
    const double t = end * i / kPlaces;
    const Vector2d place =
        origin_ + way.at(t).value + schedule_.options().amplitude * schedule_.shape(t).value * direction;
    const double distance = place.norm();
    if (!(distance < geometry_.d1 + geometry_.d2 && distance > std::abs(geometry_.d1 - geometry_.d2))) return false;
    const auto angles = robot::joint_angles(geometry_, place);
    if (!angles || robot::margin(geometry_.limits, *angles) < 0.0) return false;
  }
  return true;
}

void ReachServo::trigger() noexcept {
  triggered_ = true;
  origin_ = hand_;
  past_[0] = 1.0;
  for (int k = 0; k < WayPrediction::kLags; ++k) {
    past_.segment<2>(1 + 2 * k) = past_place((k + 1) * WayPrediction::kLag) - origin_;
  }
  const perturbation::ReachSchedule::Reach& reach = schedule_.reaches()[next_];
  if (reach.displaced) {
    if (prediction_.learned() >= perturbation::ReachSchedule::kMinUndisturbedFirst) {
      way_ = prediction_.predict(past_, past_place(WayPrediction::kStep) - origin_);
      if (way_.leverage() <= kMaxLeverage && stays_within_limits(way_, reach.direction_B)) {
        direction_ = reach.direction_B;
        ++next_;
        return enter(Phase::displacing);
      }
    }
  } else {
    ++next_;
  }
  enter(Phase::watching);
}

/// An undisturbed reach goes on; the places of its future are learned from.
void ReachServo::watch() noexcept {
  const auto every = ticks_in(WayPrediction::kStep);
  if (ticks_ > 0 && ticks_ % every == 0) future_.col(ticks_ / every - 1) = hand_ - origin_;
  if (ticks_ < every * WayPrediction::kKnots) return;
  prediction_.learn(past_, future_);
  enter(Phase::away);
}

void ReachServo::hold_to(double t) noexcept {
  const perturbation::Jet<Vector2d> way = way_.at(t);
  const perturbation::Jet<double> share = schedule_.shape(t);
  const double amplitude = schedule_.options().amplitude;
  displacement_ = amplitude * share.value * direction_;
  const perturbation::ReachSchedule::Options& o = schedule_.options();
  holding_ = t >= o.out && t <= o.out + o.hold;
  const auto angles = robot::joint_angles(geometry_, origin_ + way.value + displacement_);
  if (!angles) return;  // it was asked at the trigger
  angles_ = *angles;
  rates_ = robot::jacobian(geometry_, angles_).inverse() * (way.first + amplitude * share.first * direction_);
}

Vector2d ReachServo::step(const Vector2d& measured) noexcept {
  hand_ = robot::hand_position(geometry_, measured);
  places_[static_cast<std::size_t>(++tick_) % kHistory] = hand_;
  triggered_ = holding_ = false;
  displacement_.setZero();
  if (phase_ == Phase::away || phase_ == Phase::at_home || phase_ == Phase::leaving) wait_for_reach();
  const double t = static_cast<double>(ticks_) * sample_time_, end = schedule_.displaced_for();
  if (phase_ == Phase::watching) watch();
  if (phase_ == Phase::displacing && t >= end) phase_ = Phase::releasing;
  const bool served = phase_ == Phase::displacing || phase_ == Phase::releasing;
  if (served) {
    hold_to(t);
  } else {
    angles_ = measured;
    rates_.setZero();
  }
  const Vector2d torque = law_.step(measured, angles_, rates_);
  ++ticks_;
  if (phase_ == Phase::displacing) return torque;
  if (phase_ != Phase::releasing) return Vector2d::Zero();
  const double fade = fading((t - end) / kRelease);
  if (t - end >= kRelease) enter(Phase::away);
  return fade * torque;
}

}  // namespace mbk::control
