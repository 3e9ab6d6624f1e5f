#include "mbk/simulate/participant/one_axis_joint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace mbk::participant {
namespace one_axis_joint_test {

constexpr double kTick = 1e-3;

HandState<1> moving(double position, double velocity) {
  return {AxisVector<1>(position), AxisVector<1>(velocity)};
}

OneAxisJoint::Options calm() {
  OneAxisJoint::Options options;
  options.remnant.floor = 0.0;
  return options;
}

TEST(OneAxisJoint, WithoutReflexIsInertiaViscosityAndStiffness) {
  OneAxisJoint::Options options = calm();
  options.rest = 0.1;
  OneAxisJoint joint = OneAxisJoint::create(options, kTick).value();
  joint.tick(0.0, kTick, moving(0.3, 2.0), AxisVector<1>(0.0));
  const LoadDynamics<1> load = joint.dynamics(moving(0.3, 2.0));
  EXPECT_EQ(load.inertia(0, 0), 0.015);
  EXPECT_NEAR(load.bias[0], 0.8 * 2.0 + 45.0 * 0.2, 1e-14);
  const impedance::Model model = joint.impedance(AxisVector<1>(0.3));
  EXPECT_EQ(model.M(0, 0), 0.015);
  EXPECT_EQ(model.B(0, 0), 0.8);
  EXPECT_EQ(model.K(0, 0), 45.0);
  EXPECT_EQ(model.x0[0], 0.1);
}

TEST(StretchReflex, AnswersAStretchAfterItsDelayAsTheClosedForm) {
  const double omega = 20.0, gain = 3.0, velocity = 0.5;
  for (const double zeta : {0.5, 1.0}) {
    auto reflex =
        StretchReflex::create(
            {.gain = gain, .delay = 0.04, .natural_frequency = RadPerSec(omega), .damping_ratio = zeta}, kTick)
            .value();
    for (int i = 0; i < 600; ++i) {
      const double torque = reflex.step(velocity), t = i * kTick - 0.04;
      double step = 0.0;  // of H(s)
      if (t > 0.0 && zeta == 1.0) step = 1.0 - std::exp(-omega * t) * (1.0 + omega * t);
      if (t > 0.0 && zeta < 1.0) {
        const double damped = omega * std::sqrt(1.0 - zeta * zeta);
        step =
            1.0 - std::exp(-zeta * omega * t) * (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t));
      }
      EXPECT_NEAR(torque, gain * velocity * step, 1e-12) << zeta << ", tick " << i;
    }
  }
}

TEST(StretchReflex, IgnoresShorteningAndMirrorsWithItsDirection) {
  auto extensor = StretchReflex::create({.gain = 3.0}, kTick).value();
  auto flexor = StretchReflex::create({.gain = 3.0, .stretched_by_positive_velocity = false}, kTick).value();
  double last = 0.0, mirrored = 0.0;
  for (int i = 0; i < 500; ++i) {
    last = extensor.step(-1.0);
    mirrored = flexor.step(-1.0);
    EXPECT_EQ(last, 0.0);
  }
  EXPECT_LT(mirrored, -1.0);  // resists: h has the sign of the velocity
}

TEST(OneAxisJoint, ReflexResistsTheStretchThatCausedIt) {
  OneAxisJoint::Options options = calm();
  options.reflex.gain = 3.0;
  OneAxisJoint joint = OneAxisJoint::create(options, kTick).value();
  for (int i = 0; i < 1000; ++i) joint.tick(i * kTick, kTick, moving(0.0, 1.0), AxisVector<1>(0.0));
  EXPECT_NEAR(joint.dynamics({}).bias[0], 3.0, 1e-9);
}

TEST(OneAxisJoint, RefusesWhatIsNoJoint) {
  OneAxisJoint::Options options = calm();
  options.inertia = 0.0;
  EXPECT_NE(OneAxisJoint::create(options, kTick).error().message.find(" 0 kg·m²"), std::string::npos);
  options = calm();
  options.reflex.delay = -0.01;
  EXPECT_FALSE(OneAxisJoint::create(options, kTick));
  options = calm();
  options.reflex.natural_frequency = RadPerSec(2000.0);
  EXPECT_FALSE(OneAxisJoint::create(options, kTick));
}

}  // namespace one_axis_joint_test
}  // namespace mbk::participant
