#include "mbk/model/robot/friction.h"

#include <cmath>

namespace mbk::robot {

double JointFriction::dry_torque(double velocity) const {
  if (coulomb == 0.0 && breakaway == 0.0) return 0.0;
  double level = coulomb;
  if (breakaway > coulomb) {
    const double ratio = velocity / stribeck_velocity;
    level += (breakaway - coulomb) * std::exp(-ratio * ratio);
  }
  return level * std::tanh(velocity / smoothing);
}

}  // namespace mbk::robot
