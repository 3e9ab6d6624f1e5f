#include "mbk/model/robot/momentum_observer.h"

#include <fmt/format.h>

#include <cmath>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/option_limits.h"

namespace mbk::robot {
namespace {

/// Delay of y ← a y + (1 − a) u at zero frequency, in ticks.
double ticks_late(double memory) {
  return memory / (1.0 - memory);
}

}  // namespace

Result<MomentumObserver> MomentumObserver::create(const DynamicModel& model, double gain, double sample_time) {
  MBK_TRY(above_zero({{"observer gain", gain, "1/s"}, {"sample time", sample_time, "s"}}));
  const auto coefficients = static_cast<Index>(model.coefficients().size());
  if (model.parameters.size() != coefficients) {
    return bad_data(fmt::format("the robot model has {} parameters, but its equations have {} coefficients",
                                model.parameters.size(), coefficients),
                    "identify it again");
  }
  if (!(model.delay >= 0.0 && model.delay <= kLongestDelay)) {
    return bad_data(
        fmt::format("the motors act {:g} s after the recorded torque; an observer supports a delay of 0 to {:g} s",
                    model.delay, kLongestDelay),
        "use inverse dynamics, which use the whole recording, or check the delay of the model");
  }
  return MomentumObserver(model, gain, sample_time);
}

MomentumObserver::MomentumObserver(const DynamicModel& model, double gain, double sample_time)
    : model_(model), sample_time_(sample_time), memory_(std::exp(-gain * sample_time)) {
  const auto bodies = static_cast<Index>(model.mechanism->coefficients().size());
  const Index n = model.mechanism->joints(), terms = model.drive.per_joint();
  phi_ = model.parameters.head(bodies);
  motor_inertia_ = JointVector::Zero(n);
  if (model.drive.motor_inertia) {  // the first term of each joint
    for (Index joint = 0; joint < n; ++joint) motor_inertia_[joint] = model.parameters[bodies + joint * terms];
  }
  const double ticks = model.delay / sample_time, whole = std::floor(ticks);
  share_of_oldest_ = ticks - whole;
  held_.resize(static_cast<std::size_t>(whole) + 2, JointVector::Zero(n));
}

JointVector MomentumObserver::mean_torque(const JointVector& torque) noexcept {
  const std::size_t next = oldest_ + 1 == held_.size() ? 0 : oldest_ + 1;
  JointVector mean = share_of_oldest_ * held_[oldest_] + (1.0 - share_of_oldest_) * held_[next];
  held_[oldest_] = torque;
  oldest_ = next;
  return mean;
}

const ObservedForce& MomentumObserver::step(const JointVector& position, const JointVector& velocity,
                                            const JointVector& torque) noexcept {
  const Index n = position.size();
  if (!(position.allFinite() && velocity.allFinite() && torque.allFinite())) {
    started_ = false;
    observed_.joint_torque = JointVector::Constant(n, kNaN);
    observed_.force_hand_on_robot = HandVector::Constant(model_.mechanism->hand_axes(), kNaN);
    return observed_;
  }
  const JointTerms terms = model_.mechanism->terms(position, velocity, phi_);
  JointVector momentum = motor_inertia_.cwiseProduct(velocity);
  momentum.noalias() += terms.inertia * velocity;
  const JointVector rest =
      terms.coriolis_transposed - terms.gravity - model_.drive_torque(position, velocity, JointVector::Zero(n));
  if (started_) {
    const JointVector mean = (momentum - momentum_) / sample_time_ - mean_torque(torque) - 0.5 * (rest_ + rest);
    observed_.joint_torque = memory_ * observed_.joint_torque + (1.0 - memory_) * mean;
  } else {
    for (JointVector& held : held_) held = torque;
    observed_.joint_torque = JointVector::Zero(n);
    started_ = true;
  }
  momentum_ = momentum;
  rest_ = rest;
  if (const auto L = regular_hand_from_joints(*model_.mechanism, position)) {
    observed_.force_hand_on_robot.noalias() = *L * observed_.joint_torque;
  } else {
    observed_.force_hand_on_robot = HandVector::Constant(model_.mechanism->hand_axes(), kNaN);
  }
  return observed_;
}

double MomentumObserver::lag() const {
  return (ticks_late(memory_) + 0.5) * sample_time_;
}

Result<EncoderMomentumObserver> EncoderMomentumObserver::create(const DynamicModel& model, const Options& options,
                                                                double sample_time) {
  auto observer = MBK_TRY(MomentumObserver::create(model, options.gain, sample_time));
  const auto velocity = MBK_TRY(VelocityEstimate::create(sample_time, options.velocity_cutoff));
  return EncoderMomentumObserver(std::move(observer), velocity, sample_time);
}

const ObservedForce& EncoderMomentumObserver::step(const JointVector& position, const JointVector& torque) noexcept {
  if (!(position.allFinite() && torque.allFinite())) {
    started_ = false;
    velocity_.restart();
    return observer_.step(position, position, torque);
  }
  if (started_) {
    const double memory = velocity_.memory(), fresh = 0.5 * (1.0 - memory);
    late_position_ = memory * late_position_ + fresh * (last_position_ + position);
    late_torque_ = memory * late_torque_ + fresh * (last_torque_ + torque);
  } else {
    late_position_ = position;
    late_torque_ = torque;
    started_ = true;
  }
  last_position_ = position;
  last_torque_ = torque;
  return observer_.step(late_position_, velocity_.step(position), late_torque_);
}

double EncoderMomentumObserver::lag() const {
  return observer_.lag() + (ticks_late(velocity_.memory()) + 0.5) * sample_time_;
}

}  // namespace mbk::robot
