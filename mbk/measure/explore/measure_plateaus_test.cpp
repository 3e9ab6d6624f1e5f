#include "mbk/measure/explore/measure_plateaus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mbk/measure/explore/test_ramps.h"

namespace mbk::explore {
namespace measure_plateaus_test {

using testing::Contains;
using testing::IsEmpty;

Result<PlateauStiffness> found_of(const RampsOfLimb& limb, const PlateauOptions& options = {}) {
  const ExplorationTrial trial = ramps_of(limb);
  return plateau_stiffness({&trial, 1}, options);
}

std::vector<WarningCode> judged(PlateauStiffness& found) {
  std::vector<WarningCode> codes;
  for (const Warning& warning : judge_plateaus(found)) codes.push_back(warning.code);
  return codes;
}

TEST(PlateauStiffness, IsKWhereTheHandRests) {
  auto found = found_of({});
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_NEAR((found->fit.K - RampsOfLimb{}.K).norm(), 0.0, 1e-6);  // offset and home subtracted
  EXPECT_EQ(found->fit.displacements, 24);
  EXPECT_NEAR(found->to_s, 0.3, 1e-12);
  EXPECT_NEAR(found->from_s, 0.12, 0.0101);
  EXPECT_LT(found->motion_share, 1e-6);
  EXPECT_EQ(found->left_out, 0);
  EXPECT_THAT(judged(*found), IsEmpty());
  EXPECT_TRUE(found->usable);
}

/// Over a window from 40 to 80 ms the mean force is K x̄ + B Δx/T + M Δẋ/T, all of it along the displacement.
TEST(PlateauStiffness, IsBiasedByInertiaAndDampingInAnEarlyWindowAsInClosedFormAndSaysSo) {
  const RampsOfLimb limb;
  auto found = found_of(limb, {.from_s = 0.04, .to_s = 0.08});
  ASSERT_TRUE(found) << found.error().line();
  const double late = found->plateaus.front().onset_s - limb.pause;  // a ramp that begins flat is seen late
  EXPECT_LT(std::abs(late), 0.003);
  const auto at = [&](double t) { return minimum_jerk_path(t + late, 0.12); };
  double mean = 0.0;
  for (int i = 0; i < 40; ++i) mean += at(0.04 + 0.001 * i)[0] / 40.0;
  const double first = 0.0395, last = 0.0795;  // a sample stands for the millisecond around it
  const double velocity = (at(last)[0] - at(first)[0]) / 0.04, acceleration = (at(last)[1] - at(first)[1]) / 0.04;
  const Matrix biased = limb.K + velocity / mean * limb.B + acceleration / mean * limb.M;
  EXPECT_NEAR((found->fit.K - biased).norm() / biased.norm(), 0.0, 0.005);
  EXPECT_GT((found->fit.K - limb.K).norm(), 1.0 * limb.K.norm());
  EXPECT_GT(found->motion_share, 0.5);
  EXPECT_THAT(judged(*found), Contains(WarningCode::missing_dynamics));
  EXPECT_FALSE(found->usable);
}

TEST(PlateauStiffness, WaitsForAHandThatFollowsLate) {
  auto late = found_of({.hand_ramp = 0.2});
  ASSERT_TRUE(late);
  EXPECT_GT(late->from_s, 0.17);
  EXPECT_THAT(judged(*late), IsEmpty());
  EXPECT_NEAR((late->fit.K - RampsOfLimb{}.K).norm() / RampsOfLimb{}.K.norm(), 0.0, 0.02);
  auto too_late = found_of({.hand_ramp = 0.4});
  ASSERT_TRUE(too_late);
  EXPECT_THAT(judged(*too_late), Contains(WarningCode::missing_dynamics));
  EXPECT_FALSE(too_late->usable);
}

TEST(PlateauStiffness, IsNotUsableWhereTheRobotDoesNotDisplaceTheHand) {
  auto half = found_of({.follows = 0.8});
  ASSERT_TRUE(half);
  EXPECT_THAT(judged(*half), Contains(WarningCode::closed_loop_bias));
  EXPECT_TRUE(half->usable);
  auto hardly = found_of({.follows = 0.3});
  ASSERT_TRUE(hardly);
  EXPECT_THAT(judged(*hardly), Contains(WarningCode::closed_loop_bias));
  EXPECT_FALSE(hardly->usable);
}

TEST(PlateauStiffness, IsNotUsableWhereRampsAreSmallBesideTheNoise) {
  auto found = found_of({.amplitude = 0.0003, .noise = 0.3});
  ASSERT_TRUE(found);
  EXPECT_THAT(judged(*found), Contains(WarningCode::motion_too_small));
  EXPECT_FALSE(found->usable);
}

TEST(PlateauStiffness, SaysWhereOneStiffnessDoesNotHold) {
  // Hardening alone is the same in all directions, and only bends what directions share: here x hardens with y.
  ExplorationTrial trial = ramps_of({.repetitions = 5, .noise = 0.02});
  for (Index i = 0; i < trial.samples(); ++i) {
    const double y = trial.input(i, 1) + 0.05;
    trial.output(i, 0) += 2e4 * y * y;
  }
  auto found = plateau_stiffness({&trial, 1});
  ASSERT_TRUE(found);
  EXPECT_THAT(judged(*found), Contains(WarningCode::nonlinear_stiffness));
}

TEST(PlateauStiffness, NeedsDirectionsHoldsAndRests) {
  EXPECT_FALSE(found_of({.directions = 2, .repetitions = 10}));  // ±x alone
  EXPECT_FALSE(found_of({.directions = 5, .repetitions = 1}));   // too few
  EXPECT_FALSE(found_of({.ramp = 0.3, .hand_ramp = 0.3}));       // nothing is left before 300 ms
  EXPECT_FALSE(found_of({.pause = 0.2}));                        // no baseline
  EXPECT_FALSE(found_of({.hold = 0.1}, {.to_s = 0.4}));          // not held so long
  EXPECT_FALSE(found_of({}, {.from_s = 0.3, .to_s = 0.2}));
  EXPECT_FALSE(found_of({}, {.from_s = -0.1}));
}

TEST(PlateauStiffness, IsNotLookedForWhereTheReferenceIsAForceOrSteps) {
  ExplorationTrial trial = ramps_of({});
  EXPECT_TRUE(is_ramp_and_hold(trial, {}));
  trial.reference_quantity = ReferenceQuantity::force;
  EXPECT_FALSE(is_ramp_and_hold(trial, {}));
  trial.reference.resize(0, 0);
  trial.reference_quantity = ReferenceQuantity::unknown;
  EXPECT_FALSE(is_ramp_and_hold(trial, {}));
}

TEST(PlateauStiffness, PoolsTrialsAndRefusesThoseOfOtherRates) {
  const std::vector<ExplorationTrial> trials = {ramps_of({.noise = 0.1, .seed = 1}),
                                                ramps_of({.noise = 0.1, .seed = 2})};
  const auto both = plateau_stiffness(trials), one = plateau_stiffness({trials.data(), 1});
  ASSERT_TRUE(both && one);
  EXPECT_EQ(both->fit.displacements, 2 * one->fit.displacements);
  EXPECT_LT(both->fit.standard_error.norm(), one->fit.standard_error.norm());
  EXPECT_EQ(both->plateaus.back().recording, 1);
  std::vector<ExplorationTrial> mixed = trials;
  mixed[1].sample_time = 0.002;
  EXPECT_FALSE(plateau_stiffness(mixed));
}

}  // namespace measure_plateaus_test
}  // namespace mbk::explore
