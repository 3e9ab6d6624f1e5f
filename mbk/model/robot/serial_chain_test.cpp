#include "mbk/model/robot/serial_chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <thread>

#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/robot/dynamics.h"
#include "mbk/model/robot/test_chains.h"
#include "tests/support/allocations.h"

namespace mbk::robot {
namespace serial_chain_test {

using ::testing::HasSubstr;
using Axis = SerialChain::Axis;

constexpr double kRounding = 1e-12;  // relative, over chains of rotations
const std::vector<std::string> kKinds = {"R", "P", "RRR", "RPR", "PPR", "RCPRRP", "RRRRRRR", "CRRPRRRR"};

std::shared_ptr<const SerialChain> chain(const std::string& urdf, const SerialChain::Options& options = {}) {
  auto made = SerialChain::from_urdf(urdf, options);
  EXPECT_TRUE(made) << made.error().line();
  return made.value();
}

std::string refusal(const std::string& urdf, const SerialChain::Options& options = {}) {
  const auto made = SerialChain::from_urdf(urdf, options);
  return made ? "nothing was refused" : made.error().line();
}

Matrix regressor(const Mechanism& robot, const JointVector& q, const JointVector& dq, const JointVector& ddq) {
  Matrix Y(robot.joints(), static_cast<Index>(robot.coefficients().size()));
  robot.regressor(q, dq, ddq, Y);
  return Y;
}

/// Two links in the plane of x and z, hanging down at zero; the second angle is relative to the first link.
std::string pendulum(const std::string& inside_first = "", const std::string& after = "") {
  return R"(<robot name="pendulum"><link name="stand"/>
    <link name="upper"><inertial><origin xyz="0 0 -0.12"/><mass value="0.8"/>
      <inertia ixx="0.01" iyy="0.006" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <link name="lower"><inertial><origin xyz="0 0 -0.1"/><mass value="0.5"/>
      <inertia ixx="0.004" iyy="0.003" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="shoulder" type="continuous"><parent link="stand"/><child link="upper"/><axis xyz="0 -1 0"/>)" +
         inside_first + R"(</joint>
    <joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.3"/>
      <axis xyz="0 -1 0"/></joint>)" +
         after + "</robot>";
}

SerialChain::Options vertical_plane(double lower_length) {
  SerialChain::Options options;
  options.hand_axes = {Axis::x, Axis::z};
  options.tool = {0.0, 0.0, -lower_length};
  return options;
}

TEST(SerialChain, OfTwoHangingLinksHasTheClosedFormOfTheDoublePendulum) {
  const auto robot = chain(pendulum(), vertical_plane(0.25));
  const double m1 = 0.8, c1 = 0.12, I1 = 0.006, l1 = 0.3, m2 = 0.5, c2 = 0.1, I2 = 0.003, l2 = 0.25, g = 9.81;
  RandomChain random("RR", 3);
  for (int i = 0; i < 100; ++i) {
    const JointVector q = random.uniform_joints(3.0), v = random.uniform_joints(5.0), a = random.uniform_joints(30.0);
    const double s2 = std::sin(q[1]), k2 = std::cos(q[1]), s12 = std::sin(q[0] + q[1]), k12 = std::cos(q[0] + q[1]);
    const double a1 = a[0], a12 = a[0] + a[1], w1 = v[0], w12 = v[0] + v[1];
    // Torques on the absolute angles first: link by link, with the reaction of the lower one at the elbow.
    const double second = (I2 + m2 * c2 * c2) * a12 + m2 * l1 * c2 * (k2 * a1 + s2 * w1 * w1) + m2 * g * c2 * s12;
    const double first = (I1 + m1 * c1 * c1 + m2 * l1 * l1) * a1 + m2 * l1 * c2 * (k2 * a12 - s2 * w12 * w12) +
                         (m1 * c1 + m2 * l1) * g * std::sin(q[0]);
    const JointVector torque = regressor(*robot, q, v, a) * robot->stated_coefficients();
    EXPECT_NEAR(torque[1], second, kRounding * 100.0);
    EXPECT_NEAR(torque[0], first + second, kRounding * 100.0);

    const Vector2d hand(l1 * std::sin(q[0]) + l2 * s12, -l1 * std::cos(q[0]) - l2 * k12);
    EXPECT_LE((robot->hand_position(q) - hand).norm(), kRounding);
    Matrix2d J;
    J << l1 * std::cos(q[0]) + l2 * k12, l2 * k12, l1 * std::sin(q[0]) + l2 * s12, l2 * s12;
    EXPECT_LE((robot->jacobian(q) - J).norm(), kRounding);
  }
}

TEST(SerialChain, WrittenAsTheThesissRobotHasItsDynamics) {
  // Relative angles q of the chain, absolute θ of the thesis: q = A θ + b, A = [[1, 0], [−1, 1]], b = [0, −90°]; so
  // torques map by Aᵀ.
  const PlanarRobot thesis;
  const double d1 = thesis.geometry.d1, d2 = thesis.geometry.d2;
  const double c2 = 0.5 * d2, m2 = thesis.inertia.alpha2 / (2.0 * d1 * c2);
  const auto link = [](const char* name, double centre, double mass, double inertia) {
    return fmt::format(R"(<link name="{}"><inertial><origin xyz="{:.17g} 0 0"/><mass value="{:.17g}"/>)"
                       R"(<inertia ixx="0.01" iyy="0.01" izz="{:.17g}" ixy="0" ixz="0" iyz="0"/></inertial></link>)",
                       name, centre, mass, inertia);
  };
  SerialChain::Options options;
  options.tool = {d2, 0.0, 0.0};
  options.zero = {0.0, -0.5 * std::numbers::pi};
  const auto robot = chain(R"(<robot name="thesis"><link name="base"/>)" +
                               link("first", 0.0, 1.0, thesis.inertia.alpha1 - m2 * d1 * d1) +
                               link("last", c2, m2, thesis.inertia.alpha3 - m2 * c2 * c2) +
                               R"(<joint name="one" type="continuous"><parent link="base"/><child link="first"/>
                                  <axis xyz="0 0 1"/></joint>)" +
                               fmt::format(R"(<joint name="two" type="continuous"><parent link="first"/>
                                  <child link="last"/><origin xyz="{:.17g} 0 0"/><axis xyz="0 0 1"/></joint></robot>)",
                                           d1),
                           options);
  Matrix2d A;
  A << 1.0, 0.0, -1.0, 1.0;
  RandomChain random("RR", 4);
  for (int i = 0; i < 100; ++i) {
    const Vector2d theta = random.uniform_joints(2.0), rate = random.uniform_joints(4.0),
                   acceleration = random.uniform_joints(20.0);
    const Vector2d torque =
        A.transpose() * regressor(*robot, A * theta, A * rate, A * acceleration) * robot->stated_coefficients();
    const Vector2d expected = thesis.inertia.matrix(theta) * acceleration + thesis.inertia.coriolis(theta, rate) * rate;
    EXPECT_LE((torque - expected).norm(), kRounding * 10.0);
    EXPECT_LE((robot->hand_position(A * theta) - hand_position(thesis.geometry, theta)).norm(), kRounding);
    EXPECT_LE((robot->jacobian(A * theta) * A - jacobian(thesis.geometry, theta)).norm(), kRounding);
    EXPECT_LE((robot->jacobian_rate(A * theta, A * rate) * A - jacobian_rate(thesis.geometry, theta, rate)).norm(),
              kRounding * 10.0);
  }
}

/// The same robot as a chain of KDL's.
KDL::Chain kdl_chain(const RandomChain& random) {
  const auto frame = [](const Eigen::Vector3d& place, const Eigen::Vector3d& turn) {
    return KDL::Frame(KDL::Rotation::RPY(turn[0], turn[1], turn[2]), {place[0], place[1], place[2]});
  };
  KDL::Chain chain;
  for (const RandomChain::Link& link : random.links) {
    const KDL::Frame origin = frame(link.place, link.turn);
    const KDL::Vector axis = origin.M * KDL::Vector(link.axis[0], link.axis[1], link.axis[2]);
    const KDL::Joint joint(origin.p, axis, link.kind == 'P' ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
    const KDL::RotationalInertia principal(link.inertia[0], link.inertia[1], link.inertia[2]);
    chain.addSegment(KDL::Segment(
        joint, origin,
        frame(link.centre, link.centre_turn) * KDL::RigidBodyInertia(link.mass, KDL::Vector::Zero(), principal)));
  }
  return chain;
}

TEST(SerialChain, TimesItsStatedCoefficientsIsTheRecursiveNewtonEulerTorqueOfKDL) {
  for (const std::string& kinds : kKinds) {
    RandomChain random(kinds, 7);
    const auto robot = chain(random.urdf());
    const auto n = static_cast<unsigned>(random.joints());
    const KDL::Chain theirs = kdl_chain(random);
    KDL::ChainIdSolver_RNE solver(theirs, KDL::Vector(0.0, 0.0, -9.81));
    for (int i = 0; i < 30; ++i) {
      const JointVector q = random.uniform_joints(3.0), v = random.uniform_joints(4.0), a = random.uniform_joints(20.0);
      KDL::JntArray position(n), rate(n), acceleration(n), expected(n);
      position.data = q;
      rate.data = v;
      acceleration.data = a;
      ASSERT_EQ(solver.CartToJnt(position, rate, acceleration, KDL::Wrenches(n), expected), 0);
      const JointVector torque = regressor(*robot, q, v, a) * robot->stated_coefficients();
      EXPECT_LE((torque - expected.data).norm(), kRounding * expected.data.norm()) << kinds;
    }
  }
}

TEST(SerialChain, SplitsTheTorqueIntoInertiaCoriolisAndGravity) {
  constexpr double kStep = 1e-6, kDifference = 1e-7;  // relative, of central differences
  for (const std::string& kinds : kKinds) {
    RandomChain random(kinds, 8);
    const auto robot = chain(random.urdf());
    const Vector& phi = robot->stated_coefficients();
    for (int i = 0; i < 10; ++i) {
      const JointVector q = random.uniform_joints(3.0), v = random.uniform_joints(4.0), a = random.uniform_joints(20.0);
      const JointTerms terms = robot->terms(q, v, phi);
      const JointVector still = JointVector::Zero(q.size());
      const JointVector gravity = regressor(*robot, q, still, still) * phi;
      const double size = (regressor(*robot, q, v, a) * phi).norm();
      EXPECT_LE((terms.gravity - gravity).norm(), kRounding * size) << kinds;
      EXPECT_LE((terms.inertia * a + gravity - regressor(*robot, q, still, a) * phi).norm(), kRounding * size) << kinds;
      EXPECT_LE((terms.inertia - terms.inertia.transpose()).norm(), kRounding * terms.inertia.norm());
      EXPECT_EQ(terms.inertia.llt().info(), Eigen::Success);  // positive definite
      // C q̇ = İ q̇ − Cᵀ q̇
      const JointMatrix rate =
          (robot->terms(q + kStep * v, v, phi).inertia - robot->terms(q - kStep * v, v, phi).inertia) / (2.0 * kStep);
      const JointVector torque = terms.inertia * a + (rate * v - terms.coriolis_transposed) + terms.gravity;
      EXPECT_LE((torque - regressor(*robot, q, v, a) * phi).norm(), kDifference * size) << kinds;
      // the slow plain twin
      const JointTerms by_differences = robot->Mechanism::terms(q, v, phi);
      EXPECT_LE((by_differences.coriolis_transposed - terms.coriolis_transposed).norm(), kDifference * size) << kinds;
    }
  }
}

TEST(SerialChain, TermsHoldForCoefficientsThatNoBodyHas) {
  RandomChain random("RRPR", 9);
  const auto robot = chain(random.urdf());
  Vector phi(robot->stated_coefficients().size());
  for (double& one : phi) one = random.uniform(1.0);
  phi[0] = 0.0;  // first moments without a mass, as base parameters have
  const JointVector q = random.uniform_joints(3.0), v = random.uniform_joints(4.0);
  const JointTerms ours = robot->terms(q, v, phi), plain = robot->Mechanism::terms(q, v, phi);
  constexpr double kDifference = 1e-7;
  EXPECT_LE((ours.inertia - plain.inertia).norm(), kRounding * plain.inertia.norm());
  EXPECT_LE((ours.gravity - plain.gravity).norm(), kRounding * plain.gravity.norm());
  EXPECT_LE((ours.coriolis_transposed - plain.coriolis_transposed).norm(), kDifference * plain.inertia.norm());
}

TEST(SerialChain, HasTheJacobianOfItsHandAndItsRate) {
  constexpr double kStep = 1e-6, kDifference = 1e-8;
  for (const std::string& kinds : kKinds) {
    RandomChain random(kinds, 10);
    SerialChain::Options options;
    options.hand_axes = {Axis::z, Axis::x};
    if (kinds.size() > 2) options.hand_axes.push_back(Axis::y);
    options.tool = random.uniform3(0.3);
    const auto robot = chain(random.urdf(), options);
    for (int i = 0; i < 20; ++i) {
      const JointVector q = random.uniform_joints(3.0), v = random.uniform_joints(2.0);
      const HandVector moved =
          (robot->hand_position(q + kStep * v) - robot->hand_position(q - kStep * v)) / (2.0 * kStep);
      EXPECT_LE((robot->jacobian(q) * v - moved).norm(), kDifference) << kinds;
      const HandJacobian rate = (robot->jacobian(q + kStep * v) - robot->jacobian(q - kStep * v)) / (2.0 * kStep);
      EXPECT_LE((robot->jacobian_rate(q, v) - rate).norm(), kDifference) << kinds;
    }
  }
}

TEST(SerialChain, MeasuresTheHandAlongOneAxisIfAsked) {
  SerialChain::Options options = vertical_plane(0.25);
  const auto both = chain(pendulum(), options);
  options.hand_axes = {Axis::z};
  const auto height = chain(pendulum(), options);
  const JointVector q = Vector2d(0.3, -0.8);
  ASSERT_EQ(height->hand_axes(), 1);
  EXPECT_EQ(height->hand_position(q)[0], both->hand_position(q)[1]);
  EXPECT_EQ(height->jacobian(q).row(0), both->jacobian(q).row(1));
}

TEST(SerialChain, TellsAForceInSpaceFromItsTorques) {
  RandomChain random("RRRR", 12);
  SerialChain::Options options;
  options.hand_axes = {Axis::x, Axis::y, Axis::z};
  options.tool = random.uniform3(0.3);
  const auto robot = chain(random.urdf(), options);
  ASSERT_EQ(robot->hand_axes(), 3);
  int regular = 0;
  for (int i = 0; i < 20; ++i) {
    const JointVector q = random.uniform_joints(2.0);
    const auto hand = hand_from_joints(*robot, q);
    if (!hand) continue;
    ++regular;
    const Eigen::Vector3d force(3.0, -1.0, 7.0);
    const Vector torque = robot->jacobian(q).transpose() * force;
    EXPECT_LE((*hand * torque - force).norm(), 1e-6);
  }
  EXPECT_GT(regular, 10);
}

TEST(SerialChain, TurnsAnglesOfTheRecordingIntoTheURDFs) {
  RandomChain random("RPR", 11);
  const auto plain = chain(random.urdf());
  SerialChain::Options options;
  options.zero = {0.4, -0.2, 1.1};
  options.sign = {-1, -1, 1};
  const auto mapped = chain(random.urdf(), options);
  const JointVector zero = Eigen::Vector3d(0.4, -0.2, 1.1), sign = Eigen::Vector3d(-1.0, -1.0, 1.0);
  const JointVector q = random.uniform_joints(1.0), v = random.uniform_joints(2.0), a = random.uniform_joints(5.0);
  const JointVector there = zero + sign.cwiseProduct(q), v_there = sign.cwiseProduct(v), a_there = sign.cwiseProduct(a);
  const Vector& phi = plain->stated_coefficients();
  EXPECT_LE((mapped->stated_coefficients() - phi).norm(), kRounding);
  const JointVector torque = sign.cwiseProduct(regressor(*plain, there, v_there, a_there) * phi);
  EXPECT_LE((regressor(*mapped, q, v, a) * phi - torque).norm(), kRounding * torque.norm());
  EXPECT_LE((mapped->hand_position(q) - plain->hand_position(there)).norm(), kRounding);
  EXPECT_LE((mapped->jacobian(q) - plain->jacobian(there) * sign.asDiagonal()).norm(), kRounding);
  const SerialChain::Joint& first = mapped->joint_descriptions()[0];  // 0.4 − q within ±3
  EXPECT_DOUBLE_EQ(first.range.low, -2.6);
  EXPECT_DOUBLE_EQ(first.range.high, 3.4);
}

TEST(SerialChain, MakesOneBodyOfWhatIsFixedToALink) {
  const std::string tool_on_lower = R"(
    <link name="hand"><inertial><origin xyz="0.01 0 -0.02" rpy="0 0.3 0"/><mass value="0.2"/>
      <inertia ixx="0.0004" iyy="0.0003" izz="0.0002" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="grip" type="fixed"><parent link="lower"/><child link="hand"/><origin xyz="0 0.1 -0.25" rpy="1 0 0"/>
    </joint>)";
  const auto bare = chain(pendulum(), vertical_plane(0.25)), robot = chain(pendulum("", tool_on_lower));
  EXPECT_EQ(robot->joints(), 2);
  EXPECT_EQ(robot->tip_link(), "hand");
  const Vector added = robot->stated_coefficients() - bare->stated_coefficients();
  EXPECT_EQ(added.head(10).norm(), 0.0);
  // By hand: the centre of the tool lies at R_x(1) [0.01, 0, −0.02] + [0, 0.1, −0.25] of the lower link.
  const Eigen::Vector3d centre(0.01, 0.1 + 0.02 * std::sin(1.0), -0.25 - 0.02 * std::cos(1.0));
  EXPECT_NEAR(added[10], 0.2, kRounding);
  EXPECT_LE((added.segment<3>(11) - 0.2 * centre).norm(), kRounding);
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())).matrix();
  const Eigen::Matrix3d I = R * Eigen::Vector3d(4e-4, 3e-4, 2e-4).asDiagonal() * R.transpose() +
                            0.2 * (centre.squaredNorm() * Eigen::Matrix3d::Identity() - centre * centre.transpose());
  const Eigen::Matrix<double, 6, 1> upper_triangle =
      (Vector(6) << I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2)).finished();
  EXPECT_LE((added.tail<6>() - upper_triangle).norm(), kRounding);
  // and the hand is where the fixed link is
  const JointVector q = Vector2d::Zero();
  EXPECT_LE((robot->hand_position(q) - Vector2d(0.0, 0.1)).norm(), kRounding);
}

TEST(SerialChain, CanBePartOfATree) {
  RandomChain random("RRRRR", 12);
  SerialChain::Options options;
  options.base_link = "link_1";
  options.tip_link = "link_3";
  options.gravity = {0.0, 0.0, 0.0};
  const auto part = chain(random.urdf(), options);
  ASSERT_EQ(part->joints(), 2);
  EXPECT_EQ(part->coefficients()[0].name, "link_2.mass");
  // What comes after the tip is held at zero and belongs to the last body.
  EXPECT_NEAR(part->stated_coefficients()[10], random.links[2].mass + random.links[3].mass + random.links[4].mass,
              kRounding);
}

TEST(SerialChain, NamesCoefficientsAfterTheirLinks) {
  const auto robot = chain(pendulum(), vertical_plane(0.25));
  ASSERT_EQ(robot->coefficients().size(), 20u);
  EXPECT_EQ(robot->coefficients()[0].name, "upper.mass");
  EXPECT_EQ(robot->coefficients()[3].name, "upper.mass_z");
  EXPECT_EQ(robot->coefficients()[3].unit, "kg·m");
  EXPECT_EQ(robot->coefficients()[17].name, "lower.inertia_yy");
  EXPECT_EQ(robot->coefficients()[17].unit, "kg·m²");
  EXPECT_NEAR(robot->stated_coefficients()[17], 0.003 + 0.5 * 0.1 * 0.1, kRounding);
}

TEST(SerialChain, ChecksJointsAgainstTheLimitsOfTheURDF) {
  RandomChain random("RPC", 13);
  const auto robot = chain(random.urdf());
  EXPECT_TRUE(robot->check_joints(Eigen::Vector3d(3.0, -3.0, 100.0)));
  const auto beyond = robot->check_joints(Eigen::Vector3d(3.1, -3.5, 0.0));
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().line(), AllOf(HasSubstr("joint_2"), HasSubstr("-3.5 m"), HasSubstr(" 0.5 m")));
  EXPECT_FALSE(robot->check_joints(Eigen::Vector3d(0.0, 0.0, std::numeric_limits<double>::quiet_NaN())));
}

TEST(SerialChain, SpreadsPosturesOverItsLimits) {
  RandomChain random("RPC", 14);
  const auto robot = chain(random.urdf());
  const auto postures = robot->postures(4);
  ASSERT_EQ(postures.size(), 64u);
  EXPECT_EQ(postures.front()[0], -3.0);
  EXPECT_EQ(postures.back()[0], 3.0);
  EXPECT_NEAR(postures.back()[2], 0.5 * std::numbers::pi, kRounding);  // −180°, −90°, 0°, 90°
  for (const JointVector& q : postures) EXPECT_TRUE(robot->check_joints(q));
  EXPECT_LE(chain(RandomChain("RRRRRRRR", 15).urdf())->postures(100).size(), 50'000u);
}

TEST(SerialChain, DoesNotAllocateInOneState) {
  RandomChain random("RRPRRRRR", 16);
  const auto robot = chain(random.urdf());
  const JointVector q = random.uniform_joints(2.0);
  Matrix Y(8, 80);
  const long before = testing_support::allocations();
  robot->regressor(q, q, q, Y);
  const JointTerms terms = robot->terms(q, q, robot->stated_coefficients());
  const HandJacobian rate = robot->jacobian_rate(q, q);
  const HandVector hand = robot->jacobian(q) * q + robot->hand_position(q);
  EXPECT_EQ(testing_support::allocations(), before);
  EXPECT_TRUE(terms.inertia.allFinite() && rate.allFinite() && hand.allFinite());
  const std::vector<JointVector> counted = robot->postures(1);
  EXPECT_GT(testing_support::allocations(), before);
}

TEST(SerialChain, GivesTheSameOnSeveralThreadsAtOnce) {
  RandomChain random("RRRR", 17);
  const auto robot = chain(random.urdf());
  const JointVector q = random.uniform_joints(2.0), other = random.uniform_joints(2.0);
  const Matrix expected = regressor(*robot, q, q, q);
  std::thread disturber([&] {
    for (int i = 0; i < 20'000; ++i) static_cast<void>(robot->hand_position(other));
  });
  int wrong = 0;
  for (int i = 0; i < 2'000; ++i) wrong += regressor(*robot, q, q, q) == expected ? 0 : 1;
  disturber.join();
  EXPECT_EQ(wrong, 0);
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(SerialChain, RefusesWhatIsNoURDFWithoutAWordOnTheConsole) {
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  for (const std::string& text :
       {std::string(), std::string("no XML"), std::string("<robot"), std::string("<robot name='x'>"),
        std::string("<model/>"), std::string("<robot name='x'/>"), std::string("<robot name='x'><link/></robot>"), deep,
        pendulum().substr(0, 600)}) {
    EXPECT_THAT(refusal(text), HasSubstr("URDF")) << text.substr(0, 40);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST(SerialChain, SaysWhatTheParserFoundWrong) {
  EXPECT_THAT(refusal(with(pendulum(), R"(value="0.8")", R"(value="heavy")")), HasSubstr("heavy"));
  EXPECT_THAT(refusal(with(pendulum(), R"(child link="upper")", R"(child link="uper")")), HasSubstr("uper"));
}

TEST(SerialChain, PrintsNothingByTheFormatsOfAURDF) {
  EXPECT_THAT(refusal(with(pendulum(), R"(value="0.8")", R"(value="%s%s%s%n%n%n")")), HasSubstr("％s％s"));
  SerialChain::Options options = vertical_plane(0.25);
  options.tip_link = "lower%s";
  std::string text = pendulum();
  for (std::size_t at = 0; (at = text.find("\"lower\"", at)) != std::string::npos; ++at) text.insert(at + 6, "%s");
  EXPECT_EQ(chain(text, options)->tip_link(), "lower％s");
}

TEST(SerialChain, RefusesBodiesBeyondAllNumbers) {
  EXPECT_THAT(refusal(with(pendulum(), R"(value="0.8")", R"(value="1e308")")), HasSubstr("nothing was refused"));
  const std::string heavy = with(with(pendulum(), R"(value="0.8")", R"(value="1e308")"), "0 0 -0.12", "0 0 -100");
  EXPECT_THAT(refusal(heavy), HasSubstr("mass"));
}

TEST(SerialChain, SurvivesAnyPieceOfAURDF) {
  const std::string whole = RandomChain("RPR", 18).urdf();
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    EXPECT_NE(refusal(whole.substr(0, length)), "nothing was refused") << length;
  }
  for (std::size_t at = 0; at + 20 < whole.size(); at += 11) {  // a hole
    static_cast<void>(SerialChain::from_urdf(whole.substr(0, at) + whole.substr(at + 9), {}));
  }
}

TEST(SerialChain, RefusesJointsThatItCannotMove) {
  const std::string shoulder = R"(name="shoulder" type="continuous")", axis = R"(<axis xyz="0 -1 0"/>)";
  EXPECT_THAT(refusal(with(pendulum(), shoulder, R"(name="shoulder" type="floating")")),
              AllOf(HasSubstr("'shoulder'"), HasSubstr("floating")));
  EXPECT_THAT(refusal(with(pendulum(), shoulder, R"(name="shoulder" type="planar")")),
              AllOf(HasSubstr("'shoulder'"), HasSubstr("planar")));
  EXPECT_THAT(refusal(with(pendulum(), axis, R"(<axis xyz="0 0 0"/>)")),
              AllOf(HasSubstr("'shoulder'"), HasSubstr("axis")));
  EXPECT_THAT(refusal(pendulum(R"(<mimic joint="elbow"/>)")), AllOf(HasSubstr("'shoulder'"), HasSubstr("'elbow'")));
  const std::string stuck = with(pendulum(R"(<limit lower="1" upper="1" effort="1" velocity="1"/>)"), shoulder,
                                 R"(name="shoulder" type="revolute")");
  EXPECT_THAT(refusal(stuck), AllOf(HasSubstr("'shoulder'"), HasSubstr("limit")));
}

TEST(SerialChain, RefusesABodyThatMovesWithoutInertial) {
  std::string text = pendulum();
  const std::size_t from = text.find("<inertial>"), to = text.find("</inertial>");
  EXPECT_THAT(refusal(text.erase(from, to + 11 - from)), AllOf(HasSubstr("'upper'"), HasSubstr("<inertial>")));
}

TEST(SerialChain, RefusesLinksThatItDoesNotFind) {
  SerialChain::Options options;
  options.tip_link = "hand";
  EXPECT_THAT(refusal(pendulum(), options), AllOf(HasSubstr("'hand'"), HasSubstr("'lower', 'stand', 'upper'")));
  options.tip_link = "stand";
  options.base_link = "upper";
  EXPECT_THAT(refusal(pendulum(), options), AllOf(HasSubstr("'stand'"), HasSubstr("'upper'"), HasSubstr("base_link")));
  options.base_link = "stand";
  EXPECT_THAT(refusal(pendulum(), options), HasSubstr("no joint"));
}

TEST(SerialChain, AsksForTheTipWhereThereAreSeveral) {
  const std::string forked = pendulum("", R"(<link name="camera"/>
    <joint name="mount" type="fixed"><parent link="upper"/><child link="camera"/></joint>)");
  EXPECT_THAT(refusal(forked), AllOf(HasSubstr("'camera', 'lower'"), HasSubstr("tip_link")));
  SerialChain::Options options;
  options.tip_link = "lower";
  EXPECT_EQ(chain(forked, options)->joints(), 2);
}

TEST(SerialChain, RefusesLoopsAndLooseParts) {
  EXPECT_THAT(refusal(pendulum("", R"(<joint name="again" type="fixed"><parent link="stand"/><child link="lower"/>
    </joint>)")),
              AllOf(HasSubstr("'lower'"), HasSubstr("'again'"), HasSubstr("'elbow'")));
  EXPECT_THAT(refusal(pendulum("", R"(<link name="a"/><link name="b"/>
    <joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>
    <joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint>)")),
              AllOf(HasSubstr("2 of 5"), HasSubstr("'stand'")));
}

TEST(SerialChain, TakesUpToEightJoints) {
  EXPECT_EQ(chain(RandomChain("RRRRRRRR", 19).urdf())->joints(), 8);
  EXPECT_THAT(refusal(RandomChain("RRRRRRRRR", 19).urdf()), HasSubstr("9 joints"));
}

TEST(SerialChain, RefusesOptionsThatMakeNoSense) {
  SerialChain::Options options;
  options.hand_axes = {Axis::x, Axis::x};
  EXPECT_THAT(refusal(pendulum(), options), HasSubstr("axes"));
  options = {};
  options.sign = {1};
  EXPECT_THAT(refusal(pendulum(), options), HasSubstr("2 joints"));
  options.sign = {1, 0};
  EXPECT_THAT(refusal(pendulum(), options), AllOf(HasSubstr("sign"), HasSubstr("−1")));
  options = {};
  options.zero = {0.0, std::numeric_limits<double>::infinity()};
  EXPECT_THAT(refusal(pendulum(), options), HasSubstr("zero"));
}

}  // namespace serial_chain_test
}  // namespace mbk::robot
