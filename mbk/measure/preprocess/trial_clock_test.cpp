#include "mbk/measure/preprocess/trial_clock.h"

#include <gtest/gtest.h>

namespace mbk::preprocess {
namespace trial_clock_test {

const Hertz kRate(1000.0);

TEST(Clock, CountsFromTheFirstSample) {
  const Clock clock(Vector::LinSpaced(1000, 5.001, 6.0), kRate);
  EXPECT_NEAR(clock.seconds(0), 0.0, 1e-12);
  EXPECT_NEAR(clock.seconds(250), 0.25, 1e-12);
  EXPECT_NEAR(clock.duration(), 1.0, 1e-12);
  EXPECT_EQ(clock.sample(0.25), 250);
  EXPECT_EQ(clock.sample(0.2504), 250);
  EXPECT_EQ(clock.sample(0.2506), 251);
  EXPECT_EQ(clock.sample(1.0), 1000);
}

TEST(Clock, KeepsToTheRecordedSecondsBehindAGap) {
  Vector time = Vector::LinSpaced(1000, 0.0, 0.999);
  time.tail(500).array() += 3.0;
  const Clock clock(time, kRate);
  EXPECT_EQ(clock.sample(3.6), 600);
  EXPECT_EQ(clock.sample(1.0), 500);  // within the gap: the next sample that there is
  EXPECT_NEAR(clock.seconds(600), 3.6, 1e-12);
  EXPECT_NEAR(clock.duration(), 4.0, 1e-12);
}

TEST(Clock, TakesTheFirstSampleThatIsLateEnoughWhereTimeRestarts) {
  Vector time(6);
  time << 0.0, 0.001, 0.002, 0.0, 0.001, 0.002;
  EXPECT_EQ(Clock(time, kRate).sample(0.002), 2);
}

}  // namespace trial_clock_test
}  // namespace mbk::preprocess
