#include "mbk/present/report/robot_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "mbk/model/robot/single_joint.h"

namespace mbk::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

RobotIdentification identified() {
  RobotIdentification found;
  found.model.mechanism = std::make_shared<robot::SingleJoint>(robot::SingleJoint::Options{});
  found.model.delay = 0.4e-3;
  found.coefficients = {{{"mass", "kg"}, 95.1089, 0.25, true, false, "+ 1·motor_inertia_1"},
                        {{"motor_inertia_1", "kg"}, 0.0, 0.0, false, false, ""},
                        {{"viscous_1", "N·s/m"}, 203.5, 0.0, false, true, ""}};
  found.fit.push_back({98.5, 2.3, 99.1, 2.1, {}});
  found.rank = 1;
  found.structural_rank = 1;
  found.inertia.smallest = 95.0;
  found.preparations.emplace_back();
  found.sources.push_back({"a.csv", "CSV", "abc"});
  found.durations = {20.0};
  found.rates = {1000.0};
  return found;
}

TEST(RobotText, HasEachCoefficientWithItsIntervalAndWhatItHolds) {
  const std::string text = robot_text(identified());
  EXPECT_THAT(text, HasSubstr("a.csv   20.0 s at 1000 Hz   CSV"));
  EXPECT_THAT(text, ::testing::ContainsRegex("mass +95.11 ± 0.49 +kg +\\+ 1·motor_inertia_1"));
  EXPECT_THAT(text, ::testing::ContainsRegex("viscous_1 +203.5 +N·s/m +given"));
  EXPECT_THAT(text, HasSubstr(": motor_inertia_1"));
  EXPECT_THAT(text, HasSubstr("sums"));
  EXPECT_THAT(text, ::testing::ContainsRegex("torque of joint 1 +98.50 +2.3 N +99.10 +2.1 N\n"));
  EXPECT_THAT(text, HasSubstr("0.4 ms"));
  EXPECT_THAT(text, ::testing::ContainsRegex("eigenvalue.* 95"));
  EXPECT_THAT(text, Not(HasSubstr("instruments")));
}

TEST(RobotText, SaysNothingOfSumsWhereEveryCoefficientStandsForItself) {
  RobotIdentification found = identified();
  found.coefficients.front().together_with.clear();
  EXPECT_THAT(robot_text(found), Not(HasSubstr("sums")));
}

TEST(RobotText, SaysWhetherDataWereHeldOut) {
  RobotIdentification found = identified();
  EXPECT_THAT(robot_text(found), HasSubstr("held out"));
  found.held_out = false;
  EXPECT_THAT(robot_text(found), Not(HasSubstr("held out")));
}

TEST(RobotText, NamesInstrumentsAndWhatTheSmoothedMotionPredicts) {
  RobotIdentification found = identified();
  found.method = RobotMethod::instrumental_variables;
  found.instrument_motion = InstrumentMotion::smoothed;
  found.motion_cutoff = 5.0;
  found.fit[0].vaf_smoothed = 97.25;
  found.smoothed_cutoff = 6.0;
  const std::string text = robot_text(found);
  EXPECT_THAT(text, ::testing::ContainsRegex("instruments [^\n]* 5 Hz"));
  EXPECT_THAT(text, HasSubstr(" 6 Hz"));
  EXPECT_THAT(text, HasSubstr("97.25"));
}

TEST(RobotText, HasADashWhereNoTorqueCounts) {
  RobotIdentification found = identified();
  found.fit[0] = {std::nan(""), 0.0, std::nan(""), 0.0, {}};
  EXPECT_THAT(robot_text(found), ::testing::ContainsRegex("torque of joint 1 +– +0 N +– +0 N\n"));
}

TEST(RobotText, SaysHowSureADelayIsThatWasFound) {
  RobotIdentification found = identified();
  found.delay_standard_error = 1e-5;
  EXPECT_THAT(robot_text(found), HasSubstr("0.400 ± 0.020 ms"));
}

TEST(RobotText, EndsWithWarningsAndWithAVerdict) {
  RobotIdentification found = identified();
  EXPECT_THAT(robot_text(found), Not(HasSubstr("NOT USABLE")));
  found.usable = false;
  found.inertia.smallest = -1.0;
  found.warnings.push_back({WarningCode::inertia_not_positive, "no inertia", "move faster"});
  const std::string text = robot_text(found);
  EXPECT_THAT(text, HasSubstr("no inertia"));
  EXPECT_THAT(text, HasSubstr("try: move faster"));
  EXPECT_THAT(text, HasSubstr("NOT USABLE"));
  EXPECT_THAT(text, Not(HasSubstr("eigenvalue")));
}

RobotIdentification consistent() {
  RobotIdentification found = identified();
  ConsistentRobot one;
  one.bodies.push_back(
      {"forearm", {1.234, {0.01, 0.0, -0.12}, Eigen::Vector3d(0.02, 0.021, 0.003).asDiagonal()}, 4e-4});
  one.combinations.push_back({"forearm.mass_z", "kg·m", "+ 0.25·hand.mass", 0.31, 0.3, 0.01});
  one.free_fit = found.fit;
  one.vaf_lost = {0.125};
  one.vaf_lost_in_sample = {std::nan("")};
  one.pressing = {"forearm", "viscous_1"};
  found.consistent = std::move(one);
  found.notes = {"a ball stands in"};
  return found;
}

TEST(RobotText, OfAConsistentFitShowsLinksAndWhatTheDataDecide) {
  const std::string text = robot_text(consistent());
  EXPECT_THAT(text, ::testing::ContainsRegex("forearm +1.234 +10.0, 0.0, -120.0 +0.02, 0.021, 0.003 +0.0004\n"));
  EXPECT_THAT(text, HasSubstr("pseudo-inertia"));
  EXPECT_THAT(text, ::testing::ContainsRegex("forearm.mass_z +0.31 +0.300 ± 0.020 +kg·m +\\+ 0.25·hand.mass\n"));
  EXPECT_THAT(text, ::testing::ContainsRegex("viscous_1 +203.5 +given +N·s/m"));
  EXPECT_THAT(text, ::testing::ContainsRegex("joint 1 relative to the free fit +-0.1[23] +–\n"));
  EXPECT_THAT(text, HasSubstr("forearm, viscous_1"));
  EXPECT_THAT(text, HasSubstr("a ball stands in"));
}

TEST(RobotText, OfAConsistentFitWithoutLinksShowsNone) {
  RobotIdentification found = consistent();
  found.consistent->bodies.clear();
  found.consistent->pressing.clear();
  const std::string text = robot_text(found);
  EXPECT_THAT(text, Not(HasSubstr("pseudo-inertia")));
  EXPECT_THAT(text, Not(HasSubstr("forearm, viscous_1")));
  EXPECT_THAT(text, HasSubstr("forearm.mass_z"));
}

ForceSummary force() {
  ForceSummary force;
  force.sources.push_back({"rig.h5", "HDF5", "abc"});
  force.rms = Eigen::Vector2d(3.52, 1.74);
  force.peak = Eigen::Vector2d(8.73, 4.71);
  force.notes = {"the force is not measured"};
  return force;
}

TEST(ForceText, HasSizeAndHowSureItIs) {
  ForceSummary one = force();
  EXPECT_THAT(force_text(one), ::testing::ContainsRegex("Fx +3.52 N +8.73 N\n"));
  EXPECT_THAT(force_text(one), HasSubstr("the force is not measured"));
  one.standard_error = Eigen::Vector2d(0.1, 0.2);
  EXPECT_THAT(force_text(one), ::testing::ContainsRegex("Fy +1.74 N +4.71 N +0.39 N\n"));  // 95 %
}

TEST(ForceText, NamesTheAxesAndTheUnitOfTheHand) {
  ForceSummary one = force();
  one.axes = {"x", "z"};
  EXPECT_THAT(force_text(one), HasSubstr("Fz  1.74 N"));
  one.rms = one.peak = Vector::Constant(1, 0.5);
  one.unit = "N·m";
  EXPECT_THAT(force_text(one), HasSubstr("F  0.5 N·m"));
}

TEST(ForceText, NamesTheMethodBesideTheSensor) {
  ForceSummary one = force();
  EXPECT_THAT(force_text(one), Not(HasSubstr("force sensor")));
  ForceAgreement none{0, Vector::Zero(2), Vector::Zero(2)};
  one.comparison = ForceComparison{.all = none, .reversals = none, .rest = none, .motion = none};
  for (Vector* part : {&one.comparison->measured_rms, &one.comparison->vaf, &one.comparison->correlation,
                       &one.comparison->gain, &one.comparison->lag, &one.comparison->correlation_at_lag}) {
    *part = Vector::Ones(2);
  }
  EXPECT_THAT(force_text(one), AllOf(HasSubstr("virtual sensor"), HasSubstr("force sensor")));
  one.source = ForceSource::observer;
  EXPECT_THAT(force_text(one), AllOf(HasSubstr("momentum observer"), HasSubstr("force sensor")));
}

}  // namespace
}  // namespace mbk::report
