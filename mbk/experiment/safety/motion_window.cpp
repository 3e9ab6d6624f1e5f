#include "mbk/experiment/safety/motion_window.h"

#include <algorithm>

namespace mbk::safety {

void MotionWindow::add(const MotionSample& sample) noexcept {
  at_ = (at_ + 1) % kSize;
  samples_[static_cast<std::size_t>(at_)] = sample;
  filled_ = std::min(filled_ + 1, kSize);
}

const MotionSample& MotionWindow::before(int states) const noexcept {
  return samples_[static_cast<std::size_t>((at_ - states + kSize) % kSize)];
}

double MotionWindow::speed() const noexcept {
  const MotionSample &now = before(0), &then = before(kHalf);
  return (now.hand - then.hand).norm() / (now.time - then.time);
}

MotionWindow::Means MotionWindow::means() const noexcept {
  const MotionSample &last = before(0), &middle = before(kHalf), &first = before(2 * kHalf);
  const double rise = middle.time - first.time, fall = last.time - middle.time;
  const auto curvature = [&](const Vector2d& x0, const Vector2d& x1, const Vector2d& x2) -> Vector2d {
    return 2.0 * ((x2 - x1) / fall - (x1 - x0) / rise) / (rise + fall);
  };
  Means means;
  means.hand_acceleration = curvature(first.hand, middle.hand, last.hand);
  means.joint_acceleration = curvature(first.joint, middle.joint, last.joint);
  means.joint_rate = (last.joint - first.joint) / (rise + fall);
  means.acceleration.setZero();
  means.force.setZero();
  means.torque.setZero();
  double weights = 0.0;
  for (int k = 1; k < 2 * kHalf; ++k) {  // the trapezoidal rule; the triangle is zero at both ends
    const MotionSample& sample = before(k);
    const double height = k <= kHalf ? (last.time - sample.time) / fall : (sample.time - first.time) / rise;
    const double weight = height * (before(k - 1).time - before(k + 1).time);
    weights += weight;
    means.acceleration += weight * sample.acceleration;
    means.force += weight * sample.force;
    means.torque += weight * sample.torque;
  }
  means.acceleration /= weights;
  means.force /= weights;
  means.torque /= weights;
  return means;
}

}  // namespace mbk::safety
