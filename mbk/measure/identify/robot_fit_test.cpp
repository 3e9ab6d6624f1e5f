#include "mbk/measure/identify/robot_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/measure/identify/coupled_drives.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/robot/serial_chain.h"

namespace mbk::identify {
namespace robot_fit_test {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::Not;

constexpr double kSampleTime = 0.03;  // [s]
constexpr Index kSamples = 1000;

robot::DynamicModel planar(const robot::DriveTerms& drive) {
  robot::DynamicModel model{std::make_shared<robot::PlanarMechanism>(robot::PlanarMechanism::Options{}), drive, {}, {}};
  model.parameters = Vector::Constant(static_cast<Index>(model.coefficients().size()), 0.03);
  model.parameters.head(3) << 0.06929, 0.04217, 0.04416;
  return model;
}

/// Sines of each joint about a place in the workspace at times 0, T, 2T, …, `late` seconds later, and their
/// derivatives.
robot::JointMotion motion_of(int joints, double late = 0.0, double phase = 0.0) {
  robot::JointMotion motion{Matrix::Zero(kSamples, joints), Matrix::Zero(kSamples, joints),
                            Matrix::Zero(kSamples, joints)};
  for (Index joint = 0; joint < joints; ++joint) {
    motion.position.col(joint).setConstant(joint == 0 ? 0.4 : 0.9);
    for (int line = 1; line <= 6; ++line) {
      const double omega = 2.0 * std::numbers::pi * (0.31 * line + 0.05 * static_cast<double>(joint));
      for (Index i = 0; i < kSamples; ++i) {
        const double angle =
            omega * (kSampleTime * static_cast<double>(i) + late) + phase + static_cast<double>(line * line);
        motion.position(i, joint) += 0.08 * std::sin(angle);
        motion.velocity(i, joint) += 0.08 * omega * std::cos(angle);
        motion.acceleration(i, joint) -= 0.08 * omega * omega * std::sin(angle);
      }
    }
  }
  return motion;
}

/// Torques that the model explains exactly.
PreparedDynamics trial(const robot::DynamicModel& model, const robot::JointMotion& motion) {
  PreparedDynamics made;
  made.sample_time = kSampleTime;
  made.time = Vector::LinSpaced(kSamples, 0.0, kSampleTime * static_cast<double>(kSamples - 1));
  made.torque = model.torques(motion);
  made.torque_rate = Matrix::Zero(made.torque.rows(), made.torque.cols());
  made.regressors = model.regressors(motion);
  made.segments = {{0, 800, Purpose::identification}, {800, kSamples, Purpose::validation, 800}};
  return made;
}

PreparedDynamics trial(const robot::DynamicModel& model) {
  return trial(model, motion_of(model.mechanism->joints()));
}

/// First-order low-passed at 1.5 Hz, of that standard deviation.
Vector coloured(numeric::Random& random, double deviation) {
  const double keep = std::exp(-2.0 * std::numbers::pi * 1.5 * kSampleTime);
  Vector noise(kSamples);
  double value = deviation * random.normal();
  for (double& one : noise) {
    one = value;
    value = keep * value + deviation * std::sqrt(1.0 - keep * keep) * random.normal();
  }
  return noise;
}

RobotFit fitted(const std::vector<PreparedDynamics>& trials, const robot::DynamicModel& model,
                const RobotFitOptions& options = {}, const std::vector<PreparedDynamics>& held_out = {}) {
  auto fit = fit_robot(trials, held_out, model, options);
  EXPECT_TRUE(fit) << fit.error().line();
  return fit ? *fit : RobotFit{};
}

const RobotCoefficient& coefficient(const RobotIdentification& found, const std::string& name) {
  for (const RobotCoefficient& one : found.coefficients) {
    if (one.coefficient.name == name) return one;
  }
  ADD_FAILURE() << "no " << name;
  return found.coefficients.front();
}

std::vector<WarningCode> codes(const RobotIdentification& found) {
  std::vector<WarningCode> all;
  for (const Warning& warning : found.warnings) all.push_back(warning.code);
  return all;
}

void expect_refused(const std::vector<PreparedDynamics>& trials, const robot::DynamicModel& model, const char* says,
                    const RobotFitOptions& options = {}) {
  const auto fit = fit_robot(trials, {}, model, options);
  ASSERT_FALSE(fit);
  EXPECT_THAT(fit.error().line(), HasSubstr(says));
}

/// Rounding through a regression whose condition is about 10.
constexpr double kExact = 1e-11;

TEST(RobotFit, RecoversCoefficientsExactlyWithoutNoise) {
  const robot::DynamicModel model = planar({.stribeck = true, .cable = true});
  for (const RobotMethod method : {RobotMethod::least_squares, RobotMethod::weighted_least_squares}) {
    const RobotIdentification found = fitted({trial(model)}, model, {.method = method}).identification;
    EXPECT_LE((found.model.parameters - model.parameters).cwiseAbs().maxCoeff(), kExact);
    EXPECT_EQ(found.rank, found.structural_rank);
    EXPECT_TRUE(found.usable);
    EXPECT_TRUE(found.held_out);
    EXPECT_NEAR(found.fit[1].vaf, 100.0, 1e-9);
    EXPECT_EQ(found.samples, 800);
  }
}

TEST(RobotFit, HoldsTheTruthWithinTwoStandardErrorsInNineteenOfTwentyRunsOfColouredNoise) {
  const robot::DynamicModel model = planar({});
  const PreparedDynamics clean = trial(model);
  int inside = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    numeric::Random random(seed);
    PreparedDynamics noisy = clean;
    const Vector common = coloured(random, 0.01);  // the joints err together
    noisy.torque.col(0) += common + coloured(random, 0.03);
    noisy.torque.col(1) += common;
    const RobotIdentification found = fitted({noisy}, model).identification;
    for (Index k = 0; k < model.parameters.size(); ++k) {
      const double error = found.model.parameters[k] - model.parameters[k];
      inside += std::abs(error) <= 2.0 * found.coefficients[static_cast<std::size_t>(k)].standard_error ? 1 : 0;
      ++all;
    }
  }
  const double share = static_cast<double>(inside) / all;
  EXPECT_GT(share, 0.92);  // 900 intervals, of which nine of a run go together
  EXPECT_LT(share, 0.98);
}

TEST(RobotFit, WeighsEachJointByItsNoise) {
  const robot::DynamicModel model = planar({});
  const PreparedDynamics clean = trial(model);
  constexpr Index kShared = 1;  // α₂ acts at both joints
  double by_weights = 0.0, alike = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    numeric::Random random(seed);
    PreparedDynamics noisy = clean;
    noisy.torque.col(0) += coloured(random, 0.2);
    noisy.torque.col(1) += coloured(random, 0.002);
    const auto error = [&](RobotMethod method) {
      const RobotFit fit = fitted({noisy}, model, {.method = method});
      return std::pow(fit.identification.model.parameters[kShared] - model.parameters[kShared], 2);
    };
    by_weights += error(RobotMethod::weighted_least_squares);
    alike += error(RobotMethod::least_squares);
  }
  EXPECT_LT(by_weights, 0.01 * alike);
}

TEST(RobotFit, FindsTheDelayOfTheTorqueToSecondOrder) {
  const robot::DynamicModel model = planar({.coulomb = false});
  constexpr double kDelay = 4e-4, kStep = 1e-4;  // [s]
  PreparedDynamics late = trial(model);
  late.torque = model.torques(motion_of(2, kDelay));  // recorded: what acts is what stood there kDelay before
  late.torque_rate =
      (model.torques(motion_of(2, kDelay + kStep)) - model.torques(motion_of(2, kDelay - kStep))) / (2.0 * kStep);
  const RobotFit fit = fitted({late}, model, {.delay = true});
  EXPECT_NEAR(fit.delay_correction, kDelay, 1e-3 * kDelay);
  ASSERT_TRUE(fit.identification.delay_standard_error);
  EXPECT_LT(*fit.identification.delay_standard_error, 1e-6);
  EXPECT_LE((fit.identification.model.parameters - model.parameters).cwiseAbs().maxCoeff(), 1e-5);
  const RobotFit without = fitted({late}, model);
  EXPECT_EQ(without.delay_correction, 0.0);
  EXPECT_FALSE(without.identification.delay_standard_error);
}

TEST(RobotFit, IsNotBiasedByNoiseOfTheMotionWhereInstrumentsHaveNone) {
  const robot::DynamicModel model = planar({.coulomb = false});
  const PreparedDynamics clean = trial(model);
  double by_squares = 0.0, by_instruments = 0.0;
  constexpr int kRuns = 20;
  constexpr double kNoise = 5.0;  // [rad/s²]
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    numeric::Random random(seed);
    robot::JointMotion measured = motion_of(2);
    for (double& value : measured.acceleration.reshaped()) value += kNoise * random.normal();
    PreparedDynamics noisy = clean;
    noisy.regressors = model.regressors(measured);
    noisy.instruments = clean.regressors;
    noisy.smoothed = clean.regressors;
    by_squares += fitted({noisy}, model).identification.model.parameters[0] / model.parameters[0] / kRuns;
    const auto found = fitted({noisy}, model, {.method = RobotMethod::instrumental_variables}).identification;
    by_instruments += found.model.parameters[0] / model.parameters[0] / kRuns;
    // What predicts from the motion without noise explains more.
    ASSERT_TRUE(found.fit[0].vaf_smoothed);
    EXPECT_GT(*found.fit[0].vaf_smoothed, found.fit[0].vaf);
  }
  const double power = motion_of(2).acceleration.col(0).squaredNorm() / static_cast<double>(kSamples);
  constexpr double kScatter = 0.01;                                      // of the mean of all runs
  EXPECT_NEAR(by_squares, power / (power + kNoise * kNoise), kScatter);  // attenuation
  EXPECT_NEAR(by_instruments, 1.0, kScatter);
}

TEST(RobotFit, SaysWhichCoefficientHoldsOneThatCannotBeToldApart) {
  constexpr const char* kArm = R"(<robot name="arm"><link name="base"/>
    <joint name="one" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
    <link name="upper"><inertial><origin xyz="0 0 -0.1"/><mass value="2"/>
      <inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="two" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.25"/>
      <axis xyz="0 1 0"/></joint>
    <link name="lower"><inertial><origin xyz="0 0 -0.15"/><mass value="1.5"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>)";
  const auto chain =
      robot::SerialChain::from_urdf(kArm, {.hand_axes = {robot::SerialChain::Axis::x, robot::SerialChain::Axis::z}});
  ASSERT_TRUE(chain) << chain.error().line();
  const robot::DynamicModel model{
      *chain, {.viscous = false, .coulomb = false, .offset = false}, (*chain)->stated_coefficients(), {}};
  const RobotIdentification found = fitted({trial(model)}, model).identification;
  EXPECT_EQ(found.rank, 6);
  EXPECT_EQ(found.structural_rank, 6);
  // A mass m at the lower joint, l below the upper one, is −l m in the first moment and l² m in the inertia.
  constexpr double kLength = 0.25, kMass = 1.5;
  const RobotCoefficient& moment = coefficient(found, "upper.mass_z");
  EXPECT_EQ(moment.together_with, " − 0.25·lower.mass");
  EXPECT_NEAR(moment.value, -0.1 * 2.0 - kLength * kMass, 1e-9);
  const RobotCoefficient& inertia = coefficient(found, "upper.inertia_yy");
  EXPECT_THAT(inertia.together_with, HasSubstr("0.0625·lower.mass"));
  EXPECT_NEAR(inertia.value, 0.02 + 0.01 * 2.0 + kLength * kLength * kMass, 1e-9);
  EXPECT_EQ(coefficient(found, "lower.mass_z").together_with, "");
  const RobotCoefficient& held = coefficient(found, "lower.mass");
  EXPECT_FALSE(held.identified);
  EXPECT_EQ(held.value, 0.0);
  EXPECT_TRUE(std::isnan(held.standard_error));
  EXPECT_NEAR(found.fit[0].vaf, 100.0, 1e-9);
  // The hand lies on the lower joint: every posture is singular, so that no mass at the hand tells of units.
  EXPECT_TRUE(std::isnan(found.inertia.mass_at_hand));
  EXPECT_TRUE(found.usable);
  EXPECT_EQ(codes(found), std::vector<WarningCode>{});
}

TEST(RobotFit, KeepsWhatIsFixedAndFindsTheRest) {
  robot::DynamicModel model = planar({});
  const PreparedDynamics exact = trial(model);
  const RobotIdentification found = fitted({exact}, model, {.fixed = {0, 4}}).identification;
  EXPECT_LE((found.model.parameters - model.parameters).cwiseAbs().maxCoeff(), kExact);
  EXPECT_TRUE(found.coefficients[4].fixed);
  EXPECT_FALSE(found.coefficients[3].fixed);
  EXPECT_EQ(found.rank, 7);
  EXPECT_EQ(found.model.covariance(4, 4), 0.0);
  model.parameters[4] = 0.05;  // not what it is
  const RobotIdentification wrong = fitted({exact}, model, {.fixed = {4}}).identification;
  EXPECT_EQ(wrong.model.parameters[4], 0.05);
  EXPECT_LT(wrong.model.parameters[3], 0.03 - 1e-3);  // viscous friction makes up for it
}

TEST(RobotFit, NamesWhatIsHardToTellApartAmongThoseThatAreNotFixed) {
  // Joint 2 hardly moves, so that its cable and its offset look alike.
  const robot::DynamicModel model = planar({.viscous = false, .coulomb = false, .cable = true});
  robot::JointMotion motion = motion_of(2);
  motion.position.col(1) = (motion.position.col(1).array() - 0.9) * 1e-4 + 0.9;
  const RobotIdentification found = fitted({trial(model, motion)}, model, {.fixed = {0, 1}}).identification;
  EXPECT_THAT(found.weakest, Contains(Key("cable_2")));
  EXPECT_THAT(found.weakest, Contains(Key("offset_2")));
  EXPECT_THAT(found.weakest, Not(Contains(Key("alpha1"))));
  EXPECT_THAT(codes(found), Contains(WarningCode::poorly_conditioned));
}

TEST(RobotFit, NamesWhatWasNotExcited) {
  const robot::DynamicModel model = planar({});
  robot::JointMotion motion = motion_of(2);
  motion.position.col(1).setConstant(0.9);
  motion.velocity.col(1).setZero();
  motion.acceleration.col(1).setZero();
  const RobotIdentification found = fitted({trial(model, motion)}, model).identification;
  const auto warning = std::ranges::find(found.warnings, WarningCode::poorly_conditioned, &Warning::code);
  ASSERT_NE(warning, found.warnings.end());
  for (const char* const name : {"alpha3", "viscous_2", "coulomb_2"}) {
    EXPECT_FALSE(coefficient(found, name).identified) << name;
    EXPECT_THAT(warning->message, HasSubstr(name));
  }
  EXPECT_LT(found.rank, found.structural_rank);
}

TEST(RobotFit, FitsSeveralTrialsTogetherAndJudgesByOthers) {
  const robot::DynamicModel model = planar({});
  PreparedDynamics one = trial(model), two = trial(model, motion_of(2, 0.0, 0.7));
  one.torque.col(0).array() += 0.01;
  two.torque.col(0).array() -= 0.01;
  EXPECT_NEAR(coefficient(fitted({one}, model).identification, "offset_1").value, 0.04, 1e-9);
  EXPECT_NEAR(coefficient(fitted({one, two}, model).identification, "offset_1").value, 0.03, 5e-4);
  PreparedDynamics other = trial(model, motion_of(2, 0.0, 1.9));
  other.torque.col(1).array() += 0.1;
  other.sources.push_back({"other.csv", "CSV", "00"});
  const RobotIdentification judged = fitted({one}, model, {}, {other}).identification;
  EXPECT_EQ(judged.samples, kSamples);  // nothing of the first is kept back
  EXPECT_NEAR(judged.fit[1].rmse, 0.1, 1e-6);
  EXPECT_LT(judged.fit[1].rmse_in_sample, 1e-9);
  EXPECT_EQ(judged.held_out_files, std::vector<std::string>{"other.csv"});
}

TEST(RobotFit, IsNotUsableWhereTheInertiaIsNone) {
  const robot::DynamicModel model = planar({});
  PreparedDynamics turned = trial(model);
  turned.torque *= -1.0;
  const RobotIdentification found = fitted({turned}, model).identification;
  EXPECT_FALSE(found.usable);
  EXPECT_LT(found.inertia.smallest, 0.0);
  EXPECT_THAT(codes(found), Contains(WarningCode::inertia_not_positive));
  EXPECT_THAT(codes(found), Contains(WarningCode::damping_not_positive));
}

TEST(RobotFit, IsNotUsableWhereHeldOutDataContradictIt) {
  const robot::DynamicModel model = planar({});
  robot::DynamicModel loaded = model;
  loaded.parameters.head(3) *= 4.0;  // another load at the hand
  const auto judged_by = [&](const PreparedDynamics& other) {
    return fitted({trial(model)}, model, {}, {other}).identification;
  };
  PreparedDynamics noisy = trial(model, motion_of(2, 0.0, 1.9));
  EXPECT_TRUE(judged_by(noisy).usable);
  const RobotIdentification found = judged_by(trial(loaded, motion_of(2, 0.0, 1.9)));
  EXPECT_FALSE(found.usable);
  EXPECT_THAT(codes(found), Contains(WarningCode::held_out_fit_poor));
  EXPECT_THAT(found.warnings.back().message, HasSubstr("100.0 %"));
  noisy.torque *= -1.0;
  EXPECT_LT(judged_by(noisy).fit[0].vaf, 0.0);
  EXPECT_FALSE(judged_by(noisy).usable);
}

TEST(RobotFit, IsUsableWhereAJointOnlyHardlyMovesWhileHeldOut) {
  const robot::DynamicModel model = planar({});
  numeric::Random random(3);
  robot::JointMotion rest = motion_of(2, 0.0, 1.9);
  rest.position.rowwise() = rest.position.row(0).eval();
  rest.velocity *= 1e-3;
  rest.acceleration *= 1e-3;
  PreparedDynamics moving = trial(model), still = trial(model, rest);
  for (PreparedDynamics* one : {&moving, &still}) {
    for (Index joint = 0; joint < 2; ++joint) one->torque.col(joint) += coloured(random, 0.01);
  }
  const RobotIdentification found = fitted({moving}, model, {}, {still}).identification;
  EXPECT_LT(found.fit[1].vaf, 50.0);
  EXPECT_TRUE(found.usable);
  EXPECT_THAT(codes(found), Contains(WarningCode::held_out_fit_poor));
}

TEST(CoupledDrives, AreNamedWhereTheFrictionOfAJointGoesWithTheSpeedOfAnother) {
  const robot::DynamicModel model = planar({});
  const robot::JointMotion motion = motion_of(2);
  const auto warned = [&](double viscous, double dry, std::uint64_t seed) {
    numeric::Random random(seed);
    PreparedDynamics coupled = trial(model, motion);
    const Vector speed = motion.velocity.col(0) + motion.velocity.col(1);
    coupled.torque.col(1) += viscous * motion.velocity.col(0) + dry * (speed / 0.02).array().tanh().matrix();
    for (Index joint = 0; joint < 2; ++joint) coupled.torque.col(joint) += coloured(random, 0.01);
    RobotIdentification found = fitted({coupled}, model).identification;
    found.warnings.clear();
    warn_of_coupled_drives({coupled}, found);
    return found.warnings;
  };
  for (const auto& [viscous, dry] : {std::pair(0.1, 0.0), std::pair(-0.1, 0.0), std::pair(0.0, 0.1)}) {
    const std::vector<Warning> warnings = warned(viscous, dry, 5);
    ASSERT_EQ(warnings.size(), 1U) << viscous << ", " << dry;
    EXPECT_EQ(warnings[0].code, WarningCode::missing_dynamics);
    EXPECT_THAT(warnings[0].message, AllOf(HasSubstr("joint 2"), HasSubstr("joint 1")));
  }
  int false_alarms = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run)
    false_alarms += warned(0.0, 0.0, 100U + static_cast<unsigned>(run)).empty() ? 0 : 1;
  EXPECT_EQ(false_alarms, 0);
}

TEST(RobotFit, RefusesWhatCannotBeFittedTogether) {
  const robot::DynamicModel model = planar({});
  const PreparedDynamics one = trial(model);
  PreparedDynamics slower = one;
  slower.sample_time *= 1.01;
  expect_refused({one, slower}, model, "0.0303 s");
  expect_refused({one, trial(planar({.stribeck = true}))}, model, "robots");
  expect_refused({}, model, "recording");
}

TEST(RobotFit, RefusesWhatHoldsNothing) {
  const robot::DynamicModel model = planar({});
  PreparedDynamics one = trial(model);
  one.segments = {{0, 10, Purpose::identification}};
  expect_refused({one}, model, "10 rows");
  robot::DynamicModel bodies = planar({.viscous = false, .coulomb = false, .offset = false});
  robot::JointMotion still = motion_of(2);
  still.velocity.setZero();
  still.acceleration.setZero();
  expect_refused({trial(bodies, still)}, bodies, "joint");
  PreparedDynamics broken = trial(model);
  broken.torque(7, 1) = std::nan("");
  EXPECT_FALSE(fit_robot({broken}, {}, model, {}));
  expect_refused({trial(model)}, model, "coefficient", {.fixed = {40}});
  expect_refused({trial(model)}, model, "correlation time", {.hac_lag_s = -1.0});
}

}  // namespace robot_fit_test
}  // namespace mbk::identify
