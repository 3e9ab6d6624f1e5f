#include "mbk/simulate/laboratory/spring_rig.h"

#include <fmt/format.h>

#include <cmath>

namespace mbk::laboratory {

Result<SpringRig> SpringRig::create(std::vector<Spring> springs, double mass, const Eigen::Matrix2d& damping,
                                    double disc_zero, const Eigen::Vector2d& rest) {
  if (!(mass >= 0.0 && std::isfinite(mass))) return bad_usage(fmt::format("mass {:g} kg is negative", mass));
  if (!damping.allFinite()) return bad_usage("the damping of the rig is not finite");
  auto array = MBK_TRY(calibration::SpringArray::create(std::move(springs)));
  const auto equilibrium = MBK_TRY(calibration::equilibrium(array, rest));
  const impedance::Model at_rest{mass * Eigen::Matrix2d::Identity(), damping, array.stiffness(equilibrium),
                                 equilibrium};
  return SpringRig(std::move(array), at_rest, disc_zero);
}

SpringRig::SpringRig(calibration::SpringArray springs, const impedance::Model& at_rest, double disc_zero)
    : springs_(std::move(springs)),
      at_rest_(at_rest),
      mass_(at_rest.M(0, 0)),
      damping_(at_rest.B),
      disc_zero_(disc_zero) {}

participant::LoadDynamics<2> SpringRig::dynamics(const participant::HandState<2>& hand) const {
  const double turn = hand.rotation - disc_zero_;
  return {mass_ * Eigen::Matrix2d::Identity(), damping_ * hand.velocity - springs_.force(hand.position, turn),
          springs_.moment(hand.position, turn)};
}

impedance::Model SpringRig::impedance(const Eigen::Vector2d& /*hand*/) const {
  return at_rest_;
}

}  // namespace mbk::laboratory
