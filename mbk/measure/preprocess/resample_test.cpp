#include "mbk/measure/preprocess/resample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/measure/preprocess/test_recordings.h"

namespace mbk::preprocess {
namespace {

using testing::HasSubstr;

/// A straight line, 2 + 3 t, on a clock whose intervals vary by 40 %.
Recording line(Index samples) {
  Recording recording = testing_support::even_recording(samples, 1000.0, {{"hand_x", Vector(samples)}});
  for (Index i = 0; i < samples; ++i) {
    recording.time[i] = 0.001 * (static_cast<double>(i) + 0.4 * std::sin(static_cast<double>(i)));
    recording.channels[0].values[i] = 2.0 + 3.0 * recording.time[i];
  }
  return recording;
}

TEST(Resample, ALineStaysALine) {
  const Recording even = resample(line(1000), Hertz(777.0)).value();
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * 5.0;  // values stay below 5
  for (Index i = 0; i < even.samples(); ++i) {
    ASSERT_NEAR(even.channels[0].values[i], 2.0 + 3.0 * even.time[i], rounding) << i;
  }
}

TEST(Resample, TheClockIsEvenAndBeginsWithTheFirstSample) {
  Recording recording = line(1000);
  recording.time.array() += 5.0;
  const Recording even = resample(recording, Hertz(500.0)).value();
  EXPECT_EQ(even.time[0], recording.time[0]);
  for (Index i = 0; i < even.samples(); ++i) {
    ASSERT_NEAR(even.time[i], recording.time[0] + 0.002 * static_cast<double>(i), 1e-14) << i;
  }
  EXPECT_LE(even.time[even.samples() - 1], recording.time[999]);
}

TEST(Resample, AtItsOwnRateChangesNothing) {
  const Recording recording = testing_support::even_recording(1000, 1000.0, {{"hand_x", Vector::Random(1000)}});
  const Recording even = resample(recording, Hertz(1000.0)).value();
  ASSERT_EQ(even.samples(), 1000);
  EXPECT_LE((even.channels[0].values - recording.channels[0].values).cwiseAbs().maxCoeff(), 1e-12);
}

// Else a pulse would have two steps, and the perturbation would be taken for one that varies continuously.
TEST(Resample, AReferenceThatIsConstantButForStepsKeepsItsValues) {
  Recording recording = line(1000);
  recording.channels.push_back({"reference_x", "m", "base", Vector::Constant(1000, 0.1)});
  recording.channels.push_back({"force_x", "N", "base", Vector::Constant(1000, 0.3)});
  recording.channels[1].values.segment(300, 200).setConstant(0.13);
  const Recording even = resample(recording, Hertz(777.0)).value();
  Index steps = 0;
  for (Index i = 1; i < even.samples(); ++i) {
    const Vector& reference = even.channels[1].values;
    steps += reference[i] != reference[i - 1] ? 1 : 0;
    ASSERT_EQ(even.channels[2].values[i], 0.3) << "a constant stays constant to the last digit, at " << i;
    const bool displaced = even.time[i] >= recording.time[300] && even.time[i] < recording.time[500];
    ASSERT_EQ(reference[i], displaced ? 0.13 : 0.1) << i;
  }
  EXPECT_EQ(steps, 2);
}

TEST(Resample, KeepsEventsAndMetadata) {
  Recording recording = line(100);
  recording.events.push_back({0.05, "onset", 1.0});
  recording.metadata["participant"] = "7";
  const Recording even = resample(recording, Hertz(500.0)).value();
  EXPECT_EQ(even.events.size(), 1u);
  EXPECT_EQ(even.metadata.at("participant"), "7");
}

TEST(Resample, RefusesTimeThatRepeatsOrRunsBackwardsAndNamesTheSample) {
  for (const double shift : {0.0, -0.01}) {
    Recording recording = line(100);
    recording.time[60] = recording.time[59] + shift;
    const auto even = resample(recording, Hertz(500.0));
    ASSERT_FALSE(even) << shift;
    EXPECT_THAT(even.error().message, HasSubstr("sample 61"));  // counted from 1
  }
}

TEST(Resample, RefusesTimeThatIsNotANumber) {
  Recording recording = line(100);
  recording.time[60] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_FALSE(resample(recording, Hertz(500.0)));
  EXPECT_THAT(resample(recording, Hertz(500.0)).error().message, HasSubstr("sample 61"));
}

TEST(Resample, RefusesARateThatIsNone) {
  for (const double rate :
       {0.0, -5.0, 2e6, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto even = resample(line(100), Hertz(rate));
    ASSERT_FALSE(even) << rate;
    EXPECT_EQ(even.error().kind, ErrorKind::usage);
  }
}

TEST(Resample, RefusesToMakeAnAbsurdNumberOfSamples) {
  Recording recording = line(100);
  recording.time[99] = 1e9;
  const auto even = resample(recording, Hertz(1000.0));
  ASSERT_FALSE(even);
  EXPECT_THAT(even.error().message, HasSubstr("1e+12 samples"));
}

TEST(Resample, RefusesFewerThanTwoSamples) {
  EXPECT_FALSE(resample(line(1), Hertz(500.0)));
  EXPECT_FALSE(resample(Recording{}, Hertz(500.0)));
}

}  // namespace
}  // namespace mbk::preprocess
