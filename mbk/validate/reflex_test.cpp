#include <gtest/gtest.h>

#include "mbk/validate/simulated_limbs.h"
#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace reflex_test {

TEST(ReflexStudy, RefutesNothingInAFewRuns) {
  const auto table = reflex_study({.runs = 4, .seed = 3});
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "reflex");
  expect_nothing_refuted(*table);
}

TEST(SimulatedLimb, HasTheForceOfItsMassSpringAndDamper) {
  SimulatedLimb limb;
  limb.M = Matrix::Constant(1, 1, 2.0);
  limb.B = limb.K = Matrix::Zero(1, 1);
  limb.direction = Vector::Ones(1);
  limb.noise = limb.white = 0.0;
  const auto trial = simulate_limb(limb, 4.0, 1000.0, 1);
  const Matrix& x = trial.input;
  for (Index i = 1; i + 1 < x.rows(); ++i) {
    const double acceleration = (x(i + 1, 0) - 2.0 * x(i, 0) + x(i - 1, 0)) / 1e-6;
    ASSERT_NEAR(trial.output(i, 0), 2.0 * acceleration, 2.0);  // of 180 at most: second difference of 1 ms
  }
}

TEST(SimulatedLimb, HasAReflexThatSettlesAtItsGain) {
  SimulatedLimb limb;
  limb.M = limb.B = limb.K = Matrix::Zero(1, 1);
  limb.direction = Vector::Ones(1);
  limb.noise = limb.white = 0.0;
  limb.reflex_gain = Vector::Constant(1, 3.0);
  const auto trial = simulate_limb(limb, 60.0, 1000.0, 1);
  // ∫ of the answer is the gain times the way in the direction of stretch
  double way = 0.0;
  for (Index i = 1; i < trial.input.rows(); ++i) way += std::max(0.0, trial.input(i, 0) - trial.input(i - 1, 0));
  EXPECT_NEAR(trial.output.sum() * 1e-3, 3.0 * way, 0.02 * way);
}

}  // namespace reflex_test
}  // namespace mbk::validation
