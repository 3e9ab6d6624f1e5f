#include "mbk/simulate/laboratory/axis_loads.h"

#include <gtest/gtest.h>

#include <numbers>

#include "mbk/simulate/participant/arm.h"
#include "mbk/simulate/participant/linear_limb.h"

namespace mbk::laboratory {
namespace {

participant::HandState<1> moving(double position, double velocity) {
  return {AxisVector<1>(position), AxisVector<1>(velocity)};
}

TEST(MassSpringDamper, TakesItsForce) {
  const MassSpringDamper load(2.0, 3.0, 50.0);
  const auto dynamics = load.dynamics(moving(0.1, -0.4));
  EXPECT_DOUBLE_EQ(dynamics.inertia(0, 0), 2.0);
  EXPECT_DOUBLE_EQ(dynamics.bias[0], 50.0 * 0.1 - 3.0 * 0.4);
  EXPECT_DOUBLE_EQ(load.impedance(AxisVector<1>(0.0)).K(0, 0), 50.0);
}

TEST(AlongLine, OfALinearLimbIsItsImpedanceInThatDirection) {
  const impedance::Model model{
      (Matrix(2, 2) << 1.3, -0.9, -0.9, 1.9).finished(), (Matrix(2, 2) << 5.8, -2.1, -2.1, 10.6).finished(),
      (Matrix(2, 2) << 42.4, -28.6, -28.6, 125.3).finished(), (Vector(2) << 0.30, -0.05).finished()};
  auto limb = participant::LinearLimb::create(model).value();
  const double angle = 0.7;
  const Eigen::Vector2d u(std::cos(angle), std::sin(angle));
  const AlongLine load(limb, {0.30, -0.05}, angle);
  const double x = 0.02, v = 0.3;
  const auto dynamics = load.dynamics(moving(x, v));
  EXPECT_NEAR(dynamics.inertia(0, 0), u.dot(model.M * u), 1e-14);
  EXPECT_NEAR(dynamics.bias[0], u.dot(model.B * u) * v + u.dot(model.K * u) * x, 1e-13);
  const impedance::Model seen = load.impedance(AxisVector<1>(0.0));
  EXPECT_NEAR(seen.B(0, 0), u.dot(model.B * u), 1e-13);
  EXPECT_NEAR(seen.x0[0], 0.0, 1e-14);
}

TEST(AlongLine, OfAnArmOfTwoLinksIsStillAtItsEquilibrium) {
  auto options = participant::participant_options(1).value();
  options.remnant.floor = 0.0;
  auto arm = participant::Arm::create(options, 1e-3).value();
  AlongLine load(arm, {0.30, -0.05}, 0.5 * std::numbers::pi);
  load.tick(0.0, 1e-3, {}, AxisVector<1>(0.0));
  EXPECT_NEAR(load.dynamics({}).bias[0], 0.0, 1e-12);
  EXPECT_NEAR(load.dynamics({}).inertia(0, 0), 1.883, 1e-3);  // m_yy of participant 1
  EXPECT_NEAR(load.dynamics(moving(0.001, 0.0)).bias[0], 0.1253, 0.002);
}

}  // namespace
}  // namespace mbk::laboratory
