#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/calibration/spring_array.h"
#include "mbk/simulate/participant/load.h"

namespace mbk::laboratory {

/// A payload of mass m held at the handle by an array of springs on the disc, with dampers (Dyck 2013, appendix D):
///   Λ = m I,   h = B ẋ − F_springs(x, θ₂)
/// The disc rotates with the last link, so springs in its holes also exert a moment.
class SpringRig : public participant::Load<2> {
 public:
  /// @param disc_zero  θ₂ for which the hole positions are given [rad]
  /// @fails  usage: the mass is negative, a number is not finite; the springs have no equilibrium near `rest`; as
  ///         SpringArray::create.
  [[nodiscard]] static Result<SpringRig> create(std::vector<Spring> springs, double mass,
                                                const Eigen::Matrix2d& damping, double disc_zero,
                                                const Eigen::Vector2d& rest);

  [[nodiscard]] participant::LoadDynamics<2> dynamics(const participant::HandState<2>& hand) const override;

  /// About the equilibrium of the springs, wherever the hand is: m, B, K = −∂F/∂x with the disc as given, and x₀.
  [[nodiscard]] impedance::Model impedance(const Eigen::Vector2d& hand) const override;

 private:
  SpringRig(calibration::SpringArray springs, const impedance::Model& at_rest, double disc_zero);

  calibration::SpringArray springs_;
  impedance::Model at_rest_;
  double mass_;
  Eigen::Matrix2d damping_;
  double disc_zero_;
};

}  // namespace mbk::laboratory
