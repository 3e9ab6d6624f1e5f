#include "mbk/model/robot/hand_kinematics.h"

#include <cmath>

namespace mbk::robot {

HandKinematics<1> hand_kinematics(const OneAxisGeometry& geometry, const AxisVector<1>& joint,
                                  const AxisVector<1>& joint_rate) {
  return {hand_position(geometry, joint), jacobian(geometry, joint), jacobian_rate(geometry, joint, joint_rate)};
}

HandKinematics<2> hand_kinematics(const Geometry& geometry, const Vector2d& theta, const Vector2d& theta_rate) {
  const double s1 = std::sin(theta[0]), c1 = std::cos(theta[0]), s2 = std::sin(theta[1]), c2 = std::cos(theta[1]);
  const double first = geometry.d1 * theta_rate[0], last = geometry.d2 * theta_rate[1];
  HandKinematics<2> hand;
  hand.position = geometry.d1 * Vector2d(c1, s1) + geometry.d2 * Vector2d(s2, -c2);
  hand.J << -geometry.d1 * s1, geometry.d2 * c2, geometry.d1 * c1, geometry.d2 * s2;
  hand.J_rate << -first * c1, -last * s2, -first * s1, last * c2;
  return hand;
}

}  // namespace mbk::robot
