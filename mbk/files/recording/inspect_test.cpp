#include "mbk/files/recording/inspect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/random.h"
#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace {

Recording with_time(std::initializer_list<double> time) {
  Recording recording;
  recording.time = Eigen::Map<const Vector>(time.begin(), static_cast<Index>(time.size()));
  return recording;
}

/// 1 kHz, with one channel.
Recording with_channel(const std::string& name, Vector values) {
  Recording recording;
  recording.time = Vector::LinSpaced(values.size(), 0.0, static_cast<double>(values.size() - 1)) / 1000.0;
  recording.channels.push_back({name, "N", "base", std::move(values)});
  return recording;
}

TEST(Inspect, ReportsTheRateFromTheMeanIntervalUnlessTimeIsBroken) {
  const Inspection facts = inspect(with_time({0.0, 0.001, 0.002, 0.003, 0.0045}));
  EXPECT_NEAR(facts.rate_hz, 4.0 / 0.0045, 1e-6);
  EXPECT_NEAR(inspect(with_time({0.0, 0.001, 0.002, 0.003, 0.1})).rate_hz, 1000.0, 1e-6);
  EXPECT_NEAR(inspect(with_time({0.0, 0.001, 0.002, 0.0, 0.001})).rate_hz, 1000.0, 1e-6);
  EXPECT_DOUBLE_EQ(facts.duration, 0.0045);
  EXPECT_NEAR(facts.interval_min, 0.001, 1e-12);
  EXPECT_NEAR(facts.interval_max, 0.0015, 1e-12);
  EXPECT_NEAR(facts.interval_standard_deviation, 0.00025, 1e-12);
}

TEST(Inspect, ReportsGaps) {
  const Inspection facts = inspect(with_time({10, 11, 12, 15, 16}));
  ASSERT_EQ(facts.gaps.size(), 1u);
  EXPECT_EQ(facts.gaps[0].sample, 2);
  EXPECT_EQ(facts.gaps[0].time, 12);
  EXPECT_EQ(facts.gaps[0].length, 3);
}

/// 60 s at 1 kHz with `lost` samples lost, each by itself; stamps deviate by a standard deviation of `jitter`
/// intervals.
Recording jittering(double jitter, bool normal, int lost, std::vector<Index>& before_lost) {
  numeric::Random random(5);
  std::vector<double> times;
  for (int i = 0, left = lost; i < 60000; ++i) {
    if (left > 0 && i > 0 && i % 2500 == 0) {
      --left;
      before_lost.push_back(static_cast<Index>(times.size()) - 1);
      continue;
    }
    const double deviation = normal ? random.normal() : std::sqrt(3.0) * (2.0 * random.uniform() - 1.0);
    times.push_back(0.001 * (i + jitter * deviation));
  }
  Recording recording;
  recording.time = Eigen::Map<const Vector>(times.data(), static_cast<Index>(times.size()));
  return recording;
}

TEST(Inspect, TellsLostSamplesFromJitter) {
  for (const double jitter : {0.01, 0.05, 0.1, 0.2}) {
    for (const bool normal : {true, false}) {
      for (const int lost : {0, 20}) {
        std::vector<Index> before_lost;
        const Inspection facts = inspect(jittering(jitter, normal, lost, before_lost));
        ASSERT_EQ(facts.gaps.size(), before_lost.size()) << jitter << (normal ? " normal" : " uniform");
        for (std::size_t k = 0; k < before_lost.size(); ++k) {
          // with 20 % the interval beside may be longer than that of the lost sample
          EXPECT_NEAR(double(facts.gaps[k].sample), double(before_lost[k]), jitter > 0.1 ? 3 : 0) << jitter;
        }
      }
    }
  }
}

TEST(Inspect, ReportsSamplesThatAreNaNInEveryChannel) {
  Recording recording = with_channel("force_x", Vector{{1, kNaN, kNaN, 4, kNaN, 6, kNaN}});
  recording.channels.push_back({"force_y", "N", "base", Vector{{kNaN, kNaN, kNaN, 4, 5, 6, kNaN}}});
  const Inspection facts = inspect(recording);
  ASSERT_EQ(facts.missing.size(), 2U);
  EXPECT_EQ(facts.missing[0].first, 1);
  EXPECT_EQ(facts.missing[0].count, 2);
  EXPECT_NEAR(facts.missing[0].time, 0.001, 1e-12);
  EXPECT_EQ(facts.missing[1].first, 6);
  EXPECT_EQ(facts.missing[1].count, 1);
}

TEST(Inspect, ReportsDuplicatedAndBackwardTimes) {
  const Inspection facts = inspect(with_time({0, 1, 1, 2, 3, 0, 1, 1}));
  EXPECT_EQ(facts.duplicated_times, 2);
  EXPECT_EQ(facts.first_duplicated, 2);
  EXPECT_EQ(facts.backward_times, 1);
  EXPECT_EQ(facts.first_backward, 5);
  EXPECT_EQ(facts.interval_min, 1);
}

TEST(Inspect, ReportsNonFiniteValues) {
  Vector values = Vector::LinSpaced(10, 0, 1);
  values[3] = kNaN;
  values[7] = std::numeric_limits<double>::infinity();
  const Inspection facts = inspect(with_channel("hand_x", values));
  ASSERT_EQ(facts.non_finite.size(), 1u);
  EXPECT_EQ(facts.non_finite[0].channel, "hand_x");
  EXPECT_EQ(facts.non_finite[0].count, 2);
  EXPECT_EQ(facts.non_finite[0].first, 3);
  EXPECT_EQ(facts.channels[0].max, 1.0);
}

Vector saturated_sine() {
  Vector values(2000);
  for (Index i = 0; i < values.size(); ++i) {
    values[i] = std::min(std::max(std::sin(0.02 * static_cast<double>(i)), -0.9), 0.9);
  }
  return values;
}

TEST(Inspect, ReportsAClippedForce) {
  const Inspection facts = inspect(with_channel("force_x", saturated_sine()));
  EXPECT_TRUE(facts.channels[0].clipped);
  EXPECT_FALSE(facts.channels[0].constant);
  EXPECT_NEAR(facts.channels[0].clipped_fraction, 0.287, 0.01);  // 2 acos(0.9) / π
}

TEST(Inspect, CallsOnlySensorsClipped) {
  EXPECT_FALSE(inspect(with_channel("reference_x", saturated_sine())).channels[0].clipped);
}

TEST(Inspect, CallsAConstantChannelConstantNotClipped) {
  const Inspection facts = inspect(with_channel("force_x", Vector::Constant(1000, 2.5)));
  EXPECT_TRUE(facts.channels[0].constant);
  EXPECT_FALSE(facts.channels[0].clipped);
}

TEST(Inspect, DoesNotCallTwoRunsClipped) {
  Vector values = Vector::LinSpaced(1000, -1, 1);
  values.segment(100, 10).setConstant(5);
  values.segment(300, 10).setConstant(5);
  EXPECT_FALSE(inspect(with_channel("force_x", values)).channels[0].clipped);
  values.segment(500, 10).setConstant(5);
  EXPECT_TRUE(inspect(with_channel("force_x", values)).channels[0].clipped);
}

TEST(ClippedChannels, AreThoseThatReachTheirLimitWithinTheWindow) {
  Vector values(1000), times(1000);
  for (Index k = 0; k < 1000; ++k) {
    const double one = std::sin(0.1 * static_cast<double>(k));
    values[k] = k < 500 ? std::clamp(one, -0.9, 0.9) : one;
    times[k] = 3.0 + 0.01 * static_cast<double>(k);
  }
  Recording recording = with_channel("force_x", values);
  recording.time = times;
  EXPECT_FALSE(inspect(recording).channels[0].clipped);  // later it goes farther
  const auto clipped = clipped_channels(recording, 0.0, 4.9);
  ASSERT_EQ(clipped.size(), 1U);
  EXPECT_EQ(clipped[0].max, 0.9);
  EXPECT_TRUE(clipped_channels(recording, 5.0, 9.99).empty());
  EXPECT_TRUE(clipped_channels(recording, 20.0, 30.0).empty());
  EXPECT_TRUE(clipped_channels(Recording{}, 0.0, 1.0).empty());
}

TEST(Inspect, CopesWithNoneAndOneSample) {
  EXPECT_EQ(inspect(Recording{}).samples, 0);
  const Inspection one = inspect(with_time({5.0}));
  EXPECT_EQ(one.duration, 0.0);
  EXPECT_TRUE(std::isnan(one.rate_hz));
}

TEST(Inspect, ReportsTheJitterOfARealClock) {
  MBK_DATA_OR_SKIP(data);
  ReadOptions options;
  options.channels = parse_channel_map("q1=pos_meas1,q2=pos_meas2,tau1=tau_meas1,tau2=tau_meas2,time=time").value();
  const auto recording = read(data / "double_pendulum/C1_20230629-143339.csv", options);
  ASSERT_TRUE(recording) << recording.error().line();
  const Inspection facts = inspect(*recording);
  EXPECT_NEAR(facts.rate_hz, 500.0, 25.0);
  EXPECT_GT(facts.interval_standard_deviation, 1e-5);
  EXPECT_FALSE(facts.gaps.empty());
  EXPECT_EQ(facts.backward_times, 0);
}

}  // namespace
}  // namespace mbk::recording
