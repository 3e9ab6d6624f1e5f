#include "mbk/model/perturbation/schedule_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace mbk::perturbation {
namespace schedule_plan_test {

Plan sines(const MultisinePlan& plan = {}) {
  return {plan, {}};
}

Schedule made(const Plan& plan, std::uint64_t seed = 1) {
  auto schedule = make_schedule(plan, seed);
  EXPECT_TRUE(schedule) << schedule.error().line();
  return *schedule;
}

/// Values of all axes over the second period, when they have moved in.
Matrix period(const Schedule& schedule) {
  Matrix values(10000, schedule.axes());
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

TEST(MakeSchedule, InSpaceEachAxisReachesItsPeakAndInterleavedAxesAreOrthogonal) {
  MultisinePlan plan;
  plan.space = Space::hand;
  plan.peak = 0.02;
  plan.axes = MultisinePlan::Axes::interleaved;
  Plan in_space = sines(plan);
  in_space.axes = 3;
  const Matrix values = period(made(in_space));
  ASSERT_EQ(values.cols(), 3);
  const Matrix products = values.transpose() * values / static_cast<double>(values.rows());
  for (Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(values.col(i).cwiseAbs().maxCoeff(), 0.02, 2e-6) << i;
    for (Index k = 0; k < i; ++k) EXPECT_NEAR(products(i, k), 0.0, 1e-12 * products(i, i)) << i << ' ' << k;
  }
}

TEST(MakeSchedule, InSpaceIndependentAxesShareTheirLinesAndTheFirstTwoAreThoseOfThePlane) {
  Plan in_space = sines();
  in_space.axes = 3;
  const Matrix values = period(made(in_space));
  EXPECT_EQ(values.leftCols(2), period(made(sines())));
  EXPECT_NE(values.col(2), values.col(1));
}

TEST(MakeSchedule, RefusesOrthogonalPairsInSpace) {
  MultisinePlan plan;
  plan.axes = MultisinePlan::Axes::hadamard_first;
  Plan in_space = sines(plan);
  in_space.axes = 3;
  EXPECT_FALSE(make_schedule(in_space, 1));
}

TEST(MakeSchedule, PulsesInSpaceGoInAllDirectionsOfTheCube) {
  Plan in_space;
  in_space.kind = PulsePlan{};
  in_space.axes = 3;
  const Schedule schedule = made(in_space);
  EXPECT_EQ(schedule.axes(), 3);
  EXPECT_EQ(schedule.events().size(), 2u * 2u * 26u);
  EXPECT_EQ(schedule.at(0.0).value, Eigen::Vector3d(0.0, 0.0, 0.0));
  EXPECT_GT(schedule.facts().axis_peak[2], 0.005);
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

TEST(MakeSchedule, HadamardPairDiffersInTheSignOfTheSecondAxis) {
  MultisinePlan first, second;
  first.axes = MultisinePlan::Axes::hadamard_first;
  second.axes = MultisinePlan::Axes::hadamard_second;
  const Matrix a = period(made(sines(first), 7)), b = period(made(sines(second), 7));
  EXPECT_EQ(a.col(0), b.col(0));
  EXPECT_EQ(a.col(1), -b.col(1));
}

/// Share of each harmonic in the power of each axis, which nothing but the harmonics has.
Matrix shares(const MultisinePlan& plan) {
  const Matrix values = period(made(sines(plan)));
  Matrix power(static_cast<Index>(plan.harmonics.size()), 2);
  for (Index k = 0; k < power.rows(); ++k) {
    Eigen::RowVector2cd sum = Eigen::RowVector2cd::Zero();
    for (Index i = 0; i < values.rows(); ++i) {
      const double angle = 2.0 * std::numbers::pi * plan.harmonics[static_cast<std::size_t>(k)] *
                           static_cast<double>(i) / static_cast<double>(values.rows());
      sum += values.row(i) * std::complex<double>(std::cos(angle), std::sin(angle));
    }
    power.row(k) = 2.0 * sum.cwiseAbs2() / static_cast<double>(values.rows());
  }
  return power.array().rowwise() / values.colwise().squaredNorm().array();
}

TEST(MakeSchedule, OptimalPowerIsSharedAmongTheLinesAsItSays) {
  MultisinePlan plan;
  plan.optimal_power.emplace();
  const Vector expected = optimal_power(plan.period, plan.harmonics, *plan.optimal_power)->shares;
  EXPECT_GT(expected.maxCoeff(), 10.0 * expected.minCoeff());
  for (const auto phases : {MultisinePlan::Phases::random, MultisinePlan::Phases::low_crest}) {
    plan.phases = phases;
    const Matrix power = shares(plan);
    for (Index axis = 0; axis < 2; ++axis) EXPECT_LT((power.col(axis) - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(MakeSchedule, PowerIsFlatWithoutARuleForIt) {
  const Matrix power = shares({});
  EXPECT_LT((power.array() - 0.1).abs().maxCoeff(), 1e-12);  // ten lines
}

TEST(MakeSchedule, InterleavedAxesShareNoLine) {
  MultisinePlan plan;
  plan.axes = MultisinePlan::Axes::interleaved;
  const Matrix power = shares(plan);
  EXPECT_LT(power.rowwise().minCoeff().maxCoeff(), 1e-20);
  EXPECT_NEAR(power.col(0).sum(), 1.0, 1e-12);
  EXPECT_NEAR(power.col(1).sum(), 1.0, 1e-12);
}

TEST(MakeSchedule, TakesSeedAndSizeOfPulsesAndSequencesFromPlanAndSeed) {
  PulsePlan pulses;
  RandomBinaryPlan binary;
  binary.angle = std::numbers::pi / 6.0;
  for (const Plan& plan : {Plan{pulses, {}}, Plan{binary, {}}}) {
    EXPECT_EQ(period(made(plan, 3)), period(made(plan, 3)));
  }
  const auto onsets = [&](std::uint64_t seed) { return made({pulses, {}}, seed).events().front().time; };
  EXPECT_NE(onsets(3), onsets(4));
  EXPECT_NEAR(made({pulses, {}}, 3).duration(), made({pulses, {}}, 3).events().back().time + pulses.tail, 1e-12);
  const Matrix along = period(made({binary, {}}, 3));
  EXPECT_LT((along.col(1) * std::cos(binary.angle) - along.col(0) * std::sin(binary.angle)).cwiseAbs().maxCoeff(),
            1e-12);
  EXPECT_GT(along.norm(), 0.0);
  EXPECT_EQ(made({RestPlan{4.0}, {}}).facts().peak, 0.0);
}

TEST(MakeSchedule, SaysWhichLimitIsBroken) {
  Plan plan = sines();
  plan.limits.speed = 0.01;
  const auto outcome = make_schedule(plan, 1);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().where, "perturbation");
  EXPECT_NE(outcome.error().message.find("0.01"), std::string::npos) << outcome.error().message;
}

}  // namespace schedule_plan_test
}  // namespace mbk::perturbation
