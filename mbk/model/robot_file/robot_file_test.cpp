#include "mbk/model/robot_file/robot_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/robot/serial_chain.h"
#include "mbk/model/robot/test_chains.h"

namespace mbk::robot_file {
namespace {

using robot::RobotDescription;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::filesystem::path kExamples = MBK_EXAMPLE_ROBOTS;
constexpr double kRounding = 1e-12;

RobotDescription parsed(const std::string& toml, const std::string& urdf = "") {
  auto description = parse_robot_description(toml, urdf, "x.toml");
  EXPECT_TRUE(description) << description.error().line();
  return description.value();
}

std::string refusal(const std::string& toml, const std::string& urdf = "") {
  const auto description = parse_robot_description(toml, urdf, "x.toml");
  if (description) return "nothing was refused";
  EXPECT_EQ(description.error().kind, ErrorKind::data);
  return description.error().line();
}

double value(const RobotDescription& robot, const std::string& name) {
  const auto coefficients = robot.model.coefficients();
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    if (coefficients[k].name == name) return robot.model.parameters[static_cast<Index>(k)];
  }
  ADD_FAILURE() << "no " << name;
  return 0.0;
}

TEST(ThesisRobot, HasTheCoefficientsOfItsTable) {
  const RobotDescription thesis = thesis_robot();
  EXPECT_EQ(value(thesis, "alpha1"), 0.06929);
  EXPECT_EQ(value(thesis, "viscous_2"), 0.07389);
  EXPECT_THAT(thesis.unstated, ElementsAre("coulomb_1", "offset_1", "coulomb_2", "offset_2"));
}

TEST(ThesisRobot, IsTheExampleFile) {
  const auto file = read_robot_description(kExamples / "thesis.toml");
  ASSERT_TRUE(file) << file.error().line();
  const RobotDescription thesis = thesis_robot();
  EXPECT_LE((file->model.parameters - thesis.model.parameters).norm(), 0.0);
  EXPECT_EQ(file->model.drive.smoothing, thesis.model.drive.smoothing);
  EXPECT_EQ(file->unstated, thesis.unstated);
  const robot::JointVector q = Eigen::Vector2d(0.3, 0.9);
  EXPECT_LE((file->model.mechanism->hand_position(q) - thesis.model.mechanism->hand_position(q)).norm(), 0.0);
  for (int joint = 0; joint < 2; ++joint) {
    EXPECT_NEAR(file->model.mechanism->joint_range(joint).low, thesis.model.mechanism->joint_range(joint).low,
                kRounding);
    EXPECT_NEAR(file->model.mechanism->joint_range(joint).high, thesis.model.mechanism->joint_range(joint).high,
                kRounding);
  }
}

TEST(ExampleRobots, AreAllRead) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kExamples)) {
    const auto description = read_robot_description(entry.path());
    ASSERT_TRUE(description) << description.error().line();
    EXPECT_EQ(description->model.parameters.size(), std::ssize(description->model.coefficients()));
    EXPECT_TRUE(description->model.parameters.allFinite());
    ++count;
  }
  EXPECT_GE(count, 4);
}

TEST(DoublePendulum, HasTheInertiaGravityAndHandOfItsPublishedModel) {
  const auto pendulum = read_robot_description(kExamples / "double_pendulum.toml");
  ASSERT_TRUE(pendulum) << pendulum.error().line();
  // DFKI's double pendulum, design C.1, model 1.0
  const double m1 = 0.5234602302310271, r1 = 0.2, I1 = 0.031887199591513114, l1 = 0.2, m2 = 0.6255677234174437,
               r2 = 0.25569305436052964, I2 = 0.05086984812807257, l2 = 0.3, g = 9.81;
  const robot::JointVector q = Eigen::Vector2d(0.4, -1.1), still = Eigen::Vector2d::Zero();
  const auto& mechanism = *pendulum->model.mechanism;
  const auto terms = mechanism.terms(q, still, pendulum->model.parameters.head(std::ssize(mechanism.coefficients())));
  const double coupling = l1 * m2 * r2 * std::cos(q[1]);
  Eigen::Matrix2d M;
  M << I1 + I2 + m2 * l1 * l1 + 2.0 * coupling, I2 + coupling, I2 + coupling, I2;
  EXPECT_LE((terms.inertia - M).norm(), 1e-11);  // the file holds twelve decimals
  const double lower = m2 * g * r2 * std::sin(q[0] + q[1]);
  const Eigen::Vector2d weight((m1 * r1 + m2 * l1) * g * std::sin(q[0]) + lower, lower);
  EXPECT_LE((terms.gravity - weight).norm(), kRounding);
  const Eigen::Vector2d hand(l1 * std::sin(q[0]) + l2 * std::sin(q[0] + q[1]),
                             -l1 * std::cos(q[0]) - l2 * std::cos(q[0] + q[1]));
  EXPECT_LE((mechanism.hand_position(q) - hand).norm(), kRounding);
  EXPECT_EQ(value(*pendulum, "coulomb_1"), 0.16);  // the URDF's <dynamics>
  EXPECT_EQ(value(*pendulum, "viscous_2"), 0.001);
  EXPECT_EQ(value(*pendulum, "motor_inertia_2"), 0.0022634);
  EXPECT_THAT(pendulum->unstated, ElementsAre("offset_1", "offset_2"));
}

TEST(RobotDescription, IsMadeAnewFromItsTexts) {
  for (const char* name : {"thesis.toml", "emps.toml", "double_pendulum.toml", "double_pendulum.urdf"}) {
    const auto first = read_robot_description(kExamples / name);
    ASSERT_TRUE(first) << first.error().line();
    const auto again = parse_robot_description(first->toml, first->urdf, "result.json");
    ASSERT_TRUE(again) << again.error().line();
    EXPECT_EQ(again->model.parameters, first->model.parameters) << name;
    const robot::JointVector q = robot::JointVector::Constant(first->model.mechanism->joints(), 0.3);
    EXPECT_EQ(again->model.mechanism->hand_position(q), first->model.mechanism->hand_position(q)) << name;
  }
}

TEST(Planar, MayStandUpright) {
  const RobotDescription robot = parsed("[robot]\nkind = 'planar'\nup_deg = 90\ngravity_Nm = [1.5, 0.5]\n");
  EXPECT_EQ(value(robot, "gravity_1"), 1.5);
  EXPECT_THAT(robot.unstated, Not(Contains("gravity_1")));
  EXPECT_THAT(parsed("[robot]\nkind = 'planar'\nup_deg = 90\n").unstated, Contains("gravity_2"));
  const auto& options = dynamic_cast<const robot::PlanarMechanism&>(*robot.model.mechanism).options();
  EXPECT_DOUBLE_EQ(options.up.value(), 0.5 * std::numbers::pi);
  EXPECT_THAT(refusal("[robot]\nkind = 'planar'\ngravity_Nm = [1, 1]\n"), HasSubstr("robot.gravity_Nm"));
}

TEST(Planar, TakesTheFrictionThatAScenarioWouldHave) {
  const RobotDescription robot = parsed(
      "[robot]\nkind = 'planar'\ncoulomb_Nm = [0.2, 0.3]\nbreakaway_Nm = [0.5, 0.1]\n"
      "stribeck_velocity_rad_per_s = [0.1, 0.1]\nsmoothing_rad_per_s = [0.01, 0.01]\n"
      "[drive]\nterms = ['viscous', 'coulomb', 'stribeck']\n");
  robot::JointFriction friction{
      .viscous = 0.06510, .coulomb = 0.2, .breakaway = 0.5, .stribeck_velocity = 0.1, .smoothing = 0.01};
  const robot::JointVector still = Eigen::Vector2d::Zero();
  for (const double velocity : {-0.3, -0.02, 0.005, 0.1, 2.0}) {
    const robot::JointVector torque = robot.model.drive_torque(still, Eigen::Vector2d(velocity, 0.0), still);
    EXPECT_NEAR(torque[0], friction.torque(velocity), kRounding);
  }
  EXPECT_EQ(value(robot, "stribeck_2"), 0.0);  // breakaway below Coulomb: no Stribeck effect
  EXPECT_THAT(robot.unstated, IsEmpty());
}

TEST(Planar, RefusesFrictionThatNoTermTakes) {
  EXPECT_THAT(refusal("[robot]\nkind = 'planar'\nbreakaway_Nm = [0.5, 0.5]\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("robot.breakaway_Nm"), HasSubstr("\"stribeck\"")));
  EXPECT_THAT(refusal("[robot]\nkind = 'planar'\nsmoothing_rad_per_s = [0.5, 0.4]\n"),
              HasSubstr("robot.smoothing_rad_per_s"));
  EXPECT_THAT(refusal("[robot]\nkind = 'planar'\ntheta1_deg = [40, -40]\n"), HasSubstr("robot.theta1_deg"));
  for (const char* limits : {"smallest_opening_deg = 200", "theta2_deg = [170, 180]", "theta1_deg = [-100, -90]"}) {
    EXPECT_THAT(refusal(std::string("[robot]\nkind = 'planar'\n") + limits), HasSubstr("robot.smallest_opening_deg"));
  }
}

TEST(OneAxis, TurnsOrSlides) {
  const RobotDescription slides = parsed(
      "[robot]\nkind = 'one_axis'\nslides = true\nmass_kg = 95\nlimits_mm = [-350, 350]\n"
      "[drive]\nviscous_Ns_per_m = [203]\ncoulomb_N = [20]\noffset_N = [-3]\nsmoothing_m_per_s = 0\n");
  EXPECT_EQ(value(slides, "mass"), 95.0);
  EXPECT_EQ(value(slides, "offset_1"), -3.0);
  EXPECT_EQ(slides.model.drive.smoothing, 0.0);
  EXPECT_DOUBLE_EQ(slides.model.mechanism->joint_range(0).low, -0.35);
  EXPECT_THAT(slides.unstated, IsEmpty());
  const RobotDescription turns = parsed(
      "[robot]\nkind = 'one_axis'\nslides = false\nlimits_deg = [-90, 90]\n[drive]\nviscous_Nms_per_rad = [0.5]\n");
  EXPECT_EQ(value(turns, "viscous_1"), 0.5);
  EXPECT_THAT(turns.unstated, ElementsAre("inertia", "coulomb_1", "offset_1"));
  EXPECT_THAT(refusal("[robot]\nkind = 'one_axis'\n"), HasSubstr("robot.slides"));
  EXPECT_THAT(refusal("[robot]\nkind = 'one_axis'\nslides = true\n[drive]\nviscous_Nms_per_rad = [1]\n"),
              HasSubstr("viscous_Ns_per_m"));
}

TEST(Urdf, TakesLinksGravityHandAndTool) {
  const robot::RandomChain random("RPR", 5);
  const RobotDescription robot = parsed(
      "[robot]\nkind = 'urdf'\nfile = 'arm.urdf'\nbase_link = 'link_1'\ntip_link = 'link_3'\n"
      "gravity_m_per_s2 = [0, 9.81, 0]\nhand_axes = ['z']\ntool_mm = [0, 0, 100]\n"
      "zero_deg = [90]\nzero_mm = [20]\nsigns = [-1, 1]\n",
      random.urdf());
  robot::SerialChain::Options options;
  options.base_link = "link_1";
  options.gravity = {0.0, 9.81, 0.0};
  options.hand_axes = {robot::SerialChain::Axis::z};
  options.tool = {0.0, 0.0, 0.1};
  options.zero = {0.02, 0.5 * std::numbers::pi};
  options.sign = {-1, 1};
  const auto chain = robot::SerialChain::from_urdf(random.urdf(), options).value();
  const robot::JointVector q = Eigen::Vector2d(0.1, 0.4), still = Eigen::Vector2d::Zero();
  const Vector& phi = chain->stated_coefficients();
  EXPECT_LE((robot.model.mechanism->hand_position(q) - chain->hand_position(q)).norm(), kRounding);
  EXPECT_LE((robot.model.mechanism->terms(q, still, phi).gravity - chain->terms(q, still, phi).gravity).norm(),
            kRounding);
}

TEST(Urdf, TakesValuesOfTurningAndSlidingJointsApart) {
  const robot::RandomChain random("RPR", 5);
  const RobotDescription robot = parsed(
      "[robot]\nkind = 'urdf'\nfile = 'arm.urdf'\n"
      "[drive]\nterms = ['coulomb', 'cable']\ncoulomb_Nm = [1, 3]\ncoulomb_N = [2]\ncable_N_per_m = [7]\n"
      "motor_delay_ms = 0.8\n",
      random.urdf());
  EXPECT_EQ(value(robot, "coulomb_1"), 1.0);
  EXPECT_EQ(value(robot, "coulomb_2"), 2.0);
  EXPECT_EQ(value(robot, "coulomb_3"), 3.0);
  EXPECT_EQ(value(robot, "cable_2"), 7.0);
  EXPECT_EQ(robot.model.delay, 0.8e-3);
  EXPECT_THAT(robot.unstated, ElementsAre("cable_1", "cable_3"));
}

TEST(Urdf, SaysInWhichFileWhatIsWrong) {
  const std::string urdf = robot::RandomChain("RPR", 5).urdf(), start = "[robot]\nkind = 'urdf'\nfile = 'arm.urdf'\n";
  EXPECT_THAT(refusal(start, "<robot"), AllOf(HasSubstr("x.toml"), HasSubstr("arm.urdf")));
  EXPECT_THAT(refusal(start + "tip_link = 'hand'\n", urdf), HasSubstr("'hand'"));
  EXPECT_THAT(refusal(start + "hand_axes = ['x', 'q']\n", urdf),
              AllOf(HasSubstr("line 4"), HasSubstr("robot.hand_axes"), HasSubstr("'q'")));
  EXPECT_THAT(refusal(start + "hand_axes = []\n", urdf), HasSubstr("robot.hand_axes"));
  EXPECT_THAT(refusal(start + "signs = [1, 2, 1]\n", urdf), AllOf(HasSubstr("robot.signs"), HasSubstr("-1")));
  EXPECT_THAT(refusal(start + "signs = [1, 1]\n", urdf), AllOf(HasSubstr("robot.signs"), HasSubstr("number")));
  EXPECT_THAT(refusal(start + "zero_deg = [1, 2, 3]\n", urdf), HasSubstr("robot.zero_deg"));
  EXPECT_THAT(refusal(start + "tip = 'hand'\n", urdf), AllOf(HasSubstr("'tip'"), HasSubstr("[robot]")));
  EXPECT_THAT(refusal(start + "[drive]\nstribeck_Nm = [1, 1]\n", urdf),
              AllOf(HasSubstr("drive.stribeck_Nm"), HasSubstr("\"stribeck\"")));
  EXPECT_THAT(refusal("[robot]\nkind = 'urdf'\n", urdf), HasSubstr("robot.file"));
  EXPECT_THAT(refusal("[robot]\nkind = 'delta'\n"), HasSubstr("planar, one_axis, urdf"));
  EXPECT_THAT(refusal(""), HasSubstr("kind"));
}

TEST(ReadRobotDescription, SaysWhichFileCannotBeRead) {
  const auto none = read_robot_description("no_such_robot.toml");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().line(), HasSubstr("no_such_robot.toml"));
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "lonely.toml";
  std::ofstream(file) << "[robot]\nkind = 'urdf'\nfile = 'gone.urdf'\n";
  const auto gone = read_robot_description(file);
  ASSERT_FALSE(gone);
  EXPECT_THAT(gone.error().line(), HasSubstr("gone.urdf"));
  EXPECT_FALSE(read_robot_description(::testing::TempDir()));
}

}  // namespace
}  // namespace mbk::robot_file
