#include "mbk/measure/identify/missing_dynamics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "mbk/base/core/result.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/identify/test_trials.h"

namespace mbk::identify {
namespace missing_dynamics_test {

using testing_support::arm;
using testing_support::Making;

/// What is added to −F of a row, from its motion and its share of the trial.
using Extra = std::function<Vector(const PreparedTrial&, Index row, double share)>;

constexpr double kBand = 3.5;

PreparedTrial trial_with(const Making& making, const Extra& extra) {
  PreparedTrial trial = testing_support::trial(arm(making.axes), making);
  trial.preparation.band_high = Hertz(kBand);
  trial.preparation.cutoff = Hertz(6.0);
  const Index rows = trial.time.size();
  const Matrix force = trial.force_hand_on_robot;
  for (Index i = 0; i < rows; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(rows);
    trial.force_hand_on_robot.row(i) -= extra(trial, i, share).transpose();
  }
  return trial;
}

Vector nothing(const PreparedTrial& trial, Index /*row*/, double /*share*/) {
  return Vector::Zero(trial.axes);
}

std::vector<AssumptionTest> tested(const PreparedTrial& trial) {
  const auto found = identify_impedance({trial}, Options());
  if (!found) ADD_FAILURE() << found.error().message;
  return found ? found->assumptions : std::vector<AssumptionTest>();
}

const AssumptionTest& about(const std::vector<AssumptionTest>& tests, Assumption assumption) {
  static const AssumptionTest kNone{Assumption::no_tremor};
  const auto found = std::ranges::find(tests, assumption, &AssumptionTest::assumption);
  EXPECT_NE(found, tests.end()) << word_of(assumption);
  return found == tests.end() ? kNone : *found;
}

/// Only that one is contradicted, and it is that large.
void expect_only(const std::vector<AssumptionTest>& tests, Assumption assumption, double size, double tolerance) {
  for (const AssumptionTest& test : tests) {
    EXPECT_EQ(test.contradicted, test.assumption == assumption)
        << word_of(test.assumption) << " p " << test.p_value << " size " << test.size << " shift " << test.shift;
  }
  EXPECT_NEAR(about(tests, assumption).size, size, tolerance);
}

Making quiet() {
  return {.noise = 0.02};
}

TEST(MissingDynamics, NothingIsContradictedWhereTheModelHolds) {
  int alarms = 0;
  constexpr unsigned kTrials = 40;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const auto tests = tested(trial_with({.noise = 0.3, .seed = seed}, nothing));
    EXPECT_EQ(tests.size(), 8U);
    alarms += static_cast<int>(std::ranges::count_if(tests, &AssumptionTest::contradicted));
  }
  EXPECT_LE(alarms, 1);  // 11 of 400 together would be 2.75 %
}

TEST(MissingDynamics, ALateForceIsFoundWithItsDelay) {
  constexpr double kDelay = 0.010;
  const Extra late = [&](const PreparedTrial& trial, Index i, double) {
    // −F(t − τ) − (−F(t)), to first order, with the model's own rate
    const impedance::Model model = arm();
    const Index before = std::max<Index>(0, i - 1), after = std::min<Index>(trial.time.size() - 1, i + 1);
    const Vector jerk = ((trial.acceleration.row(after) - trial.acceleration.row(before)) /
                         (static_cast<double>(after - before) * trial.sample_time))
                            .transpose();
    return Vector(-kDelay * (model.M * jerk + model.B * trial.acceleration.row(i).transpose() +
                             model.K * trial.velocity.row(i).transpose()));
  };
  expect_only(tested(trial_with(quiet(), late)), Assumption::simultaneous, kDelay, 0.0015);
}

TEST(MissingDynamics, HardeningIsFound) {
  const Extra cubic = [](const PreparedTrial& trial, Index i, double) {
    const Vector away = trial.position.row(i).transpose() - (Vector(2) << 0.28, 0.02).finished();
    return Vector(1e6 * away.squaredNorm() * away);
  };
  const auto tests = tested(trial_with(quiet(), cubic));
  EXPECT_TRUE(about(tests, Assumption::linear_stiffness).contradicted);
  EXPECT_GT(about(tests, Assumption::linear_stiffness).size, 0.2);
  EXPECT_FALSE(about(tests, Assumption::constant_stiffness).contradicted);
}

TEST(MissingDynamics, DryFrictionIsFoundWithItsForce) {
  const Extra friction = [](const PreparedTrial& trial, Index i, double) {
    const Vector v = trial.velocity.row(i).transpose();
    return Vector(0.5 * v / std::hypot(v.norm(), 0.005));
  };
  expect_only(tested(trial_with(quiet(), friction)), Assumption::no_dry_friction, 0.5, 0.1);
}

TEST(MissingDynamics, AStiffnessThatChangesIsFoundAtOnceAndAsAWave) {
  const auto with = [](const std::function<double(double)>& factor) -> Extra {
    return [factor](const PreparedTrial& trial, Index i, double share) {
      const Vector away = trial.position.row(i).transpose() - (Vector(2) << 0.28, 0.02).finished();
      return Vector((factor(share) - 1.0) * arm().K * away);
    };
  };
  // × 1.5 in the second half: a standard deviation of 0.25 over a mean of 1.25
  expect_only(tested(trial_with(quiet(), with([](double share) { return share < 0.5 ? 1.0 : 1.5; }))),
              Assumption::constant_stiffness, 0.2, 0.05);
  // ± 50 % at 0.1 Hz in 40 s
  expect_only(tested(trial_with(quiet(), with([](double share) { return 1.0 + 0.5 * std::sin(8.0 * M_PI * share); }))),
              Assumption::constant_stiffness, 0.35, 0.08);
}

TEST(MissingDynamics, ADampingThatChangesIsFound) {
  const Extra doubled = [](const PreparedTrial& trial, Index i, double share) {
    return Vector((share < 0.4 ? 0.0 : 1.0) * arm().B * trial.velocity.row(i).transpose());
  };
  // × 2 at half of the data behind the parameters: a standard deviation of 0.5 over a mean of 1.5
  expect_only(tested(trial_with(quiet(), doubled)), Assumption::constant_damping, 0.33, 0.06);
}

TEST(MissingDynamics, AForceThatRelaxesIsFound) {
  Vector lagging;
  const Extra maxwell = [&lagging](const PreparedTrial& trial, Index i, double) {
    const Vector x = trial.position.row(i).transpose();
    if (i == 0) lagging = x;
    lagging += trial.sample_time / 0.5 * (x - lagging);
    return Vector(0.3 * arm().K * (x - lagging));
  };
  const auto tests = tested(trial_with(quiet(), maxwell));
  EXPECT_TRUE(about(tests, Assumption::no_memory).contradicted);
  EXPECT_FALSE(about(tests, Assumption::alike_both_ways).contradicted);
}

TEST(MissingDynamics, AStiffnessOnOneSideIsFoundAndALittleOfItIsNot) {
  const auto one_sided = [](double share) -> Extra {
    return [share](const PreparedTrial& trial, Index i, double) {
      const Vector away = trial.position.row(i).transpose() - (Vector(2) << 0.28, 0.02).finished();
      return Vector(share * arm().K * away.cwiseAbs());
    };
  };
  EXPECT_TRUE(about(tested(trial_with(quiet(), one_sided(0.6))), Assumption::alike_both_ways).contradicted);
  EXPECT_FALSE(about(tested(trial_with(quiet(), one_sided(0.02))), Assumption::alike_both_ways).contradicted);
}

TEST(MissingDynamics, TheIntervalOfTheEquilibriumHoldsWhatCurvatureShifts) {
  // A force that grows with the square of the displacement, as the geometry of an arm makes one, too small to warn of.
  static constexpr double kCurvature = 2e3;  // [N/m²]
  const Extra curved = [](const PreparedTrial& trial, Index i, double) {
    const double away = trial.position(i, 0) - 0.28;
    return Vector(kCurvature * away * away * Vector::Unit(2, 1));
  };
  Making straight = quiet();
  straight.noise = 0.005;
  const auto without = identify_impedance({trial_with(straight, nothing)}, Options());
  const auto found = identify_impedance({trial_with(straight, curved)}, Options());
  ASSERT_TRUE(without && found);
  EXPECT_FALSE(about(found->assumptions, Assumption::alike_both_ways).contradicted);
  const Vector off = (found->model.x0 - arm().x0).cwiseAbs();
  EXPECT_GT(off[1], 2.0 * without->standard_error.x0[1]);
  EXPECT_LT(off[1], 2.0 * found->standard_error.x0[1]);
  const Index last = found->covariance.rows() - 1;
  EXPECT_DOUBLE_EQ(found->standard_error.x0[1], std::sqrt(found->covariance(last, last)));
}

TEST(MissingDynamics, ADriftIsFoundWithItsHeight) {
  const Extra drift = [](const PreparedTrial&, Index, double share) { return Vector(Vector::Constant(2, -share)); };
  // Behind the parameters stand the first 80 % of the data.
  expect_only(tested(trial_with(quiet(), drift)), Assumption::constant_rest, 0.8, 0.05);
}

TEST(MissingDynamics, OneAxisIsTestedToo) {
  const Extra friction = [](const PreparedTrial& trial, Index i, double) {
    const double v = trial.velocity(i, 0);
    return Vector(Vector::Constant(1, 0.5 * v / std::hypot(v, 0.005)));
  };
  Making one = quiet();
  one.axes = 1;
  expect_only(tested(trial_with(one, friction)), Assumption::no_dry_friction, 0.5, 0.1);
}

TEST(MissingDynamics, TooFewRowsAreNotTested) {
  Making shorter = quiet();
  shorter.samples = 4000;
  EXPECT_TRUE(tested(trial_with(shorter, nothing)).empty());
}

TEST(MissingDynamics, EachIsWarnedOf) {
  const Extra drift = [](const PreparedTrial&, Index, double share) { return Vector(Vector::Constant(2, -share)); };
  const auto found = identify_impedance({trial_with(quiet(), drift)}, Options());
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(std::ranges::count(found->warnings, WarningCode::force_drifts, &Warning::code), 1);
  EXPECT_TRUE(found->usable);
}

}  // namespace missing_dynamics_test
}  // namespace mbk::identify
