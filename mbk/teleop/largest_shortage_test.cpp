#include "mbk/teleop/largest_shortage.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mbk/teleop/admissible.h"
#include "mbk/teleop/llewellyn.h"
#include "mbk/teleop/test_networks.h"

namespace mbk::teleop {
namespace largest_shortage_test {

constexpr double kWidth = 0x1p-49;  // of two brackets of 2⁻⁵⁰ each

bool holds(const PortEquations& equations, Port port, const Rational& a) {
  const auto two_port = equations.with_shortage(port, Polynomial{a}).at(0);
  return two_port && is_absolutely_stable(*two_port);
}

/// By nothing but halving between decisions of single values.
LargestShortage bisected(const PortEquations& equations, Port port) {
  LargestShortage result;
  result.port = static_cast<int>(port);
  constexpr int kDoublings = 64;
  Rational low = -1, high = 1;
  for (int i = 0; !holds(equations, port, low); ++i) {
    if (i == kDoublings) return result;
    high = low;
    low = 2 * low;
  }
  for (int i = 0; holds(equations, port, high); ++i) {
    if (i == kDoublings) return result;
    low = high;
    high = 2 * high;
  }
  const Rational finest = std::max<Rational>(abs(high), 1) / Rational(1ULL << 50U);
  while (high - low > finest) {
    const Rational quarter = (high - low) / 4;
    const Rational middle = lti::simplest_between(low + quarter, high - quarter);
    (holds(equations, port, middle) ? low : high) = middle;
  }
  result.exists = true;
  result.at_least = lti::to_double(low);
  result.at_most = lti::to_double(high);
  return result;
}

void expect_the_same(const PortEquations& equations, Port port, const std::string& name) {
  const LargestShortage found = largest_shortage(equations, port), slow = bisected(equations, port);
  ASSERT_EQ(found.exists, slow.exists) << name;
  const double tolerance = kWidth * std::max(1.0, 2.0 * std::abs(slow.value()));
  EXPECT_NEAR(found.at_least, slow.at_least, tolerance) << name;
  EXPECT_NEAR(found.at_most, slow.at_most, tolerance) << name;
}

TEST(LargestShortage, IsThatOfTheBisectionForRandomNetworks) {
  numeric::Random random(7);
  int exist = 0;
  for (int trial = 0; trial < 6; ++trial) {
    const TwoPort z = trial % 3 == 0 ? random_passive(random) : random_near_passive(random);
    for (const Port port : {Port::one, Port::two}) {
      const PortEquations equations = PortEquations::of(z);
      expect_the_same(equations, port, fmt::format("trial {}, port {}", trial, static_cast<int>(port)));
      exist += largest_shortage(equations, port).exists ? 1 : 0;
    }
  }
  EXPECT_GT(exist, 4);
}

TEST(LargestShortage, IsThatOfTheBisectionForTeleoperators) {
  Teleoperator delayed = position_position(3, 5, 10, 100, 20, 200);
  delayed.values.insert({{"delay.to_slave", {1, 200}}, {"delay.to_master", {1, 200}}});
  delayed.pade_order = 1;
  for (const auto& [name, teleoperator] : {std::pair{"delayed", delayed},
                                           {"two sides", position_position(1, 1, 10, 100, 20, 300)},
                                           {"undamped", position_position(0, 0, 10, 100, 20, 200)},
                                           {"never", position_position(0, 0, 10, 100, 20, 210)},
                                           {"position-force", position_force({1, 10})}}) {
    for (const Port port : {Port::one, Port::two}) expect_the_same(teleoperator.equations(), port, name);
  }
}

TEST(LargestShortage, IsThatOfTheBisectionWhereNoImpedanceExists) {
  // the ideal teleoperator as h; a spring and a damper between the ports as y
  const TwoPort ideal = two_port(Form::h, {{{{0}, {1}}, {{1}, {1}}, {{-1}, {1}}, {{0}, {1}}}});
  const TwoPort link = two_port(Form::y, {{{{1, 0}, {2, 5}}, {{-1, 0}, {2, 5}}, {{-1, 0}, {2, 5}}, {{1, 0}, {2, 5}}}});
  const TwoPort cut = two_port(Form::y, {{{{0}, {1}}, {{0}, {1}}, {{1}, {1}}, {{1}, {1}}}});
  for (const auto& [name, network] : {std::pair{"ideal", ideal}, {"link", link}, {"cut", cut}}) {
    for (const Port port : {Port::one, Port::two}) expect_the_same(PortEquations::of(network), port, name);
  }
}

TEST(LargestShortage, SeesAMinimumBesideADeeperOneAndBelowEveryGrid) {
  // r₁₁ dips by 1.01 within 0.02 rad/s at 10 rad/s, and by 1 within 40 rad/s at 100 rad/s
  const TwoPort z = two_port(Form::z, {{{{3}, {1}}, {{0}, {1}}, {{0}, {1}}, {{1}, {1}}}});
  TwoPort dips = z;
  dips.matrix(0, 0) =
      dips.matrix(0, 0) + narrow_resonance().matrix(0, 0) + lti::RationalFunction::of({0, -40}, {10000, 40, 1}).value();
  const LargestShortage largest = largest_shortage(PortEquations::of(dips), Port::one);
  ASSERT_TRUE(largest.exists);
  EXPECT_LT(largest.value(), 3.0 - 0.01);
  expect_the_same(PortEquations::of(dips), Port::one, "dips");
}

TEST(LargestShortage, OfPositionPositionIsTheClosedForm) {
  // with k_s/k_m = d_s/d_m: b_s + d_s b_m/(b_m + d_m)
  const PortEquations equations = position_position(2, 3, 10, 100, 20, 200).equations();
  const LargestShortage two = largest_shortage(equations, Port::two), one = largest_shortage(equations, Port::one);
  EXPECT_NEAR(two.value(), 19.0 / 3.0, 1e-13);
  EXPECT_LE(two.at_least, 19.0 / 3.0 + 1e-15);
  EXPECT_NEAR(one.value(), 2.0 + 10.0 * 3.0 / 23.0, 1e-13);
}

TEST(LargestShortage, IsTheEndOfTheAdmissibleSetOfA) {
  const Teleoperator t = position_position(1, 1, 10, 100, 20, 300);
  const LargestShortage largest = largest_shortage(t.equations(), Port::two);
  const auto set = admissible_set(t.equations().with_shortage(Port::two, Polynomial{0, 1}), -100, 100);
  ASSERT_TRUE(set) << set.error().line();
  ASSERT_EQ(set->intervals.size(), 1u);
  EXPECT_EQ(set->intervals[0].low.value, -100.0);
  EXPECT_NEAR(set->intervals[0].high.value, largest.value(), 1e-12);
}

TEST(LargestShortage, DoesNotExistWhereNoExcessHelps) {
  EXPECT_FALSE(largest_shortage(PortEquations::of(narrow_resonance()), Port::two).exists);
  EXPECT_NEAR(largest_shortage(PortEquations::of(narrow_resonance()), Port::one).value(), -0.01, 1e-12);
}

}  // namespace largest_shortage_test
}  // namespace mbk::teleop
