#include "mbk/model/robot/capstan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mbk::robot {
namespace {

using Eigen::Vector2d;

TEST(Capstan, PullsWithItsStiffnessAndDamping) {
  const Capstan capstan{.stiffness = {400.0, 300.0}, .damping = {0.2, 0.1}};
  EXPECT_TRUE(capstan.torque({0.01, -0.02}, {1.0, 2.0}).isApprox(Vector2d(4.2, -5.8), 1e-15));
  EXPECT_EQ(capstan.torque(Vector2d::Zero(), Vector2d::Zero()), Vector2d::Zero());
}

TEST(Capstan, ATwistThatGoesRoundLosesWhatTheDampersTake) {
  // twist = a sin ωt on each joint: the springs give back what they took, the dampers keep π c ω a² a round
  const Capstan capstan;
  const double amplitude = 0.003, omega = 2.0 * std::numbers::pi * 5.0;
  constexpr int kSteps = 2000;  // the trapezoidal rule is exact for a whole period of few harmonics
  double work = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / kSteps;
    const Vector2d twist = Vector2d::Constant(amplitude * std::sin(phase));
    const Vector2d rate = Vector2d::Constant(amplitude * omega * std::cos(phase));
    work += capstan.torque(twist, rate).dot(rate) * 2.0 * std::numbers::pi / omega / kSteps;
  }
  const double kLost = std::numbers::pi * omega * amplitude * amplitude * capstan.damping.sum();
  EXPECT_NEAR(work, kLost, 1e-12 * kLost);
}

TEST(Capstan, TransmitsNothingInsideItsGapAndNeverPullsBack) {
  const Capstan capstan{.stiffness = {400.0, 400.0}, .damping = {0.2, 0.2}, .backlash = {0.01, 0.01}};
  EXPECT_EQ(capstan.torque({0.004, -0.005}, {3.0, -3.0}), Vector2d::Zero());
  EXPECT_TRUE(capstan.torque({0.006, -0.007}, {1.0, 0.0}).isApprox(Vector2d(0.4 + 0.2, -0.8), 1e-12));
  EXPECT_EQ(capstan.torque({0.006, -0.006}, {-3.0, 3.0}), Vector2d::Zero());  // parting faster than the spring follows
  EXPECT_TRUE(capstan.bend({0.006, -0.004}).isApprox(Vector2d(0.001, 0.0), 1e-12));
}

}  // namespace
}  // namespace mbk::robot
