#include "mbk/simulate/participant/cocontraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace mbk::participant {
namespace {

Cocontraction::Options tense() {
  Cocontraction::Options options;
  options.rest = 0.4;
  options.slope = 0.6;
  return options;
}

TEST(Cocontraction, RelaxedScalesNothingHoweverFastTheHand) {
  Cocontraction relaxed = Cocontraction::create({}, 1e-3).value();
  for (int i = 0; i < 5000; ++i) relaxed.step(0.5);
  EXPECT_EQ(relaxed.stiffness_scale(), 1.0);
  EXPECT_EQ(relaxed.damping_scale(), 1.0);
  EXPECT_EQ(relaxed.voluntary_weight(), 1.0);
}

TEST(Cocontraction, FollowsTheSmoothedSpeedInClosedForm) {
  Cocontraction arm = Cocontraction::create(tense(), 1e-3).value();
  EXPECT_EQ(arm.level(), 0.4);
  for (int i = 0; i < 2000; ++i) arm.step(0.02);
  const double smoothed = 0.02 * (1.0 - std::exp(-2.0 / 2.5));  // exact for a constant speed
  const double level = 0.4 + 0.6 * std::pow(smoothed / 0.03, 2);
  EXPECT_NEAR(arm.level(), level, 1e-12);
  EXPECT_NEAR(arm.stiffness_scale(), 1.0 + 6.0 * level, 1e-11);
  EXPECT_NEAR(arm.damping_scale(), 1.0 + 3.0 * level, 1e-11);
  EXPECT_NEAR(arm.voluntary_weight(), 1.0 - 0.62 * level, 1e-11);
}

TEST(Cocontraction, NeverExceedsOne) {
  Cocontraction arm = Cocontraction::create(tense(), 1e-3).value();
  for (int i = 0; i < 5000; ++i) arm.step(1.0);
  EXPECT_EQ(arm.level(), 1.0);
}

TEST(Cocontraction, RefusesWhatIsNoLevel) {
  Cocontraction::Options options = tense();
  options.rest = 1.2;
  EXPECT_NE(Cocontraction::create(options, 1e-3).error().message.find("1.2"), std::string::npos);
  options = tense();
  options.speed = 0.0;
  EXPECT_FALSE(Cocontraction::create(options, 1e-3));
  EXPECT_FALSE(Cocontraction::create(tense(), 0.0));
}

}  // namespace
}  // namespace mbk::participant
