#include "mbk/measure/analyse/energy_blocks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "mbk/base/numeric/random.h"

namespace mbk::analyse {
namespace {

constexpr double kShare = 0.05;
constexpr int kReplicates = 1000;

/// A block of `steps` samples whose energy wanders with a drift.
EnergyBlock wandering(numeric::Random& random, int steps, double drift) {
  std::vector<EnergySums> sums;
  EnergySums sum;
  for (int i = 0; i < steps; ++i) {
    sum.squared_velocity += std::max(0.0, random.uniform(-0.3, 1.0));  // now and then at rest
    sum.absorbed += drift + random.normal();
    sums.push_back(sum);
  }
  return energy_block(0.5, std::move(sums));
}

/// One sample in which E changes by so much.
EnergyBlock block(double absorbed, double squared_velocity = 1.0) {
  return energy_block(2.0, {{squared_velocity, absorbed}});
}

std::vector<EnergyBlock> blocks(const std::vector<double>& absorbed) {
  std::vector<EnergyBlock> all;
  for (const double one : absorbed) all.push_back(block(one));
  return all;
}

EnergyAccount account(const std::vector<EnergyBlock>& all) {
  return account_of(all, true, kShare, kReplicates, 1);
}

TEST(LargestShortage, IsThatOfEverySample) {
  numeric::Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<EnergyBlock> all;
    for (int k = 0; k < 6; ++k) all.push_back(wandering(random, 1 + static_cast<int>(random.below(40)), 0.2));
    std::vector<std::size_t> order(8);
    for (std::size_t& k : order) k = static_cast<std::size_t>(random.below(6));
    // Slow and plain: all sums one after another.
    std::vector<EnergySums> path;
    EnergySums before;
    for (const std::size_t k : order) {
      for (const EnergySums& sum : all[k].sums) {
        path.push_back({before.squared_velocity + sum.squared_velocity, before.absorbed + sum.absorbed});
      }
      before = path.back();
    }
    double largest = -std::numeric_limits<double>::infinity();
    for (const EnergySums& sum : path) {
      if (sum.squared_velocity > 0.0 && sum.squared_velocity >= kShare * before.squared_velocity) {
        largest = std::max(largest, -sum.absorbed / sum.squared_velocity);
      }
    }
    EXPECT_NEAR(largest_shortage(all, order, kShare), largest, 1e-12 * (1.0 + std::abs(largest))) << "trial " << trial;
  }
}

TEST(LargestShortage, IsTheSameWhereTheInsideOfBlocksIsMadeAgain) {
  numeric::Random random(6);
  int made = 0;
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<EnergyBlock> kept, outlined;
    for (int k = 0; k < 6; ++k) {
      kept.push_back(wandering(random, 1 + static_cast<int>(random.below(40)), 0.2));
      outlined.push_back(outline(kept.back(), [sums = kept.back().sums, &made] {
        ++made;
        return sums;
      }));
      EXPECT_TRUE(outlined.back().sums.empty());
    }
    std::vector<std::size_t> order(8);
    for (std::size_t& k : order) k = static_cast<std::size_t>(random.below(6));
    EXPECT_EQ(largest_shortage(outlined, order, kShare), largest_shortage(kept, order, kShare)) << "trial " << trial;
  }
  EXPECT_GT(made, 0);
  EXPECT_LE(made, 100);  // in no order is more than one block cut
}

TEST(LargestShortage, IsFoundOnAHullOfFewSamples) {
  numeric::Random random(4);
  const EnergyBlock one = wandering(random, 2500, 0.1);
  std::size_t vertices = 1;
  for (std::size_t i = 0; one.next[i] != i; i = one.next[i]) ++vertices;
  EXPECT_GT(vertices, 2U);
  EXPECT_LT(vertices, 100U);
}

TEST(LargestShortage, IsNotThatOfTheFirstMoment) {
  // 1000 N·s/m in the first thousandth of the motion, none afterwards
  const std::vector<EnergyBlock> all = {energy_block(1.0, {{0.001, -1.0}, {0.5, 1.0}, {1.0, 2.0}})};
  EXPECT_DOUBLE_EQ(largest_shortage(all, {0}, kShare), -2.0);
  EXPECT_DOUBLE_EQ(largest_shortage(all, {0}, 1e-6), 1000.0);
}

TEST(LargestShortage, OfALimbAtRestIsNone) {
  EXPECT_TRUE(std::isnan(largest_shortage({energy_block(1.0, {{0.0, 0.0}})}, {0}, kShare)));
}

TEST(Account, AddsUpAndKeepsTheSign) {
  const EnergyAccount one = account({block(1.0, 2.0), block(-4.0, 1.0), block(2.0, 1.0)});
  EXPECT_DOUBLE_EQ(one.duration, 6.0);
  EXPECT_DOUBLE_EQ(one.absorbed, -1.0);
  EXPECT_DOUBLE_EQ(one.mean_power, -1.0 / 6.0);
  EXPECT_DOUBLE_EQ(one.squared_velocity, 4.0);
  EXPECT_DOUBLE_EQ(one.shortage_at_end, 0.25);
  EXPECT_DOUBLE_EQ(one.shortage_largest, 1.0);  // 3 J generated after 3 m²/s
  EXPECT_EQ(one.blocks, 3);
  EXPECT_LT(account(blocks({1.0, 2.0})).shortage_at_end, 0.0);  // an excess
}

TEST(Verdict, IsThatOfTheBounds) {
  EXPECT_EQ(account(blocks({1, 2, 1, 3, 2, 1})).verdict, Verdict::passive);
  EXPECT_EQ(account(blocks({-1, -2, -1, -3, -2, -1})).verdict, Verdict::active);
  EXPECT_EQ(account(blocks({1, -2, 1, -1, 2, -0.5})).verdict, Verdict::undecided);
}

TEST(Verdict, NeverContradictsTheIntervalThatStandsBesideIt) {
  numeric::Random random(11);
  int decided = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> energies;
    for (int k = 0; k < 8; ++k) energies.push_back(random.uniform(-1.0, 1.0) + random.normal());
    const EnergyAccount one = account(blocks(energies));
    const bool above = one.absorbed95.first > 0.0, below = one.absorbed95.second < 0.0;
    EXPECT_EQ(one.verdict, above ? Verdict::passive : below ? Verdict::active : Verdict::undecided);
    decided += one.verdict == Verdict::undecided ? 0 : 1;
  }
  EXPECT_GT(decided, 0);
}

TEST(Verdict, OfFewBlocksIsUndecided) {
  const EnergyAccount five = account(blocks({1, 1.1, 0.9, 1.2, 1}));
  EXPECT_EQ(five.verdict, Verdict::undecided);  // that five agree happens by chance in 3 %
  EXPECT_TRUE(std::isnan(five.absorbed95.first));
  EXPECT_NE(five.reason, "");
}

TEST(Intervals, AreTheSameWithTheSameSeed) {
  const std::vector<EnergyBlock> all = blocks({1, 2, -1, 3, 2, 1, 4});
  const EnergyAccount a = account_of(all, true, kShare, kReplicates, 5),
                      b = account_of(all, true, kShare, kReplicates, 5),
                      other = account_of(all, true, kShare, kReplicates, 6);
  EXPECT_EQ(a.absorbed95, b.absorbed95);
  EXPECT_EQ(a.shortage_largest95, b.shortage_largest95);
  EXPECT_NE(a.mean_power95, other.mean_power95);
}

TEST(Intervals, AreNestedAboutTheEnergyAndConsistentWithTheShortage) {
  const EnergyAccount one = account(blocks({1, 2, -1, 3, 2, 1, 4}));
  EXPECT_LT(one.absorbed95.first, one.lower95);
  EXPECT_LT(one.lower95, one.absorbed);
  EXPECT_LT(one.absorbed, one.upper95);
  EXPECT_LT(one.upper95, one.absorbed95.second);
  // With the same ∫ v·v dt in each block, λ is −E over it.
  EXPECT_NEAR(one.shortage_at_end95.first, -one.absorbed95.second / 7.0, 1e-9);
  EXPECT_NEAR(one.shortage_at_end95.second, -one.absorbed95.first / 7.0, 1e-9);
}

/// Share of trials in which the one-sided bounds hold the mean of `count` normal blocks.
double coverage(int count, int trials, bool lower) {
  int held = 0;
  for (int trial = 0; trial < trials; ++trial) {
    numeric::Random random(static_cast<std::uint64_t>(trial), 9);
    std::vector<double> energies;
    for (int k = 0; k < count; ++k) energies.push_back(1.0 + random.normal());
    const EnergyAccount one = account_of(blocks(energies), true, kShare, 400, 1);
    held += lower ? one.lower95 < count : one.upper95 > count;
  }
  return static_cast<double>(held) / trials;
}

TEST(Intervals, HoldTheTruthAsOftenAsTheySay) {
  // 1000 trials leave 95 % within ±2.1 points (three deviations); percentiles keep a point less.
  for (const int count : {6, 16}) {
    for (const bool lower : {false, true}) {
      const double share = coverage(count, 1000, lower);
      EXPECT_GT(share, 0.92) << count;
      EXPECT_LT(share, 0.975) << count;
    }
  }
}

}  // namespace
}  // namespace mbk::analyse
