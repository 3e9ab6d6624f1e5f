#include "mbk/measure/explore/limb_signals.h"

#include <gtest/gtest.h>

#include "mbk/measure/explore/test_limb_trials.h"

namespace mbk::explore {
namespace limb_signals_test {

/// x = sin 2π f t for 8 s at 1 kHz.
ExplorationTrial sine(double frequency) {
  constexpr Index kSamples = 8000;
  Matrix x(kSamples, 1);
  for (Index i = 0; i < kSamples; ++i) x(i, 0) = std::sin(2e-3 * std::numbers::pi * frequency * static_cast<double>(i));
  ExplorationTrial trial = trial_of(x, 2.0 * x, 1e-3);
  trial.split = 4000;
  return trial;
}

TEST(LimbSignals, AreDecimatedToTwoAndAHalfTimesTheBand) {
  const auto trial = sine(3.0);
  const auto signals = limb_signals({&trial, 1});
  ASSERT_TRUE(signals) << signals.error().line();
  EXPECT_EQ(signals->every, 8);
  EXPECT_DOUBLE_EQ(signals->sample_time, 0.008);
  ASSERT_EQ(signals->identification.size(), 1u);
  EXPECT_EQ(signals->identification[0].end, 488);  // 12 rows are dropped at each end
  EXPECT_EQ(signals->validation[0].begin, 488);
  EXPECT_EQ(signals->validation[0].end, signals->position.rows());
  EXPECT_EQ(signals->explained.size(), 0);
}

TEST(LimbSignals, HaveTheDerivativesOfASine) {
  for (const double frequency : {3.0, 30.0}) {
    const auto trial = sine(frequency);
    const auto signals = limb_signals({&trial, 1});
    ASSERT_TRUE(signals);
    const double omega = 2.0 * std::numbers::pi * frequency;
    for (Index k = 200; k < 700; ++k) {
      constexpr double kOfEnds = 1e-5;  // what the filter remembers of them
      const double sine = 0.5 * signals->resistance(k, 0);
      EXPECT_NEAR(signals->acceleration(k, 0) / (omega * omega), -sine, kOfEnds);
      EXPECT_NEAR(signals->position(k, 0) - signals->position(200, 0), sine - 0.5 * signals->resistance(200, 0),
                  kOfEnds);
    }
  }
}

TEST(LimbSignals, TakeFromTheReferenceWhatItExplains) {
  const Vector r = binary_motion(4000, 1), noise = coloured_noise(4000, 2);
  const auto trial = trial_of(convolved(r, Vector{{0.2, 0.5, 0.3}}, 1) + 0.1 * noise, noise, kStep, r);
  const auto signals = limb_signals({&trial, 1});
  ASSERT_TRUE(signals);
  ASSERT_EQ(signals->explained.cols(), 3);
  EXPECT_GT(signals->explained_share[0], 0.9);
  EXPECT_LT(signals->explained_share[0], 1.0);
  const auto& rows = signals->identification[0];
  const Vector left = (signals->position - signals->explained.leftCols(1)).col(0).segment(rows.begin, rows.size());
  const Vector part = noise.segment(rows.begin + 4, rows.size());
  const double correlation =
      (left.array() - left.mean()).matrix().normalized().dot((part.array() - part.mean()).matrix().normalized());
  EXPECT_GT(correlation, 0.95);  // the noise stays behind

  const auto alone = trial_of(noise, noise, kStep, r);
  EXPECT_EQ(limb_signals({&alone, 1})->explained.size(), 0);  // a reference that explains nothing
}

TEST(LimbSignals, OfSeveralTrialsStandUnderEachOther) {
  const std::vector<ExplorationTrial> trials = {sine(3.0), sine(4.0)};
  const auto signals = limb_signals(trials);
  ASSERT_TRUE(signals);
  ASSERT_EQ(signals->pieces.size(), 2u);
  EXPECT_EQ(signals->pieces[0].end, signals->pieces[1].begin);
  EXPECT_EQ(signals->pieces[1].end, signals->position.rows());
}

TEST(LimbSignals, RefuseWhatDoesNotBelongTogether) {
  EXPECT_FALSE(limb_signals({}));
  std::vector<ExplorationTrial> trials = {sine(3.0), sine(3.0)};
  trials[1].sample_time = 2e-3;
  EXPECT_EQ(limb_signals(trials).error().kind, ErrorKind::data);
  const auto brief = trial_of(Vector::LinSpaced(6, 0, 1), Vector::LinSpaced(6, 0, 1), 1e-3);
  EXPECT_FALSE(limb_signals({&brief, 1}));
}

}  // namespace limb_signals_test
}  // namespace mbk::explore
