#include "mbk/simulate/laboratory/closed_loop.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <vector>

#include "mbk/base/core/option_limits.h"
#include "mbk/model/robot/hand_kinematics.h"

namespace mbk::laboratory {
namespace {

std::vector<Choice> lengths(const robot::OneAxisGeometry& /*none*/) {
  return {};
}

std::vector<Choice> lengths(const robot::Geometry& geometry) {
  return {{"link length", geometry.d1, "m"}, {"link length", geometry.d2, "m"}};
}

/// Whether the inertia leaves the links some of their own, wherever they are.
Result<void> check_links(const robot::OneAxisInertia& inertia, const AxisVector<1>& motor) {
  if (const double link = inertia.mass - motor[0]; !(link > 0.0 && std::isfinite(link))) {
    return bad_usage(fmt::format("inertia {:g} of the machine is not positive", link));
  }
  return {};
}

Result<void> check_links(const robot::Inertia& inertia, const AxisVector<2>& motors) {
  const double links1 = inertia.alpha1 - motors[0], links2 = inertia.alpha3 - motors[1];
  if (!(links1 > 0.0 && links2 > 0.0 && links1 * links2 > 0.25 * inertia.alpha2 * inertia.alpha2)) {
    return bad_usage(fmt::format("alpha = {:g}, {:g}, {:g} kg·m², of which {:g} and {:g} kg·m² are in the motors, is "
                                 "not positive definite in every posture",
                                 inertia.alpha1, inertia.alpha2, inertia.alpha3, motors[0], motors[1]),
                     "make alpha1·alpha3 larger than alpha2²/4");
  }
  return {};
}

template <int Axes>
Result<void> check(const typename ClosedLoop<Axes>::Options& options) {
  std::vector<Choice> at_least_zero = {{"handle mass", options.handle_mass, "kg"}};
  std::vector<Choice> positive = lengths(options.robot.geometry);
  for (const robot::JointFriction& joint : options.robot.friction) {
    at_least_zero.push_back({"viscous friction", joint.viscous, "N·m·s/rad"});
    at_least_zero.push_back({"Coulomb friction", joint.coulomb, "N·m"});
    at_least_zero.push_back({"breakaway friction", joint.breakaway, "N·m"});
    positive.push_back({"Stribeck velocity", joint.stribeck_velocity, "rad/s"});
    positive.push_back({"smoothing of dry friction", joint.smoothing, "rad/s"});
  }
  AxisVector<Axes> motors = AxisVector<Axes>::Zero();
  if (options.capstan) {
    motors = options.capstan->motor_inertia;
    for (int joint = 0; joint < Axes; ++joint) {
      positive.push_back({"capstan stiffness", options.capstan->stiffness[joint], "N·m/rad"});
      at_least_zero.push_back({"capstan damping", options.capstan->damping[joint], "N·m·s/rad"});
      at_least_zero.push_back({"capstan backlash", options.capstan->backlash[joint], "rad"});
      positive.push_back({"motor inertia", motors[joint], "kg·m²"});
    }
  }
  MBK_TRY(not_negative(at_least_zero));
  MBK_TRY(above_zero(positive));
  MBK_TRY(check_links(options.robot.inertia, motors));
  if (options.steps_per_tick < 1) return bad_usage(fmt::format("{} steps per tick", options.steps_per_tick));
  return {};
}

/// I⁻¹ τ.
AxisVector<1> accelerated(const AxisMatrix<1>& inertia, const AxisVector<1>& torque) {
  return torque / inertia(0, 0);
}

AxisVector<2> accelerated(const AxisMatrix<2>& inertia, const AxisVector<2>& torque) {
  return inertia.inverse() * torque;
}

/// The last link is the last axis.
template <int Axes>
participant::HandState<Axes> hand_of(const TrueState<Axes>& state) {
  return {state.position, state.velocity, state.theta[Axes - 1], state.theta_rate[Axes - 1]};
}

}  // namespace

template <int Axes>
Result<ClosedLoop<Axes>> ClosedLoop<Axes>::create(const Options& options, const Values& home,
                                                  participant::Load<Axes>& load, double start_time) {
  MBK_TRY(check<Axes>(options));
  const auto theta = MBK_TRY(joint_angles(options.robot.geometry, home));
  return ClosedLoop(options, theta, load, start_time);
}

template <int Axes>
ClosedLoop<Axes>::ClosedLoop(const Options& options, const Values& theta, participant::Load<Axes>& load,
                             double start_time)
    : options_(options), load_(&load), time_(start_time) {
  state_.template segment<Axes>(kTheta) = theta;
  state_.template segment<Axes>(kMotorAngle) = theta;
}

template <int Axes>
auto ClosedLoop<Axes>::mechanics(const State& state) const -> Mechanics {
  const RobotOf<Axes>& robot = options_.robot;
  Mechanics now;
  now.theta = state.template segment<Axes>(kTheta);
  now.rate = state.template segment<Axes>(kRate);
  now.motor_angle = state.template segment<Axes>(kMotorAngle);
  now.motor_rate = options_.capstan ? Values(state.template segment<Axes>(kMotorRate)) : now.rate;
  const auto [place, J, J_rate] = hand_kinematics(robot.geometry, now.theta, now.rate);
  now.J = J;
  now.convective = J_rate * now.rate;
  now.hand = {place, J * now.rate, now.theta[Axes - 1], now.rate[Axes - 1]};
  now.friction = robot.friction_torque(now.motor_rate);
  now.inertia = robot.inertia.matrix(now.theta);
  now.coriolis = robot.inertia.coriolis(now.theta, now.rate) * now.rate;
  if (options_.capstan) {
    const Values twist = now.motor_angle - now.theta, twist_rate = now.motor_rate - now.rate;
    now.cable = options_.capstan->torque(twist, twist_rate);
    now.inertia.diagonal() -= options_.capstan->motor_inertia;
    const Values elastic = options_.capstan->stiffness.cwiseProduct(options_.capstan->bend(twist));
    now.cable_loss = twist_rate.dot(now.cable - elastic);
  }
  return now;
}

template <int Axes>
auto ClosedLoop<Axes>::derivative(const State& state, const Mechanics& now, TrueState<Axes>* seen) const -> State {
  const AxisMatrix<Axes>& J = now.J;
  const participant::HandState<Axes>& hand = now.hand;
  Values drive = torque_ - now.friction, motor_acceleration = Values::Zero();
  if (options_.capstan) {
    motor_acceleration = (drive - now.cable).cwiseQuotient(options_.capstan->motor_inertia);
    drive = now.cable;
  }

  const participant::LoadDynamics<Axes> load = load_->dynamics(hand);
  const AxisMatrix<Axes> beyond = load.inertia + options_.handle_mass * AxisMatrix<Axes>::Identity();
  const Values moment = load.moment * Values::Unit(Axes - 1);
  const Values torque = drive - now.coriolis + moment - J.transpose() * (beyond * now.convective + load.bias);
  const Values acceleration = accelerated(now.inertia + J.transpose() * beyond * J, torque);
  const Values hand_acceleration = J * acceleration + now.convective;
  const Values force = -(beyond * hand_acceleration + load.bias);

  double viscous = 0.0;
  for (int joint = 0; joint < Axes; ++joint) {
    const double damping = options_.robot.friction[static_cast<std::size_t>(joint)].viscous;
    viscous += damping * now.motor_rate[joint] * now.motor_rate[joint];
  }
  if (!options_.capstan) motor_acceleration = acceleration;
  State change;
  change << now.rate, acceleration, now.motor_rate, motor_acceleration, torque_.dot(now.motor_rate),
      -force.dot(hand.velocity) - load.moment * hand.rotation_rate, viscous, now.friction.dot(now.motor_rate) - viscous,
      now.cable_loss;

  if (seen != nullptr) {
    seen->time = time_;
    seen->theta = now.theta;
    seen->theta_rate = now.rate;
    seen->motor_angle = now.motor_angle;
    seen->position = hand.position;
    seen->velocity = hand.velocity;
    seen->acceleration = hand_acceleration;
    seen->force_hand_on_robot = force;
    seen->motor_torque = torque_;
    seen->kinetic_energy = 0.5 * now.rate.dot(now.inertia * now.rate);
    seen->elastic_energy = 0.0;
    if (options_.capstan) {
      const Values bent = options_.capstan->bend(now.motor_angle - now.theta);
      seen->kinetic_energy += 0.5 * now.motor_rate.dot(options_.capstan->motor_inertia.cwiseProduct(now.motor_rate));
      seen->elastic_energy = 0.5 * bent.dot(options_.capstan->stiffness.cwiseProduct(bent));
    }
    const auto energy = state.template segment<5>(kEnergy);
    seen->energy = {energy[0], energy[1], energy[2], energy[3], energy[4]};
  }
  return change;
}

template <int Axes>
TrueState<Axes> ClosedLoop<Axes>::state() const {
  TrueState<Axes> now;
  derivative(state_, mechanics(state_), &now);
  return now;
}

template <int Axes>
const TrueState<Axes>& ClosedLoop<Axes>::hold(const Values& motor_torque, double sample_time) {
  const Mechanics now = mechanics(state_);
  TrueState<Axes> before;
  derivative(state_, now, &before);
  load_->tick(time_, sample_time, hand_of(before), true_state_.force_hand_on_robot);
  torque_ = motor_torque;
  sample_time_ = sample_time;
  change_ = derivative(state_, now, &true_state_);
  true_state_.acceleration = 0.5 * (before.acceleration + true_state_.acceleration);
  true_state_.force_hand_on_robot = 0.5 * (before.force_hand_on_robot + true_state_.force_hand_on_robot);
  return true_state_;
}

template <int Axes>
void ClosedLoop<Axes>::advance() {
  const double step = sample_time_ / options_.steps_per_tick;
  for (int k = 0; k < options_.steps_per_tick; ++k) {
    const State first = k == 0 ? change_ : derivative(state_);
    const State second = derivative(state_ + 0.5 * step * first);
    const State third = derivative(state_ + 0.5 * step * second);
    const State fourth = derivative(state_ + step * third);
    state_ += step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth);
  }
  time_ += sample_time_;
}

template class ClosedLoop<1>;
template class ClosedLoop<2>;

}  // namespace mbk::laboratory
