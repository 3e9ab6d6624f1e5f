#include "mbk/simulate/participant/tone_robot.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {

Result<ToneRobot> ToneRobot::create(const Options& options) {
  if (auto ok = not_negative({{"inertia of the device", options.inertia, "kg"},
                              {"rigidity", options.rigidity, "N"},
                              {"catch gain", options.catch_gain, "N·s/m"},
                              {"catch speed", options.catch_speed, "m/s"},
                              {"motor lag", options.motor_lag, "s"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (auto ok = above_zero({{"speed over which rigidity changes sign", options.rigidity_speed, "m/s"},
                            {"largest force", options.largest_force, "N"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (!(options.release_force > 0.0)) {
    return bad_usage(fmt::format("release force {:g} N is not positive", options.release_force));
  }
  if (!options.stiffness.allFinite() || !options.damping.allFinite() || !options.rest.allFinite() ||
      !std::isfinite(options.stretch_angle)) {
    return bad_usage("stiffness, damping, rest or stretch angle of the device is not finite");
  }
  return ToneRobot(options);
}

ToneRobot::ToneRobot(const Options& options)
    : options_(options), stretch_(std::cos(options.stretch_angle), std::sin(options.stretch_angle)) {}

Vector2d ToneRobot::programmed(const HandState<2>& hand) {
  const Vector2d& v = hand.velocity;
  Vector2d force = options_.stiffness * (hand.position - options_.rest) + options_.damping * v +
                   options_.rigidity / std::hypot(v.norm(), options_.rigidity_speed) * v;
  const double stretch_speed = stretch_.dot(v);
  if (stretch_speed <= 0.0) released_ = false;
  if (!released_) {
    const Vector2d caught =
        force + options_.catch_gain * std::max(0.0, stretch_speed - options_.catch_speed) * stretch_;
    released_ = stretch_speed > 0.0 && stretch_.dot(caught) > options_.release_force;
    if (!released_) force = caught;
  }
  const double size = force.norm();
  return size > options_.largest_force ? Vector2d(options_.largest_force / size * force) : force;
}

void ToneRobot::tick(double /*t*/, double sample_time, const HandState<2>& hand, const Vector2d& /*force_on_robot*/) {
  const double keep = options_.motor_lag > 0.0 ? std::exp(-sample_time / options_.motor_lag) : 0.0;
  force_ = keep * force_ + (1.0 - keep) * command_;
  command_ = programmed(hand);
}

LoadDynamics<2> ToneRobot::dynamics(const HandState<2>& /*hand*/) const {
  return {options_.inertia * Matrix2d::Identity(), force_, 0.0};
}

impedance::Model ToneRobot::impedance(const Vector2d& /*hand*/) const {
  const Vector2d rest = Eigen::FullPivLU<Matrix2d>(options_.stiffness).isInvertible()
                            ? options_.rest
                            : Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  return {options_.inertia * Matrix2d::Identity(), options_.damping, options_.stiffness, rest};
}

}  // namespace mbk::participant
