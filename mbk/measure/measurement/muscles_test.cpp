#include "mbk/measure/measurement/muscles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"

namespace mbk::measurement {
namespace muscles_test {

constexpr double kRate = 1000.0;
constexpr Index kSamples = 20'000;
const std::vector<std::string> kBoth = {"emg_biceps", "emg_triceps"};

/// Noise whose amplitude is sin² of that period, and its cosine.
Recording contractions(double period_s) {
  Recording recording;
  recording.time = Vector::LinSpaced(kSamples, 0.0, (kSamples - 1) / kRate);
  numeric::Random random(4, 1);
  for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
    Vector emg(kSamples);
    for (Index i = 0; i < kSamples; ++i) {
      const double s = std::sin(std::numbers::pi * recording.time[i] / period_s + phase);
      emg[i] = 1e-4 * s * s * random.normal();
    }
    recording.channels.push_back({recording.channels.empty() ? kBoth[0] : kBoth[1], "V", "", std::move(emg)});
  }
  return recording;
}

ExplorationTrial trial_from(double from_s, Index samples) {
  ExplorationTrial trial;
  trial.sample_time = 1.0 / kRate;
  trial.from_s = from_s;
  trial.input = Matrix::Zero(samples, 1);
  return trial;
}

TEST(Muscles, CoContractionIsTheLesserOfTwoEnvelopes) {
  constexpr double kPeriod = 10.0;
  ExplorationTrial trial = trial_from(5.0, 10'000);
  ASSERT_TRUE(add_muscles(contractions(kPeriod), kBoth, {}, trial));
  EXPECT_EQ(trial.muscles.rows(), 10'000);
  EXPECT_GE(trial.muscles.minCoeff(), 0.0);
  EmgProcessing slow;
  slow.envelope_hz = 2.0;
  ASSERT_TRUE(scale_muscles({&trial, 1}, {}, kCoContraction, slow));
  EXPECT_EQ(trial.scheduling_label.unit, "mean");
  EXPECT_NEAR(trial.muscles.col(0).mean(), 1.0, 1e-12);
  double error = 0.0;
  for (Index i = 0; i < trial.samples(); ++i) {
    const double s = std::sin(std::numbers::pi * (5.0 + static_cast<double>(i) / kRate) / kPeriod);
    error += std::abs(trial.scheduling[i] - 2.0 * std::min(s * s, 1.0 - s * s)) / static_cast<double>(trial.samples());
  }
  EXPECT_LT(error, 0.08);  // the EMG of 250 ms is so uncertain
}

TEST(Muscles, AreSharesOfMaximalContractionWhereThatIsKnown) {
  ExplorationTrial trial = trial_from(0.0, kSamples);
  ASSERT_TRUE(add_muscles(contractions(10.0), {kBoth[0]}, {}, trial));
  const double mean = trial.muscles.col(0).mean();
  ASSERT_TRUE(scale_muscles({&trial, 1}, {{kBoth[0], 5e-4}}, kBoth[0], {}));
  EXPECT_NEAR(trial.muscles.col(0).mean(), mean / 5e-4, 1e-12);
  EXPECT_EQ(trial.scheduling_label.unit, "MVC");
  EXPECT_EQ(trial.scheduling_label.name, kBoth[0]);
  EXPECT_EQ(trial.scheduling.size(), kSamples);
}

TEST(Muscles, TheMeanIsThatOfAllTrials) {
  Recording weak = contractions(10.0);
  for (Channel& channel : weak.channels) channel.values *= 0.5;
  std::vector<ExplorationTrial> trials = {trial_from(0.0, kSamples), trial_from(0.0, kSamples)};
  ASSERT_TRUE(add_muscles(contractions(10.0), kBoth, {}, trials[0]));
  ASSERT_TRUE(add_muscles(weak, kBoth, {}, trials[1]));
  ASSERT_TRUE(scale_muscles(trials, {}, "", {}));
  EXPECT_NEAR(trials[0].muscles.col(1).mean(), 4.0 / 3.0, 1e-9);
  EXPECT_NEAR(trials[1].muscles.col(1).mean(), 2.0 / 3.0, 1e-9);
  EXPECT_EQ(trials[0].scheduling.size(), 0);
}

TEST(Muscles, WhatIsMissingIsSaid) {
  ExplorationTrial trial = trial_from(0.0, kSamples);
  const auto other = add_muscles(contractions(10.0), {"emg_deltoid"}, {}, trial);
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().line().find("emg_biceps, emg_triceps"), std::string::npos) << other.error().line();
  Recording none = contractions(10.0);
  none.channels.clear();
  EXPECT_NE(add_muscles(none, kBoth, {}, trial).error().line().find("--channels"), std::string::npos);
  Recording rectified = contractions(10.0);
  rectified.channels[0].values = rectified.channels[0].values.cwiseAbs();
  EXPECT_EQ(add_muscles(rectified, kBoth, {}, trial).error().kind, ErrorKind::data);
}

TEST(Muscles, OneSignalUnderTwoNamesIsRefused) {
  Recording twice = contractions(10.0);
  twice.channels[1].values = 0.1 * twice.channels[0].values;
  ExplorationTrial trial = trial_from(0.0, kSamples);
  ASSERT_TRUE(add_muscles(twice, kBoth, {}, trial));
  const auto scaled = scale_muscles({&trial, 1}, {}, "", {});
  ASSERT_FALSE(scaled);
  EXPECT_NE(scaled.error().line().find("same signal"), std::string::npos);
}

TEST(Muscles, DoubtfulAmplitudesAreSaid) {
  Recording gained = contractions(10.0);
  gained.channels[0].values *= 10.0;
  std::vector<ExplorationTrial> trials = {trial_from(0.0, kSamples), trial_from(0.0, kSamples)};
  ASSERT_TRUE(add_muscles(contractions(10.0), kBoth, {}, trials[0]));
  ASSERT_TRUE(add_muscles(gained, kBoth, {}, trials[1]));
  auto other = trials;
  ASSERT_TRUE(scale_muscles(trials, {}, "", {}));
  ASSERT_EQ(trials[0].notes.size(), 1u);
  EXPECT_NE(trials[0].notes[0].find("gain of the amplifier"), std::string::npos) << trials[0].notes[0];
  EXPECT_EQ(scale_muscles(other, {{kBoth[0], 1e-7}}, "", {}).error().kind, ErrorKind::usage);
}

TEST(Muscles, AScheduleThatDriftsIsSaid) {
  ExplorationTrial trial = trial_from(0.0, kSamples);
  ASSERT_TRUE(add_muscles(contractions(45.0), {kBoth[0]}, {}, trial));  // rises all the time
  ASSERT_TRUE(scale_muscles({&trial, 1}, {}, kBoth[0], {}));
  ASSERT_EQ(trial.notes.size(), 1u);
  EXPECT_NE(trial.notes[0].find("changes with time"), std::string::npos) << trial.notes[0];
}

TEST(Muscles, CoContractionNeedsTwoOnOneScale) {
  ExplorationTrial one = trial_from(0.0, kSamples), both = one;
  ASSERT_TRUE(add_muscles(contractions(10.0), {kBoth[0]}, {}, one));
  EXPECT_EQ(scale_muscles({&one, 1}, {}, kCoContraction, {}).error().kind, ErrorKind::usage);
  ASSERT_TRUE(add_muscles(contractions(10.0), kBoth, {}, both));
  EXPECT_EQ(scale_muscles({&both, 1}, {{kBoth[0], 5e-4}}, kCoContraction, {}).error().kind, ErrorKind::usage);
}

}  // namespace muscles_test
}  // namespace mbk::measurement
