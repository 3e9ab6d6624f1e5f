#include "mbk/teleop/admissible.h"

#include <gmock/gmock.h>

#include <cmath>

#include "mbk/teleop/llewellyn.h"
#include "mbk/teleop/test_networks.h"

namespace mbk::teleop {
namespace {

/// Whether the set holds k; k is not an end.
bool contains(const AdmissibleSet& set, double k) {
  return std::ranges::any_of(set.intervals, [&](const auto& i) { return i.low.value <= k && k <= i.high.value; });
}

TEST(AdmissibleSet, OfSlaveStiffnessHasTwoSides) {
  const auto set = admissible_set(position_position(1, 1, 10, 100, 20, 200).equations("slave.k"), 0, 10000);
  ASSERT_TRUE(set) << set.error().line();
  ASSERT_EQ(set->intervals.size(), 1u);
  // 4 (b_m + d_m)(b_s + d_s) k_m k_s = (d_m k_s + d_s k_m)²
  const auto residual = [](double k) { return 4.0 * 11.0 * 21.0 * 100.0 * k - std::pow(10.0 * k + 2000.0, 2); };
  for (const AdmissibleEnd& end : {set->intervals[0].low, set->intervals[0].high}) {
    EXPECT_NEAR(residual(end.value), 0.0, 1e-6) << end.value;
    EXPECT_EQ(end.included, true);
    EXPECT_FALSE(end.limit_of_search);
  }
  EXPECT_NEAR(set->intervals[0].low.value, 92.754616, 1e-6);
  EXPECT_NEAR(set->intervals[0].high.value, 431.245384, 1e-6);
}

TEST(AdmissibleSet, MayBeASingleValue) {
  const auto set = admissible_set(position_position(0, 0, 10, 100, 20, 200).equations("slave.k"), 0, 1000);
  ASSERT_TRUE(set) << set.error().line();
  ASSERT_EQ(set->intervals.size(), 1u);
  EXPECT_EQ(set->intervals[0].low.value, 200.0);
  EXPECT_EQ(set->intervals[0].high.value, 200.0);
  EXPECT_THAT(set->undecided, testing::IsEmpty());
}

TEST(AdmissibleSet, MayBeOneGainOfTheTransparentTeleoperator) {
  Teleoperator t = position_position(1, 2, 10, 100, 20, 300);
  t.architecture = Architecture::four_channel;
  t.values.insert({{"channels.force_to_master", 1},
                   {"channels.force_to_slave", 1},
                   {"channels.to_slave_d", 22},
                   {"channels.to_slave_k", 300},
                   {"channels.to_master_d", 11},
                   {"channels.to_master_k", 100}});
  const auto set = admissible_set(t.equations("channels.force_to_master"), 0, 3);
  ASSERT_TRUE(set) << set.error().line();
  ASSERT_EQ(set->intervals.size(), 1u);
  EXPECT_EQ(set->intervals[0].low.value, 1.0);
  EXPECT_EQ(set->intervals[0].high.value, 1.0);
}

TEST(AdmissibleSet, AgreesWithDecisionsOfSingleValues) {
  Teleoperator delayed = position_position(3, 5, 10, 100, 20, 200);
  delayed.values.insert({{"delay.to_slave", {1, 200}}, {"delay.to_master", {1, 200}}});
  delayed.pade_order = 1;
  const Teleoperator plain = position_position(1, 1, 10, 100, 20, 200);
  for (const auto& [teleoperator, parameter, high] : {std::tuple{plain, "slave.d", 100},
                                                      {plain, "slave.b", 10},
                                                      {plain, "master.k", 1000},
                                                      {delayed, "slave.k", 2000},
                                                      {delayed, "master.b", 10},
                                                      {delayed, "delay.to_slave", 1}}) {
    const auto set = admissible_set(teleoperator.equations(parameter), 0, high);
    ASSERT_TRUE(set) << parameter << set.error().line();
    for (int i = 0; i < 60; ++i) {
      const Rational k(high * (2 * i + 1), 120);
      Teleoperator at = teleoperator;
      at.values.insert_or_assign(parameter, k);
      EXPECT_EQ(contains(*set, lti::to_double(k)), is_absolutely_stable(*at.equations().at(0)))
          << parameter << " " << k;
    }
  }
}

TEST(AdmissibleSet, FollowsPolesAcrossTheAxis) {
  // z₁₁ = 9 + 1/(s² + k s + 1): the pole is on the right for k < 0; at k = 0 on the axis, with a residue of 1/(2j)
  PortEquations equations;
  const ParametricPolynomial d({Polynomial{1}, Polynomial{0, 1}, Polynomial{1}});
  const auto constant = [](int c) { return ParametricPolynomial::of({Rational(c)}); };
  equations.rows[0][0] = constant(-1) * d;
  equations.rows[0][2] = constant(9) * d + constant(1);
  equations.rows[1][1] = constant(-1);
  equations.rows[1][3] = constant(1);
  const auto set = admissible_set(equations, -5, 5);
  ASSERT_TRUE(set) << set.error().line();
  ASSERT_EQ(set->intervals.size(), 1u);
  EXPECT_GT(set->intervals[0].low.value, 0.0);
  for (const Rational& k : {Rational(-1), Rational(0), Rational(1, 50), Rational(1, 10), Rational(1)}) {
    EXPECT_EQ(contains(*set, lti::to_double(k)), is_absolutely_stable(*equations.at(k))) << k;
  }
}

TEST(AdmissibleSet, RefusesARangeThatEndsBeforeItBegins) {
  EXPECT_FALSE(admissible_set(position_position(1, 1, 1, 1, 1, 1).equations("slave.k"), 2, 1));
}

}  // namespace
}  // namespace mbk::teleop
