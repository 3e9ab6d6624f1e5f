#include "mbk/model/robot/momentum_observer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "mbk/model/robot/single_joint.h"
#include "mbk/model/robot/test_models.h"
#include "tests/support/allocations.h"

namespace mbk::robot {
namespace momentum_observer_test {

constexpr double kGain = 60.0, kTick = 1e-3;
constexpr double kRounding = 1e-12;  // of some N·m, over thousands of ticks
const Vector2d kPlace(0.4, 0.9);
const Vector2d kStill(0.0, 0.0);

DynamicModel thesis_robot() {
  PlanarRobot robot;
  robot.friction[0].coulomb = 0.11;
  robot.friction[1].coulomb = 0.1;
  return model_of(robot);
}

/// A mass that slides, without friction.
DynamicModel sliding(double mass) {
  return {std::make_shared<SingleJoint>(SingleJoint::Options{}),
          {.viscous = false, .coulomb = false, .offset = false},
          Vector::Constant(1, mass)};
}

JointVector one(double value) {
  return JointVector::Constant(1, value);
}

Vector2d at_joints(const Vector2d& force) {
  return jacobian(Geometry{}, kPlace).transpose() * force;
}

TEST(MomentumObserver, OfARobotAtRestApproachesTheForceOfTheHandExponentially) {
  const Vector2d force(3.0, -1.5);  // motors hold against it, τ = −Jᵀ F
  auto observer = MomentumObserver::create(thesis_robot(), kGain, kTick).value();
  for (int k = 0; k < 300; ++k) {
    const ObservedForce& seen = observer.step(kPlace, kStill, -at_joints(force));
    const double share = 1.0 - std::exp(-kGain * kTick * k);
    ASSERT_LE((seen.joint_torque - share * at_joints(force)).norm(), kRounding);
    ASSERT_LE((seen.force_hand_on_robot - share * force).norm(), kRounding);
  }
}

TEST(MomentumObserver, FeelsAHandThatPushesAFreeMassForwardAsAForceForward) {
  auto observer = MomentumObserver::create(sliding(2.0), kGain, kTick).value();
  for (int k = 0; k < 300; ++k) {
    const double t = k * kTick;  // a = 0.5 m/s² by 1 N
    const ObservedForce& seen = observer.step(one(0.25 * t * t), one(0.5 * t), one(0.0));
    ASSERT_NEAR(seen.force_hand_on_robot[0], 1.0 - std::exp(-kGain * t), kRounding);
  }
}

TEST(MomentumObserver, CountsTheInertiaOfTheMotorsAsMomentum) {
  DynamicModel model = sliding(2.0);
  model.drive.motor_inertia = true;
  model.parameters = Eigen::Vector2d(2.0, 0.5);
  auto observer = MomentumObserver::create(model, kGain, kTick).value();
  double seen = 0.0;
  for (int k = 0; k <= 300; ++k) seen = observer.step(one(0.0), one(0.4 * k * kTick), one(0.0)).joint_torque[0];
  EXPECT_NEAR(seen, 1.0 - std::exp(-kGain * 300 * kTick), kRounding);  // 2.5 kg · 0.4 m/s²
}

TEST(MomentumObserver, FindsNothingAtTheHandOfARobotThatMovesAsItsModel) {
  const DynamicModel model = thesis_robot();
  const JointMotion motion = Swing{}.sampled(3000, kTick);
  // The torque that is held over a tick acts as that of its middle.
  Matrix torque(3000, 2);
  const Swing swing;
  for (Index i = 0; i < 3000; ++i) {
    const double t = kTick * (static_cast<double>(i) + 0.5);
    JointMotion now{swing.position(t).transpose(), swing.velocity(t).transpose(), swing.acceleration(t).transpose()};
    torque.row(i) = model.torques(now);
  }
  auto observer = MomentumObserver::create(model, kGain, kTick).value();
  double largest = 0.0;
  for (Index i = 0; i < 3000; ++i) {
    largest = std::max(
        largest,
        observer.step(motion.position.row(i).transpose(), motion.velocity.row(i).transpose(), torque.row(i).transpose())
            .joint_torque.norm());
  }
  EXPECT_LT(largest, 2e-3);  // torques of 2 N·m; what is left are reversals, a dry friction of 0.1 N·m within one tick
}

/// The equation of the header in continuous time for a Swing and a torque that is held over each tick, by midpoint
/// steps: r at the ticks.
std::vector<Vector2d> twin(const DynamicModel& model, const std::vector<Vector2d>& torque, double tick, int substeps) {
  const Swing swing;
  const double h = tick / substeps;
  const Vector phi = model.parameters.head(3);
  struct Terms {
    Vector2d momentum, rest;
  };
  const auto terms = [&](double t) -> Terms {
    const Vector2d q = swing.position(t), v = swing.velocity(t);
    const JointTerms now = model.mechanism->terms(q, v, phi);
    return {now.inertia * v, now.coriolis_transposed - now.gravity - model.drive_torque(q, v, Vector2d::Zero())};
  };
  const Vector2d p0 = terms(0.0).momentum;
  Vector2d integral = Vector2d::Zero();  // ∫ (τ + b + r) dt
  std::vector<Vector2d> r;
  Terms now = terms(0.0);
  for (std::size_t k = 0; k < torque.size(); ++k) {
    for (int i = 0; i < substeps; ++i) {
      const double t = tick * static_cast<double>(k) + h * i;
      const Vector2d here = kGain * (now.momentum - p0 - integral);
      if (i == 0) r.push_back(here);
      const Terms middle = terms(t + 0.5 * h);
      const Vector2d half = integral + 0.5 * h * (torque[k] + now.rest + here);
      integral += h * (torque[k] + middle.rest + kGain * (middle.momentum - p0 - half));
      now = terms(t + h);
    }
  }
  return r;
}

/// Largest difference between the observer and its twin over one second of a swing with torques of some N·m.
double difference_from_twin(double tick) {
  DynamicModel model = thesis_robot();
  model.drive.smoothing = 0.5;  // so that friction is smooth on the scale of a tick
  const Swing swing;
  const auto ticks = static_cast<std::size_t>(std::llround(1.0 / tick));
  std::vector<Vector2d> torque;
  for (std::size_t k = 0; k < ticks; ++k) {
    const double t = tick * (static_cast<double>(k) + 0.5);
    torque.emplace_back(1.5 * std::sin(7.0 * t), -std::cos(11.0 * t));
  }
  const std::vector<Vector2d> expected = twin(model, torque, tick, 50);
  auto observer = MomentumObserver::create(model, kGain, tick).value();
  double largest = 0.0;
  for (std::size_t k = 0; k < ticks; ++k) {
    const double t = tick * static_cast<double>(k);
    const ObservedForce& seen = observer.step(swing.position(t), swing.velocity(t), torque[k]);
    largest = std::max(largest, (seen.joint_torque - expected[k]).norm());
  }
  return largest;
}

TEST(MomentumObserver, AgreesWithASlowIntegrationOfItsEquation) {
  EXPECT_LT(difference_from_twin(kTick), 2e-4);  // of some N·m; T² times second derivatives
}

TEST(MomentumObserver, ErrsWithTheSquareOfTheTick) {
  EXPECT_NEAR(difference_from_twin(2e-3) / difference_from_twin(1e-3), 4.0, 0.4);
}

TEST(MomentumObserver, HoldsARampBackByItsLag) {
  const double kSlope = 2.0;  // [N/s]
  auto observer = MomentumObserver::create(sliding(1.0), kGain, kTick).value();
  double seen = 0.0;
  for (int k = 0; k <= 2000; ++k) {  // at rest: the motors hold against the mean of the tick
    seen = observer.step(one(0.0), one(0.0), one(-kSlope * kTick * (k + 0.5))).force_hand_on_robot[0];
  }
  EXPECT_NEAR(seen, kSlope * (2000 * kTick - observer.lag()), kRounding);
  EXPECT_NEAR(observer.lag(), 1.0 / kGain, kGain * kTick * kTick / 12.0);
}

TEST(MomentumObserver, LetsTheTorqueActAfterTheDelayOfTheModel) {
  DynamicModel model = sliding(1.0);
  const auto held = [](double t) { return std::sin(0.3 * std::floor(t / kTick + 1e-9)); };
  for (const double ticks : {0.0, 0.4, 1.0, 2.3}) {
    model.delay = ticks * kTick;
    auto observer = MomentumObserver::create(model, kGain, kTick).value();
    auto plain = MomentumObserver::create(sliding(1.0), kGain, kTick).value();
    for (int k = 0; k < 200; ++k) {
      // The mean of the delayed torque over the next tick, by many small parts
      double mean = 0.0;
      constexpr int kParts = 1000;
      for (int i = 0; i < kParts; ++i) {
        mean += held(std::max(0.0, (k + (i + 0.5) / kParts) * kTick - model.delay)) / kParts;
      }
      const double expected = plain.step(one(0.0), one(0.0), one(mean)).joint_torque[0];
      ASSERT_NEAR(observer.step(one(0.0), one(0.0), one(held(k * kTick))).joint_torque[0], expected, 1e-9)
          << ticks << " ticks late, tick " << k;
    }
  }
}

TEST(MomentumObserver, BeginsAgainAfterASampleThatIsNoNumber) {
  const Vector2d force(3.0, -1.5);
  auto observer = MomentumObserver::create(thesis_robot(), kGain, kTick).value();
  for (int k = 0; k < 100; ++k) observer.step(kPlace, kStill, -at_joints(force));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ObservedForce& seen = observer.step(kPlace, Vector2d(nan, 0.0), -at_joints(force));
  EXPECT_TRUE(seen.joint_torque.array().isNaN().all());
  EXPECT_TRUE(seen.force_hand_on_robot.array().isNaN().all());
  auto fresh = MomentumObserver::create(thesis_robot(), kGain, kTick).value();
  for (int k = 0; k < 100; ++k) {
    const Vector again = observer.step(kPlace, kStill, -at_joints(force)).force_hand_on_robot;
    EXPECT_EQ(again, Vector(fresh.step(kPlace, kStill, -at_joints(force)).force_hand_on_robot));
  }
}

TEST(MomentumObserver, KnowsTheJointsButNotTheHandInASingularPosture) {
  const Vector2d folded(0.5 * std::numbers::pi, 0.0), torque(0.2, 0.1);
  auto observer = MomentumObserver::create(thesis_robot(), kGain, kTick).value();
  observer.step(folded, kStill, torque);
  const ObservedForce& seen = observer.step(folded, kStill, torque);
  EXPECT_TRUE(seen.joint_torque.allFinite());
  EXPECT_TRUE(seen.force_hand_on_robot.array().isNaN().all());
}

TEST(MomentumObserver, ObservesARobotWithMoreJointsThanAxesUnderGravity) {
  const auto mechanism = std::make_shared<ThreePointMasses>();
  const DynamicModel model{
      mechanism, {.coulomb = false, .offset = false}, (Vector(6) << 1.0, 0.8, 0.5, 0.1, 0.1, 0.1).finished()};
  const JointVector q = Eigen::Vector3d(0.2, 0.7, -0.4), still = JointVector::Zero(3);
  const Vector2d force(2.0, -1.0);
  const JointVector holding =
      mechanism->terms(q, still, model.parameters.head(3)).gravity - mechanism->jacobian(q).transpose() * force;
  auto observer = MomentumObserver::create(model, kGain, kTick).value();
  Vector seen;
  for (int k = 0; k <= 1000; ++k) seen = observer.step(q, still, holding).force_hand_on_robot;
  EXPECT_LE((seen - force).norm(), kRounding);
}

TEST(MomentumObserver, DoesNotAllocate) {
  auto observer = MomentumObserver::create(thesis_robot(), kGain, kTick).value();
  auto by_encoder = EncoderMomentumObserver::create(thesis_robot(), {}, kTick).value();
  const Swing swing;
  const long before = testing_support::allocations();
  double sum = 0.0;
  for (int k = 0; k < 100; ++k) {
    const double t = kTick * k;
    const Vector2d torque(k == 50 ? std::numeric_limits<double>::quiet_NaN() : 0.1, 0.2);
    sum += observer.step(swing.position(t), swing.velocity(t), torque).force_hand_on_robot[0];
    sum += by_encoder.step(swing.position(t), torque).force_hand_on_robot[0];
  }
  EXPECT_EQ(testing_support::allocations(), before) << sum;
  const auto counted = std::make_unique<double>(1.0);
  EXPECT_GT(testing_support::allocations(), before) << "the counter counts: " << *counted;
}

TEST(MomentumObserver, RefusesGainsTimesAndModelsThatAreNone) {
  EXPECT_THAT(MomentumObserver::create(thesis_robot(), 0.0, kTick).error().message,
              AllOf(testing::HasSubstr("gain"), testing::HasSubstr("0 1/s")));
  EXPECT_EQ(MomentumObserver::create(thesis_robot(), kGain, -kTick).error().kind, ErrorKind::usage);
  DynamicModel model = thesis_robot();
  model.delay = -0.001;
  EXPECT_THAT(MomentumObserver::create(model, kGain, kTick).error().message, testing::HasSubstr("-0.001 s"));
  model.delay = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(MomentumObserver::create(model, kGain, kTick));
  model = thesis_robot();
  model.parameters.conservativeResize(8);
  EXPECT_THAT(MomentumObserver::create(model, kGain, kTick).error().message,
              AllOf(testing::HasSubstr("8 parameters"), testing::HasSubstr("9 coefficients")));
  EXPECT_FALSE(EncoderMomentumObserver::create(thesis_robot(), {.velocity_cutoff = Hertz(0.0)}, kTick));
}

TEST(EncoderMomentumObserver, HoldsARampBackByItsLag) {
  const double kSlope = 2.0;  // [N/s]
  auto observer = EncoderMomentumObserver::create(sliding(1.0), {}, kTick).value();
  double seen = 0.0;
  for (int k = 0; k <= 2000; ++k) {
    seen = observer.step(one(0.0), one(-kSlope * kTick * (k + 0.5))).force_hand_on_robot[0];
  }
  EXPECT_NEAR(seen, kSlope * (2000 * kTick - observer.lag()), kRounding);
  EXPECT_NEAR(observer.lag(), 1.0 / kGain + 1.0 / (2.0 * std::numbers::pi * 100.0), 1e-4);
}

TEST(EncoderMomentumObserver, IsAsLateForAForceThatAcceleratesAsForOneThatTheMotorsHold) {
  // A mass swung by the hand alone, and the same motion by motors alone, whose torque must cancel.
  constexpr double kMass = 2.0, kOmega = 20.0, kReach = 0.01;
  auto by_hand = EncoderMomentumObserver::create(sliding(kMass), {}, kTick).value();
  auto by_motors = EncoderMomentumObserver::create(sliding(kMass), {}, kTick).value();
  const double peak = kMass * kReach * kOmega * kOmega;  // 8 N
  double of_hand = 0.0, of_motors = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double t = k * kTick;
    const JointVector q = one(kReach * std::sin(kOmega * t));
    const double seen = by_hand.step(q, one(0.0)).force_hand_on_robot[0];
    const double left = by_motors.step(q, one(-peak * std::sin(kOmega * (t + 0.5 * kTick)))).force_hand_on_robot[0];
    if (k < 1000) continue;
    of_hand = std::max(of_hand, std::abs(seen + peak * std::sin(kOmega * (t - by_hand.lag()))));
    of_motors = std::max(of_motors, std::abs(left));
  }
  EXPECT_LT(of_hand, 0.06 * peak);    // a low-pass of 60 1/s at 20 1/s: gain 0.949, and a delay below that at zero
  EXPECT_LT(of_motors, 1e-4 * peak);  // differences of a tick
}

TEST(EncoderMomentumObserver, BeginsAgainAfterASampleThatIsNoNumber) {
  auto observer = EncoderMomentumObserver::create(thesis_robot(), {}, kTick).value();
  auto fresh = EncoderMomentumObserver::create(thesis_robot(), {}, kTick).value();
  const Swing swing;
  for (int k = 0; k < 50; ++k) observer.step(swing.position(k * kTick), Vector2d(0.3, 0.1));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(observer.step(Vector2d(nan, 0.4), Vector2d(0.3, 0.1)).force_hand_on_robot.array().isNaN().all());
  for (int k = 50; k < 100; ++k) {
    const Vector again = observer.step(swing.position(k * kTick), Vector2d(0.3, 0.1)).force_hand_on_robot;
    EXPECT_EQ(again, Vector(fresh.step(swing.position(k * kTick), Vector2d(0.3, 0.1)).force_hand_on_robot));
  }
}

}  // namespace momentum_observer_test
}  // namespace mbk::robot
