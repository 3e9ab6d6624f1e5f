#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "mbk/laboratory/scenario.h"

namespace mbk::laboratory {
namespace {

using perturbation::Schedule;

PerturbationPlan sines(const MultisinePlan& plan = {}) {
  return {plan, {}};
}

Schedule made(const PerturbationPlan& plan, std::uint64_t seed = 1) {
  auto schedule = make_schedule(plan, seed);
  EXPECT_TRUE(schedule) << schedule.error().line();
  return *schedule;
}

/// Values of both axes over the second period, when they have moved in.
Matrix period(const Schedule& schedule) {
  Matrix values(10000, 2);
  for (Index i = 0; i < values.rows(); ++i) {
    values.row(i) = schedule.at(10.0 + 1e-3 * static_cast<double>(i)).value.transpose();
  }
  return values;
}

TEST(MakeSchedule, EachAxisReachesItsPeak) {
  for (const auto phases : {MultisinePlan::Phases::random, MultisinePlan::Phases::schroeder}) {
    MultisinePlan plan;
    plan.phases = phases;
    plan.peak = 0.02;
    const Vector largest = period(made(sines(plan))).cwiseAbs().colwise().maxCoeff().transpose();
    EXPECT_NEAR(largest[0], 0.02, 2e-6);
    EXPECT_NEAR(largest[1], 0.02, 2e-6);
  }
}

TEST(MakeSchedule, IsTheSameForTheSameSeedAlone) {
  EXPECT_EQ(period(made(sines(), 4)), period(made(sines(), 4)));
  EXPECT_NE(period(made(sines(), 4)), period(made(sines(), 5)));
}

TEST(MakeSchedule, PhasesOfLowCrestPutMorePowerUnderTheSamePeak) {
  MultisinePlan random, low;
  low.phases = MultisinePlan::Phases::low_crest;
  const double before = period(made(sines(random))).squaredNorm(), after = period(made(sines(low))).squaredNorm();
  EXPECT_GT(after, 1.3 * before);
}

TEST(MakeSchedule, InterleavedAxesAreUncorrelated) {
  MultisinePlan plan;
  plan.axes = MultisinePlan::Axes::interleaved;
  const Matrix values = period(made(sines(plan)));
  const double together = values.col(0).dot(values.col(1));
  EXPECT_LT(std::abs(together), 1e-9 * values.squaredNorm());
}

TEST(MakeSchedule, HadamardPairDiffersInTheSignOfTheSecondAxis) {
  MultisinePlan first, second;
  first.axes = MultisinePlan::Axes::hadamard_first;
  second.axes = MultisinePlan::Axes::hadamard_second;
  const Matrix a = period(made(sines(first), 7)), b = period(made(sines(second), 7));
  EXPECT_EQ(a.col(0), b.col(0));
  EXPECT_EQ(a.col(1), -b.col(1));
}

TEST(MakeSchedule, OptimalPowerGoesToTheEndsOfTheBand) {
  MultisinePlan plan;
  plan.optimal_power.emplace();
  const Matrix values = period(made(sines(plan)));
  const auto power_at = [&](int harmonic) {
    std::complex<double> sum = 0.0;
    for (Index i = 0; i < values.rows(); ++i) {
      const double angle = 2.0 * std::numbers::pi * harmonic * static_cast<double>(i) / 10000.0;
      sum += values(i, 0) * std::complex<double>(std::cos(angle), std::sin(angle));
    }
    return std::norm(sum);
  };
  EXPECT_GT(power_at(29), 1.5 * power_at(1));
  EXPECT_GT(power_at(1), 5.0 * power_at(13));
  EXPECT_GT(power_at(13), 0.0);
}

TEST(MakeSchedule, SaysWhichLimitIsBroken) {
  PerturbationPlan plan = sines();
  plan.limits.speed = 0.01;
  const auto outcome = make_schedule(plan, 1);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().where, "perturbation");
  EXPECT_NE(outcome.error().message.find("0.01"), std::string::npos) << outcome.error().message;
}

}  // namespace
}  // namespace mbk::laboratory
