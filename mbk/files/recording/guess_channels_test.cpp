#include "mbk/files/recording/guess_channels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mbk/files/recording/channel_map.h"

namespace mbk::recording {
namespace guess_channels_test {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Index kSamples = 50;

Vector rising(double step) {
  return Vector::LinSpaced(kSamples, 0.0, step * static_cast<double>(kSamples - 1));
}

/// Goes up and down, as far as `size` from its mean.
Vector moving(double size) {
  return size * Eigen::sin(rising(0.7).array()).matrix();
}

std::vector<FileSignal> columns(const std::vector<std::pair<std::string, Vector>>& named) {
  std::vector<FileSignal> signals;
  for (const auto& [name, values] : named) signals.push_back({std::to_string(signals.size() + 1), name, values});
  return signals;
}

ChannelGuess guessed(const std::vector<std::pair<std::string, Vector>>& named) {
  return guess_channels(columns(named));
}

TEST(GuessChannels, GoesByTheWordsInTheNames) {
  const ChannelGuess guess = guessed({{"Time (s)", rising(0.001)},
                                      {"PosX_mm", moving(5)},
                                      {"PosY_mm", moving(5)},
                                      {"VelX", moving(1)},
                                      {"Hand force X [N]", moving(2)},
                                      {"Hand force Y [N]", moving(2)},
                                      {"Hand force Z [N]", moving(2)},
                                      {"ref pos x", moving(0.01)},
                                      {"ref pos y", moving(0.01)}});
  EXPECT_EQ(guess.map, "time=1:s,x=2:mm,y=3:mm,Fx=5:N,Fy=6:N,xr=8,yr=9");
  EXPECT_THAT(guess.missing, IsEmpty());
  ASSERT_EQ(guess.channels.size(), 7u);
  EXPECT_EQ(guess.channels[1].entry, "x=2:mm");
  EXPECT_EQ(guess.channels[3].signal, 4u);
  EXPECT_EQ(guess.channels[3].why, "name");
  EXPECT_FALSE(guess.channels[3].unit_by_size);
  EXPECT_TRUE(parse_channel_map(guess.map));
}

TEST(GuessChannels, ThreeAxesHavePositionAndForceAlongZ) {
  const std::vector<std::pair<std::string, Vector>> plane = {{"t", rising(0.01)}, {"x", moving(1)},  {"y", moving(1)},
                                                             {"Fx", moving(2)},   {"Fy", moving(2)}, {"Fz", moving(2)}};
  auto space = plane;
  for (const char* const name : {"vel z", "z", "zr", "xr", "az"}) space.emplace_back(name, moving(1));
  EXPECT_EQ(guessed(space).map, "time=1,x=2,y=3,z=8,Fx=4,Fy=5,Fz=6,xr=10,zr=9,az=11");
  EXPECT_EQ(guessed(plane).map, "time=1,x=2,y=3,Fx=4,Fy=5");
  EXPECT_EQ(guessed({{"PosX", moving(9)},
                     {"PosY", moving(9)},
                     {"PosZ", moving(9)},
                     {"Force X", moving(1)},
                     {"Force Y", moving(1)},
                     {"Force Z", moving(1)}})
                .map,
            "x=1:mm,y=2:mm,z=3:mm,Fx=4,Fy=5,Fz=6");
  // Without a force along z, z stays out, as the heights of a plane do.
  EXPECT_EQ(guessed({{"t", rising(0.01)},
                     {"x", moving(1)},
                     {"y", moving(1)},
                     {"z", moving(1)},
                     {"Fx", moving(2)},
                     {"Fy", moving(2)}})
                .map,
            "time=1,x=2,y=3,Fx=5,Fy=6");
}

TEST(GuessChannels, OneAxisHasAForceOrATorque) {
  EXPECT_EQ(guessed({{"t", rising(0.01)}, {"Ankle angle (deg)", moving(5)}, {"Torque (N.m)", moving(2)}}).map,
            "time=1,x=2:deg,F=3:N.m");
}

TEST(GuessChannels, ALetterBehindAWordIsNoQuantity) {
  const ChannelGuess guess = guessed(
      {{"t", rising(0.01)}, {"enc1", moving(1)}, {"enc2", moving(1)}, {"cellA", moving(2)}, {"cellB", moving(2)}});
  EXPECT_EQ(guess.map, "time=1,F=4");
  EXPECT_THAT(guess.missing, ElementsAre("x"));
  EXPECT_EQ(guessed({{"t", rising(0.01)}, {"x", moving(1)}, {"F", moving(2)}, {"a", moving(1)}}).map,
            "time=1,x=2,F=3,a=4");
}

TEST(GuessChannels, StampsSince1970AreInTheUnitOfTheirSize) {
  const auto since_1970 = [](double scale) {
    return Vector((1.7e9 * scale + 0.01 * scale * rising(1.0).array()).matrix());
  };
  EXPECT_EQ(guessed({{"rosbagTimestamp", since_1970(1e9)}, {"pos", moving(1)}, {"force", moving(2)}}).map,
            "time=1:ns,x=2,F=3");
  EXPECT_EQ(guessed({{"tout", since_1970(1e3)}, {"pos", moving(1)}, {"force", moving(2)}}).map, "time=1:ms,x=2,F=3");
}

TEST(GuessChannels, TimeIsWhatRisesByEvenSteps) {
  const ChannelGuess guess =
      guessed({{"a1", moving(1)}, {"count", rising(1.0)}, {"position", moving(0.1)}, {"force", moving(1)}});
  EXPECT_EQ(guess.map, "time=2:ms,x=3,F=4");
  EXPECT_EQ(guess.channels[0].why, "steps");
  EXPECT_TRUE(guess.channels[0].unit_by_size);
  const ChannelGuess two =
      guessed({{"n", rising(1.0)}, {"m", rising(2.0)}, {"position", moving(0.1)}, {"force", moving(1)}});
  EXPECT_EQ(two.map, "x=3,F=4");
}

TEST(GuessChannels, LargePositionsAreInMillimetres) {
  const auto map = [](double size) {
    return guessed(
               {{"t", rising(0.001)}, {"x", moving(size)}, {"y", moving(size)}, {"fx", moving(1)}, {"fy", moving(1)}})
        .map;
  };
  EXPECT_EQ(map(0.05), "time=1,x=2,y=3,Fx=4,Fy=5");
  EXPECT_EQ(map(12.0), "time=1,x=2:mm,y=3:mm,Fx=4,Fy=5");
}

TEST(GuessChannels, WithoutAxesTheOrderOfTheFileCounts) {
  EXPECT_EQ(guessed({{"t", rising(0.001)},
                     {"pos1", moving(0.1)},
                     {"pos2", moving(0.1)},
                     {"force1", moving(1)},
                     {"force2", moving(1)}})
                .map,
            "time=1,x=2,y=3,Fx=4,Fy=5");
}

TEST(GuessChannels, WhatNobodyNamesIsMissing) {
  const ChannelGuess guess = guessed({{"", rising(0.001)}, {"", moving(1)}, {"", moving(1)}});
  EXPECT_EQ(guess.map, "time=1");
  EXPECT_THAT(guess.missing, ElementsAre("x", "F"));
}

TEST(SignalsOf, CountsColumnsOfTablesAndNamesThoseOfMatrices) {
  Contents table;
  table.table = true;
  table.arrays.push_back({"time", SharedMatrix(Matrix(rising(1)))});
  table.arrays.push_back({"x", SharedMatrix(Matrix(moving(1))), "mm"});
  const auto counted = signals_of(table);
  ASSERT_EQ(counted.size(), 2u);
  EXPECT_EQ(counted[1].source, "2");
  EXPECT_EQ(counted[1].name, "x (mm)");

  Contents matrices;
  Matrix wide(2, kSamples);
  wide << rising(1).transpose(), moving(1).transpose();
  matrices.arrays.push_back({"pos", SharedMatrix(wide)});
  matrices.arrays.push_back({"force", SharedMatrix(Matrix(moving(2)))});
  matrices.arrays.push_back({"a b", SharedMatrix(Matrix(moving(2)))});  // cannot stand in a map
  matrices.arrays.push_back({"rate", SharedMatrix(Matrix(Matrix::Ones(1, 1)))});
  const auto named = signals_of(matrices);
  ASSERT_EQ(named.size(), 3u);
  EXPECT_EQ(named[0].source, "pos[1]");
  EXPECT_EQ(named[1].source, "pos[2]");
  EXPECT_EQ(named[1].values, moving(1));
  EXPECT_EQ(named[2].source, "force");
}

}  // namespace guess_channels_test
}  // namespace mbk::recording
