#include "mbk/measure/analyse/summarise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::analyse {
namespace {

Identification trial(double m, double b, double k, double x0) {
  Identification id;
  id.axes = 1;
  id.model = {Matrix::Constant(1, 1, m), Matrix::Constant(1, 1, b), Matrix::Constant(1, 1, k), Vector::Constant(1, x0)};
  return id;
}

TEST(Summarise, IsTheMeanAndTheDeviationOverTheRootOfTheCount) {
  const Summary summary =
      summarise({trial(1.0, 5.0, 100.0, 0.1), trial(2.0, 5.0, 110.0, 0.1), trial(4.5, 5.0, 150.0, 0.4)}).value();
  EXPECT_EQ(summary.trials, 3);
  EXPECT_DOUBLE_EQ(summary.mean.M(0, 0), 2.5);
  EXPECT_DOUBLE_EQ(summary.mean.K(0, 0), 120.0);
  EXPECT_DOUBLE_EQ(summary.mean.x0[0], 0.2);
  // (2.25 + 0.25 + 4)/2 = 3.25;  (400 + 100 + 900)/2 = 700;  (0.01 + 0.01 + 0.04)/2 = 0.03
  EXPECT_DOUBLE_EQ(summary.between_trial_standard_error.M(0, 0), std::sqrt(3.25 / 3.0));
  EXPECT_DOUBLE_EQ(summary.between_trial_standard_error.K(0, 0), std::sqrt(700.0 / 3.0));
  EXPECT_NEAR(summary.between_trial_standard_error.x0[0], 0.1, 1e-15);
  EXPECT_LE(summary.between_trial_standard_error.B(0, 0), 1e-15);
}

TEST(Summarise, RefusesNoneAndOneTrial) {
  EXPECT_FALSE(summarise({}));
  EXPECT_FALSE(summarise({trial(1.0, 5.0, 100.0, 0.1)}));
}

TEST(Summarise, RefusesTrialsOfDifferentAxesOrUnits) {
  Identification two = trial(1.0, 5.0, 100.0, 0.1);
  two.axes = 2;
  EXPECT_FALSE(summarise({trial(1.0, 5.0, 100.0, 0.1), two}));
  Identification rotation = trial(1.0, 5.0, 100.0, 0.1);
  rotation.motion = Motion::rotation;
  EXPECT_FALSE(summarise({trial(1.0, 5.0, 100.0, 0.1), rotation}));
}

TEST(Summarise, AnUndefinedEquilibriumStaysUndefined) {
  const Summary summary = summarise({trial(1.0, 5.0, 100.0, 0.1), trial(1.0, 5.0, 0.0, std::nan(""))}).value();
  EXPECT_TRUE(std::isnan(summary.mean.x0[0]));
  EXPECT_DOUBLE_EQ(summary.mean.K(0, 0), 50.0);
}

}  // namespace
}  // namespace mbk::analyse
