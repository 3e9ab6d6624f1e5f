#include "mbk/files/recording/own_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mbk/files/recording/test_stale_signals.h"

namespace mbk::recording {
namespace own_samples_test {

using testing::IsEmpty;
using testing::SizeIs;

constexpr Index kSamples = 30000;

Recording recording_of(const std::string& name, const Vector& values) {
  Recording recording;
  recording.time = Vector::LinSpaced(kSamples, 0.0, 1e-3 * (kSamples - 1));
  recording.channels.push_back({name, "N", "base", values});
  find_updates(recording);
  return recording;
}

TEST(AtOwnSamples, LeavesAnHonestChannelToTheBit) {
  numeric::Random random(1);
  const Vector force = test::with_noise(test::multisine(kSamples, 1000.0, 5.0), 0.05, random);
  const Recording same = at_own_samples(recording_of("force_x", force));
  EXPECT_EQ(same.channels[0].values, force);
  EXPECT_THAT(same.warnings, IsEmpty());
}

TEST(AtOwnSamples, GivesBackASignalThatWasHeld) {
  const Vector truth = test::multisine(kSamples, 1000.0, 5.0);
  for (const double period : {4.0, 8.0, 20.0}) {
    const Recording mended = at_own_samples(recording_of("force_x", test::held(truth, period)));
    const Vector& values = mended.channels[0].values;
    // A hold of T is late by T/2 on average: 0.5 N here at 20 ms. A cubic is off by (ωT)⁴/384 of a line.
    EXPECT_LT((values - truth).segment(100, kSamples - 200).cwiseAbs().maxCoeff(), 0.002) << period;
    for (Index i = 0; i < kSamples; i += static_cast<Index>(period)) ASSERT_EQ(values[i], truth[i]);
    ASSERT_THAT(mended.warnings, SizeIs(1));
    EXPECT_EQ(mended.warnings[0].code, WarningCode::held_signal);
  }
}

TEST(AtOwnSamples, FillsSingleSamplesAndLeavesLongFreezesEmpty) {
  const Vector truth = test::multisine(kSamples, 1000.0, 5.0);
  numeric::Random random(2);
  const Vector gaps = truth.unaryExpr([&](double v) { return random.uniform() < 0.1 ? 0.0 : v; });
  const Recording mended = at_own_samples(recording_of("force_x", gaps));
  EXPECT_LT((mended.channels[0].values - truth).cwiseAbs().maxCoeff(), 0.01);
  ASSERT_THAT(mended.warnings, SizeIs(1));
  EXPECT_EQ(mended.warnings[0].code, WarningCode::missing_samples);

  Vector frozen = truth;
  for (Index i = 500; i + 100 < kSamples; i += 1000) frozen.segment(i, 100).setConstant(frozen[i]);
  const Recording empty = at_own_samples(recording_of("force_x", frozen));
  EXPECT_EQ(empty.channels[0].values[500], truth[500]);
  EXPECT_TRUE(std::isnan(empty.channels[0].values[550]));
  EXPECT_EQ(empty.channels[0].values[600], truth[600]);
}

TEST(AtOwnSamples, LeavesAHeldTorqueAndWarns) {
  const Vector torque = test::held(test::multisine(kSamples, 1000.0, 5.0), 10.0);
  const Recording same = at_own_samples(recording_of("torque_1", torque));
  EXPECT_EQ(same.channels[0].values, torque);
  ASSERT_THAT(same.warnings, SizeIs(1));
  EXPECT_EQ(same.warnings[0].code, WarningCode::held_signal);
}

TEST(FindUpdates, LeavesReferencesAlone) {
  const Recording recording = recording_of("reference_x", test::held(test::multisine(kSamples, 1000.0, 5.0), 10.0));
  EXPECT_EQ(recording.channels[0].updates.staleness, Staleness::none);
}

}  // namespace own_samples_test
}  // namespace mbk::recording
