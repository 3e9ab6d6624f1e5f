#include "mbk/simulate/participant/one_axis_joint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {

Result<StretchReflex> StretchReflex::create(const Options& options, double sample_time) {
  if (auto ok = above_zero({{"sample time", sample_time, "s"},
                            {"natural frequency of the reflex", options.natural_frequency.value, "rad/s"},
                            {"damping ratio of the reflex", options.damping_ratio, ""}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  MBK_TRY(not_negative({{"reflex gain", options.gain, "N·m·s/rad"}, {"reflex delay", options.delay, "s"}}));
  if (options.delay > 10.0) return bad_usage(fmt::format("reflex delay {:g} s is above 10 s", options.delay));
  if (options.natural_frequency.value * sample_time * std::max(1.0, 2.0 * options.damping_ratio) >= 1.0) {
    return bad_usage(fmt::format("a reflex of {:g} rad/s is too fast for ticks of {:g} s",
                                 options.natural_frequency.value, sample_time),
                     "give a lower natural frequency or a higher control rate");
  }
  return StretchReflex(options, sample_time);
}

StretchReflex::StretchReflex(const Options& options, double sample_time)
    : gain_(options.gain),
      direction_(options.stretched_by_positive_velocity ? 1.0 : -1.0),
      delayed_(static_cast<std::size_t>(std::lround(options.delay / sample_time)) + 1, 0.0) {
  // [y, ẏ, input] over one tick: the exponential of a small matrix, by its series
  const double omega = options.natural_frequency.value;
  Eigen::Matrix3d A;
  A << 0.0, 1.0, 0.0, -omega * omega, -2.0 * options.damping_ratio * omega, omega * omega, 0.0, 0.0, 0.0;
  Eigen::Matrix3d term = Eigen::Matrix3d::Identity(), sum = term;
  for (int k = 1; k <= 30; ++k) {
    term = term * A * (sample_time / k);
    sum += term;
  }
  transition_ = sum.topLeftCorner<2, 2>();
  input_ = sum.topRightCorner<2, 1>();
}

double StretchReflex::step(double velocity) {
  delayed_[next_] = std::max(0.0, direction_ * velocity);
  next_ = (next_ + 1) % delayed_.size();  // now the oldest: the delay ago
  const double torque = direction_ * gain_ * state_[0];
  state_ = transition_ * state_ + input_ * delayed_[next_];
  return torque;
}

Result<OneAxisJoint> OneAxisJoint::create(const Options& options, double sample_time) {
  MBK_TRY(above_zero({{"inertia of the joint", options.inertia, "kg·m²"}}));
  if (auto ok = not_negative({{"viscosity of the joint", options.viscosity, "N·m·s/rad"},
                              {"stiffness of the joint", options.stiffness, "N·m/rad"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  if (!std::isfinite(options.rest)) return bad_usage("the resting angle of the joint must be finite");
  auto reflex = MBK_TRY(StretchReflex::create(options.reflex, sample_time));
  const auto remnant = MBK_TRY(Remnant<1>::create(options.remnant, sample_time, options.seed));
  return OneAxisJoint(options, std::move(reflex), remnant);
}

OneAxisJoint::OneAxisJoint(const Options& options, StretchReflex reflex, const Remnant<1>& remnant)
    : options_(options), reflex_(std::move(reflex)), remnant_(remnant) {}

void OneAxisJoint::tick(double /*t*/, double /*sample_time*/, const HandState<1>& joint,
                        const AxisVector<1>& /*reaction*/) {
  reflex_torque_ = reflex_.step(joint.velocity[0]);
  noise_ = remnant_.step(0.0)[0];
}

LoadDynamics<1> OneAxisJoint::dynamics(const HandState<1>& joint) const {
  const double bias = options_.viscosity * joint.velocity[0] +
                      options_.stiffness * (joint.position[0] - options_.rest) + reflex_torque_ - noise_;
  return {AxisMatrix<1>(options_.inertia), AxisVector<1>(bias), 0.0};
}

impedance::Model OneAxisJoint::impedance(const AxisVector<1>& /*position*/) const {
  const auto one = [](double value) { return Matrix::Constant(1, 1, value); };
  return {one(options_.inertia), one(options_.viscosity), one(options_.stiffness), Vector::Constant(1, options_.rest)};
}

}  // namespace mbk::participant
