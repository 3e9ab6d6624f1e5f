#include "mbk/simulate/participant/compliant_grip.h"

#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {
namespace {

constexpr int kSteps = 8;  // of a tick

/// On the straight line between two states of the handle.
HandState<2> between(const HandState<2>& a, const HandState<2>& b, double share) {
  HandState<2> state = a;
  state.position += share * (b.position - a.position);
  state.velocity += share * (b.velocity - a.velocity);
  return state;
}

}  // namespace

Result<CompliantGrip> CompliantGrip::create(const GripOptions& options, Arm arm) {
  MBK_TRY(above_zero({{"stiffness of the grip", options.stiffness, "N/m"}}));
  MBK_TRY(not_negative({{"damping ratio of the grip", options.damping_ratio, ""}}));
  return CompliantGrip(options, std::move(arm));
}

Vector2d CompliantGrip::force_on_hand(const HandState<2>& handle, const HandState<2>& hand) const {
  return options_.stiffness * (handle.position - hand.position) + damping_ * (handle.velocity - hand.velocity);
}

void CompliantGrip::move(HandState<2>& hand, const HandState<2>& from, const HandState<2>& to, double duration) const {
  const double step = duration / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const HandState<2> handle = between(from, to, (k + 0.5) / kSteps);
    const LoadDynamics<2> arm = arm_.dynamics(hand);
    const Vector2d acceleration = arm.inertia.inverse() * (force_on_hand(handle, hand) - arm.bias);
    hand.velocity += step * acceleration;
    hand.position += step * hand.velocity;
  }
}

void CompliantGrip::tick(double t, double sample_time, const HandState<2>& handle, const Vector2d& force_on_robot) {
  if (!begun_) {
    begun_ = true;
    hand_ = handle_ = handle;
    const double inertia = 0.5 * arm_.dynamics(handle).inertia.trace();
    damping_ = 2.0 * options_.damping_ratio * std::sqrt(options_.stiffness * inertia);
  } else {
    move(hand_, handle_, handle, sample_time);
  }
  arm_.tick(t, sample_time, hand_, force_on_robot);
  HandState<2> ahead = handle;
  ahead.position += 0.5 * sample_time * handle.velocity;
  middle_ = hand_;
  move(middle_, handle, ahead, 0.5 * sample_time);
  handle_ = handle;
}

LoadDynamics<2> CompliantGrip::dynamics(const HandState<2>& handle) const {
  LoadDynamics<2> load;
  load.bias = force_on_hand(handle, middle_);
  return load;
}

}  // namespace mbk::participant
