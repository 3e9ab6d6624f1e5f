#include "mbk/experiment/control/laws.h"

#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::control {

Result<JointPositionControl> JointPositionControl::create(const Gains& gains, double sample_time) {
  for (int joint = 0; joint < 2; ++joint) {
    if (auto ok = not_negative({{"proportional gain", gains.proportional[joint], "N·m/rad"},
                                {"derivative gain", gains.derivative[joint], "N·m·s/rad"}});
        !ok) {
      return tl::unexpected(ok.error());
    }
  }
  const auto velocity = MBK_TRY(robot::VelocityEstimate::create(sample_time, gains.velocity_cutoff));
  return JointPositionControl(gains, velocity);
}

Vector2d JointPositionControl::step(const Vector2d& measured, const Vector2d& reference,
                                    const Vector2d& reference_rate) noexcept {
  const Vector2d velocity = velocity_.step(measured);
  return gains_.proportional.cwiseProduct(reference - measured) +
         gains_.derivative.cwiseProduct(reference_rate - velocity);
}

Vector2d ForceControl::step(const Vector2d& measured, const Vector2d& force_on_hand) const noexcept {
  return robot::jacobian(geometry_, measured).transpose() * force_on_hand;
}

LineConstraint::LineConstraint(const Options& options, const robot::Geometry& geometry,
                               robot::VelocityEstimate velocity)
    : options_(options), geometry_(geometry), velocity_(velocity) {
  const Vector2d along(std::cos(options.angle), std::sin(options.angle));
  across_ = Matrix2d::Identity() - along * along.transpose();
}

Result<LineConstraint> LineConstraint::create(const Options& options, const robot::Geometry& geometry,
                                              double sample_time) {
  if (auto ok = not_negative({{"stiffness across the line", options.stiffness, "N/m"},
                              {"damping across the line", options.damping, "N·s/m"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  const auto velocity = MBK_TRY(robot::VelocityEstimate::create(sample_time, options.velocity_cutoff));
  return LineConstraint(options, geometry, velocity);
}

Vector2d LineConstraint::step(const Vector2d& measured, const Vector2d& force_on_hand) noexcept {
  const Matrix2d J = robot::jacobian(geometry_, measured);
  const Vector2d velocity = J * velocity_.step(measured);
  const Vector2d away = robot::hand_position(geometry_, measured) - options_.through;
  const Vector2d holding = across_ * (options_.stiffness * away + options_.damping * velocity);
  return J.transpose() * (force_on_hand - across_ * force_on_hand - holding);
}

}  // namespace mbk::control
