#include "mbk/simulate/laboratory/closed_loop.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <vector>

#include "mbk/base/core/option_limits.h"

namespace mbk::laboratory {
namespace {

Result<void> check(const ClosedLoop::Options& options) {
  const robot::PlanarRobot& robot = options.robot;
  std::vector<Choice> at_least_zero = {{"handle mass", options.handle_mass, "kg"}};
  std::vector<Choice> positive = {{"link length", robot.geometry.d1, "m"}, {"link length", robot.geometry.d2, "m"}};
  for (const robot::JointFriction& joint : robot.friction) {
    at_least_zero.push_back({"viscous friction", joint.viscous, "N·m·s/rad"});
    at_least_zero.push_back({"Coulomb friction", joint.coulomb, "N·m"});
    at_least_zero.push_back({"breakaway friction", joint.breakaway, "N·m"});
    positive.push_back({"Stribeck velocity", joint.stribeck_velocity, "rad/s"});
    positive.push_back({"smoothing of dry friction", joint.smoothing, "rad/s"});
  }
  Vector2d motors = {0.0, 0.0};
  if (options.capstan) {
    motors = options.capstan->motor_inertia;
    for (int joint = 0; joint < 2; ++joint) {
      positive.push_back({"capstan stiffness", options.capstan->stiffness[joint], "N·m/rad"});
      at_least_zero.push_back({"capstan damping", options.capstan->damping[joint], "N·m·s/rad"});
      positive.push_back({"motor inertia", motors[joint], "kg·m²"});
    }
  }
  if (auto ok = not_negative(at_least_zero); !ok) return ok;
  if (auto ok = above_zero(positive); !ok) return ok;
  const robot::Inertia& inertia = robot.inertia;
  const double links1 = inertia.alpha1 - motors[0], links2 = inertia.alpha3 - motors[1];
  if (!(links1 > 0.0 && links2 > 0.0 && links1 * links2 > 0.25 * inertia.alpha2 * inertia.alpha2)) {
    return bad_usage(
        fmt::format("alpha = {:g}, {:g}, {:g} kg·m² with {:g} and {:g} kg·m² of it in the motors is no inertia in "
                    "every posture",
                    inertia.alpha1, inertia.alpha2, inertia.alpha3, motors[0], motors[1]),
        "alpha1·alpha3 must be above alpha2²/4");
  }
  if (options.steps_per_tick < 1) return bad_usage(fmt::format("{} steps per tick", options.steps_per_tick));
  return {};
}

}  // namespace

Result<ClosedLoop> ClosedLoop::create(const Options& options, const Vector2d& home, participant::Load& load,
                                      double start_time) {
  if (auto ok = check(options); !ok) return tl::unexpected(ok.error());
  const auto theta = robot::joint_angles(options.robot.geometry, home);
  if (!theta) return tl::unexpected(theta.error());
  return ClosedLoop(options, *theta, load, start_time);
}

ClosedLoop::ClosedLoop(const Options& options, const Vector2d& theta, participant::Load& load, double start_time)
    : options_(options), load_(&load), time_(start_time) {
  state_.segment<2>(kTheta) = theta;
  state_.segment<2>(kMotorAngle) = theta;
}

ClosedLoop::State ClosedLoop::derivative(const State& state, TrueState* seen) const {
  const robot::PlanarRobot& robot = options_.robot;
  const Vector2d theta = state.segment<2>(kTheta), rate = state.segment<2>(kRate);
  const Vector2d motor_rate = options_.capstan ? Vector2d(state.segment<2>(kMotorRate)) : rate;
  const Matrix2d J = robot::jacobian(robot.geometry, theta);
  const Matrix2d J_rate = robot::jacobian_rate(robot.geometry, theta, rate);
  const participant::HandState hand = {robot::hand_position(robot.geometry, theta), J * rate, theta[1], rate[1]};

  const Vector2d friction = robot.friction_torque(motor_rate);
  Matrix2d I = robot.inertia.matrix(theta);
  Vector2d drive = torque_ - friction, motor_acceleration = {0.0, 0.0};
  double cable_loss = 0.0;
  if (options_.capstan) {
    const Vector2d twist = state.segment<2>(kMotorAngle) - theta, twist_rate = motor_rate - rate;
    const Vector2d cable = options_.capstan->torque(twist, twist_rate);
    motor_acceleration = (drive - cable).cwiseQuotient(options_.capstan->motor_inertia);
    I.diagonal() -= options_.capstan->motor_inertia;
    drive = cable;
    cable_loss = twist_rate.dot(options_.capstan->damping.cwiseProduct(twist_rate));
  }

  const participant::LoadDynamics load = load_->dynamics(hand);
  const Matrix2d beyond = load.inertia + options_.handle_mass * Matrix2d::Identity();
  const Vector2d convective = J_rate * rate;
  const Vector2d torque = drive - robot.inertia.coriolis(theta, rate) * rate + Vector2d(0.0, load.moment) -
                          J.transpose() * (beyond * convective + load.bias);
  const Vector2d acceleration = (I + J.transpose() * beyond * J).inverse() * torque;
  const Vector2d hand_acceleration = J * acceleration + convective;
  const Vector2d force = -(beyond * hand_acceleration + load.bias);

  double viscous = 0.0;
  for (int joint = 0; joint < 2; ++joint) {
    viscous += robot.friction[static_cast<std::size_t>(joint)].viscous * motor_rate[joint] * motor_rate[joint];
  }
  if (!options_.capstan) motor_acceleration = acceleration;
  State change;
  change << rate, acceleration, motor_rate, motor_acceleration, torque_.dot(motor_rate),
      -force.dot(hand.velocity) - load.moment * rate[1], viscous, friction.dot(motor_rate) - viscous, cable_loss;

  if (seen != nullptr) {
    seen->theta = theta;
    seen->theta_rate = rate;
    seen->motor_angle = state.segment<2>(kMotorAngle);
    seen->position = hand.position;
    seen->velocity = hand.velocity;
    seen->acceleration = hand_acceleration;
    seen->force_hand_on_robot = force;
    seen->motor_torque = torque_;
    seen->kinetic_energy = 0.5 * rate.dot(I * rate);
    seen->elastic_energy = 0.0;
    if (options_.capstan) {
      const Vector2d twist = seen->motor_angle - theta;
      seen->kinetic_energy += 0.5 * motor_rate.dot(options_.capstan->motor_inertia.cwiseProduct(motor_rate));
      seen->elastic_energy = 0.5 * twist.dot(options_.capstan->stiffness.cwiseProduct(twist));
    }
    const auto energy = state.segment<5>(kEnergy);
    seen->energy = {energy[0], energy[1], energy[2], energy[3], energy[4]};
  }
  return change;
}

const TrueState& ClosedLoop::hold(const Vector2d& motor_torque, double sample_time) {
  TrueState before;
  derivative(state_, &before);
  load_->tick(time_, sample_time, {before.position, before.velocity, before.theta[1], before.theta_rate[1]},
              true_state_.force_hand_on_robot);
  torque_ = motor_torque;
  sample_time_ = sample_time;
  true_state_.time = time_;
  derivative(state_, &true_state_);
  true_state_.acceleration = 0.5 * (before.acceleration + true_state_.acceleration);
  true_state_.force_hand_on_robot = 0.5 * (before.force_hand_on_robot + true_state_.force_hand_on_robot);
  return true_state_;
}

void ClosedLoop::advance() {
  const double step = sample_time_ / options_.steps_per_tick;
  for (int k = 0; k < options_.steps_per_tick; ++k) {
    const State first = derivative(state_);
    const State second = derivative(state_ + 0.5 * step * first);
    const State third = derivative(state_ + 0.5 * step * second);
    const State fourth = derivative(state_ + step * third);
    state_ += step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth);
  }
  time_ += sample_time_;
}

}  // namespace mbk::laboratory
