#include "mbk/files/recording/channel_map.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::recording {
namespace channel_map_test {

using testing::HasSubstr;

Error error_of(std::string_view text) {
  const auto map = parse_channel_map(text);
  EXPECT_FALSE(map) << text;
  return map ? Error{} : map.error();
}

TEST(ParseChannelMap, ReadsSourcesUnitsAndSigns) {
  const auto map = parse_channel_map("x=2:mm, y=3,Fx=-10,time=clock:ms");
  ASSERT_TRUE(map);
  ASSERT_EQ(map->size(), 4u);
  EXPECT_EQ((*map)[0].channel, "x");  // of one axis or two: not known yet
  EXPECT_EQ((*map)[0].source, "2");
  EXPECT_EQ((*map)[0].unit, "mm");
  EXPECT_FALSE((*map)[0].negate);
  EXPECT_EQ((*map)[1].channel, "hand_y");
  EXPECT_EQ((*map)[2].channel, "force_x");
  EXPECT_EQ((*map)[2].source, "10");
  EXPECT_TRUE((*map)[2].negate);
  EXPECT_EQ((*map)[3].channel, "time");
  EXPECT_EQ((*map)[3].source, "clock");
}

TEST(ParseChannelMap, ReadsAColumnOfANamedMatrix) {
  const auto map = parse_channel_map("x=out.signals(1).values[2]:mm");
  ASSERT_TRUE(map);
  EXPECT_EQ((*map)[0].source, "out.signals(1).values[2]");
  EXPECT_EQ((*map)[0].unit, "mm");
  EXPECT_EQ(counted_source((*map)[0].source)->name, "out.signals(1).values");
  EXPECT_EQ(counted_source("a[1][ 12 ]")->name, "a[1]");
  EXPECT_EQ(counted_source("a[1][ 12 ]")->number, 12);
  for (const char* text : {"", "a", "[1]", "a[]", "a[x]", "a[1", "a[1]b", "a[1.5]", "a[99999999999999999999]"}) {
    EXPECT_FALSE(counted_source(text)) << text;
  }
}

TEST(ParseChannelMap, KnowsEveryNameOfTheDocumentation) {
  for (const char* name :
       {"time", "t",         "hand_x",      "hand_y",      "x",    "y",         "force_x",           "force_y",
        "Fx",   "Fy",        "reference_x", "reference_y", "xr",   "yr",        "joint_1",           "joint_2",
        "q1",   "q2",        "torque_1",    "torque_2",    "tau1", "tau2",      "acceleration_x",    "acceleration_y",
        "ax",   "ay",        "position",    "reaction",    "F",    "reference", "acceleration",      "a",
        "q3",   "q8",        "joint_8",     "torque_3",    "tau8", "qr1",       "reference_joint_8", "Vx",
        "Vy",   "voltage_x", "voltage_y"}) {
    EXPECT_TRUE(parse_channel_map(std::string(name) + "=1")) << name;
  }
}

TEST(ParseChannelMap, RefusesWhatIsNotAnEntry) {
  for (const char* text : {"", "x", "x=", "x=-", "x=:mm", "=2", "x=2,", "x=2,,y=3"}) {
    EXPECT_EQ(error_of(text).kind, ErrorKind::usage) << text;
  }
}

TEST(ParseChannelMap, NamesTheNearestChannel) {
  const Error error = error_of("hnad_x=2");
  EXPECT_EQ(error.kind, ErrorKind::usage);
  EXPECT_THAT(error.line(), AllOf(HasSubstr("'hnad_x'"), HasSubstr("'hand_x'")));
}

TEST(ParseChannelMap, QuotesWhatItRefusesOnOnePrintableLine) {
  EXPECT_THAT(error_of("x\n\xE9=2").message, HasSubstr("'x?é'"));
  EXPECT_THAT(error_of("\x01").message, HasSubstr("'?'"));
}

TEST(ParseChannelMap, RefusesAChannelTwice) {
  EXPECT_EQ(error_of("Fx=2,force_x=3").kind, ErrorKind::usage);
}

TEST(ParseChannelMap, RefusesUnitsOfTheWrongDimension) {
  const Error error = error_of("y=2:N");
  EXPECT_EQ(error.kind, ErrorKind::data);
  EXPECT_THAT(error.line(), AllOf(HasSubstr("channel y"), HasSubstr("m, cm, mm, um, in, ft, mil")));
}

TEST(ParseChannelMap, RefusesAVoltageInNewtons) {
  EXPECT_THAT(error_of("Vx=2:N").line(), AllOf(HasSubstr("channel Vx"), HasSubstr("V, mV, uV")));
}

TEST(ParseChannelMap, LeavesCommasInBracketsToTheName) {
  for (const char* source : {"data[1,:,2]", "data[trial, :, 2]", "data(:, 2)", "Force (N, left)", "a[b, c](1,2)"}) {
    const auto map = parse_channel_map(fmt::format("x={},Fx=-{},y=3", source, source));
    ASSERT_TRUE(map) << map.error().line();
    ASSERT_EQ(map->size(), 3U) << source;
    EXPECT_EQ((*map)[0].source, source);
    EXPECT_EQ((*map)[1].source, source);
  }
  EXPECT_EQ(parse_channel_map("x=a(1,Fx=b(2)").value().size(), 2U);
  EXPECT_EQ(parse_channel_map("x=a),Fx=[b").value().size(), 2U);
}

TEST(ParseChannelMap, LeavesAColonWithTheNameWhereNoUnitFollows) {
  const auto map = parse_channel_map("x=Arm:Hand.x,y=Arm:Hand.y:mm,Fx=-A:b:c").value();
  EXPECT_EQ(map[0].source, "Arm:Hand.x");
  EXPECT_EQ(map[0].unit, "");
  EXPECT_EQ(map[1].source, "Arm:Hand.y");
  EXPECT_EQ(map[1].unit, "mm");
  EXPECT_EQ(map[2].source, "A:b:c");
  EXPECT_EQ(error_of("x=2,y=:counts,y=3").kind, ErrorKind::usage);
}

TEST(ParseChannelMap, LeavesArithmeticWithTheSource) {
  const auto map = parse_channel_map("tau1=vir*35.15065:N, Fx=-Vx*-8.56+0.54:N").value();
  EXPECT_EQ(map[0].source, "vir*35.15065");
  EXPECT_EQ(map[0].unit, "N");
  EXPECT_EQ(map[1].source, "Vx*-8.56+0.54");
  EXPECT_TRUE(map[1].negate);
}

TEST(ParseChannelMap, KeepsTheCommasOfSlices) {
  const auto map = parse_channel_map("x=data[trial,:,2]:mm, Fx=-data(:, 3)*2,y=pos[2,:]").value();
  ASSERT_EQ(map.size(), 3U);
  EXPECT_EQ(map[0].source, "data[trial,:,2]");
  EXPECT_EQ(map[0].unit, "mm");
  EXPECT_EQ(map[1].source, "data(:, 3)*2");
  EXPECT_TRUE(map[1].negate);
  EXPECT_EQ(map[2].source, "pos[2,:]");
  EXPECT_EQ(parse_channel_map("x=a[1,y=b(2]").value().size(), 2U);  // no slices
}

TEST(ParseChannelMap, DoesNotTakeAVelocityForAVoltage) {
  EXPECT_THAT(error_of("vx=2").line(), AllOf(HasSubstr("'vx'"), HasSubstr("'Vx'")));
}

struct Reading {
  std::string name;
  double gain, offset;
  bool operator==(const Reading&) const = default;
};

std::vector<Reading> all_readings(std::string_view source) {
  std::vector<Reading> all;
  for (const SourceReading& way : readings(source)) all.push_back({std::string(way.name), way.gain, way.offset});
  return all;
}

TEST(Readings, AreFromTheLongestNameToTheShortest) {
  using Readings = std::vector<Reading>;
  EXPECT_EQ(all_readings("vir"), (Readings{{"vir", 1, 0}}));
  EXPECT_EQ(all_readings("vir*35.5"), (Readings{{"vir*35.5", 1, 0}, {"vir", 35.5, 0}}));
  EXPECT_EQ(all_readings("vir * 2 + 1"), (Readings{{"vir * 2 + 1", 1, 0}, {"vir * 2", 1, 1}, {"vir", 2, 1}}));
  EXPECT_EQ(all_readings("Vx*-8.56-.5"), (Readings{{"Vx*-8.56-.5", 1, 0}, {"Vx*-8.56", 1, -0.5}, {"Vx", -8.56, -0.5}}));
  EXPECT_EQ(all_readings("hand-1"), (Readings{{"hand-1", 1, 0}, {"hand", 1, -1}}));
  EXPECT_EQ(all_readings("arm-2-1"), (Readings{{"arm-2-1", 1, 0}, {"arm-2", 1, -1}}));
  EXPECT_EQ(all_readings("a+1e-3"), (Readings{{"a+1e-3", 1, 0}, {"a", 1, 1e-3}}));
}

TEST(Readings, TakeNoWordForANumber) {
  for (const char* source : {"a-b", "a*b", "x-inf", "x*nan", "a*", "a+", "*2", "+2", "a*2x", "a*1e999"}) {
    EXPECT_EQ(all_readings(source).size(), 1u) << source;
  }
}

}  // namespace channel_map_test
}  // namespace mbk::recording
