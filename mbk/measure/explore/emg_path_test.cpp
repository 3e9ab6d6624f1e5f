#include "mbk/measure/explore/emg_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/measure/explore/parallel_cascade.h"
#include "mbk/measure/explore/test_limb_trials.h"

namespace mbk::explore {
namespace emg_path_test {

constexpr Index kSamples = 5000;  ///< 40 s
const Vector kIntrinsic{{8.0, 40.0, 15.0}};

/// Rectified EMG, of mean 1, of a muscle whose activity changes slowly.
Vector emg_of(const Vector& activity, std::uint64_t seed) {
  numeric::Random random(seed, 23);
  Vector emg(activity.size());
  for (Index i = 0; i < emg.size(); ++i) emg[i] = activity[i] * std::abs(random.normal());
  return emg / emg.mean();
}

Vector slow_activity(std::uint64_t seed) {
  const Vector slow = binary_motion(kSamples, seed, 0.6);
  return (1.0 + 0.8 * slow.array() / slow.cwiseAbs().maxCoeff()).matrix();
}

/// A trial of 5000 samples, 4000 of which identify.
ExplorationTrial trial_with(const Vector& x, const Vector& f, const Matrix& muscles) {
  ExplorationTrial trial = trial_of(x, f, kStep);
  trial.split = 4000;
  trial.muscles = muscles;
  for (Index k = 0; k < muscles.cols(); ++k) {
    trial.muscle_names.push_back("emg_" + std::to_string(k + 1));
    trial.muscle_units.emplace_back("mean");
  }
  return trial;
}

ParallelCascadeEstimate cascade_of(const ExplorationTrial& trial) {
  const auto signals = limb_signals({&trial, 1});
  EXPECT_TRUE(signals);
  auto found = parallel_cascade(*signals);
  EXPECT_TRUE(found);
  return *found;
}

TEST(EmgPath, FindsTheForceOfEachMuscle) {
  const Vector x = binary_motion(kSamples, 1), twitch = reflex_response(1.0, 20.0, 0.02, 60);
  Matrix muscles(kSamples, 2);
  muscles << emg_of(slow_activity(2), 3), emg_of(slow_activity(4), 5);
  const Vector f = convolved(x, kIntrinsic, -1) - 60.0 * convolved(muscles.col(0), twitch, 0) +
                   90.0 * convolved(muscles.col(1), twitch, 0) + 3.0 * coloured_noise(kSamples, 6);
  const auto found = cascade_of(trial_with(x, f, muscles));
  EXPECT_EQ(found.found, DelayedResponse::none) << found.why;
  ASSERT_TRUE(found.emg);
  EXPECT_TRUE(found.emg->explains) << found.emg->why;
  EXPECT_LT(found.emg->p_value, 1e-9);
  ASSERT_EQ(found.emg->muscles.size(), 2u);
  const double gains[] = {60.0, -90.0};  // of F, not of −F
  for (std::size_t k = 0; k < 2; ++k) {
    const Margin& gain = found.emg->muscles[k].gain[0];
    EXPECT_NEAR(gain.value, gains[k] * twitch.sum(), 2.0 * gain.half_width);
    EXPECT_LT(gain.half_width, 10.0);
  }
  ASSERT_EQ(found.emg->shares.size(), 1u);
  EXPECT_GT(found.emg->shares[0].all.vaf, found.shares[0].intrinsic_alone.vaf + 5.0);
  EXPECT_GT(found.emg->shares[0].all.vaf, 95.0);
  EXPECT_EQ(found.emg->shares[0].all.vaf, found.emg->shares[0].intrinsic_and_emg.vaf);
  ASSERT_FALSE(found.emg->coherence.empty());
  const CoherenceBand& slow = found.emg->coherence.front();
  EXPECT_GT(slow.motion_and_emg[0], slow.motion[0] + 0.1);
  EXPECT_LE(slow.motion_and_emg[0], 1.0);
}

TEST(EmgPath, CreditsNoForceToUnrelatedEmg) {
  constexpr int kRuns = 25;
  int credited = 0;
  double added = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const auto seed = static_cast<std::uint64_t>(100 + 10 * run);
    const Vector x = binary_motion(kSamples, seed);
    Matrix muscles(kSamples, 4);
    for (Index k = 0; k < 4; ++k) {
      const auto own = seed + 1 + static_cast<std::uint64_t>(k);
      muscles.col(k) = emg_of(slow_activity(own), own);
    }
    const Vector f = convolved(x, kIntrinsic, -1) + 6.0 * coloured_noise(kSamples, seed);
    const auto found = cascade_of(trial_with(x, f, muscles));
    ASSERT_TRUE(found.emg);
    credited += found.emg->explains ? 1 : 0;
    const CoherenceBand& slow = found.emg->coherence.front();
    added += (slow.motion_and_emg[0] - slow.motion[0]) / kRuns;
  }
  EXPECT_LE(credited, 1);  // at 0.1 %, two of 25 have a chance of 0.03 %
  EXPECT_NEAR(added, 0.0, 0.05);
}

TEST(EmgPath, TakesDriftOfForceAndFatigueForNoEffect) {
  const Vector x = binary_motion(kSamples, 21), time = Vector::LinSpaced(kSamples, 0.0, 1.0);
  const Vector tired = (slow_activity(22).array() * (1.0 + time.array())).matrix();
  const Vector f = convolved(x, kIntrinsic, -1) + 60.0 * time + 3.0 * coloured_noise(kSamples, 23);
  const auto found = cascade_of(trial_with(x, f, emg_of(tired, 24)));
  ASSERT_TRUE(found.emg);
  EXPECT_FALSE(found.emg->explains) << found.emg->why;
  EXPECT_TRUE(found.emg->muscles[0].gain.empty());
}

TEST(EmgPath, IsNoCauseOfTheForceThatItFollows) {
  const Vector x = binary_motion(kSamples, 31), earlier = emg_of(slow_activity(32), 33);
  Vector emg = Vector::Zero(kSamples);
  emg.tail(kSamples - 25) = earlier.head(kSamples - 25);  // 200 ms
  const Vector f = convolved(x, kIntrinsic, -1) + 90.0 * convolved(earlier, reflex_response(1.0, 20.0, 0.02, 60), 0) +
                   3.0 * coloured_noise(kSamples, 34);
  const auto found = cascade_of(trial_with(x, f, emg));
  ASSERT_TRUE(found.emg);
  EXPECT_FALSE(found.emg->explains);
  EXPECT_NE(found.emg->why.find("follows"), std::string::npos) << found.emg->why;
}

TEST(EmgPath, TellsForceThatTheReflexPathWouldExplainToo) {
  const Vector x = binary_motion(kSamples, 7), stretch = velocity_of(x).cwiseMax(0.0);
  Vector delayed = Vector::Zero(kSamples);  // EMG follows the stretch by 40 ms, force the EMG
  delayed.tail(kSamples - 5) = stretch.head(kSamples - 5);
  const Vector emg = emg_of((0.2 + 2.0 * delayed.array() / delayed.maxCoeff()).matrix(), 8);
  const Vector f = convolved(x, kIntrinsic, -1) + 40.0 * convolved(emg, reflex_response(1.0, 25.0, 0.02, 60), 0) +
                   3.0 * coloured_noise(kSamples, 9);
  const auto found = cascade_of(trial_with(x, f, emg));
  ASSERT_EQ(found.found, DelayedResponse::reflex) << found.why;
  ASSERT_TRUE(found.emg);
  EXPECT_TRUE(found.emg->explains);
  EXPECT_GT(found.emg->shares[0].intrinsic_and_emg.vaf, found.shares[0].both.vaf);
  EXPECT_LT(std::abs(found.emg->shares[0].all.vaf - found.emg->shares[0].intrinsic_and_emg.vaf), 1.0);
}

TEST(EmgPath, RefusesMoreMusclesThanTheRowsTellApart) {
  const Vector x = binary_motion(kSamples, 1);
  Matrix muscles(kSamples, 12);
  for (Index k = 0; k < 12; ++k) muscles.col(k) = emg_of(slow_activity(2), static_cast<std::uint64_t>(k + 1));
  const auto found = cascade_of(trial_with(x, convolved(x, kIntrinsic, -1) + coloured_noise(kSamples, 2), muscles));
  ASSERT_TRUE(found.emg);
  EXPECT_FALSE(found.emg->explains);
  EXPECT_NE(found.emg->why.find("12 muscles"), std::string::npos);
  EXPECT_TRUE(found.emg->shares.empty());
}

TEST(EmgPath, LeavesTheOtherPathsAsTheyAre) {
  const Vector x = binary_motion(kSamples, 1);
  const Vector f = convolved(x, kIntrinsic, -1) + coloured_noise(kSamples, 2);
  const auto without = cascade_of(trial_with(x, f, Matrix()));
  const auto with = cascade_of(trial_with(x, f, emg_of(slow_activity(3), 4)));
  EXPECT_FALSE(without.emg);
  EXPECT_EQ(with.intrinsic_vaf, without.intrinsic_vaf);
  EXPECT_EQ(with.shares[0].intrinsic_alone.vaf, without.shares[0].intrinsic_alone.vaf);
}

}  // namespace emg_path_test
}  // namespace mbk::explore
