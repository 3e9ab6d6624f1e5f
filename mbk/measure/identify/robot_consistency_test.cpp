#include "mbk/measure/identify/robot_consistency.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/measure/identify/robot_fit.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/robot/serial_chain.h"
#include "mbk/model/robot/single_joint.h"

namespace mbk::identify {
namespace robot_consistency_test {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kSampleTime = 0.02;  // [s]
constexpr Index kSamples = 1500, kLearned = 1200;

/// A body with a mass of 0.3 … 3 kg, a size of 3 … 15 cm along each of three oblique axes, its centre up to 0.2 m away.
robot::RigidBody random_body(numeric::Random& random) {
  robot::RigidBody body;
  body.mass = random.uniform(0.3, 3.0);
  for (double& one : body.centre) one = random.uniform(-0.12, 0.12);
  Eigen::Vector3d moments;
  for (double& one : moments) one = body.mass * std::pow(random.uniform(0.03, 0.15), 2);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
  const Eigen::Matrix3d R = turn.toRotationMatrix(), sigma = R * moments.asDiagonal() * R.transpose();
  body.inertia = sigma.trace() * Eigen::Matrix3d::Identity() - sigma;
  return body;
}

/// What someone believes of it: each number up to a third away, but a body still.
robot::RigidBody believed(const robot::RigidBody& truth, numeric::Random& random) {
  const double factor = random.uniform(0.7, 1.3);
  robot::RigidBody body{truth.mass * random.uniform(0.7, 1.3), truth.centre, truth.inertia * factor};
  for (double& one : body.centre) one += random.uniform(-0.03, 0.03);
  return body;
}

std::string inertial(const robot::RigidBody& body) {
  const Eigen::Matrix3d& I = body.inertia;
  return fmt::format(R"(<inertial><origin xyz="{:.17g} {:.17g} {:.17g}"/><mass value="{:.17g}"/><inertia ixx="{:.17g}")"
                     R"( ixy="{:.17g}" ixz="{:.17g}" iyy="{:.17g}" iyz="{:.17g}" izz="{:.17g}"/></inertial>)",
                     body.centre[0], body.centre[1], body.centre[2], body.mass, I(0, 0), I(0, 1), I(0, 2), I(1, 1),
                     I(1, 2), I(2, 2));
}

/// A chain of random axes and offsets, of which a sixth slides.
struct RandomRobot {
  std::vector<std::string> joints;  ///< <joint> of each
  std::vector<robot::RigidBody> truth, stated;

  RandomRobot(int axes, std::uint64_t seed) {
    numeric::Random random(seed);
    for (int k = 0; k < axes; ++k) {
      const auto any = [&](double reach) { return random.uniform(-reach, reach); };
      // Half of all axes along x, y or z, as robots have them, with right angles between their frames.
      const bool square = random.uniform(0.0, 1.0) < 0.5;
      const auto which = static_cast<int>(random.uniform(0.0, 3.0));
      const Eigen::Vector3d axis =
          square ? Eigen::Vector3d(Eigen::Vector3d::Unit(which)) : Eigen::Vector3d(any(1.0), any(1.0), 1.5);
      const double roll = square ? 1.5708 * static_cast<int>(random.uniform(-1.0, 3.0)) : any(3.0);
      joints.push_back(fmt::format(R"(<joint name="joint_{0}" type="{1}"><parent link="{2}"/><child link="link_{0}"/>)"
                                   R"(<origin xyz="{3:.4g} {4:.4g} {5:.4g}" rpy="{6:.6g} 0 {7:.6g}"/>)"
                                   R"(<axis xyz="{8:.6g} {9:.6g} {10:.6g}"/>)"
                                   R"(<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>)",
                                   k + 1, random.uniform(0.0, 1.0) < 1.0 / 6.0 ? "prismatic" : "revolute",
                                   k == 0 ? "base" : fmt::format("link_{}", k), any(0.25), any(0.25), any(0.25), roll,
                                   square ? 0.0 : any(1.0), axis[0], axis[1], axis[2]));
      truth.push_back(random_body(random));
      stated.push_back(believed(truth.back(), random));
    }
  }

  [[nodiscard]] std::string urdf(const std::vector<robot::RigidBody>& bodies) const {
    std::string text = R"(<robot name="random"><link name="base"/>)";
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      text += joints[k] + fmt::format(R"(<link name="link_{}">{}</link>)", k + 1, inertial(bodies[k]));
    }
    return text + "</robot>";
  }
};

std::shared_ptr<const robot::SerialChain> chain(const std::string& urdf) {
  auto made = robot::SerialChain::from_urdf(urdf, {});
  EXPECT_TRUE(made) << made.error().line();
  return made ? *made : nullptr;
}

/// The bodies of a URDF, and drives with the same friction everywhere.
robot::DynamicModel model_of(const std::string& urdf, const robot::DriveTerms& drive = {}) {
  const auto mechanism = chain(urdf);
  robot::DynamicModel model{mechanism, drive, {}, {}};
  const auto coefficients = model.coefficients();
  model.parameters = Vector::Zero(static_cast<Index>(coefficients.size()));
  const Vector& stated = mechanism->stated_coefficients();
  model.parameters.head(stated.size()) = stated;
  for (auto k = static_cast<std::size_t>(stated.size()); k < coefficients.size(); ++k) {
    const std::string& name = coefficients[k].name;
    model.parameters[static_cast<Index>(k)] =
        name.starts_with("viscous") ? 0.4
                                    : (name.starts_with("coulomb") ? 0.2 : (name.starts_with("motor") ? 0.05 : 0.1));
  }
  return model;
}

/// Six sines for each joint.
robot::JointMotion motion_of(int joints, std::uint64_t seed, double amplitude = 0.15) {
  numeric::Random random(seed);
  robot::JointMotion motion{Matrix::Zero(kSamples, joints), Matrix::Zero(kSamples, joints),
                            Matrix::Zero(kSamples, joints)};
  for (Index joint = 0; joint < joints; ++joint) {
    for (int line = 1; line <= 6; ++line) {
      const double omega = 2.0 * std::numbers::pi * (0.17 * line + 0.03 * static_cast<double>(joint));
      const double phase = random.uniform(0.0, 2.0 * std::numbers::pi), size = amplitude * random.uniform(0.5, 2.0);
      for (Index i = 0; i < kSamples; ++i) {
        const double angle = omega * kSampleTime * static_cast<double>(i) + phase;
        motion.position(i, joint) += size * std::sin(angle);
        motion.velocity(i, joint) += size * omega * std::cos(angle);
        motion.acceleration(i, joint) -= size * omega * omega * std::sin(angle);
      }
    }
  }
  return motion;
}

/// Torques of `truth` with coloured noise, a part of each joint's torque, beside the regressors of `model`.
PreparedDynamics trial(const robot::DynamicModel& truth, const robot::DynamicModel& model,
                       const robot::JointMotion& motion, double noise, std::uint64_t seed) {
  PreparedDynamics made;
  made.sample_time = kSampleTime;
  made.time = Vector::LinSpaced(kSamples, 0.0, kSampleTime * static_cast<double>(kSamples - 1));
  made.torque = truth.torques(motion);
  made.torque_rate = Matrix::Zero(made.torque.rows(), made.torque.cols());
  made.regressors = model.regressors(motion);
  made.segments = {{0, kLearned, Purpose::identification}, {kLearned, kSamples, Purpose::validation, kLearned}};
  numeric::Random random(seed);
  const double keep = std::exp(-2.0 * std::numbers::pi * 1.5 * kSampleTime);
  for (Index joint = 0; joint < made.torque.cols(); ++joint) {
    const Vector varying = made.torque.col(joint).array() - made.torque.col(joint).mean();
    const double deviation = noise * varying.norm() / std::sqrt(static_cast<double>(kSamples));
    double value = deviation * random.normal();
    for (double& one : made.torque.col(joint)) {
      one += value;
      value = keep * value + deviation * std::sqrt(1.0 - keep * keep) * random.normal();
    }
  }
  return made;
}

std::optional<RobotIdentification> fitted(const PreparedDynamics& recorded, const robot::DynamicModel& model,
                                          RobotFitOptions options = {}) {
  options.consistent = true;
  auto fit = fit_robot({recorded}, {}, model, options);
  EXPECT_TRUE(fit) << fit.error().line();
  if (!fit) return std::nullopt;
  return fit->identification;
}

std::vector<WarningCode> codes(const RobotIdentification& found) {
  std::vector<WarningCode> all;
  for (const Warning& warning : found.warnings) all.push_back(warning.code);
  return all;
}

double largest(const std::vector<double>& values) {
  return *std::ranges::max_element(values);
}

/// The physical conditions, by eigenvalues and without the solver.
void expect_possible(const RobotIdentification& found) {
  for (const robot::PhysicalCondition& one : found.model.physical_conditions()) {
    const auto n = static_cast<Index>(std::llround(std::sqrt(static_cast<double>(one.A.rows()))));
    const Matrix S = (one.A * found.model.parameters).reshaped(n, n);
    EXPECT_GT(numeric::symmetric_eigenvalues(S)[0], 0.0) << one.name;
  }
  for (const ConsistentBody& body : found.consistent->bodies) EXPECT_GT(body.smallest_eigenvalue, 0.0) << body.link;
}

constexpr double kMaxLoss = 0.5;  // [points of VAF]

TEST(RobotConsistency, OfTwentyRandomChainsKeepsEveryBodyPossibleAndTheTorqueExplained) {
  int pressed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const int axes = 1 + static_cast<int>(seed - 1) % 6;
    const RandomRobot robot(axes, seed);
    const robot::DynamicModel truth = model_of(robot.urdf(robot.truth)), model = model_of(robot.urdf(robot.stated));
    for (const double noise : {0.01, 0.03, 0.1, 0.3}) {
      SCOPED_TRACE(fmt::format("robot {} of {} axes, noise {}", seed, axes, noise));
      const auto found = fitted(trial(truth, model, motion_of(axes, seed), noise, 100 + seed), model);
      ASSERT_TRUE(found);
      const ConsistentRobot& consistent = *found->consistent;
      ASSERT_EQ(consistent.bodies.size(), static_cast<std::size_t>(axes));
      expect_possible(*found);
      EXPECT_LT(largest(consistent.vaf_lost_in_sample), kMaxLoss);
      // The six seconds that are held out judge to within a point or two where the noise is a third of the torque.
      EXPECT_LT(largest(consistent.vaf_lost), noise < 0.2 ? kMaxLoss : 4.0 * kMaxLoss);
      EXPECT_THAT(codes(*found), Not(Contains(WarningCode::consistent_fit_poor)));
      EXPECT_THAT(codes(*found), Not(Contains(WarningCode::inertia_not_positive)));
      EXPECT_LT(consistent.newton_steps, 100);
      pressed += consistent.pressing.empty() ? 0 : 1;
    }
  }
  EXPECT_GE(pressed, 10);  // or nothing was tested
}

/// Three axes that turn, and what is believed of them.
const RandomRobot& three_axes() {
  static const RandomRobot robot(3, 3);
  return robot;
}

TEST(RobotConsistency, WithoutNoiseHasTheFreeFitsCombinations) {
  const RandomRobot& robot = three_axes();
  const robot::DynamicModel truth = model_of(robot.urdf(robot.truth)), model = model_of(robot.urdf(robot.stated));
  const auto found = fitted(trial(truth, model, motion_of(3, 1), 0.0, 1), model);
  ASSERT_TRUE(found);
  expect_possible(*found);
  ASSERT_EQ(found->consistent->combinations.size(), static_cast<std::size_t>(found->rank));
  for (const RobotCombination& one : found->consistent->combinations) {
    EXPECT_NEAR(one.value, one.free, 1e-6 * std::max(1.0, std::abs(one.free))) << one.name;
  }
  EXPECT_LT(largest(found->consistent->vaf_lost_in_sample), 1e-6);
  // What no torque shows stays near what the description says of it.
  for (std::size_t k = 0; k < 3; ++k) {
    const double mass = found->consistent->bodies[k].body.mass, stated = robot.stated[k].mass;
    EXPECT_GT(mass, 0.3 * stated);
    EXPECT_LT(mass, 3.0 * stated);
  }
}

TEST(RobotConsistency, ReturnsTheStatedRobotWhereThatExplainsTheTorque) {
  const RandomRobot& robot = three_axes();
  const robot::DynamicModel truth = model_of(robot.urdf(robot.truth));
  const auto found = fitted(trial(truth, truth, motion_of(3, 1), 0.0, 1), truth);
  ASSERT_TRUE(found);
  for (Index k = 0; k < truth.parameters.size(); ++k) {
    EXPECT_NEAR(found->model.parameters[k], truth.parameters[k], 1e-4) << k;  // the null space, by the divergence
  }
}

TEST(RobotConsistency, IsTheConstrainedLeastSquaresOfTheSameRows) {
  // Viscous friction that feeds the motion: the best that is allowed is none.
  robot::DynamicModel model{
      std::make_shared<robot::SingleJoint>(robot::SingleJoint::Options{}), {.coulomb = false}, {}, {}};
  model.parameters = Eigen::Vector3d(2.0, -0.5, 0.1);
  const PreparedDynamics recorded = trial(model, model, motion_of(1, 1), 0.02, 1);
  const auto found = fitted(recorded, model);
  ASSERT_TRUE(found);
  robot::DynamicModel none = model;
  none.parameters[1] = 0.0;
  const auto bound = fit_robot({recorded}, {}, none, {.fixed = {1}});
  ASSERT_TRUE(bound);
  EXPECT_GT(found->model.parameters[1], 0.0);
  EXPECT_LT((found->model.parameters - bound->identification.model.parameters).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_THAT(found->consistent->pressing, Contains("viscous_1"));
  EXPECT_TRUE(found->consistent->bodies.empty());
}

TEST(RobotConsistency, ContradictsATorqueOfTheWrongSign) {
  const RandomRobot& robot = three_axes();
  const robot::DynamicModel truth = model_of(robot.urdf(robot.truth)), model = model_of(robot.urdf(robot.stated));
  for (Index joint = 0; joint < 3; ++joint) {
    PreparedDynamics turned = trial(truth, model, motion_of(3, 1), 0.03, 1);
    turned.torque.col(joint) *= -1.0;
    const auto found = fitted(turned, model);
    ASSERT_TRUE(found);
    expect_possible(*found);
    EXPECT_GT(largest(found->consistent->vaf_lost_in_sample), 10.0) << joint;
    EXPECT_THAT(codes(*found), Contains(WarningCode::consistent_fit_poor)) << joint;
    EXPECT_FALSE(found->usable);
    EXPECT_FALSE(found->consistent->pressing.empty());
  }
}

TEST(RobotConsistency, DoesNotBlameTheRobotForWhatNoiseDoes) {
  const RandomRobot& robot = three_axes();
  const robot::DynamicModel truth = model_of(robot.urdf(robot.truth)), model = model_of(robot.urdf(robot.stated));
  int lost = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto found = fitted(trial(truth, model, motion_of(3, 1), 4.0, seed), model);
    ASSERT_TRUE(found);
    expect_possible(*found);
    EXPECT_THAT(codes(*found), Not(Contains(WarningCode::consistent_fit_poor))) << seed;
    if (largest(found->consistent->vaf_lost_in_sample) <= kMaxLoss) continue;
    ++lost;
    EXPECT_THAT(found->notes, Contains(HasSubstr("not significant"))) << seed;
  }
  EXPECT_GT(lost, 5);  // or nothing was tested
}

TEST(RobotConsistency, KeepsWhatIsFixed) {
  const RandomRobot& robot = three_axes();
  robot::DynamicModel truth = model_of(robot.urdf(robot.truth)), model = model_of(robot.urdf(robot.stated));
  std::vector<Index> fixed = {10, 11, 20, 30};  // mass and first moment of link 2, mass of link 3, a drive's viscous
  for (const Index k : fixed) model.parameters[k] = truth.parameters[k];
  const auto found = fitted(trial(truth, model, motion_of(3, 1), 0.03, 1), model, {.fixed = fixed});
  ASSERT_TRUE(found);
  expect_possible(*found);
  for (const Index k : fixed) EXPECT_EQ(found->model.parameters[k], truth.parameters[k]) << k;
  EXPECT_LT(largest(found->consistent->vaf_lost_in_sample), kMaxLoss);
}

TEST(RobotConsistency, FindsARobotWhereThatOfTheDescriptionContradictsWhatIsFixed) {
  const RandomRobot& robot = three_axes();
  const robot::DynamicModel truth = model_of(robot.urdf(robot.truth));
  robot::DynamicModel model = model_of(robot.urdf(robot.stated));
  model.parameters[20] = 0.2;  // so light that the stated moments of link 3 are none of its mass
  model.parameters[21] = 0.3;
  const auto found = fitted(trial(truth, model, motion_of(3, 1), 0.03, 1), model, {.fixed = {20, 21}});
  ASSERT_TRUE(found);
  expect_possible(*found);
  EXPECT_EQ(found->model.parameters[21], 0.3);
}

TEST(RobotConsistency, RefusesValuesOfNoRobot) {
  const RandomRobot& robot = three_axes();
  robot::DynamicModel model = model_of(robot.urdf(robot.stated));
  const PreparedDynamics recorded = trial(model, model, motion_of(3, 1), 0.03, 1);
  const auto refused = [&](std::vector<Index> fixed, const char* says) {
    const auto fit = fit_robot({recorded}, {}, model, {.fixed = std::move(fixed), .consistent = true});
    ASSERT_FALSE(fit);
    EXPECT_THAT(fit.error().line(), HasSubstr(says));
  };
  model.parameters[20] = 0.0;
  refused({20}, "--fix");
  model.parameters[30] = -0.1;
  refused({30}, "viscous_1");
}

TEST(RobotConsistency, PutsBodiesWhereTheDescriptionHasNone) {
  const RandomRobot& robot = three_axes();
  const robot::DynamicModel truth = model_of(robot.urdf(robot.truth));
  std::vector<robot::RigidBody> poor = robot.stated;
  poor[0] = {0.0, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  poor[1].inertia.setZero();                                           // a point
  poor[2].inertia = Eigen::Vector3d(0.001, 0.001, 0.01).asDiagonal();  // a moment above the sum of the others
  for (const auto& [bodies, replaced] : {std::pair(poor, 3), std::pair(std::vector(3, poor[0]), 3)}) {
    const robot::DynamicModel model = model_of(robot.urdf(bodies));
    const auto found = fitted(trial(truth, model, motion_of(3, 1), 0.03, 1), model);
    ASSERT_TRUE(found);
    expect_possible(*found);
    EXPECT_LT(largest(found->consistent->vaf_lost_in_sample), kMaxLoss);
    EXPECT_EQ(
        std::ranges::count_if(found->notes, [](const auto& note) { return note.find("body") != std::string::npos; }),
        replaced);
    // As heavy as its torques, though nobody said a mass.
    for (const ConsistentBody& one : found->consistent->bodies) {
      EXPECT_GT(one.body.mass, 0.05) << one.link;
      EXPECT_LT(one.body.mass, 50.0) << one.link;
    }
  }
}

TEST(RobotConsistency, StandardErrorsHoldTheTruthOfTheCombinations) {
  const RandomRobot& robot = three_axes();
  const robot::DynamicModel truth = model_of(robot.urdf(robot.truth)), model = model_of(robot.urdf(robot.stated));
  const robot::JointMotion motion = motion_of(3, 1);
  const auto exact = fitted(trial(truth, model, motion, 0.0, 1), model);
  ASSERT_TRUE(exact);
  int inside = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto found = fitted(trial(truth, model, motion, 0.1, seed), model);
    ASSERT_TRUE(found);
    for (std::size_t k = 0; k < found->consistent->combinations.size(); ++k) {
      const RobotCombination& one = found->consistent->combinations[k];
      inside += std::abs(one.value - exact->consistent->combinations[k].free) <= 2.0 * one.standard_error ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GT(static_cast<double>(inside) / all, 0.93);  // 23 of a run go together
}

TEST(RobotConsistency, MakesTheInertiaOfAPlanarRobotPositive) {
  robot::DynamicModel model{std::make_shared<robot::PlanarMechanism>(robot::PlanarMechanism::Options{}), {}, {}, {}};
  model.parameters = Vector::Constant(9, 0.03);
  model.parameters.head(3) << 0.069, 0.2, 0.044;  // α₂² > 4 α₁ α₃
  const PreparedDynamics recorded = trial(model, model, motion_of(2, 1), 0.02, 1);
  const auto free = fit_robot({recorded}, {}, model, {});
  ASSERT_TRUE(free);
  EXPECT_LE(free->identification.inertia.smallest, 0.0);
  const auto found = fitted(recorded, model);
  ASSERT_TRUE(found);
  expect_possible(*found);
  EXPECT_GT(found->inertia.smallest, 0.0);
}

}  // namespace robot_consistency_test
}  // namespace mbk::identify
