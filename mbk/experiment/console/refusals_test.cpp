#include "mbk/experiment/console/refusals.h"

#include <gtest/gtest.h>

namespace mbk::console {
namespace {

using namespace std::chrono_literals;
using Time = Refusals::Time;

TEST(Refusals, TheFirstFewAreSaidAndTheOthersCounted) {
  Refusals refusals;
  int said = 0;
  for (int k = 0; k < 1000; ++k) said += refusals.take(Refusal::token, Time(1ms * k)) ? 1 : 0;
  EXPECT_EQ(said, 5);
  EXPECT_FALSE(refusals.summary(Time(9s)));
  const auto line = refusals.summary(Time(10s));
  ASSERT_TRUE(line);
  EXPECT_EQ(*line, "995 more within 10 s: 995 × wrong token");
  EXPECT_FALSE(refusals.summary(Time(30s)));
}

TEST(Refusals, AFloodOfOneKindHidesNoOther) {
  Refusals refusals;
  for (int k = 0; k < 1000; ++k) (void)refusals.take(Refusal::token, Time());
  EXPECT_TRUE(refusals.take(Refusal::host, Time(1s)));
  for (int k = 0; k < 6; ++k) (void)refusals.take(Refusal::origin, Time(1s));
  EXPECT_EQ(refusals.summary(Time(10s)).value(), "996 more within 10 s: 995 × wrong token, 1 × foreign origin");
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
  EXPECT_EQ(refusals.summary(Time(1s), true).value(), "2 more within 10 s: 2 × command out of place");
  EXPECT_FALSE(refusals.summary(Time(1s), true));
}

}  // namespace
}  // namespace mbk::console
