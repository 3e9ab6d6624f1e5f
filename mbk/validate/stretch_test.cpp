#include "mbk/measure/explore/stretch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/validate/simulated_stretches.h"
#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace stretch_test {

TEST(StretchStudy, RefutesNothingIn60Limbs) {
  const auto table = stretch_study({.runs = 60, .seed = 5});  // `mbk validate stretch` takes more
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "stretch");
  expect_nothing_refuted(*table);
  for (const ValidationRow& row : table->rows) {
    if (row.what == "spastic: called velocity-dependent") {
      EXPECT_GT(row.value, 50.0);
    }
  }
}

/// Put back into its equation: at rest and without noise the torque is elasticity and offset.
TEST(SimulatedStretches, AtRestHaveTheirElasticTorque) {
  StretchedLimb limb;
  limb.offset = 0.2;
  const StretchProtocol protocol;
  const ExplorationTrial trial = stretched_on_average(limb, protocol, {});
  EXPECT_NEAR(trial.output(0, 0), limb.elasticity * std::exp((protocol.from - protocol.to) / 0.4) + limb.offset, 1e-9);
  EXPECT_NEAR(trial.input.maxCoeff(), protocol.to, 1e-3);
}

}  // namespace stretch_test
}  // namespace mbk::validation
