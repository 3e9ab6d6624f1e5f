#include "mbk/simulate/laboratory/one_axis_control.h"

#include <cmath>

namespace mbk::laboratory {

using perturbation::Quantity;

Result<OneAxisControl> OneAxisControl::create(const OneAxisMode& mode, const perturbation::Schedule& schedule,
                                              const robot::OneAxisGeometry& /*none*/, const AxisVector<1>& home,
                                              double sample_time) {
  const auto* servo = std::get_if<ServoMode>(&mode);
  if ((servo != nullptr) != (schedule.quantity() == Quantity::position)) {
    return bad_usage("control and perturbation refer to different quantities",
                     "use positions for both or torques for both");
  }
  if (servo != nullptr &&
      !(servo->proportional >= 0.0 && servo->derivative >= 0.0 && servo->velocity_cutoff.value > 0.0)) {
    return bad_usage("a servo gain is negative, or its velocity cutoff is not positive");
  }
  return OneAxisControl(mode, schedule, home[0], sample_time);
}

OneAxisControl::OneAxisControl(const OneAxisMode& mode, const perturbation::Schedule& schedule, double home,
                               double sample_time)
    : mode_(mode), schedule_(schedule), home_(home), sample_time_(sample_time) {
  if (const auto* servo = std::get_if<ServoMode>(&mode)) {
    memory_ = std::exp(-RadPerSec(servo->velocity_cutoff).value * sample_time);
  }
}

AxisVector<1> OneAxisControl::torque(double t, const AxisVector<1>& measured) noexcept {
  const perturbation::Jet<perturbation::AxesVector> now = schedule_.at(t);
  const auto* servo = std::get_if<ServoMode>(&mode_);
  if (servo == nullptr) return AxisVector<1>(now.value[0]);
  const double x = measured[0];
  if (moved_) velocity_ = memory_ * velocity_ + (1.0 - memory_) * (x - last_) / sample_time_;
  moved_ = true;
  last_ = x;
  return AxisVector<1>(servo->proportional * (home_ + now.value[0] - x) +
                       servo->derivative * (now.first[0] - velocity_));
}

AxisVector<1> OneAxisControl::reference(double t) const noexcept {
  const double value = schedule_.reference(t)[0];
  return AxisVector<1>(schedule_.quantity() == Quantity::force ? value : home_ + value);
}

}  // namespace mbk::laboratory
