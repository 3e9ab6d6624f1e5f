#include "mbk/simulate/laboratory/one_axis_loop.h"

#include <fmt/format.h>

#include <cmath>

namespace mbk::laboratory {

Result<OneAxisLoop> OneAxisLoop::create(const Machine& machine, double position, participant::OneAxisLoad& load,
                                        double start_time) {
  if (!(machine.inertia > 0.0 && std::isfinite(machine.inertia))) {
    return bad_usage(fmt::format("inertia {:g} of the machine is not above zero", machine.inertia));
  }
  const robot::JointFriction& friction = machine.friction;
  if (!(friction.viscous >= 0.0 && friction.coulomb >= 0.0 && friction.breakaway >= 0.0 && friction.smoothing > 0.0 &&
        friction.stribeck_velocity > 0.0)) {
    return bad_usage("friction of the machine must not be negative, its velocities must be above zero");
  }
  if (machine.steps_per_tick < 1) return bad_usage(fmt::format("{} steps per tick", machine.steps_per_tick));
  if (!std::isfinite(position)) return bad_usage("the machine's position is not finite");
  return OneAxisLoop(machine, position, load, start_time);
}

OneAxisLoop::OneAxisLoop(const Machine& machine, double position, participant::OneAxisLoad& load, double start_time)
    : machine_(machine), load_(&load), time_(start_time), state_{position, 0.0} {}

OneAxisLoop::Change OneAxisLoop::change(const participant::JointState& state) const {
  const participant::OneAxisDynamics load = load_->dynamics(state);
  const double friction = machine_.friction.torque(state.velocity);
  const double acceleration = (motor_ - friction - load.bias) / (machine_.inertia + load.inertia);
  const double taken = load.inertia * acceleration + load.bias;
  return {state.velocity, acceleration, motor_ * state.velocity, taken * state.velocity, friction * state.velocity};
}

double OneAxisLoop::reaction(double acceleration) const {
  const participant::OneAxisDynamics load = load_->dynamics(state_);
  return -(load.inertia * acceleration + load.bias);
}

OneAxisLoop::Reading OneAxisLoop::read() const {
  const double acceleration = change(state_).acceleration;
  return {state_.position, state_.velocity, acceleration, reaction(acceleration)};
}

const OneAxisTrueState& OneAxisLoop::hold(double motor, double sample_time) {
  const Reading before = read();
  load_->tick(time_, sample_time, state_, seen_.reaction);
  motor_ = motor;
  sample_time_ = sample_time;
  const double acceleration_after = change(state_).acceleration;
  seen_.time = time_;
  seen_.position = state_.position;
  seen_.velocity = state_.velocity;
  seen_.acceleration = 0.5 * (before.acceleration + acceleration_after);
  seen_.reaction = 0.5 * (before.reaction + reaction(acceleration_after));
  seen_.motor = motor;
  return seen_;
}

void OneAxisLoop::advance() {
  const double step = sample_time_ / machine_.steps_per_tick;
  const auto after = [&](const Change& slope, double time) {
    return participant::JointState{state_.position + time * slope.velocity,
                                   state_.velocity + time * slope.acceleration};
  };
  for (int k = 0; k < machine_.steps_per_tick; ++k) {
    const Change first = change(state_);
    const Change second = change(after(first, 0.5 * step));
    const Change third = change(after(second, 0.5 * step));
    const Change fourth = change(after(third, step));
    const auto mean = [&](double Change::*part) {
      return step / 6.0 * (first.*part + 2.0 * second.*part + 2.0 * third.*part + fourth.*part);
    };
    state_.position += mean(&Change::velocity);
    state_.velocity += mean(&Change::acceleration);
    seen_.work_motor += mean(&Change::work_motor);
    seen_.absorbed += mean(&Change::absorbed);
    seen_.lost += mean(&Change::lost);
  }
  time_ += sample_time_;
}

}  // namespace mbk::laboratory
