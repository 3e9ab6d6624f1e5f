#include "mbk/validate/faulty_device.h"

#include <Eigen/LU>
#include <algorithm>

namespace mbk::validation {

FaultyDevice::FaultyDevice(laboratory::SimulatedDevice& robot, const robot::Geometry& geometry, DeviceFault fault,
                           std::int64_t onset, bool keeps_time, std::size_t ticks)
    : robot_(&robot), geometry_(geometry), fault_(std::move(fault)), facts_(robot.facts()), onset_(onset) {
  facts_.keeps_time = keeps_time;
  received_.reserve(ticks);
}

bool FaultyDevice::read(device::State& state) noexcept {
  const int k = static_cast<int>(tick_ - onset_);
  device::State now;
  bool fine = robot_->read(now);
  now.force += pushed_;
  if (k >= 0 && fault_.reading) fine = fault_.reading(now, k) && fine;
  if (fine) state = now;
  return fine;
}

bool FaultyDevice::write(const device::Command& command) noexcept {
  const int k = static_cast<int>(tick_ - onset_);
  const Eigen::Matrix2d jacobian = robot::jacobian(geometry_, robot_->motor_angle());
  const Vector2d torque = command.enabled ? command.torque : Vector2d::Zero();
  if (received_.size() < received_.capacity()) {
    received_.push_back({command, (jacobian.transpose().inverse() * torque).norm()});
  }
  device::Command driven = command;
  bool fine = true;
  pushed_.setZero();
  if (k >= 0) {
    if (fault_.driving) fine = fault_.driving(driven, k);
    if (fault_.push) pushed_ = fault_.push(k);
  }
  if (!driven.enabled) driven.torque.setZero();
  driven.torque += jacobian.transpose() * pushed_;
  driven.enabled = true;
  robot_->write(driven);
  Vector2d& before = hands_[static_cast<std::size_t>(tick_) % kSpeedTicks];
  const Vector2d hand = robot::hand_position(geometry_, robot_->motor_angle());
  if (k >= static_cast<int>(kSpeedTicks)) {
    largest_speed_ = std::max(largest_speed_, (hand - before).norm() / (1e-3 * kSpeedTicks));
  }
  before = hand;
  ++tick_;
  return fine;
}

void FaultyDevice::stop() noexcept {
  robot_->stop();
  stopped_ = true;
}

}  // namespace mbk::validation
