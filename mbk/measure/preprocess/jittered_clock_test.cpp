#include "mbk/measure/preprocess/jittered_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/measure/preprocess/test_recordings.h"

namespace mbk::preprocess {
namespace jittered_clock_test {

constexpr double kInterval = 0.001;
constexpr double kNoise = 5e-6;  // of the position sensor [m]

/// 20 s of 5 mm at 1 and 3 Hz; the stamps deviate by `jitter` of an interval.
Recording moving(double jitter, bool taken_at_stamps, double amplitude = 0.005) {
  constexpr Index kSamples = 20000;
  Recording recording = testing_support::even_recording(kSamples, 1.0 / kInterval,
                                                        {{"hand_x", Vector(kSamples)}, {"hand_y", Vector(kSamples)}});
  numeric::Random random(3);
  for (Index i = 0; i < kSamples; ++i) {
    const double even = recording.time[i];
    recording.time[i] += jitter * kInterval * random.normal();
    const double phase = 2.0 * std::numbers::pi * (taken_at_stamps ? recording.time[i] : even);
    recording.channels[0].values[i] = amplitude * std::sin(phase) + kNoise * random.normal();
    recording.channels[1].values[i] = amplitude * std::sin(3.0 * phase) + kNoise * random.normal();
  }
  return recording;
}

Inspection facts_of(const Recording& recording) {
  Inspection facts;
  const Vector intervals = recording.time.tail(recording.samples() - 1) - recording.time.head(recording.samples() - 1);
  facts.interval_median = kInterval;
  facts.rate_hz = 1.0 / intervals.mean();
  facts.interval_standard_deviation = std::sqrt((intervals.array() - intervals.mean()).square().mean());
  return facts;
}

TEST(StampEvidence, SeesWhetherSamplesWereTakenAtTheirStamps) {
  for (const double jitter : {0.05, 0.1}) {
    const StampEvidence at_stamps = stamp_evidence(moving(jitter, true)), even = stamp_evidence(moving(jitter, false));
    EXPECT_NEAR(at_stamps.slope, 1.0, 4.0 * at_stamps.standard_error) << jitter;
    EXPECT_NEAR(even.slope, 0.0, 4.0 * even.standard_error) << jitter;
    EXPECT_LT(at_stamps.standard_error, 0.1) << jitter;
  }
}

TEST(StampEvidence, IsNoneWhereNothingMoves) {
  Recording recording = moving(0.1, true);
  for (Channel& channel : recording.channels) channel.values.setConstant(0.3);
  EXPECT_TRUE(std::isinf(stamp_evidence(recording).standard_error));
  EXPECT_TRUE(std::isinf(stamp_evidence(testing_support::even_recording(50, 1000.0, {})).standard_error));
}

TEST(OnEvenClock, BringsBackTheMotionInEitherCase) {
  for (const bool at_stamps : {true, false}) {
    const Recording recording = moving(0.1, at_stamps, 0.02);
    const auto even = on_even_clock(recording, facts_of(recording));
    ASSERT_TRUE(even);
    EXPECT_EQ(even->warning.code, WarningCode::clock_jitter);
    EXPECT_EQ(even->warning.message.find(" Hz") != std::string::npos, at_stamps) << even->warning.message;
    const Vector& x = even->recording.channels[0].values;
    // a tenth of an interval is 9 µm rms at these speeds, and would be seen
    const Vector truth = 0.02 * (2.0 * std::numbers::pi * even->recording.time.array()).sin();
    EXPECT_LT(std::sqrt((x - truth).squaredNorm() / static_cast<double>(x.size())), 1.05 * kNoise) << at_stamps;
  }
}

TEST(OnEvenClock, TakesRecordedTimeForTrueWhereTheMotionShowsNothing) {
  const Recording recording = moving(0.1, false, 1e-7);
  const auto even = on_even_clock(recording, facts_of(recording));
  ASSERT_TRUE(even);
  EXPECT_NE(even->warning.message.find(" Hz"), std::string::npos) << even->warning.message;
}

TEST(JittersOnly, IsNotSaidOfAGapOrOfASteadyClock) {
  Inspection facts = facts_of(moving(0.1, true));
  EXPECT_TRUE(jitters_only(facts));
  facts.gaps.push_back({10, 0.01, 0.002});
  EXPECT_FALSE(jitters_only(facts));
  EXPECT_FALSE(jitters_only(facts_of(moving(0.0, true))));
}

}  // namespace jittered_clock_test
}  // namespace mbk::preprocess
