#include "mbk/model/robot/velocity_estimate.h"

#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::robot {

Result<VelocityEstimate> VelocityEstimate::create(double sample_time, Hertz cutoff) {
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}, {"velocity cutoff", cutoff.value, "Hz"}}));
  return VelocityEstimate(sample_time, std::exp(-RadPerSec(cutoff).value * sample_time));
}

const JointVector& VelocityEstimate::step(const JointVector& position) noexcept {
  if (last_.size() == 0) {
    velocity_ = JointVector::Zero(position.size());
  } else {
    velocity_ = memory_ * velocity_ + (1.0 - memory_) / sample_time_ * (position - last_);
  }
  last_ = position;
  return velocity_;
}

}  // namespace mbk::robot
