#include "mbk/model/robot/friction.h"

#include <algorithm>
#include <cmath>

namespace mbk::robot {

double JointFriction::dry_torque(double velocity) const {
  if (coulomb == 0.0 && breakaway == 0.0) return 0.0;
  const double extra = std::max(0.0, breakaway - coulomb);
  const double ratio = velocity / stribeck_velocity;
  return (coulomb + extra * std::exp(-ratio * ratio)) * std::tanh(velocity / smoothing);
}

}  // namespace mbk::robot
