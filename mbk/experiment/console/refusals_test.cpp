#include "mbk/experiment/console/refusals.h"

#include <gtest/gtest.h>

#include <string>

namespace mbk::console {
namespace {

using namespace std::chrono_literals;
using Time = Refusals::Time;

/// As a summary counts one kind.
std::string counted(int times, Refusal kind) {
  return std::to_string(times) + " × " + std::string(word_of(kind));
}

TEST(Refusals, TheFirstFewAreSaidAndTheOthersCounted) {
  Refusals refusals;
  int said = 0;
  for (int k = 0; k < 1000; ++k) said += refusals.take(Refusal::token, Time(1ms * k)) ? 1 : 0;
  EXPECT_EQ(said, 5);
  EXPECT_FALSE(refusals.summary(Time(9s)));
  const auto line = refusals.summary(Time(10s));
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->starts_with("995 ")) << *line;
  EXPECT_NE(line->find(counted(995, Refusal::token)), std::string::npos) << *line;
  EXPECT_FALSE(refusals.summary(Time(30s)));
}

TEST(Refusals, AFloodOfOneKindHidesNoOther) {
  Refusals refusals;
  for (int k = 0; k < 1000; ++k) (void)refusals.take(Refusal::token, Time());
  EXPECT_TRUE(refusals.take(Refusal::host, Time(1s)));
  for (int k = 0; k < 6; ++k) (void)refusals.take(Refusal::origin, Time(1s));
  const std::string line = refusals.summary(Time(10s)).value();
  EXPECT_TRUE(line.starts_with("996 ")) << line;
  EXPECT_NE(line.find(counted(995, Refusal::token)), std::string::npos) << line;
  EXPECT_NE(line.find(counted(1, Refusal::origin)), std::string::npos) << line;
}

TEST(Refusals, AnHourOfAFloodIsAFewLines) {
  Refusals refusals;
  int lines = 0;
  std::uint64_t flood = 0;
  for (auto now = Time(); now < Time(1h); now += 1ms, ++flood) {
    lines += refusals.take(Refusal::token, now) ? 1 : 0;
    lines += refusals.summary(now) ? 1 : 0;
  }
  EXPECT_EQ(flood, 3'600'000U);
  EXPECT_LE(lines, 360 * 6);
}

TEST(Refusals, NothingIsSummedUpWhereAllWasSaid) {
  Refusals refusals;
  for (int k = 0; k < 5; ++k) EXPECT_TRUE(refusals.take(Refusal::message, Time()));
  EXPECT_FALSE(refusals.summary(Time(10s)));
  EXPECT_TRUE(refusals.take(Refusal::message, Time(11s)));
}

TEST(Refusals, AtTheEndTheSpellIsNotWaitedFor) {
  Refusals refusals;
  for (int k = 0; k < 7; ++k) (void)refusals.take(Refusal::command, Time());
  const std::string line = refusals.summary(Time(1s), true).value();
  EXPECT_NE(line.find(counted(2, Refusal::command)), std::string::npos) << line;
  EXPECT_FALSE(refusals.summary(Time(1s), true));
}

}  // namespace
}  // namespace mbk::console
