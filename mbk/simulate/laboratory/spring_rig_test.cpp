#include "mbk/simulate/laboratory/spring_rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mbk/experiment/control/laws.h"
#include "mbk/simulate/laboratory/closed_loop.h"

namespace mbk::laboratory {
namespace {

const Vector2d kRest(0.39, 0.0);

/// Four springs of unequal strength in the corners of the frame, in holes of the disc.
std::vector<Spring> springs() {
  const double k[] = {120.0, 90.0, 100.0, 150.0};
  std::vector<Spring> all;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d corner((i < 2 ? 1.0 : -1.0) * 0.175, (i % 2 == 0 ? 1.0 : -1.0) * 0.183);
    all.push_back({k[i], 0.12, kRest + corner, 0.01125 * corner.normalized()});
  }
  return all;
}

SpringRig rig(double damping = 0.0, double disc_zero = 0.5) {
  return SpringRig::create(springs(), 0.8, damping * Matrix2d::Identity(), disc_zero, kRest).value();
}

TEST(SpringRig, ExertsTheForceAndMomentOfItsSpringsAndTheDrag) {
  const SpringRig load = rig(2.0);
  const auto array = calibration::SpringArray::create(springs()).value();
  const participant::HandState<2> hand{kRest + Vector2d(0.01, -0.02), {0.1, 0.3}, 0.57, 0.2};
  const participant::LoadDynamics<2> dynamics = load.dynamics(hand);
  EXPECT_EQ(dynamics.inertia, 0.8 * Matrix2d::Identity());
  EXPECT_LT((dynamics.bias - (2.0 * hand.velocity - array.force(hand.position, 0.57 - 0.5))).norm(), 1e-14);
  EXPECT_EQ(dynamics.moment, array.moment(hand.position, 0.57 - 0.5));
}

TEST(SpringRig, TruthIsTheStiffnessWhereTheSpringsRest) {
  const SpringRig load = rig();
  const auto array = calibration::SpringArray::create(springs()).value();
  const impedance::Model truth = load.impedance(kRest);
  const Vector2d rest = truth.x0;
  EXPECT_LE(array.force(rest).norm(), calibration::kEquilibriumForce);
  EXPECT_EQ(truth.K, Matrix(array.stiffness(rest)));
  EXPECT_EQ(truth.M, Matrix(0.8 * Matrix2d::Identity()));
}

TEST(SpringRig, EnergyBalancesWithADiscThatTurnsWithTheLink) {
  SpringRig load = rig(1.0);
  const auto array = calibration::SpringArray::create(springs()).value();
  ClosedLoop<2> loop = ClosedLoop<2>::create({}, kRest, load).value();
  const control::ForceControl force(robot::Geometry{});
  TrueState<2> first, last;
  double dragged = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double t = loop.time();
    last = loop.hold(force.step(loop.motor_angle(), {3.0 * std::sin(7.0 * t), 2.0 * std::sin(5.0 * t)}), 1e-3);
    if (i == 0) first = last;
    dragged += last.velocity.squaredNorm() * 1e-3;
    loop.advance();
  }
  const EnergyLedger& e = last.energy;
  EXPECT_NEAR(e.absorbed, e.motors - e.viscous - last.kinetic_energy, 1e-6 * e.motors);
  // What was absorbed is in the springs, the payload and the dampers: only so if the moment does its work too
  const auto stored = [&](const TrueState<2>& state) {
    return array.energy(state.position, state.theta[1] - 0.5) + 0.5 * 0.8 * state.velocity.squaredNorm();
  };
  EXPECT_NEAR(e.absorbed, stored(last) - stored(first) + dragged, 2e-4 * e.motors);  // rectangles for the dampers
}

TEST(SpringRig, RefusesSpringsThatHoldNothing) {
  std::vector<Spring> slack = springs();
  for (Spring& spring : slack) spring.rest_length = 1.0;
  EXPECT_FALSE(SpringRig::create(slack, 0.8, Matrix2d::Zero(), 0.0, kRest));
  EXPECT_FALSE(SpringRig::create({}, 0.8, Matrix2d::Zero(), 0.0, kRest));
  const std::string refused = SpringRig::create(springs(), -1.0, Matrix2d::Zero(), 0.0, kRest).error().message;
  EXPECT_NE(refused.find("-1 kg"), std::string::npos) << refused;
}

}  // namespace
}  // namespace mbk::laboratory
