#include "mbk/files/kinarm/kinarm_exam.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "mbk/files/kinarm/test_exam.h"

namespace mbk::recording {
namespace {

using test::ArmOfTest;
using test::ExamOfTest;
using test::small_exam;
using test::TrialOfTest;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

KinarmExam opened(const std::string& bytes) {
  auto exam = KinarmExam::open(test::buffer_of(bytes));
  EXPECT_TRUE(exam) << exam.error().line();
  return std::move(exam.value());
}

Contents decoded(const std::string& bytes, const ExamChoice& choice = {}) {
  const KinarmExam exam = opened(bytes);
  auto contents = exam.decode(choice);
  EXPECT_TRUE(contents) << contents.error().line();
  return contents ? std::move(*contents) : Contents();
}

std::string refusal(const std::string& bytes, const ExamChoice& choice = {}) {
  const auto exam = KinarmExam::open(test::buffer_of(bytes));
  if (!exam) return exam.error().line();
  const auto contents = exam->decode(choice);
  EXPECT_FALSE(contents);
  return contents ? "" : contents.error().line();
}

const Array* find(const Contents& contents, std::string_view name) {
  for (const Array& array : contents.arrays) {
    if (array.name == name) return &array;
  }
  return nullptr;
}

Vector values(const Contents& contents, std::string_view name) {
  const Array* const array = find(contents, name);
  EXPECT_NE(array, nullptr) << name;
  return array == nullptr ? Vector() : Vector(array->values.reshaped());
}

std::string means(const Contents& contents, std::string_view name) {
  const Array* const array = find(contents, name);
  return array == nullptr ? "none" : array->means;
}

std::string notes(const Contents& contents) {
  std::string text;
  for (const std::string& note : contents.notes) text += note + "\n";
  return text;
}

std::vector<std::string> names(const std::vector<TrialName>& trials) {
  std::vector<std::string> list;
  for (const TrialName& trial : trials) list.push_back(trial.name);
  return list;
}

double largest(const Vector& difference) {
  return difference.cwiseAbs().maxCoeff();
}

// ---- what is stored ----

TEST(KinarmExam, SignalsAreTheStoredRealsToTheBit) {
  const ExamOfTest exam = small_exam();
  const Contents contents = decoded(exam.bytes());
  EXPECT_EQ(contents.format, "KINARM exam");
  for (const test::SignalOfTest& signal : exam.trials.front().signals) {
    const Vector stored = values(contents, signal.label);
    ASSERT_EQ(stored.size(), 400);
    for (Index i = 0; i < stored.size(); ++i) {
      ASSERT_EQ(stored[i], static_cast<double>(signal.values[static_cast<std::size_t>(i)])) << signal.label;
    }
  }
  EXPECT_EQ(values(contents, "Right_Hand.x")[17], static_cast<double>(exam.trials.front().hand_x[17]));
  EXPECT_EQ(find(contents, "Right_L1Vel")->rate_hz, 1000.0);
  EXPECT_EQ(find(contents, "Right_M1TorCMD")->unit, "N.m");
}

TEST(KinarmExam, TheStatusOfTheSensorIsItsBits) {
  ExamOfTest exam = small_exam();
  std::vector<float> status(400, 0.0F);
  for (const std::uint32_t bits : {0x1U, 0x80000003U, 0x7FA00001U, 0xFFFFFFFFU}) {
    std::memcpy(&status[bits & 7U], &bits, sizeof bits);
  }
  exam.trials.front().signals.push_back({"Right_FS_Status", "", status});
  const Vector stored = values(decoded(exam.bytes()), "Right_FS_Status");
  EXPECT_EQ(stored[0], 0.0);
  EXPECT_EQ(stored[1], double{0x7FA00001U});  // of a NaN
  EXPECT_EQ(stored[3], double{0x80000003U});
  EXPECT_EQ(stored[7], double{0xFFFFFFFFU});
}

TEST(KinarmExam, EventsKeepTheirLettersAndTimes) {
  const Contents contents = decoded(small_exam().bytes());
  ASSERT_EQ(contents.events.size(), 2U);
  EXPECT_EQ(contents.events[0].name, "Début 開始");
  EXPECT_EQ(contents.events[0].time, static_cast<double>(0.1F));
}

TEST(KinarmExam, ParametersAreMetadataAndThePersonStaysInTheExam) {
  const Contents contents = decoded(small_exam().bytes());
  EXPECT_EQ(contents.metadata.at("EXPERIMENT_TASK_PROTOCOL"), "Reaching, 8 targets");
  EXPECT_EQ(contents.metadata.at("TRIAL_TP"), "4");
  EXPECT_EQ(contents.metadata.at("RIGHT_KINARM_VERSION"), "KINARM_EP_2.0");
  EXPECT_EQ(contents.metadata.at("RIGHT_KINARM_L1_L"), "0.31");
  EXPECT_EQ(contents.metadata.at("trial"), "1");
  std::string all = notes(contents);
  for (const auto& [key, value] : contents.metadata) all += key + "=" + value + "\n";
  for (const char* personal : {"Doe", "Jane", "1970", "Roe", "51"}) EXPECT_THAT(all, Not(HasSubstr(personal)));
  EXPECT_THAT(all, HasSubstr("SUBJECT"));
  EXPECT_THAT(all, HasSubstr("EXPERIMENT:OPERATOR"));
}

TEST(KinarmExam, TorqueXOfOldRecordersIsLeftOut) {
  ExamOfTest exam = small_exam();
  for (const char* torque : {"Right_FS_TorqueX", "Right_FS_TorqueZ"}) {
    exam.trials.front().signals.push_back({torque, "Nm", std::vector<float>(400, 1.0F)});
  }
  EXPECT_NE(find(decoded(exam.bytes()), "Right_FS_TorqueX"), nullptr);
  for (const char* version : {"3.4.1", "3.3.9.1", "2.9"}) {
    exam.trials.front().parameters =
        test::exam_group("EXPERIMENT") + test::exam_parameter("TASK_PROGRAM_BUILD_TDK", version);
    const Contents old = decoded(exam.bytes());
    EXPECT_EQ(find(old, "Right_FS_TorqueX"), nullptr) << version;
    EXPECT_NE(find(old, "Right_FS_TorqueZ"), nullptr);
    EXPECT_THAT(notes(old), HasSubstr("Right_FS_TorqueX"));
  }
  for (const char* version : {"3.4.2", "3.10", "4.0.0"}) {
    exam.trials.front().parameters =
        test::exam_group("EXPERIMENT") + test::exam_parameter("TASK_PROGRAM_BUILD_TDK", version);
    EXPECT_NE(find(decoded(exam.bytes()), "Right_FS_TorqueX"), nullptr) << version;
  }
}

// ---- trials ----

TEST(KinarmExam, TrialsStandInTheOrderOfTheirNumbers) {
  ExamOfTest exam = small_exam({}, 3, 60);
  exam.trials[0].number = 12;
  exam.trials[1].number = 2;
  exam.trials[2].number = 7;
  const KinarmExam opened_exam = opened(exam.bytes());
  EXPECT_THAT(names(opened_exam.trials()), ElementsAre("2", "7", "12"));
  EXPECT_THAT(opened_exam.trials()[0].description,
              AllOf(HasSubstr("TP 4"), HasSubstr("block 2"), HasSubstr("trial 1"), HasSubstr("repeat 1"),
                    HasSubstr("0.060 s"), HasSubstr("60 frames"), HasSubstr("2 events")));
  const auto contents = opened_exam.decode({"7", std::nullopt});
  ASSERT_TRUE(contents);
  EXPECT_EQ(values(*contents, "Right_L1Ang")[5], static_cast<double>(exam.trials[2].values("Right_L1Ang")[5]));
  EXPECT_THAT(refusal(exam.bytes()), AllOf(HasSubstr("--trial"), HasSubstr("3 trials")));
  EXPECT_THAT(refusal(exam.bytes(), {"3", std::nullopt}),
              AllOf(HasSubstr("'3'"), HasSubstr("3 trials"), HasSubstr("12")));
}

TEST(KinarmExam, PartsOfASplitTrialAreJoined) {
  ExamOfTest exam = small_exam({}, 4, 100);
  for (int k = 0; k < 4; ++k) exam.trials[static_cast<std::size_t>(k)].number = 5 + k;
  exam.trials[1].break_id = 1;
  exam.trials[2].break_id = 2;
  exam.trials[2].frames = 80;
  for (test::SignalOfTest& signal : exam.trials[2].signals) signal.values.resize(80);
  exam.trials[2].hand_x.resize(80);
  exam.trials[2].hand_y.resize(80);
  exam.trials[3].break_id = 1;  // another one begins
  const KinarmExam opened_exam = opened(exam.bytes());
  EXPECT_THAT(names(opened_exam.trials()), ElementsAre("5", "6", "8"));
  const auto contents = opened_exam.decode({"6", std::nullopt});
  ASSERT_TRUE(contents) << contents.error().line();
  const Vector joint = values(*contents, "Right_L2Ang");
  ASSERT_EQ(joint.size(), 180);
  EXPECT_EQ(joint[99], static_cast<double>(exam.trials[1].values("Right_L2Ang")[99]));
  EXPECT_EQ(joint[100], static_cast<double>(exam.trials[2].values("Right_L2Ang")[0]));
  ASSERT_EQ(contents->events.size(), 4U);
  EXPECT_EQ(contents->events[1].time, 0.1 + static_cast<double>(0.1F));
  EXPECT_THAT(notes(*contents), HasSubstr("2 parts"));
}

// ---- the hand ----

TEST(KinarmExam, TheHandFollowsFromTheJointsOfAnEndPointRobot) {
  const ExamOfTest exam = small_exam();
  const Contents contents = decoded(exam.bytes());
  EXPECT_EQ(means(contents, "Right_hand_x"), "hand_x");
  EXPECT_EQ(means(contents, "Right_hand_acceleration_y"), "acceleration_y");
  EXPECT_EQ(means(contents, "Right_L1Ang"), "joint_1");
  EXPECT_EQ(means(contents, "Right_Hand.x"), "");
  EXPECT_LT(largest(values(contents, "Right_hand_x") - values(contents, "Right_Hand.x")), 1e-7);
  EXPECT_THAT(notes(contents), AllOf(HasSubstr("Right_Hand"), HasSubstr("rounding")));
  // Velocity and acceleration are the derivatives of the position, whose numbers are smooth in this test.
  const Vector x = values(contents, "Right_hand_x"), v = values(contents, "Right_hand_velocity_x");
  const Vector a = values(contents, "Right_hand_acceleration_x");
  for (Index i = 20; i < 380; ++i) {
    EXPECT_NEAR((x[i + 4] - x[i - 4]) / 0.008, v[i], 5e-4);  // h² / 6 times the largest jerk
    EXPECT_NEAR((v[i + 4] - v[i - 4]) / 0.008, a[i], 1e-2);
  }
}

TEST(KinarmExam, ThePointerOfAnExoskeletonTurnsItsSignOnTheLeft) {
  for (const char* side : {"Right", "Left"}) {
    const bool left = side[0] == 'L';
    const std::string capitals = left ? "LEFT" : "RIGHT";
    ArmOfTest arm;
    arm.pointer = left ? -0.04 : 0.04;  // stored is 0.04 for both
    ExamOfTest exam;
    TrialOfTest& trial = exam.trials.emplace_back();
    test::add_arm(trial, side, arm);
    trial.hand = std::string(side) + "_Hand";
    const auto real = [](double value) { return std::vector<float>{static_cast<float>(value)}; };
    exam.common = test::exam_group("RIGHT_KINARM") + test::exam_parameter("VERSION", "KINARM_H_1.2") +
                  test::exam_group("CALIBRATION") + test::exam_parameter(capitals + "_L1", real(arm.link1)) +
                  test::exam_parameter(capitals + "_L2", real(arm.link2)) +
                  test::exam_parameter(capitals + "_PTR_ANTERIOR", real(0.04));
    const Contents contents = decoded(exam.bytes());
    const std::string name(side);
    EXPECT_LT(largest(values(contents, name + "_hand_y") - values(contents, name + "_Hand.y")), 1e-7) << side;
    EXPECT_EQ(means(contents, name + "_hand_y"), "hand_y");
    EXPECT_THAT(notes(contents), AllOf(HasSubstr(name + "_Hand"), HasSubstr("rounding")));
  }
}

TEST(KinarmExam, AWrongGeometryIsNoHand) {
  ArmOfTest arm;
  ExamOfTest exam = small_exam(arm);
  for (const double wrong : {0.3, 0.309}) {
    exam.trials.front().parameters =
        test::exam_group("RIGHT_KINARM") + test::exam_parameter("L1_L", std::vector<float>{static_cast<float>(wrong)});
    const Contents contents = decoded(exam.bytes());
    EXPECT_EQ(means(contents, "Right_hand_x"), "") << wrong;
    EXPECT_EQ(means(contents, "Right_hand_acceleration_x"), "");
    EXPECT_THAT(notes(contents), AllOf(HasSubstr("0.31 m"), HasSubstr("0.28 m"), HasSubstr("pointer")));
    EXPECT_THAT(notes(contents), HasSubstr("--channels Fx=-force_x,Fy=-force_y,x=hand_x,y=hand_y"));
    EXPECT_THAT(notes(contents), Not(HasSubstr(" kg")));  // of which a sign is inferred
  }
}

TEST(KinarmExam, AHandThatWasSampledAtOtherTimesIsNoWrongGeometry) {
  ExamOfTest exam = small_exam();
  TrialOfTest& trial = exam.trials.front();
  for (std::size_t i = 0; i + 1 < trial.hand_x.size(); ++i) {  // 0.2 ms later
    trial.hand_x[i] += 0.2F * (trial.hand_x[i + 1] - trial.hand_x[i]);
    trial.hand_y[i] += 0.2F * (trial.hand_y[i + 1] - trial.hand_y[i]);
  }
  const Contents contents = decoded(exam.bytes());
  EXPECT_EQ(means(contents, "Right_hand_x"), "hand_x");
  EXPECT_THAT(notes(contents), AllOf(HasSubstr("Right_Hand"), HasSubstr("motion")));
}

TEST(KinarmExam, AConstantOffsetOfTheRecordedHandIsSaid) {
  ExamOfTest exam = small_exam();
  for (float& x : exam.trials.front().hand_x) x += 0.25F;
  const Contents contents = decoded(exam.bytes());
  EXPECT_EQ(means(contents, "Right_hand_x"), "hand_x");
  EXPECT_THAT(notes(contents), AllOf(HasSubstr("Right_Hand"), HasSubstr("0.25")));
}

TEST(KinarmExam, OfTwoArmsOneMustBeNamed) {
  ExamOfTest exam = small_exam();
  ArmOfTest left;
  left.sensor_sign = -1.0;
  exam.common += ExamOfTest::end_point(left, "LEFT");
  test::add_arm(exam.trials.front(), "Left", left, 2.0);
  exam.trials.front().hand = "Left_Hand";
  EXPECT_THAT(refusal(exam.bytes()), AllOf(HasSubstr("--side right"), HasSubstr("--side left")));
  const Contents contents = decoded(exam.bytes(), {"", Arm::left});
  EXPECT_EQ(means(contents, "Left_hand_x"), "hand_x");
  EXPECT_EQ(means(contents, "Left_M2TorCMD"), "torque_2");
  EXPECT_EQ(find(contents, "Right_hand_x"), nullptr);
  EXPECT_EQ(means(contents, "Right_L1Ang"), "");
  EXPECT_LT(largest(values(contents, "Left_force_x") + values(contents, "Left_FS_ForceX")), 1e-12);
  const Contents both = decoded(exam.bytes(), {"", std::nullopt, false});
  EXPECT_EQ(means(both, "Left_hand_x"), "");
  EXPECT_NE(find(both, "Right_hand_x"), nullptr);
}

TEST(KinarmExam, WithoutARightArmTheRightHandIsTheLeft) {
  ArmOfTest arm;
  ExamOfTest exam;
  TrialOfTest& trial = exam.trials.emplace_back();
  test::add_arm(trial, "Left", arm);
  exam.common = ExamOfTest::end_point(arm, "LEFT") + test::exam_group("RIGHT_KINARM") +
                test::exam_parameter("VERSION", "KINARM_EP_2.0") + test::exam_parameter("IS_PRESENT", std::int32_t{0});
  const Contents contents = decoded(exam.bytes());
  EXPECT_EQ(find(contents, "Right_Hand.x"), nullptr);
  EXPECT_NE(find(contents, "Left_Hand.x"), nullptr);
  EXPECT_EQ(means(contents, "Left_hand_x"), "hand_x");
  EXPECT_THAT(notes(contents), AllOf(HasSubstr("RIGHT_KINARM:IS_PRESENT"), HasSubstr("Left_Hand")));
}

TEST(KinarmExam, AnUnknownRobotGivesNoHandAndSaysWhy) {
  ExamOfTest exam = small_exam();
  exam.trials.front().parameters = test::exam_group("RIGHT_KINARM") + test::exam_parameter("VERSION", "NHP_UTS_1");
  const Contents contents = decoded(exam.bytes());
  EXPECT_EQ(find(contents, "Right_hand_x"), nullptr);
  EXPECT_THAT(notes(contents), HasSubstr("'NHP_UTS_1'"));
}

// ---- the sign of the force ----

TEST(KinarmExam, TheSignOfTheForceIsInferred) {
  for (const bool commanded : {true, false}) {
    for (const double sign : {1.0, -1.0}) {
      ArmOfTest arm;
      arm.sensor_sign = sign;
      arm.commanded = commanded;
      const Contents contents = decoded(small_exam(arm).bytes());
      EXPECT_EQ(means(contents, "Right_force_x"), "force_x");
      EXPECT_EQ(largest(values(contents, "Right_force_x") - sign * values(contents, "Right_FS_ForceX")), 0.0);
      EXPECT_THAT(notes(contents), HasSubstr("1.2 kg")) << commanded << sign;
    }
  }
}

TEST(KinarmExam, ANearlyMasslessRobotBalancesForces) {
  for (const double sign : {1.0, -1.0}) {
    ArmOfTest arm;
    arm.sensor_sign = sign;
    arm.robot_mass = 0.0;
    const Contents contents = decoded(small_exam(arm).bytes());
    EXPECT_EQ(largest(values(contents, "Right_force_y") - sign * values(contents, "Right_FS_ForceY")), 0.0);
  }
}

TEST(KinarmExam, NoiseDoesNotDecideTheSign) {
  ExamOfTest exam = small_exam();
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0.0F, 3.0F);
  for (test::SignalOfTest& signal : exam.trials.front().signals) {
    if (signal.label.find("FS_Force") == std::string::npos) continue;
    for (float& value : signal.values) value = noise(random);
  }
  const Contents contents = decoded(exam.bytes());
  EXPECT_THAT(notes(contents), HasSubstr("evidence"));
  EXPECT_EQ(means(contents, "Right_force_x"), "force_x");
}

TEST(KinarmExam, TheSignIsThatOfTheWholeExam) {
  ArmOfTest arm;
  arm.sensor_sign = -1.0;
  ExamOfTest exam = small_exam(arm, 12, 200);
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0.0F, 0.2F);
  for (test::SignalOfTest& signal : exam.trials[4].signals) {  // this one tells nothing by itself
    if (signal.label.find("FS_Force") == std::string::npos) continue;
    for (float& value : signal.values) value = noise(random);
  }
  const Contents contents = decoded(exam.bytes(), {"5", std::nullopt});
  EXPECT_EQ(values(contents, "Right_force_x")[9], -values(contents, "Right_FS_ForceX")[9]);
  EXPECT_THAT(notes(contents), HasSubstr("8 trials"));
}

TEST(KinarmExam, TheCommandedForceDoesTheWorkOfTheTorques) {
  const Contents contents = decoded(small_exam().bytes());
  const auto power = [&](const char* one, const char* other) {
    return (values(contents, one).array() * values(contents, other).array()).matrix().eval();
  };
  const Vector at_hand = power("Right_commanded_force_x", "Right_hand_velocity_x") +
                         power("Right_commanded_force_y", "Right_hand_velocity_y");
  const Vector at_joints = power("Right_M1TorCMD", "Right_L1Vel") + power("Right_M2TorCMD", "Right_L2Vel");
  EXPECT_LT(largest(at_hand - at_joints), 1e-12 * (1.0 + largest(at_joints)) * 100);
}

// ---- C3D ----

std::string exam_of_c3d(const std::string& trial, const std::string& common) {
  return test::zip_of({{"raw/common.c3d", common}, {"raw/01_01_01.c3d", trial}});
}

/// The C3D twin of a trial: the hand as a point, everything else as analog channels.
test::C3d c3d_of(const TrialOfTest& trial) {
  test::C3d file;
  file.rate = 1000.0;
  file.point_units = "m";
  file.points = {"Right_Hand"};
  file.coordinates = Matrix::Zero(trial.frames, 4);
  for (Index i = 0; i < trial.frames; ++i) {
    file.coordinates(i, 0) = static_cast<double>(trial.hand_x[static_cast<std::size_t>(i)]);
    file.coordinates(i, 1) = static_cast<double>(trial.hand_y[static_cast<std::size_t>(i)]);
  }
  file.analog.resize(trial.frames, static_cast<Index>(trial.signals.size()));
  for (std::size_t c = 0; c < trial.signals.size(); ++c) {
    file.channels.push_back(trial.signals[c].label);
    file.analog_units.push_back(trial.signals[c].unit);
    file.analog_scale.push_back(1.0);
    file.analog_offset.push_back(0.0);
    for (Index i = 0; i < trial.frames; ++i) {
      file.analog(i, static_cast<Index>(c)) = static_cast<double>(trial.signals[c].values[static_cast<std::size_t>(i)]);
    }
  }
  return file;
}

TEST(KinarmExam, AnExamOfC3dFilesIsTheSame) {
  ExamOfTest exam = small_exam();
  TrialOfTest& trial = exam.trials.front();
  std::vector<float> status(400, 0.0F);
  const std::uint32_t bits = 0x80000005U;
  std::memcpy(&status[3], &bits, sizeof bits);
  trial.signals.push_back({"Right_FS_Status", "", status});
  test::C3d file = c3d_of(trial);
  const auto n = file.numbers();
  constexpr int kTrialGroup = test::C3d::kTrial, kRobot = 20, kExperiment = 21, kEvents = 22, kUnused = 23;
  file.records = n.words(kTrialGroup, "TRIAL_NUM", {1}) + n.words(kTrialGroup, "TP", {4}) + n.group(kEvents, "EVENTS") +
                 n.words(kEvents, "USED", {2}) + n.texts(kEvents, "LABELS", {"GO", "STOP"}) +
                 n.parameter(kEvents, "TIMES", 4, {2, 2}, n.real(1) + n.real(0.125) + n.real(1) + n.real(0.25)) +
                 n.group(kUnused, "LOAD_TABLE") + n.words(kUnused, "USED", {0}) + n.reals(kUnused, "LEFT", {3.0});
  test::C3d common = test::small_c3d();
  common.records = n.group(kRobot, "RIGHT_KINARM") + n.texts(kRobot, "VERSION", {"KINARM_EP_2.0"}) +
                   n.reals(kRobot, "L1_L", {0.31}) + n.reals(kRobot, "L2_L", {0.28}) +
                   n.group(kExperiment, "EXPERIMENT") + n.texts(kExperiment, "TASK_PROTOCOL", {"Reaching"}) +
                   n.texts(kExperiment, "SUBJECT_NAME", {"Jane Doe"});
  const std::string bytes = exam_of_c3d(file.bytes(), common.bytes());
  EXPECT_THAT(opened(bytes).trials().front().description,
              AllOf(HasSubstr("TP 4"), HasSubstr("block 1"), HasSubstr("trial 1"), HasSubstr("repeat 1"),
                    HasSubstr("0.400 s"), HasSubstr("400 frames")));
  const Contents c3d = decoded(bytes), kinarm = decoded(exam.bytes());
  EXPECT_EQ(c3d.format, "KINARM exam (C3D)");
  for (const char* name :
       {"Right_L1Ang", "Right_FS_ForceY", "Right_Hand.y", "Right_hand_x", "Right_hand_acceleration_y", "Right_force_x",
        "Right_commanded_force_x", "Right_FS_Status"}) {
    EXPECT_EQ(largest(values(c3d, name) - values(kinarm, name)), 0.0) << name;
    EXPECT_EQ(means(c3d, name), means(kinarm, name));
  }
  EXPECT_EQ(values(c3d, "Right_FS_Status")[3], double{bits});
  ASSERT_EQ(c3d.events.size(), 2U);
  EXPECT_EQ(c3d.events[1].time, 0.25);  // the first row is dropped
  EXPECT_EQ(c3d.metadata.at("EXPERIMENT_TASK_PROTOCOL"), "Reaching");
  EXPECT_FALSE(c3d.metadata.contains("EXPERIMENT_SUBJECT_NAME"));
  EXPECT_FALSE(c3d.metadata.contains("LOAD_TABLE_LEFT"));
}

TEST(KinarmExam, AC3dChannelWithoutScaleIsLeftOutAndCountsOfFramesAreSettledByTheSize) {
  const ExamOfTest exam = small_exam();
  test::C3d file = c3d_of(exam.trials.front());
  ASSERT_EQ(file.channels.at(9), "Right_FS_ForceY");
  file.analog_scale[9] = 0.0;
  file.records = file.numbers().words(test::C3d::kPoint, "FRAMES", {399});  // of 400, as the header says
  const std::string bytes = exam_of_c3d(file.bytes(), test::small_c3d().bytes());
  EXPECT_THAT(opened(bytes).trials().front().description, HasSubstr("400 frames"));
  const Contents contents = decoded(bytes);
  EXPECT_EQ(find(contents, "Right_FS_ForceY"), nullptr);
  EXPECT_EQ(values(contents, "Right_FS_ForceX").size(), 400);
  EXPECT_THAT(notes(contents), HasSubstr("'Right_FS_ForceY'"));
  EXPECT_THAT(notes(contents), AllOf(HasSubstr("400"), HasSubstr("POINT:FRAMES"), HasSubstr("399")));
}

// ---- what cannot be read ----

TEST(KinarmExam, RefusesWhatIsNoExamOrHoldsNoTrial) {
  EXPECT_THAT(refusal(test::zip_of({{"a.txt", "b"}})), HasSubstr("KINARM"));
  ExamOfTest exam = small_exam();
  exam.trials.clear();
  EXPECT_THAT(refusal(exam.bytes()), HasSubstr("trial"));
  exam.trials.push_back(TrialOfTest());
  EXPECT_THAT(refusal(exam.bytes()), HasSubstr("signal"));
}

TEST(KinarmExam, RefusesVersionsAndCountsThatItCannotRead) {
  auto members = small_exam().members();
  const auto with = [&](std::string_view end, std::size_t at, std::int32_t value) {
    auto changed = members;
    for (auto& [name, bytes] : changed) {
      if (name.ends_with(end)) bytes.replace(at, 4, test::raw(value));
    }
    return refusal(test::zip_of(changed));
  };
  EXPECT_THAT(with("1/header.bin", 0, 9), AllOf(HasSubstr("version 9"), HasSubstr("header.bin")));
  EXPECT_THAT(with("1/header.bin", 4, -1), HasSubstr("count"));
  EXPECT_THAT(with("1/parameters.bin", 4, 77), HasSubstr("type 77"));
  EXPECT_THAT(with("L1Ang.kinematics", 4, 0x7FFFFFFF), HasSubstr("2147483647"));
  EXPECT_THAT(with("examevents.bin", 4, 1000000), AllOf(HasSubstr("events"), HasSubstr("1000000")));
}

TEST(KinarmExam, ASignalOfAnotherLengthIsLeftOutAndSaid) {
  ExamOfTest exam = small_exam();
  exam.trials.front().signals.push_back({"EMG_biceps", "V", std::vector<float>(399, 1.0F)});
  exam.trials.front().signals.push_back({"EMG_triceps", "V", std::vector<float>(400, 1.0F)});
  const Contents contents = decoded(exam.bytes());
  EXPECT_EQ(find(contents, "EMG_biceps"), nullptr);
  EXPECT_EQ(find(contents, "EMG_triceps")->unit, "V");
  EXPECT_THAT(notes(contents), AllOf(HasSubstr("EMG_biceps"), HasSubstr("399 samples")));
}

TEST(KinarmExam, SurvivesMembersCutAnywhere) {
  const auto members = small_exam({}, 1, 40).members();
  for (std::size_t k = 0; k < members.size(); ++k) {
    for (std::size_t size = 0; size < members[k].second.size(); size += 1 + size / 8) {
      auto cut = members;
      cut[k].second.resize(size);
      const auto exam = KinarmExam::open(test::buffer_of(test::zip_of(cut)));
      if (!exam) {
        EXPECT_FALSE(exam.error().message.empty());
        continue;
      }
      const auto contents = exam->decode({});
      if (!contents) {
        EXPECT_FALSE(contents.error().message.empty());
      } else {
        EXPECT_LE(contents->arrays.size(), 24U);
      }
    }
  }
}

TEST(KinarmExam, VideoFramesAreSummedUp) {
  ExamOfTest exam = small_exam();
  exam.trials.front().video =
      test::raw(std::int32_t{1}) + test::raw(std::int32_t{1}) + test::raw(0.5F) + test::raw(0.5156250F);
  EXPECT_THAT(notes(decoded(exam.bytes())), AllOf(HasSubstr("1 video frame"), HasSubstr("15.6 ms")));
}

}  // namespace
}  // namespace mbk::recording
