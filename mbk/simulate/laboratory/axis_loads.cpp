#include "mbk/simulate/laboratory/axis_loads.h"

#include <cmath>
#include <limits>

namespace mbk::laboratory {
namespace {

impedance::Model one_axis(double mass, double damping, double stiffness, double rest) {
  const auto number = [](double value) { return Matrix::Constant(1, 1, value); };
  return {number(mass), number(damping), number(stiffness), Vector::Constant(1, rest)};
}

}  // namespace

impedance::Model MassSpringDamper::impedance(const AxisVector<1>& /*position*/) const {
  return one_axis(mass_, damping_, stiffness_, stiffness_ != 0.0 ? 0.0 : std::numeric_limits<double>::quiet_NaN());
}

AlongLine::AlongLine(participant::Load<2>& load, const Eigen::Vector2d& origin, double angle)
    : load_(&load), origin_(origin), direction_(std::cos(angle), std::sin(angle)) {}

participant::HandState<2> AlongLine::hand(const participant::HandState<1>& state) const {
  return {origin_ + state.position[0] * direction_, state.velocity[0] * direction_, 0.0, 0.0};
}

void AlongLine::tick(double t, double sample_time, const participant::HandState<1>& state,
                     const AxisVector<1>& reaction) {
  load_->tick(t, sample_time, hand(state), reaction[0] * direction_);
}

participant::LoadDynamics<1> AlongLine::dynamics(const participant::HandState<1>& state) const {
  const participant::LoadDynamics<2> dynamics = load_->dynamics(hand(state));
  return {AxisMatrix<1>(direction_.dot(dynamics.inertia * direction_)), AxisVector<1>(direction_.dot(dynamics.bias)),
          0.0};
}

impedance::Model AlongLine::impedance(const AxisVector<1>& position) const {
  const impedance::Model model = load_->impedance(origin_ + position[0] * direction_);
  const auto along = [&](const Matrix& m) { return direction_.dot(m * direction_); };
  const double stiffness = along(model.K);
  // where K (x − x₀) has no part along the line
  const double pull = direction_.dot(model.K * (model.x0 - origin_));
  return one_axis(along(model.M), along(model.B), stiffness, pull / stiffness);
}

}  // namespace mbk::laboratory
