#include "mbk/files/ros/mcap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/ros/bag.h"
#include "mbk/files/ros/test_ros.h"

namespace mbk::recording {
namespace {

namespace bag = test::bag;
namespace mcap = test::mcap;
using test::kLineOfTypes;
using test::Message;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

Result<Contents> decoded(std::string_view file) {
  const auto bytes = std::as_bytes(std::span(file));
  return looks_like_bag(bytes) ? decode_bag(bytes) : decode_mcap(bytes);
}

std::string error_of(std::string_view file) {
  const auto contents = decoded(file);
  return contents ? std::string() : contents.error().line();
}

const Array* find(const Contents& contents, std::string_view name) {
  const auto found = std::ranges::find(contents.arrays, name, &Array::name);
  return found == contents.arrays.end() ? nullptr : &*found;
}

std::vector<double> numbers(const Contents& contents, std::string_view name) {
  const Array* const array = find(contents, name);
  if (array == nullptr) return {};
  const auto values = array->values.reshaped();
  return {values.begin(), values.end()};
}

const Vector& time_of(const Contents& contents, std::string_view name) {
  return std::ranges::find(contents.clocks, name, &Clock::name)->time;
}

/// One topic of one type, with these messages, 1 ms after each other.
std::string one_topic(std::string_view type, std::string_view definition, const std::vector<Message>& messages) {
  std::string records = mcap::schema(1, type, definition) + mcap::channel(1, 1, "/topic");
  std::uint64_t time = 2'000'000'000;
  for (const Message& message : messages) records += mcap::message(1, time += 1'000'000, message.bytes());
  return mcap::file(records);
}

void expect_wrench(const Contents& contents) {
  ASSERT_EQ(contents.clocks.size(), 1U);
  const Vector& time = time_of(contents, "/ft");
  ASSERT_EQ(time.size(), 20);
  EXPECT_EQ(time[0], 0.0);
  EXPECT_EQ(time[19], 0.019);
  const Array* const x = find(contents, "/ft.wrench.force.x");
  ASSERT_NE(x, nullptr);
  EXPECT_EQ(x->means, "force_x");
  EXPECT_EQ(x->unit, "N");
  EXPECT_EQ(x->clock, 0);
  EXPECT_EQ(x->values(19, 0), 19.0);
  EXPECT_EQ(numbers(contents, "/ft.wrench.force.y")[19], -9.5);
  EXPECT_EQ(find(contents, "/ft.wrench.torque.x")->means, "/ft.wrench.torque.x");  // no channel by its last letter
  EXPECT_EQ(contents.metadata.at("start"), "2023-11-14T22:13:20.000000000Z");
  EXPECT_THAT(contents.notes, Contains(HasSubstr("'tool0'")));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("20 messages"), HasSubstr("1000 Hz"))));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("header.stamp"), HasSubstr("'/ft'"))));
}

class EveryPacking : public testing::TestWithParam<const char*> {};

TEST_P(EveryPacking, OfMcapIsRead) {
  const auto contents = decoded(test::wrench_file(GetParam()));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->format, "MCAP");
  expect_wrench(*contents);
}
INSTANTIATE_TEST_SUITE_P(Mcap, EveryPacking, testing::Values("", "zstd", "lz4"));

class EveryPackingOfBags : public testing::TestWithParam<const char*> {};

TEST_P(EveryPackingOfBags, IsRead) {
  const auto contents = decoded(test::wrench_bag(GetParam()));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->format, "ROS 1 bag");
  expect_wrench(*contents);
  EXPECT_EQ(numbers(*contents, "/ft.header.seq")[3], 7.0);
}
INSTANTIATE_TEST_SUITE_P(Bag, EveryPackingOfBags, testing::Values("none", "bz2", "lz4"));

TEST(Mcap, IsTheSameInPassing) {
  const test::Folder folder;
  // More than a piece of what is read at a time, most of it what is not kept.
  std::string records =
      mcap::schema(1, "geometry_msgs/msg/WrenchStamped", test::kWrench2) + mcap::channel(1, 1, "/ft") +
      mcap::schema(2, "lab/msg/Picture", "uint32 width\nuint8[] data\n") + mcap::channel(2, 2, "/camera");
  const std::string picture = Message::cdr().add(std::uint32_t{640}).text(std::string(1'000'000, 'p')).bytes();
  for (int k = 0; k < 20; ++k) {
    const auto nanoseconds = static_cast<std::uint32_t>(k * 1'000'000);
    records +=
        mcap::message(1, nanoseconds, test::wrench(Message::cdr(), 1'700'000'000, nanoseconds, k, -k / 2.0).bytes());
    records += mcap::message(2, 1'700'000'000'000'000'000U + nanoseconds, picture);
  }
  for (const std::string_view packing : {"", "lz4"}) {
    const auto path = folder.write("big.mcap", mcap::file(mcap::chunk(records, packing, mcap::crc(records))));
    auto whole = OpenFile::open(path).value();
    auto file = whole.in_passing();
    ASSERT_TRUE(file && file->read_on());
    const auto contents = decode_mcap(*file);
    ASSERT_TRUE(contents) << contents.error().line();
    EXPECT_EQ(numbers(*contents, "/ft.wrench.force.x")[19], 19.0);
    EXPECT_EQ(numbers(*contents, "/camera.width")[19], 640.0);
    EXPECT_THAT(contents->notes, Contains(HasSubstr("/camera.data")));
    const std::string bytes = test::bytes_of(path);
    EXPECT_EQ(whole.sha256(), sha256(std::as_bytes(std::span(bytes))));
  }
}

TEST(Mcap, EveryTypeOfNumberInBothByteOrders) {
  const std::string definition =
      "bool a\nint8 b\nuint8 c\nint16 d\nuint16 e\nint32 f\nuint32 g\nint64 h\nuint64 i\nfloat32 j\nfloat64 k\n"
      "builtin_interfaces/Duration l\nstring m\nfloat64[2] n\nuint8[] o\n";
  for (const bool big_endian : {false, true}) {
    Message message = Message::cdr(big_endian);
    message.add(std::uint8_t{1}).add(std::int8_t{-2}).add(std::uint8_t{200}).add(std::int16_t{-300});
    message.add(std::uint16_t{60000}).add(std::int32_t{-70000}).add(std::uint32_t{4000000000});
    message.add(std::int64_t{-5000000000}).add(std::uint64_t{5000000001}).add(1.5F).add(-2.25);
    message.add(std::int32_t{-1}).add(std::uint32_t{250000000}).text("abc").add(7.0).add(8.0).text("x");
    const auto contents = decoded(one_topic("lab/msg/All", definition, {message, message}));
    ASSERT_TRUE(contents) << contents.error().line();
    const std::vector<std::pair<std::string, double>> expected = {
        {"a", 1},      {"b", -2},    {"c", 200},    {"d", -300},   {"e", 60000},
        {"f", -70000}, {"g", 4e9},   {"h", -5e9},   {"j", 1.5},    {"i", 5000000001.0},
        {"k", -2.25},  {"l", -0.75}, {"n[0]", 7.0}, {"n[1]", 8.0}, {"o[0]", 'x'}};
    for (const auto& [name, value] : expected) {
      EXPECT_EQ(numbers(*contents, "/topic." + name), (std::vector<double>{value, value})) << name;
    }
  }
}

Message state(const std::vector<std::string>& names, const std::vector<double>& position,
              const std::vector<double>& effort = {}) {
  Message message = Message::cdr();
  message.header(100, 0, "").add(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) message.text(name);
  const auto sequence = [&](const std::vector<double>& values) {
    message.add(static_cast<std::uint32_t>(values.size()));
    for (const double value : values) message.add(value);
  };
  sequence(position);
  sequence({});
  sequence(effort);
  return message;
}

Result<Contents> joint_states(const std::vector<Message>& messages) {
  return decoded(one_topic("sensor_msgs/msg/JointState", test::kJoints2, messages));
}

TEST(Mcap, JointsGoByTheirNamesInWhateverOrder) {
  const auto contents = joint_states(
      {state({"shoulder", "elbow"}, {1, 2}), state({"gripper"}, {9}), state({"elbow", "shoulder"}, {4, 3})});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(numbers(*contents, "/topic.position.shoulder"), (std::vector<double>{1, 3}));
  EXPECT_EQ(numbers(*contents, "/topic.position.elbow"), (std::vector<double>{2, 4}));
  EXPECT_EQ(find(*contents, "/topic.position.elbow")->means, "joint_2");
  EXPECT_EQ(find(*contents, "/topic.position.elbow")->joint, "elbow");
  EXPECT_EQ(numbers(*contents, "/topic/2.position.gripper"), (std::vector<double>{9}));
  EXPECT_EQ(find(*contents, "/topic/2.position.gripper")->joint, "gripper");
  EXPECT_THAT(contents->notes, Contains(HasSubstr("1 shoulder, 2 elbow")));
  EXPECT_THAT(contents->notes, Not(Contains(HasSubstr("'/topic.effort'"))));
}

TEST(Mcap, JointsWithoutNamesAreCounted) {
  for (const std::vector<std::string>& names : {std::vector<std::string>{}, {"", ""}}) {
    const auto contents = joint_states({state(names, {1, 2}, {3, 4})});
    ASSERT_TRUE(contents) << contents.error().line();
    EXPECT_EQ(find(*contents, "/topic.effort[1]")->means, "torque_2");
    EXPECT_EQ(find(*contents, "/topic.effort[1]")->joint, "");
    EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/topic'"), HasSubstr("joint"))));
  }
}

TEST(Mcap, JointsOfOneNameAreNoChannels) {
  const auto contents = joint_states({state({"elbow", "elbow"}, {1, 2})});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(find(*contents, "/topic.position[0]")->means, "/topic.position[0]");
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/topic'"), HasSubstr("joint_1"), HasSubstr("torque_1"))));
}

TEST(Mcap, EffortsThatAreNotAsManyAsJointsAreNobodys) {
  const auto contents = joint_states({state({"shoulder", "elbow"}, {1, 2}, {3})});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(find(*contents, "/topic.position.elbow")->means, "joint_2");
  EXPECT_EQ(find(*contents, "/topic.effort[0]")->means, "/topic.effort[0]");
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/topic.effort'"), HasSubstr("torque_1"))));
}

TEST(Mcap, EffortsThatNotEveryMessageHasAreSaid) {
  const auto contents =
      joint_states({state({"shoulder", "elbow"}, {1, 2}), state({"shoulder", "elbow"}, {1, 2}, {3, 4})});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(find(*contents, "/topic.effort.elbow"), nullptr);
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/topic.effort'"), HasSubstr("torque_1"))));
}

TEST(Mcap, EveryJointOfManyHasItsName) {
  std::vector<std::string> names;
  std::vector<double> position;
  for (int k = 1; k <= 14; ++k) {
    names.push_back("arm_" + std::to_string(k));
    position.push_back(k);
  }
  const auto contents = joint_states({state(names, position)});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(find(*contents, "/topic.position.arm_14")->means, "joint_14");
  EXPECT_EQ(find(*contents, "/topic.position.arm_14")->joint, "arm_14");
}

TEST(Mcap, JointStatesInJsonGoByTheirNamesToo) {
  std::string records =
      mcap::schema(1, "sensor_msgs/msg/JointState", "{}", "jsonschema") + mcap::channel(1, 1, "/js", "json");
  records += mcap::message(1, 5'000'000'000, R"({"name": ["7", "b"], "position": [1, 2], "effort": [3, 4]})");
  records += mcap::message(1, 5'500'000'000, R"({"name": ["b", "7"], "position": [20, 10], "effort": [40, 30]})");
  const auto contents = decoded(mcap::file(records));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(numbers(*contents, "/js.position.7"), (std::vector<double>{1, 10}));
  EXPECT_EQ(numbers(*contents, "/js.effort.b"), (std::vector<double>{4, 40}));
  EXPECT_EQ(find(*contents, "/js.effort.b")->means, "torque_2");
  EXPECT_EQ(find(*contents, "/js.effort.b")->joint, "b");
  EXPECT_EQ(find(*contents, "/js.name[0]"), nullptr);
}

/// /pose in one frame and /ft in others.
Result<Contents> with_frames(std::string_view of_pose, const std::vector<std::string_view>& of_wrench) {
  std::string records = mcap::schema(1, "geometry_msgs/msg/WrenchStamped", test::kWrench2) +
                        mcap::channel(1, 1, "/ft") + mcap::schema(2, "geometry_msgs/msg/PoseStamped", test::kPose2) +
                        mcap::channel(2, 2, "/pose");
  std::uint32_t time = 0;
  for (const std::string_view frame : of_wrench) {
    records += mcap::message(1, 10, test::wrench(Message::cdr(), 100, time += 1000, 1, 2, frame).bytes());
    Message pose = Message::cdr().header(100, time, of_pose);
    for (int rest = 0; rest < 7; ++rest) pose.add(0.5);
    records += mcap::message(2, 10, pose.bytes());
  }
  return decoded(mcap::file(records));
}

TEST(Mcap, AForceInAnotherFrameThanThePositionIsNoChannel) {
  const auto contents = with_frames("base_link", {"tool0", "tool0"});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(find(*contents, "/ft.wrench.force.x")->means, "/ft.wrench.force.x");
  EXPECT_EQ(find(*contents, "/ft.wrench.force.z")->means, "/ft.wrench.force.z");
  EXPECT_EQ(find(*contents, "/pose.pose.position.x")->means, "hand_x");
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/ft'"), HasSubstr("'tool0'"), HasSubstr("'/pose'"),
                                              HasSubstr("'base_link'"))));
  EXPECT_THAT(contents->notes, Contains(HasSubstr("Fx=/ft.wrench.force.x,Fy=/ft.wrench.force.y")));
}

TEST(Mcap, AForceInTheFrameOfThePositionIsAChannel) {
  for (const std::string_view same : {"base_link", "/base_link", ""}) {
    const auto contents = with_frames("base_link", {same, same});
    ASSERT_TRUE(contents) << contents.error().line();
    EXPECT_EQ(find(*contents, "/ft.wrench.force.x")->means, "force_x") << same;
    EXPECT_EQ(find(*contents, "/ft.wrench.force.z")->means, "force_z") << same;
    EXPECT_EQ(find(*contents, "/pose.pose.position.z")->means, "hand_z") << same;
  }
}

TEST(Mcap, AForceThatChangesItsFrameIsNoChannel) {
  const auto contents = with_frames("base_link", {"base_link", "tool0"});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(find(*contents, "/ft.wrench.force.x")->means, "/ft.wrench.force.x");
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/ft'"), HasSubstr("'base_link', 'tool0'"))));
}

TEST(Mcap, PublishersThatTakeTurnsAreNoChannels) {
  const auto from = [](const std::vector<std::uint32_t>& publishers) {
    std::string records = bag::connection(0, "/ft", "geometry_msgs/WrenchStamped", test::kWrench1) +
                          bag::connection(1, "/ft", "geometry_msgs/WrenchStamped", test::kWrench1);
    std::uint32_t time = 0;
    for (const std::uint32_t publisher : publishers) {
      time += 1000;
      records += bag::message(publisher, 100, time, test::wrench(Message::ros1(), 100, time, publisher, 2).bytes());
    }
    return decoded(bag::file(records)).value();
  };
  const Contents turns = from({0, 1, 0, 1});
  EXPECT_EQ(find(turns, "/ft.wrench.force.x")->means, "/ft.wrench.force.x");
  EXPECT_THAT(turns.notes, Contains(AllOf(HasSubstr("'/ft'"), HasSubstr("2 publishers"))));
  EXPECT_EQ(find(from({0, 0, 1, 1}), "/ft.wrench.force.x")->means, "force_x");  // one was started anew
}

TEST(Mcap, AnArrayWhoseLengthChangesIsLeftOutAndSaid) {
  const auto list = [](std::uint32_t count) {
    Message message = Message::cdr().add(count);
    for (std::uint32_t k = 0; k < count; ++k) message.add(1.0 + k);
    return message.add(0.5);
  };
  const auto contents = decoded(one_topic("lab/msg/List", "float64[] values\nfloat64 rest", {list(2), list(3)}));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(numbers(*contents, "/topic.rest"), (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(find(*contents, "/topic.values[0]"), nullptr);
  EXPECT_THAT(contents->notes, Contains(HasSubstr("/topic.values")));
}

TEST(Mcap, JsonIsRead) {
  std::string records = mcap::channel(1, 0, "/js", "json");
  records += mcap::message(1, 5'000'000'000, R"({"force_x": 1.5, "on": true, "deep": {"list": [1, 2]}, "late": 1})");
  records += mcap::message(1, 5'500'000'000, R"({"force_x": null, "on": false, "deep": {"list": [3, 4]}})");
  const auto contents = decoded(mcap::file(records));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(numbers(*contents, "/js.deep.list[1]"), (std::vector<double>{2, 4}));
  EXPECT_EQ(numbers(*contents, "/js.on"), (std::vector<double>{1, 0}));
  EXPECT_EQ(numbers(*contents, "/js.force_x")[0], 1.5);
  EXPECT_TRUE(std::isnan(numbers(*contents, "/js.force_x")[1]));
  EXPECT_EQ(find(*contents, "/js.late"), nullptr);
  EXPECT_EQ(find(*contents, "/js.force_x")->means, "");
  EXPECT_EQ(time_of(*contents, "/js")[1], 0.5);
  EXPECT_FALSE(contents->metadata.contains("start"));  // nobody recorded in 1970
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/js'"), HasSubstr("stamp"))));
}

TEST(Mcap, NumbersThatJsonWritesAsTextAreRead) {
  std::string records = mcap::channel(1, 0, "/js", "json");
  records += mcap::message(1, 5'000'000'000, R"({"force_x": "12.5", "rest": "NaN", "name": "a1", "odd": "3 N"})");
  records += mcap::message(1, 5'500'000'000, R"({"force_x": " +1e1", "rest": "Infinity", "name": "a2", "odd": "4 N"})");
  const auto contents = decoded(mcap::file(records));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(numbers(*contents, "/js.force_x"), (std::vector<double>{12.5, 10}));
  EXPECT_TRUE(std::isnan(numbers(*contents, "/js.rest")[0]));
  EXPECT_EQ(find(*contents, "/js.name"), nullptr);
  EXPECT_THAT(contents->notes, Contains(HasSubstr("/js.force_x, /js.rest")));
  EXPECT_THAT(contents->notes, Contains(HasSubstr("/js.odd")));
}

TEST(Mcap, ChecksumsAreChecked) {
  const std::string records = mcap::schema(1, "lab/msg/A", "float64 a") + mcap::channel(1, 1, "/a");
  EXPECT_THAT(error_of(mcap::file(mcap::chunk(records, "zstd", 1234))),
              AllOf(HasSubstr("chunk"), HasSubstr("checksum")));
  EXPECT_EQ(error_of(mcap::file(mcap::chunk(records, "zstd", 0))), "");

  std::string file = mcap::file(records);
  const std::size_t end = file.find(mcap::record(15, test::raw(std::uint32_t{0})));
  const auto with_sum = [&](std::uint32_t sum) {
    std::string changed = file;
    return changed.replace(end + 9, 4, test::raw(sum));
  };
  EXPECT_EQ(error_of(with_sum(mcap::crc(std::string_view(file).substr(0, end)))), "");
  EXPECT_THAT(error_of(with_sum(1234)), AllOf(HasSubstr("data"), HasSubstr("checksum")));
}

TEST(Mcap, WhatWasCutShortIsReadAsFarAsItGoes) {
  for (const std::string& whole :
       {one_topic("lab/msg/A", "float64 a", {Message::cdr().add(1.0), Message::cdr().add(2.0)}),
        test::wrench_bag("none") + test::wrench_bag("none").substr(13)}) {
    const auto contents = decoded(whole.substr(0, whole.size() - (whole.starts_with("#") ? 300 : 60)));
    ASSERT_TRUE(contents) << contents.error().line();
    EXPECT_FALSE(contents->arrays.empty());
    EXPECT_THAT(contents->notes, Contains(HasSubstr("byte")));
  }
}

TEST(Mcap, DamageIsAnErrorThatSaysWhatToDo) {
  const std::string whole = test::wrench_file("zstd");
  std::string damaged = whole;
  for (std::size_t k = whole.find("zstd") + 20; k < whole.find("zstd") + 60; ++k) damaged[k] ^= 0x55;
  EXPECT_THAT(error_of(damaged), HasSubstr("chunk"));
  const std::string records = mcap::channel(1, 0, "/a", "json");
  EXPECT_THAT(error_of(mcap::file(mcap::chunk(records + "abc", "lz4", 0))), HasSubstr("chunk"));
  EXPECT_THAT(error_of(mcap::file(mcap::chunk(records, "brotli", 0))), HasSubstr("'brotli'"));
  EXPECT_THAT(error_of("#ROSBAG V1.2\nold"), HasSubstr("rosbag fix"));
}

TEST(Mcap, ATopicThatCannotBeReadIsSaid) {
  std::string records = mcap::schema(1, "lab/msg/A", "float64 a") + mcap::channel(1, 1, "/short") +
                        mcap::schema(2, "lab.A", "x", "protobuf") + mcap::channel(2, 2, "/other", "protobuf") +
                        mcap::schema(3, "lab/msg/W", "wstring a") + mcap::channel(3, 3, "/wide") +
                        mcap::schema(4, "lab/msg/B", "Nowhere a") + mcap::channel(4, 4, "/odd");
  for (std::uint16_t id = 1; id <= 4; ++id) records += mcap::message(id, 10, Message::cdr().add(1.0F).bytes());
  const auto contents = decoded(mcap::file(records));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_TRUE(contents->arrays.empty());
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/short'"), HasSubstr("message 1"))));
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/other'"), HasSubstr("'protobuf'"))));
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/wide'"), HasSubstr("strings"))));
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/odd'"), HasSubstr("lab/msg/B"))));
}

TEST(Mcap, StampsThatNobodySetAreNoTimes) {
  const auto contents =
      decoded(one_topic("geometry_msgs/msg/WrenchStamped", test::kWrench2,
                        {test::wrench(Message::cdr(), 0, 0, 1, 2), test::wrench(Message::cdr(), 0, 0, 1, 2)}));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(time_of(*contents, "/topic")[1], 0.001);
  EXPECT_THAT(contents->notes, Not(Contains(HasSubstr("header.stamp"))));
}

TEST(Mcap, AnotherClockIsSaid) {
  const auto contents = decoded(one_topic("geometry_msgs/msg/WrenchStamped", test::kWrench2,
                                          {test::wrench(Message::cdr(), 1'700'000'000, 0, 1, 2)}));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'/topic'"), HasSubstr("1.7e+09 s"))));
}

/// Wrenches with these stamps [s], recorded at 100 s, 1 ms after each other.
Result<Contents> stamped(const std::vector<double>& stamps, std::uint64_t recorded = 100'000'000'000) {
  std::string records = mcap::schema(1, "geometry_msgs/msg/WrenchStamped", test::kWrench2) + mcap::channel(1, 1, "/ft");
  double x = 0.0;
  for (const double stamp : stamps) {
    const auto seconds = static_cast<std::uint32_t>(stamp);
    const auto rest = static_cast<std::uint32_t>(std::lround(1e9 * (stamp - seconds)));
    records += mcap::message(1, recorded += 1'000'000, test::wrench(Message::cdr(), seconds, rest, x += 1, 2).bytes());
  }
  return decoded(mcap::file(records));
}

TEST(Mcap, AnotherClockIsNotToldByTheFirstMessage) {
  const auto late_start = stamped({2, 100.001, 100.002, 100.003});
  ASSERT_TRUE(late_start) << late_start.error().line();
  EXPECT_THAT(late_start->notes, Not(Contains(HasSubstr("98.001 s"))));
  const auto other = stamped({100, 500.001, 500.002, 500.003});
  ASSERT_TRUE(other) << other.error().line();
  EXPECT_THAT(other->notes, Contains(AllOf(HasSubstr("'/ft'"), HasSubstr("399.999 s"))));
}

TEST(Mcap, MessagesWhoseStampWasNotSetAreLeftOut) {
  const auto contents = stamped({0, 0, 100.003, 100.004});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(time_of(*contents, "/ft"), (Vector(2) << 0.0, 0.001).finished());
  EXPECT_EQ(numbers(*contents, "/ft.wrench.force.x"), (std::vector<double>{3, 4}));
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("2 of 4 messages"), HasSubstr("'/ft'"))));
  EXPECT_THAT(contents->notes, Not(Contains(HasSubstr("100.001 s"))));
}

TEST(Mcap, ASimulationMayBeginAtZero) {
  const auto contents = stamped({0, 0.001, 0.002});
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(numbers(*contents, "/ft.wrench.force.x"), (std::vector<double>{1, 2, 3}));
}

TEST(Mcap, MessagesThatWereRecordedBeforeTheClockRanAreLeftOut) {
  std::string records = mcap::channel(1, 0, "/js", "json");
  for (const std::uint64_t time : {0, 0, 7'000'000, 8'000'000}) records += mcap::message(1, time, R"({"a": 1})");
  const auto contents = decoded(mcap::file(records));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(time_of(*contents, "/js"), (Vector(2) << 0.0, 0.001).finished());
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("2 of 4 messages"), HasSubstr("'/js'"))));
}

TEST(Mcap, ArraysOfNothingAreNoWork) {
  // A thousand million elements of a type without fields, and of one that is within itself a thousand times.
  const std::string definition = "Void[] nothing\nVoid[1000000000] more\nfloat64 a" + kLineOfTypes + "MSG: lab/Void\n";
  std::string records = bag::connection(0, "/v", "lab/V", definition);
  records += bag::message(0, 1, 0, Message::ros1().add(std::uint32_t{4000000000}).add(5.0).bytes());
  const auto contents = decoded(bag::file(records));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(numbers(*contents, "/v.a"), (std::vector<double>{5.0}));
}

TEST(Mcap, ReadsRecordingsOfOthers) {
  MBK_DATA_OR_SKIP(folder);
  const std::string basic = test::bytes_of(folder / "mcap" / "cdr_test_0.mcap");
  ASSERT_FALSE(basic.empty());
  const auto contents = decoded(basic);
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(numbers(*contents, "/test_topic.int32_value").size(), 3U);
  EXPECT_THAT(numbers(*contents, "/test_topic.int32_value"), Contains(123.0));
  EXPECT_EQ(time_of(*contents, "/array_topic").size(), 4);
  EXPECT_EQ(contents->metadata.at("start"), "2020-04-09T04:27:36.763032325Z");

  const std::string talker = test::bytes_of(folder / "mcap" / "talker.mcap");
  const auto three = decoded(talker);
  ASSERT_TRUE(three) << three.error().line();
  EXPECT_THAT(three->notes,
              Contains(AllOf(HasSubstr("/rosout"), HasSubstr("/parameter_events"), HasSubstr("10 messages"))));
  EXPECT_NE(find(*three, "/rosout.level"), nullptr);
  EXPECT_THAT(three->notes, Not(Contains(HasSubstr("'/topic'"))));  // quoted where it is not read
}

}  // namespace
}  // namespace mbk::recording
