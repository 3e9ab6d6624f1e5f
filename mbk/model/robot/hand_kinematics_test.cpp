#include "mbk/model/robot/hand_kinematics.h"

#include <gtest/gtest.h>

namespace mbk::robot {
namespace hand_kinematics_test {

TEST(HandKinematics, AreThoseOfThePartsToTheLastBit) {
  const Geometry geometry;
  for (double first = -0.9; first < 1.5; first += 0.17) {
    for (double last = 0.0; last < 2.5; last += 0.23) {
      const Vector2d theta(first, last), rate(0.3 - first, 0.7 * last);
      const HandKinematics<2> hand = hand_kinematics(geometry, theta, rate);
      EXPECT_EQ(hand.position, hand_position(geometry, theta));
      EXPECT_EQ(hand.J, jacobian(geometry, theta));
      EXPECT_EQ(hand.J_rate, jacobian_rate(geometry, theta, rate));
    }
  }
}

TEST(HandKinematics, OfOneAxisAreThatAxis) {
  const HandKinematics<1> hand = hand_kinematics(OneAxisGeometry{}, AxisVector<1>(0.4), AxisVector<1>(2.0));
  EXPECT_EQ(hand.position[0], 0.4);
  EXPECT_EQ(hand.J(0, 0), 1.0);
  EXPECT_EQ(hand.J_rate(0, 0), 0.0);
}

}  // namespace hand_kinematics_test
}  // namespace mbk::robot
