#include "mbk/files/recording/joint_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/write.h"

namespace mbk::recording {
namespace joint_names_test {

using testing::Contains;
using testing::HasSubstr;

using Names = std::vector<std::string>;

/// As a topic of JointStates: position and effort of joint k are k and −k throughout.
Contents topic(const Names& joints, const std::string& name = "/js") {
  Contents contents;
  contents.format = "MCAP";
  const auto clock = static_cast<int>(contents.clocks.size());
  contents.clocks.push_back({name, Vector::LinSpaced(5, 0.0, 0.004)});
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const std::string number = std::to_string(k + 1);
      Array array{.name = name + (sign > 0 ? ".position." : ".effort.") + joints[k],
                  .values = SharedMatrix::of_column(Vector::Constant(5, sign * static_cast<double>(k + 1)))};
      array.signal = true;
      array.clock = clock;
      array.means = (sign > 0 ? "joint_" : "torque_") + number;
      array.joint = joints[k];
      contents.arrays.push_back(std::move(array));
    }
  }
  return contents;
}

Contents both(Contents one, Contents other) {
  for (Array& array : other.arrays) {
    array.clock = 1;
    one.arrays.push_back(std::move(array));
  }
  one.clocks.push_back(other.clocks.front());
  return one;
}

double value(const Recording& recording, std::string_view channel) {
  const Channel* const found = recording.find(channel);
  return found == nullptr ? 0.0 : found->values[0];
}

ReadOptions of_robot(const Names& joints, const std::string& map = "") {
  ReadOptions options;
  options.joints = joints;
  if (!map.empty()) options.channels = parse_channel_map(map).value();
  return options;
}

std::string error_of(Contents contents, const ReadOptions& options) {
  const auto recording = assemble(std::move(contents), options);
  return recording ? "" : recording.error().line();
}

TEST(JointNames, WithoutARobotTheOrderIsThatOfTheFile) {
  const auto read = assemble(topic({"elbow", "shoulder"}), {});
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(value(*read, "joint_1"), 1.0);
  EXPECT_EQ(read->find("joint_1")->origin.joint, "elbow");
  EXPECT_EQ(read->find("joint_1")->unit, "");  // it may slide
}

TEST(JointNames, JointsOfARobotAreFoundByName) {
  const auto read = assemble(topic({"elbow", "finger", "shoulder"}), of_robot({"shoulder", "elbow"}));
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(value(*read, "joint_1"), 3.0);
  EXPECT_EQ(value(*read, "joint_2"), 1.0);
  EXPECT_EQ(value(*read, "torque_1"), -3.0);
  EXPECT_EQ(read->find("torque_1")->origin.joint, "shoulder");
  EXPECT_EQ(read->find("joint_3"), nullptr);
  EXPECT_THAT(read->notes, Contains(AllOf(HasSubstr("1 shoulder"), HasSubstr("2 elbow"))));
}

TEST(JointNames, ARobotMayHaveTheLastOfMany) {
  Names joints;
  for (int k = 1; k <= 14; ++k) joints.push_back("arm_" + std::to_string(k));
  const auto read = assemble(topic(joints), of_robot({"arm_13", "arm_1"}));
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(value(*read, "joint_1"), 13.0);
  EXPECT_EQ(value(*read, "torque_2"), -1.0);
}

TEST(JointNames, AJointThatIsNotThereIsAnErrorWithBothLists) {
  const std::string error = error_of(topic({"elbow", "lift"}), of_robot({"shoulder", "elbow"}));
  EXPECT_THAT(error, AllOf(HasSubstr("elbow, lift"), HasSubstr("shoulder, elbow")));
  EXPECT_THAT(error, HasSubstr("--channels q1=/js.position.elbow,tau1=/js.effort.elbow"));
}

TEST(JointNames, AJointOfTwoTopicsIsThatOfTheNamedClock) {
  const Contents two = both(topic({"elbow", "shoulder"}), topic({"shoulder", "elbow"}, "/fast"));
  EXPECT_THAT(
      error_of(two, of_robot({"shoulder", "elbow"})),
      AllOf(HasSubstr("'shoulder'"), HasSubstr("'/js.position.shoulder'"), HasSubstr("'/fast.position.shoulder'")));
  ReadOptions options = of_robot({"shoulder", "elbow"});
  options.clock = "/fast";
  const auto read = assemble(two, options);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(read->find("joint_1")->origin.source, "/fast.position.shoulder");
  EXPECT_EQ(value(*read, "joint_1"), 1.0);
}

TEST(JointNames, AMapThatContradictsNamesIsRefused) {
  const std::string swapped = "q1=/js.position.elbow,q2=/js.position.shoulder";
  EXPECT_THAT(error_of(topic({"elbow", "shoulder"}), of_robot({"shoulder", "elbow"}, swapped)),
              AllOf(HasSubstr("joint_1"), HasSubstr("'/js.position.elbow'"), HasSubstr("'elbow'"), HasSubstr("2nd")));
  Contents table;
  table.format = "CSV";
  table.table = true;
  for (const char* name : {"time", "tau_elbow_joint", "q [rad]"}) {
    table.arrays.push_back({.name = name, .values = SharedMatrix::of_column(Vector::LinSpaced(5, 0.0, 1.0))});
  }
  const Names joints = {"shoulder_joint", "elbow_joint"};
  EXPECT_THAT(error_of(table, of_robot(joints, "tau1=tau_elbow_joint")),
              AllOf(HasSubstr("'tau_elbow_joint'"), HasSubstr("2nd")));
  EXPECT_EQ(error_of(table, of_robot(joints, "tau2=tau_elbow_joint,q1=3")), "");
}

TEST(JointNames, AMapSaysWhichJointANameOfAnotherKindIs) {
  const auto read = assemble(topic({"elbow", "lift"}), of_robot({"shoulder", "elbow"}, "q1=/js.position.lift"));
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(value(*read, "joint_1"), 2.0);
  EXPECT_EQ(read->find("joint_1")->origin.joint, "shoulder");
}

TEST(JointNames, ANameWithinAnotherNameIsNotMeant) {
  const ChannelKind& first = *kinds_called("q1").front();
  const Names joints = {"left_elbow", "elbow", "joint_1", "joint_10"};
  EXPECT_TRUE(check_joint(first, joints, "pos_left_elbow", ""));
  EXPECT_FALSE(check_joint(first, joints, "pos_elbow", ""));
  EXPECT_FALSE(check_joint(first, joints, "joint_10", ""));
  EXPECT_TRUE(check_joint(first, joints, "elbow_and_joint_1", ""));  // names two
  EXPECT_TRUE(check_joint(first, joints, "elbows", ""));
}

TEST(JointNames, AColumnOfAChannelsNameThatIsAnotherJointIsRefused) {
  Contents table;
  table.format = "CSV";
  table.table = true;
  for (const char* name : {"time", "joint_1", "joint_2"}) {
    table.arrays.push_back({.name = name, .values = SharedMatrix::of_column(Vector::LinSpaced(5, 0.0, 1.0))});
  }
  // The chain begins behind joint_1 of the arm.
  EXPECT_THAT(error_of(table, of_robot({"joint_2", "joint_3"})), AllOf(HasSubstr("'joint_2'"), HasSubstr("1st")));
  EXPECT_EQ(error_of(table, of_robot({"joint_1", "joint_2"})), "");
  EXPECT_EQ(error_of(table, of_robot({"shoulder", "elbow"})), "");
}

TEST(JointNames, GoThroughEveryFormat) {
  const test::Folder folder;
  Recording one;
  one.time = Vector::LinSpaced(50, 0.0, 0.49);
  for (const char* name : {"joint_1", "joint_2", "torque_1", "torque_2"}) {
    Channel channel{name, "", "joint", one.time};
    channel.origin.joint = std::string(name).ends_with("1") ? "elbow" : "shoulder";
    one.channels.push_back(std::move(channel));
  }
  one.channels[1].unit = "m";
  one.channels[3].unit = "N.m";
  for (const char* const name : {"a.h5", "a.csv", "a.mat"}) {
    const auto path = folder / name;
    const auto ok = write(one, path, format_of(path).value(), true);
    ASSERT_TRUE(ok) << ok.error().line();
    const auto read = recording::read(path, {});
    ASSERT_TRUE(read) << name << read.error().line();
    EXPECT_EQ(read->metadata.size(), 0U) << name;
    for (const Channel& channel : one.channels) {
      const Channel* const back = read->find(channel.name);
      ASSERT_NE(back, nullptr) << name << channel.name;
      EXPECT_EQ(back->origin.joint, channel.origin.joint) << name;
      EXPECT_EQ(back->unit, channel.unit) << name << channel.name;
    }
  }
}

}  // namespace joint_names_test
}  // namespace mbk::recording
