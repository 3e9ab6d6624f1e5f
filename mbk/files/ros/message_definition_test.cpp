#include "mbk/files/ros/message_definition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mbk/files/ros/test_ros.h"

namespace mbk::recording {
namespace {

using test::kLineOfTypes;
using testing::HasSubstr;
using Count = MessageField::Count;

TEST(MessageDefinition, ReadsFieldsConstantsDefaultsAndBounds) {
  const auto definition = parse_definition("lab_msgs/msg/Everything",
                                           "# comment\n"
                                           "int32 ANSWER=42\n"
                                           "string WORD = \"a # b\"\n"
                                           "bool on\r\n"
                                           "float32  gain 1.5  # default\n"
                                           "string<=10 name \"x\"\n"
                                           "int16[<=5] few\n"
                                           "uint8[3] fixed\n"
                                           "string<=4[] words\n"
                                           "byte raw\nchar letter\n"
                                           "builtin_interfaces/Duration wait",
                                           Dialect::ros2);
  ASSERT_TRUE(definition) << definition.error().line();
  const auto& fields = definition->messages.front().fields;
  ASSERT_EQ(fields.size(), 9U);
  EXPECT_EQ(fields[0].name, "on");
  EXPECT_EQ(fields[0].type, FieldType::boolean);
  EXPECT_EQ(fields[1].type, FieldType::float32);
  EXPECT_EQ(fields[2].type, FieldType::text);
  EXPECT_EQ(fields[3].count, Count::counted);
  EXPECT_EQ(fields[4].count, Count::fixed);
  EXPECT_EQ(fields[4].elements, 3U);
  EXPECT_EQ(fields[5].count, Count::counted);
  EXPECT_EQ(fields[6].type, FieldType::uint8);
  EXPECT_EQ(fields[7].type, FieldType::uint8);
  EXPECT_EQ(fields[8].type, FieldType::duration);
  EXPECT_EQ(definition->messages.front().min_bytes, 1U + 4 + 4 + 4 + 3 + 4 + 1 + 1 + 8);
}

TEST(MessageDefinition, FindsTypesOfTheSamePackageAndOfOthers) {
  const auto definition = parse_definition("geometry_msgs/msg/WrenchStamped", test::kWrench2, Dialect::ros2);
  ASSERT_TRUE(definition) << definition.error().line();
  EXPECT_EQ(definition->messages.front().name, "geometry_msgs/WrenchStamped");
  EXPECT_EQ(definition->messages.front().fields[1].type, FieldType::message);
  EXPECT_EQ(definition->messages.front().min_bytes, 8U + 4 + 48);
}

TEST(MessageDefinition, TheWordsOfRos1MeanWhatTheyMeanThere) {
  const auto definition =
      parse_definition("lab/Mixed", "Header header\nbyte signed\ntime at\nduration long\n", Dialect::ros1);
  ASSERT_TRUE(definition) << definition.error().line();
  const auto& fields = definition->messages.front().fields;
  EXPECT_EQ(fields[1].type, FieldType::int8);
  EXPECT_EQ(fields[2].type, FieldType::time);
  EXPECT_EQ(fields[3].type, FieldType::duration);
  EXPECT_EQ(definition->messages[static_cast<std::size_t>(fields[0].message)].fields.size(), 3U);
}

TEST(MessageDefinition, SaysWhatItDoesNotUnderstand) {
  const auto error_of = [](std::string_view text) {
    const auto definition = parse_definition("lab/msg/Odd", text, Dialect::ros2);
    return definition ? std::string() : definition.error().line();
  };
  EXPECT_THAT(error_of("int32"), HasSubstr("'int32'"));
  EXPECT_THAT(error_of("int32[x] a"), HasSubstr("'int32[x] a'"));
  EXPECT_THAT(error_of("Elsewhere a"), HasSubstr("'Elsewhere'"));
  EXPECT_THAT(error_of("A a" + kLineOfTypes + "MSG: lab/A\nB b" + kLineOfTypes + "MSG: lab/B\nA a"),
              HasSubstr("'lab/A'"));
}

TEST(MessageDefinition, AnEmptyStructureOfRos2HasOneByte) {
  const auto two = parse_definition("std_msgs/msg/Empty", "", Dialect::ros2);
  const auto one = parse_definition("std_msgs/Empty", "", Dialect::ros1);
  ASSERT_TRUE(two && one);
  EXPECT_EQ(two->messages.front().min_bytes, 1U);
  EXPECT_EQ(one->messages.front().min_bytes, 0U);
}

}  // namespace
}  // namespace mbk::recording
