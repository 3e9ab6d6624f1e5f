#include "mbk/teleop/delayed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/random.h"
#include "mbk/teleop/llewellyn.h"
#include "mbk/teleop/sampled.h"
#include "mbk/teleop/test_networks.h"

namespace mbk::teleop {
namespace delayed_test {

Teleoperator delayed_pair(int to_slave_ms, int to_master_ms) {
  Teleoperator t = position_position(3, 5, 10, 100, 20, 200);
  t.values.insert_or_assign("master.m", Rational(1, 2));
  t.values.insert_or_assign("slave.m", Rational(4, 5));
  t.values.insert({{"delay.to_slave", {to_slave_ms, 1000}}, {"delay.to_master", {to_master_ms, 1000}}});
  return t;
}

Rational a_of(double value) {
  return lti::exact(value).value();
}

TEST(WithDelay, AgreesWithTheClosedFormWithoutMass) {
  // r11 = b_m + d_m, r22 = b_s + d_s; with k = 0 p = d_m d_s e^(−jωT) is worst where the delay turns once:
  // r11 r22 = d_m d_s at the limit
  for (const auto& [b_m, stable] : {std::pair{Rational(1), true}, {Rational(-1, 100), false}}) {
    Teleoperator t = position_position(b_m, 0, 10, 0, 20, 0);
    t.values.insert({{"delay.to_slave", {1, 20}}, {"delay.to_master", {1, 20}}});
    const auto found = llewellyn_with_delay(t);
    ASSERT_TRUE(found) << found.error().line();
    EXPECT_EQ(found->stability.holds(), stable);
  }
  Teleoperator t = position_position(3, 0, 10, 0, 20, 0);
  t.values.insert({{"delay.to_slave", {1, 20}}, {"delay.to_master", {1, 20}}});
  const auto largest = largest_shortage_with_delay(t, Port::one);
  ASSERT_TRUE(largest);
  ASSERT_TRUE(largest->exists);
  constexpr double kTolerance = 1e-5;  // of the decisions, 1e-6 of terms of that size
  constexpr double kSearch = 0.05;     // it touches at all low frequencies, which ends the search early
  EXPECT_LE(largest->at_least, 3.0 + kTolerance);
  EXPECT_GE(largest->at_least, 3.0 - kSearch);
  EXPECT_NEAR(largest->at_most, 3.0, kTolerance);
}

TEST(WithDelay, AgreesWithADenseGrid) {
  numeric::Random random(3);
  int stable = 0, unstable = 0;
  for (int trial = 0; trial < 24; ++trial) {
    const auto below = [&](unsigned most) { return static_cast<int>(random.below(most)); };
    Teleoperator t = position_position(below(20), below(20), 1 + below(20), below(300), 1 + below(20), below(300));
    t.values.insert_or_assign("master.m", below(3));
    t.values.insert_or_assign("slave.m", below(3));
    t.values.insert(
        {{"delay.to_slave", Rational(1 + below(100), 1000)}, {"delay.to_master", Rational(below(100), 1000)}});
    const auto found = llewellyn_with_delay(t);
    ASSERT_TRUE(found) << trial << found.error().line();
    const auto grid = llewellyn_on_grid(t, {RadPerSec(1e-3), RadPerSec(1e3), 3000});
    ASSERT_TRUE(grid);
    EXPECT_TRUE(grid->holds() || !found->stability.holds()) << trial;
    for (const StabilityOutcome& outcome : found->stability.conditions) {
      for (const ViolatedBand& band : outcome.violated) EXPECT_LT(band.value, 0.0) << trial;
    }
    (found->stability.holds() ? stable : unstable) += 1;
  }
  EXPECT_GT(stable, 3);
  EXPECT_GT(unstable, 3);
}

TEST(WithDelay, FindsAViolationNarrowerThanAGrid) {
  const Teleoperator t = delayed_pair(50, 50);
  const auto largest = largest_shortage_with_delay(t, Port::one);
  ASSERT_TRUE(largest);
  ASSERT_TRUE(largest->exists);
  EXPECT_LT(largest->at_least, largest->at_most);
  EXPECT_LT(largest->at_most - largest->at_least, 1e-4);
  const Rational a = a_of(largest->at_most + 1e-4);
  const auto found = llewellyn_with_delay(t, Port::one, a);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_FALSE(found->stability.holds());
  const StabilityOutcome& squares = found->stability.conditions[5];
  ASSERT_EQ(squares.violated.size(), 1u);
  const ViolatedBand& band = squares.violated.front();
  EXPECT_LT(band.high.value / band.low.value, 1.01);
  EXPECT_LE(band.low, band.worst);
  EXPECT_LE(band.worst, band.high);
  const auto grid = llewellyn_on_grid(t, {RadPerSec(0.01), RadPerSec(1e4), 500}, Port::one, a);
  ASSERT_TRUE(grid);
  EXPECT_TRUE(grid->holds());  // which misses it
  EXPECT_TRUE(llewellyn_with_delay(t, Port::one, a_of(largest->at_least))->stability.holds());
}

TEST(WithDelay, BandsEndWhereTheConditionChangesItsSign) {
  Teleoperator t = delayed_pair(50, 50);
  t.values.insert_or_assign("master.b", Rational(-2));
  const auto found = llewellyn_with_delay(t);
  ASSERT_TRUE(found) << found.error().line();
  const StabilityOutcome& squares = found->stability.conditions[5];
  ASSERT_FALSE(squares.violated.empty());
  for (const ViolatedBand& band : squares.violated) {
    if (!std::isfinite(band.high.value) || band.low.value == 0.0) continue;
    constexpr double kBeside = 1e-5;
    const auto at = [&](double omega) {
      return condition_values(immittance(t.with_exact_delay(RadPerSec(omega)), Form::z)).third;
    };
    EXPECT_GT(at(band.low.value * (1.0 - kBeside)), 0.0);
    EXPECT_LT(at(band.low.value * (1.0 + kBeside)), 0.0);
  }
}

TEST(WithDelay, CoversAllFrequenciesWhereItHolds) {
  const auto found = llewellyn_with_delay(delayed_pair(50, 50));
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_TRUE(found->stability.holds());
  EXPECT_EQ(found->grid.low.value, 0.0);
  EXPECT_TRUE(std::isinf(found->grid.high.value));
  EXPECT_TRUE(found->grid.bounded);
}

TEST(WithDelay, FindsWhatFailsAtVeryHighFrequenciesOnly) {
  Teleoperator t = position_force({1, 1'000'000});
  t.values.insert({{"delay.to_slave", {1, 20}}, {"delay.to_master", {1, 20}}});
  const auto found = llewellyn_with_delay(t);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_FALSE(found->stability.holds());
}

TEST(WithDelay, DependsOnTheSumOfTheDelays) {
  const auto one = llewellyn_with_delay(delayed_pair(80, 20), Port::one, 6);
  const auto other = llewellyn_with_delay(delayed_pair(0, 100), Port::one, 6);
  ASSERT_TRUE(one && other);
  ASSERT_FALSE(one->stability.conditions[5].violated.empty());
  EXPECT_EQ(one->stability.conditions[5].violated.front().low, other->stability.conditions[5].violated.front().low);
}

TEST(WithDelay, RefusesForcesThatFeedThemselves) {
  Teleoperator t = delayed_pair(10, 20);
  t.architecture = Architecture::four_channel;
  t.values.insert({{"channels.force_to_master", 1}, {"channels.force_to_slave", 1}});
  EXPECT_FALSE(llewellyn_with_delay(t));
  EXPECT_FALSE(largest_shortage_with_delay(t, Port::one));
}

}  // namespace delayed_test
}  // namespace mbk::teleop
