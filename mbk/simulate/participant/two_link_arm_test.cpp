#include "mbk/simulate/participant/two_link_arm.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "mbk/base/numeric/dense.h"

namespace mbk::participant {
namespace two_link_arm_test {

const Vector2d kHome(0.30, -0.05);
const Matrix2d kZero = Matrix2d::Zero();

TwoLinkArm::Options asymmetric() {
  TwoLinkArm::Options options;
  options.joints.stiffness << 11.0, 3.5, 2.3, 4.8;
  options.geometry.rotation = 0.2;
  return options;
}

/// What the hand exerts on the robot in a motion.
Vector2d force(const TwoLinkArm& arm, const HandState<2>& hand, const Vector2d& acceleration) {
  const LoadDynamics<2> load = arm.dynamics(hand);
  return -(load.inertia * acceleration + load.bias);
}

TEST(TwoLinkArm, DefaultIsTheFirstParticipantsHand) {
  const impedance::Model hand = TwoLinkArm::create({}).value().impedance(kHome);
  const double rounding = 0.06;  // K_q is given with two digits, its K at the hand with one decimal
  const Matrix2d K = (Matrix2d() << 40.7, -29.6, -29.6, 128.0).finished();
  EXPECT_LT((hand.K - K).cwiseAbs().maxCoeff(), rounding);
  EXPECT_LT((Vector2d(hand.x0) - kHome).norm(), 1e-12);
  // Near the first participant's relaxed arm: M 1.326 1.883 −0.935, B 5.76 10.56 −2.14 (tables 3.3 and 3.5)
  EXPECT_LT((hand.M - (Matrix2d() << 1.326, -0.935, -0.935, 1.883).finished()).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT((hand.B - (Matrix2d() << 5.76, -2.14, -2.14, 10.56).finished()).cwiseAbs().maxCoeff(), 0.7);
}

TEST(TwoLinkArm, SaysTheSameOfAPlaceWhateverItWasAskedBefore) {
  const Vector2d elsewhere = kHome + Vector2d(0.05, 0.03);
  const HandState<2> hand = {kHome, {0.1, -0.2}, 0.0, 0.0};
  const auto changed = [] {
    TwoLinkArm arm = TwoLinkArm::create(asymmetric()).value();
    arm.scale(2.0, 1.5);
    arm.rest_at(kHome + Vector2d(0.01, 0.0));
    return arm;
  };
  TwoLinkArm asked = TwoLinkArm::create(asymmetric()).value();
  EXPECT_NE(asked.dynamics(hand).bias, changed().dynamics(hand).bias);
  asked.scale(2.0, 1.5);
  asked.rest_at(kHome + Vector2d(0.01, 0.0));
  for (const Vector2d& before : {kHome, elsewhere}) {
    static_cast<void>(asked.kinetic_energy({before, {1.0, 0.0}, 0.0, 0.0}));
    EXPECT_EQ(asked.dynamics(hand).inertia, changed().dynamics(hand).inertia);
    EXPECT_EQ(asked.dynamics(hand).bias, changed().dynamics(hand).bias);
    EXPECT_EQ(asked.stiffness(kHome), changed().stiffness(kHome));
    EXPECT_EQ(asked.kinetic_energy(hand), changed().kinetic_energy(hand));
    EXPECT_EQ(asked.impedance(kHome).x0, changed().impedance(kHome).x0);
  }
}

TEST(ChainInertia, ComesFromItsMatrixAtOnePosture) {
  const JointParameters joints;
  const ChainInertia chain = ChainInertia::from_matrix(joints.inertia, joints.elbow_angle).value();
  EXPECT_NEAR(chain.a, 0.304, 5e-4);
  EXPECT_NEAR(chain.b, 0.1006, 1e-4);
  EXPECT_EQ(chain.c, 0.072);
  EXPECT_LT((chain.matrix(Elbow::at(joints.elbow_angle)) - joints.inertia).norm(), 1e-15);
  for (double elbow = 0.0; elbow < 3.2; elbow += 0.1) {
    EXPECT_GT(numeric::symmetric_eigenvalues(chain.matrix(Elbow::at(elbow)))[0], 0.0) << elbow;
  }
}

TEST(ChainInertia, RefusesWhatIsNoInertiaInPosturesNearby) {
  const Matrix2d second_participant = (Matrix2d() << 0.3518, 0.1069, 0.1069, 0.0649).finished();
  EXPECT_TRUE(ChainInertia::from_matrix(second_participant, 1.2886));  // c (a − c) < b², but cos² q₂ is small enough
  const Matrix2d bent = (Matrix2d() << 0.3518, 0.13, 0.13, 0.0649).finished();
  const auto refused = ChainInertia::from_matrix(bent, 1.2886);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("inertia"), std::string::npos);
  EXPECT_FALSE(ChainInertia::from_matrix(JointParameters{}.inertia, 1.5708));
  EXPECT_FALSE(ChainInertia::from_matrix((Matrix2d() << 0.36, 0.1, 0.2, 0.072).finished(), 1.2886));
}

TEST(TwoLinkArm, JointParametersGiveBackTheHand) {
  impedance::Model hand;
  hand.M = (Matrix2d() << 1.326, -0.935, -0.935, 1.883).finished();
  hand.B = (Matrix2d() << 5.76, -2.14, -2.14, 10.56).finished();
  hand.K = (Matrix2d() << 42.4, -20.9, -36.3, 125.3).finished();
  hand.x0 = kHome;
  TwoLinkArm::Options options;
  options.joints = joint_parameters(options.geometry, hand).value();
  const impedance::Model again = TwoLinkArm::create(options).value().impedance(kHome);
  EXPECT_LT((impedance::stacked(again) - impedance::stacked(hand)).norm(), 1e-12 * impedance::stacked(hand).norm());
  const double det = jacobian(options.geometry, joint_angles(options.geometry, kHome)).determinant();
  const double k_a = 0.5 * (hand.K(0, 1) - hand.K(1, 0));
  EXPECT_NEAR(0.5 * (options.joints.stiffness(0, 1) - options.joints.stiffness(1, 0)), det * k_a, 1e-12);
}

TEST(TwoLinkArm, ImpedanceIsTheSlopeOfTheForceAtAnyPlace) {
  TwoLinkArm arm = TwoLinkArm::create(asymmetric()).value();
  arm.scale(3.0, 2.0);
  const Vector2d place = kHome + Vector2d(0.06, -0.04);  // away from rest, where the geometric term counts
  const impedance::Model model = arm.impedance(place);
  const double step = 1e-5;  // curvature of the force, below 1e5 N/m³, leaves 1e-5; rounding leaves 1e-10
  for (int axis = 0; axis < 2; ++axis) {
    const Vector2d e = Vector2d::Unit(axis);
    const Vector2d K = -(force(arm, {place + step * e}, {0, 0}) - force(arm, {place - step * e}, {0, 0})) / (2 * step);
    const Vector2d B = -(force(arm, {place, step * e}, {0, 0}) - force(arm, {place, -step * e}, {0, 0})) / (2 * step);
    const Vector2d M = -(force(arm, {place}, e) - force(arm, {place}, {0, 0}));
    EXPECT_LT((K - model.K.col(axis)).norm(), 1e-5);
    EXPECT_LT((B - model.B.col(axis)).norm(), 1e-8);
    EXPECT_LT((M - model.M.col(axis)).norm(), 1e-12);
  }
  EXPECT_LT((model.K * (place - Vector2d(model.x0)) + force(arm, {place}, {0, 0})).norm(), 1e-12);
  EXPECT_LT((arm.stiffness(place) - model.K).norm(), 1e-12);
}

TEST(TwoLinkArm, WithoutDampingAFreeHandKeepsItsEnergy) {
  TwoLinkArm::Options options;
  options.joints.damping = kZero;
  const TwoLinkArm arm = TwoLinkArm::create(options).value();
  using State = Eigen::Vector4d;
  const auto derivative = [&](const State& s) -> State {
    const LoadDynamics<2> load = arm.dynamics({s.head<2>(), s.tail<2>()});
    return (State() << s.tail<2>(), -load.inertia.inverse() * load.bias).finished();
  };
  const auto energy = [&](const State& s) {
    return arm.kinetic_energy({s.head<2>(), s.tail<2>()}) + arm.elastic_energy(s.head<2>());
  };
  State state;
  state << kHome + Vector2d(0.08, -0.06), 0.3, -0.2;
  const double before = energy(state);
  const double step = 1e-4;
  for (int i = 0; i < 30000; ++i) {
    const State k1 = derivative(state), k2 = derivative(state + 0.5 * step * k1);
    const State k3 = derivative(state + 0.5 * step * k2), k4 = derivative(state + step * k3);
    state += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  EXPECT_GT(arm.kinetic_energy({state.head<2>(), state.tail<2>()}), 0.01 * before);  // it did move
  EXPECT_NEAR(energy(state), before, 1e-9 * before);  // Runge–Kutta at 1e-4 s leaves about 1e-12
}

TEST(TwoLinkArm, ObeysItsEquationOfMotionInTheJoints) {
  const TwoLinkArm arm = TwoLinkArm::create(asymmetric()).value();
  const TwoLinkArm::Options options = asymmetric();
  const Vector2d q(0.9, 1.5), q_rate(1.2, -2.0), q_acceleration(-7.0, 11.0);
  const Matrix2d J = jacobian(arm.geometry(), q);
  const HandState<2> hand = {hand_position(arm.geometry(), q), J * q_rate};
  const Vector2d acceleration = J * q_acceleration + jacobian_rate(arm.geometry(), q, q_rate) * q_rate;
  const Vector2d q0 = joint_angles(arm.geometry(), kHome);
  const Vector2d torque = arm.inertia().matrix(Elbow::at(q[1])) * q_acceleration +
                          arm.inertia().coriolis_torque(Elbow::at(q[1]), q_rate) + options.joints.damping * q_rate +
                          options.joints.stiffness * (q - q0);
  EXPECT_LT((J.transpose() * force(arm, hand, acceleration) + torque).norm(), 1e-12 * torque.norm());
}

TEST(TwoLinkArm, CocontractionScalesStiffnessAndDampingOnly) {
  TwoLinkArm arm = TwoLinkArm::create({}).value();
  const impedance::Model relaxed = arm.impedance(kHome);
  arm.scale(7.0, 4.0);
  const impedance::Model rigid = arm.impedance(kHome);
  EXPECT_LT((rigid.K - 7.0 * relaxed.K).norm(), 1e-12 * rigid.K.norm());
  EXPECT_LT((rigid.B - 4.0 * relaxed.B).norm(), 1e-12 * rigid.B.norm());
  EXPECT_EQ(rigid.M, relaxed.M);
}

TEST(TwoLinkArm, RefusesWhatIsNoArm) {
  TwoLinkArm::Options options;
  options.equilibrium = {0.30, 0.10};
  const std::string refused = TwoLinkArm::create(options).error().message;
  for (const char* const length : {"0.67 m", "0.31", "0.34 m"})
    EXPECT_NE(refused.find(length), std::string::npos) << refused;
  options = {};
  options.geometry.forearm = 0.0;
  EXPECT_FALSE(TwoLinkArm::create(options));
  options = {};
  options.joints.stiffness(0, 1) = NAN;
  EXPECT_FALSE(TwoLinkArm::create(options));
}

}  // namespace two_link_arm_test
}  // namespace mbk::participant
