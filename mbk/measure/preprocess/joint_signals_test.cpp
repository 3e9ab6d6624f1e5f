#include "mbk/measure/preprocess/joint_signals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <numbers>
#include <random>

#include "mbk/measure/preprocess/resample.h"
#include "mbk/measure/preprocess/test_recordings.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/robot/serial_chain.h"
#include "mbk/model/robot/single_joint.h"
#include "mbk/model/robot/test_chains.h"
#include "mbk/model/robot/test_models.h"

namespace mbk::preprocess {
namespace joint_signals_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kRate = 1000.0;  // [Hz]

/// Two seconds of a planar robot that swings, with the units of a file.
Recording swing() {
  const robot::JointMotion motion = robot::Swing().sampled(2000, 1.0 / kRate);
  Recording recording = testing_support::even_recording(motion.samples(), kRate,
                                                        {{"joint_1", motion.position.col(0)},
                                                         {"joint_2", motion.position.col(1)},
                                                         {"torque_1", motion.acceleration.col(0)},
                                                         {"torque_2", motion.acceleration.col(1)}});
  const char* const units[] = {"rad", "rad", "N.m", "N.m"};
  for (std::size_t k = 0; k < 4; ++k) recording.channels[k].unit = units[k];
  return recording;
}

Channel& channel(Recording& recording, const std::string& name) {
  return *std::ranges::find(recording.channels, name, &Channel::name);
}

Vector sine(Index samples, double rate, double hz, double amplitude, double offset = 0.0) {
  Vector values(samples);
  for (Index i = 0; i < samples; ++i) {
    values[i] = offset + amplitude * std::sin(2.0 * std::numbers::pi * hz * static_cast<double>(i) / rate);
  }
  return values;
}

void expect_refused(const Result<JointSignals>& signals, std::initializer_list<const char*> facts) {
  ASSERT_FALSE(signals);
  EXPECT_EQ(signals.error().kind, ErrorKind::data);
  for (const char* const fact : facts) EXPECT_THAT(signals.error().line(), HasSubstr(fact));
}

const robot::PlanarMechanism kPlanar{{}};

TEST(SelectJointSignals, NamesAChannelThatIsMissingAndThoseThatAreThere) {
  Recording recording = swing();
  channel(recording, "torque_2").name = "current_2";
  expect_refused(select_joint_signals(recording, kPlanar, false),
                 {"'torque_2'", "joint_1, joint_2, torque_1, current_2"});
  expect_refused(select_joint_signals(swing(), kPlanar, true), {"'acceleration_x'"});
}

TEST(SelectJointSignals, RefusesAUnitOfAnotherKindAndTakesNone) {
  Recording recording = swing();
  channel(recording, "joint_2").unit = "m";
  expect_refused(select_joint_signals(recording, kPlanar, false), {"'joint_2'", "rad"});
  channel(recording, "joint_2").unit = "";
  EXPECT_TRUE(select_joint_signals(recording, kPlanar, false));
}

TEST(SelectJointSignals, OfOneJointMayBeCalledPosition) {
  const robot::SingleJoint slide{{}};
  const Vector x = sine(100, kRate, 3.0, 0.1);
  const Recording recording = testing_support::even_recording(100, kRate, {{"position", x}, {"torque_1", 2.0 * x}});
  const auto signals = select_joint_signals(recording, slide, false);
  ASSERT_TRUE(signals) << signals.error().line();
  EXPECT_EQ(signals->position.col(0), x);
  EXPECT_EQ(signals->torque.col(0), 2.0 * x);
  EXPECT_EQ(signals->joint_reference.size(), 0);
}

/// Two joints that turn, called joint_1 and joint_2.
std::shared_ptr<const robot::SerialChain> chain(const char* joints = "RR") {
  return robot::SerialChain::from_urdf(robot::RandomChain(joints, 5).urdf(), {}).value();
}

/// As `swing`, with names of joints in their order; "" for one that has none.
Recording swing_of(const std::vector<std::string>& joints, const std::vector<std::string>& torques) {
  Recording recording = swing();
  for (std::size_t k = 0; k < 2; ++k) {
    recording.channels[k].origin.joint = joints[k];
    recording.channels[k + 2].origin.joint = torques[k];
    if (!joints[k].empty()) recording.channels[k].unit = "";
    if (!torques[k].empty()) recording.channels[k + 2].unit = "";
  }
  return recording;
}

TEST(SelectJointSignals, TakesJointsByName) {
  const Recording recording = swing_of({"joint_2", "joint_1"}, {"joint_2", "joint_1"});
  const auto signals = select_joint_signals(recording, *chain(), false);
  ASSERT_TRUE(signals) << signals.error().line();
  EXPECT_EQ(signals->position.col(0), recording.find("joint_2")->values);
  EXPECT_EQ(signals->position.col(1), recording.find("joint_1")->values);
  EXPECT_EQ(signals->torque.col(0), recording.find("torque_2")->values);
}

TEST(SelectJointSignals, RefusesNamesThatAreNotTheRobotsWithBothLists) {
  expect_refused(select_joint_signals(swing_of({"elbow", "joint_1"}, {"elbow", "joint_1"}), *chain(), false),
                 {"'elbow', 'joint_1'", "'joint_1', 'joint_2'"});
  expect_refused(select_joint_signals(swing_of({"joint_1", "joint_1"}, {"", ""}), *chain(), false),
                 {"'joint_1', 'joint_1'"});
}

TEST(SelectJointSignals, TakesWhatHasNoNamesByNumber) {
  const Recording recording = swing_of({"joint_1", "joint_2"}, {"", ""});
  const auto signals = select_joint_signals(recording, *chain(), false);
  ASSERT_TRUE(signals) << signals.error().line();
  EXPECT_EQ(signals->torque.col(0), recording.find("torque_1")->values);
  EXPECT_TRUE(select_joint_signals(swing_of({"", ""}, {"", ""}), *chain(), false));
  EXPECT_TRUE(select_joint_signals(swing_of({"elbow", "shoulder"}, {"elbow", "shoulder"}), kPlanar, false));
}

TEST(SelectJointSignals, RefusesTorquesWithoutNamesBesideJointsInAnotherOrder) {
  expect_refused(select_joint_signals(swing_of({"joint_2", "joint_1"}, {"", ""}), *chain(), false),
                 {"joint_1", "'joint_1', 'joint_2'"});
}

TEST(SelectJointSignals, RefusesMoreNamedJointsThanARobotWithoutNamesHas) {
  Recording recording = swing_of({"elbow", "shoulder"}, {"elbow", "shoulder"});
  recording.channels.push_back({"joint_3", "", "joint", recording.channels[0].values});
  recording.channels.back().origin.joint = "wrist";
  expect_refused(select_joint_signals(recording, kPlanar, false), {"'elbow', 'shoulder', 'wrist'"});
}

TEST(SelectJointSignals, LeavesOutReferencesThatCountOtherwise) {
  Recording recording = swing_of({"joint_2", "joint_1"}, {"joint_2", "joint_1"});
  for (const char* name : {"reference_joint_1", "reference_joint_2"}) {
    recording.channels.push_back({name, "rad", "joint", recording.channels[0].values});
  }
  EXPECT_EQ(select_joint_signals(recording, *chain(), false)->joint_reference.size(), 0);
  recording.channels[0].origin.joint = recording.channels[2].origin.joint = "joint_1";
  recording.channels[1].origin.joint = recording.channels[3].origin.joint = "joint_2";
  EXPECT_EQ(select_joint_signals(recording, *chain(), false)->joint_reference.cols(), 2);
}

TEST(SelectJointSignals, ANamedJointHasTheUnitThatTheRobotSays) {
  Recording recording = swing_of({"joint_1", "joint_2"}, {"joint_1", "joint_2"});
  EXPECT_TRUE(select_joint_signals(recording, *chain("PR"), false));
  recording.channels[0].unit = "rad";
  expect_refused(select_joint_signals(recording, *chain("PR"), false), {"'joint_1'", "rad", ":m"});
}

/// Checked over all of it.
Result<void> checked(const Recording& recording, std::vector<std::string>* notes = nullptr) {
  std::vector<std::string> unused;
  const auto signals = select_joint_signals(recording, kPlanar, false).value();
  const Clock clock(recording.time, Hertz(kRate));
  return check_joint_signals(signals, kPlanar, clock, WindowPlan{{Cut{100, recording.samples(), {}}}, "", {}, 0},
                             notes != nullptr ? *notes : unused);
}

TEST(CheckJointSignals, NamesTheTimeAtWhichAJointIsBeyondItsLimits) {
  EXPECT_TRUE(checked(swing()));
  Recording recording = swing();
  channel(recording, "joint_1").values[1234] = 1.6;  // 91.7°
  const auto refused = checked(recording);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::data);
  EXPECT_THAT(refused.error().line(),
              AllOf(HasSubstr("sample 1235"), HasSubstr("1.234"), HasSubstr("θ₁"), HasSubstr("91.6")));
  EXPECT_THAT(refused.error().line(), HasSubstr("--channels"));
}

TEST(CheckJointSignals, AcceptsAndNotesWhatIsBeyondALimitByTheNoiseOfAnEncoder) {
  const robot::JointRange range = kPlanar.joint_range(0);
  Recording recording = swing();
  channel(recording, "joint_1").values[1234] = range.high + 7e-5;
  channel(recording, "joint_1").values[1240] = range.high + 0.009;
  std::vector<std::string> notes;
  const auto accepted = checked(recording, &notes);
  ASSERT_TRUE(accepted) << accepted.error().line();
  EXPECT_THAT(notes, ElementsAre(AllOf(HasSubstr("sample 1235"), HasSubstr("1.234"), HasSubstr("2 samples"))));
  channel(recording, "joint_1").values[1234] = range.high + 0.011;
  EXPECT_FALSE(checked(recording));
  // Both angles, each within its limits, may not close the links on each other either.
  recording = swing();
  const double opening = robot::JointLimits().smallest_opening;
  channel(recording, "joint_1").values[1300] = 0.2;
  channel(recording, "joint_2").values[1300] = 0.2 + 0.5 * std::numbers::pi - opening + 0.005;
  EXPECT_TRUE(checked(recording));
  channel(recording, "joint_2").values[1300] += 0.02;
  EXPECT_FALSE(checked(recording));
}

TEST(CheckJointSignals, LooksOnlyAtWhatCounts) {
  Recording recording = swing();
  channel(recording, "joint_1").values[99] = 1.6;
  channel(recording, "torque_1").values[99] = std::nan("");
  EXPECT_TRUE(checked(recording));
  channel(recording, "torque_1").values[100] = std::nan("");
  EXPECT_THAT(checked(recording).error().line(), AllOf(HasSubstr("'torque_1'"), HasSubstr("sample 101")));
}

TEST(CheckJointSignals, TakesATorqueOfZeroForOneThatWasNotRecorded) {
  Recording recording = swing();
  channel(recording, "torque_2").values.setZero();
  EXPECT_THAT(checked(recording).error().line(), AllOf(HasSubstr("'torque_2'"), HasSubstr("zero")));
}

TEST(StandingJoints, AreThoseThatFlickerByTheStepsOfTheirEncoder) {
  constexpr double kStep = 4e-4;  // [rad]
  std::mt19937 random(1);
  JointSignals signals;
  signals.position.resize(5000, 3);
  signals.position.col(0) = sine(5000, 500.0, 0.8, 0.2);
  signals.position.col(2).setConstant(0.3);
  for (double& value : signals.position.col(1)) value = kStep * static_cast<double>(random() % 3);
  signals.position = (signals.position / kStep).array().round() * kStep;
  const WindowPlan whole{{Cut{0, 5000, {}}}, "", {}, 0};
  EXPECT_THAT(standing_joints(signals, whole), ElementsAre(false, true, true));
}

TEST(StandingJoints, AreSeenAfterTheClockWasPutRight) {
  constexpr double kStep = 4e-4;  // [rad]
  std::mt19937 random(1);
  Vector flicker(5000);
  for (double& value : flicker) value = kStep * static_cast<double>(random() % 3);
  Recording recording =
      testing_support::even_recording(5000, 503.0, {{"joint_1", sine(5000, 503.0, 0.8, 0.2)}, {"joint_2", flicker}});
  const auto even = resample(recording, Hertz(500.0));
  ASSERT_TRUE(even) << even.error().line();
  JointSignals signals;
  signals.position.resize(even->samples(), 2);
  for (Index joint = 0; joint < 2; ++joint) {
    signals.position.col(joint) = even->channels[static_cast<std::size_t>(joint)].values;
  }
  EXPECT_THAT(standing_joints(signals, WindowPlan{{Cut{0, even->samples(), {}}}, "", {}, 0}), ElementsAre(false, true));
}

TEST(PositionNoise, IsThatOfWhiteNoiseAndNothingOfASlowMotion) {
  constexpr double kNoise = 1e-4;  // [rad]
  std::mt19937 random(2);
  Matrix position(20'000, 2);
  position.col(0) = sine(20'000, kRate, 5.0, 0.3);
  for (Index i = 0; i < position.rows(); ++i)
    position(i, 1) = position(i, 0) + kNoise * testing_support::normal(random);
  const Vector noise = position_noise(position, {Cut{0, 9000, {}}, Cut{9000, 20'000, {}}});
  EXPECT_LT(noise[0], 1e-3 * kNoise);
  EXPECT_NEAR(noise[1], kNoise, 0.02 * kNoise);
}

TEST(SmoothJoints, ShiftTheTorqueByTheDelayOfTheMotors) {
  constexpr double kHz = 5.0, kDelay = 2.3e-3;  // [s]: between two samples
  JointSignals signals;
  signals.position = sine(1000, kRate, 1.0, 0.1, 0.4).replicate(1, 2);
  signals.torque = sine(1000, kRate, kHz, 1.0).replicate(1, 2);
  const dsp::SavitzkyGolay smoothing{6, 21};
  const auto joints = smooth_joints(signals, kPlanar, Cut{0, 1000, {}}, smoothing, Hertz(kRate), kDelay);
  ASSERT_TRUE(joints) << joints.error().line();
  const Index inside = joints->torque.rows();
  double largest = 0.0, at_ends = 0.0;
  for (Index i = 0; i < inside; ++i) {
    const double t = static_cast<double>(i + smoothing.half_window()) / kRate - kDelay;
    const double error = std::abs(joints->torque(i, 0) - std::sin(2.0 * std::numbers::pi * kHz * t));
    (i < 3 ? at_ends : largest) = std::max(i < 3 ? at_ends : largest, error);
  }
  EXPECT_LT(largest, 1e-6);
  EXPECT_LT(at_ends, 3e-3);  // straight lines: ½ (2π 5 · 2.3 ms)²
  const auto early = smooth_joints(signals, kPlanar, Cut{0, 1000, {}}, smoothing, Hertz(kRate), -1.0 / kRate);
  const auto none = smooth_joints(signals, kPlanar, Cut{0, 1000, {}}, smoothing, Hertz(kRate), 0.0);
  EXPECT_LE((early->torque.topRows(inside - 1) - none->torque.bottomRows(inside - 1)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SmoothJoints, TakeTheAccelerationFromTheHandsAccelerometer) {
  const robot::JointMotion motion = robot::Swing().sampled(1000, 1.0 / kRate);
  JointSignals signals;
  signals.position = motion.position;
  signals.torque = motion.acceleration;
  signals.hand_acceleration.resize(1000, 2);
  for (Index i = 0; i < 1000; ++i) {
    const robot::JointVector q = motion.position.row(i).transpose(), v = motion.velocity.row(i).transpose();
    signals.hand_acceleration.row(i) =
        (kPlanar.jacobian(q) * motion.acceleration.row(i).transpose() + kPlanar.jacobian_rate(q, v) * v).transpose();
  }
  const dsp::SavitzkyGolay smoothing{6, 21};
  const auto joints = smooth_joints(signals, kPlanar, Cut{0, 1000, {}}, smoothing, Hertz(kRate), 0.0);
  ASSERT_TRUE(joints) << joints.error().line();
  const Matrix truth = motion.acceleration.middleRows(smoothing.half_window(), joints->torque.rows());
  EXPECT_LE((joints->motion.acceleration - truth).cwiseAbs().maxCoeff(), 1e-5 * truth.cwiseAbs().maxCoeff());
  signals.hand_acceleration *= 2.0;  // the sensor is used, not the joints
  const auto twice = smooth_joints(signals, kPlanar, Cut{0, 1000, {}}, smoothing, Hertz(kRate), 0.0);
  EXPECT_GT((twice->motion.acceleration - truth).cwiseAbs().maxCoeff(), 0.5 * truth.cwiseAbs().maxCoeff());
}

}  // namespace joint_signals_test
}  // namespace mbk::preprocess
