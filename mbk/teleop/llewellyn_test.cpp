#include "mbk/teleop/llewellyn.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "mbk/base/numeric/random.h"
#include "mbk/teleop/test_networks.h"

namespace mbk::teleop {
namespace {

using enum StabilityCondition;

const StabilityOutcome& outcome(const AbsoluteStability& stability, StabilityCondition condition) {
  return stability.conditions[static_cast<std::size_t>(condition)];
}

/// The conditions that are violated.
std::vector<StabilityCondition> violated(const AbsoluteStability& stability) {
  std::vector<StabilityCondition> found;
  for (const StabilityOutcome& one : stability.conditions) {
    if (!one.violated.empty()) found.push_back(one.condition);
  }
  return found;
}

TEST(Llewellyn, OfTheIdealTeleoperatorIsMarginalEverywhere) {
  const AbsoluteStability ideal = llewellyn(two_port(Form::h, {{{{0}, {1}}, {{1}, {1}}, {{-1}, {1}}, {{0}, {1}}}}));
  EXPECT_EQ(ideal.verdict, StabilityVerdict::marginal);
  EXPECT_TRUE(ideal.touches_everywhere);
  // and with the other sign, V₁ = V₂ with I₁ = I₂, it feeds itself
  const AbsoluteStability turned = llewellyn(two_port(Form::h, {{{{0}, {1}}, {{1}, {1}}, {{1}, {1}}, {{0}, {1}}}}));
  EXPECT_THAT(violated(turned), testing::Contains(product));
}

TEST(Llewellyn, OfPositionPositionWithoutDampingNeedsEqualTimeConstants) {
  for (const auto& [k_s, expected] : {std::pair{200, StabilityVerdict::marginal},
                                      {210, StabilityVerdict::unstable},
                                      {190, StabilityVerdict::unstable}}) {
    EXPECT_EQ(llewellyn(*position_position(0, 0, 10, 100, 20, k_s).equations().at(0)).verdict, expected) << k_s;
  }
}

TEST(Llewellyn, OfPositionForceFailsForEveryGain) {
  for (const Rational& gain : {Rational(1, 1'000'000), Rational(1, 2), Rational(1), Rational(3)}) {
    const Teleoperator teleoperator = position_force(gain);
    const AbsoluteStability stability = llewellyn(*teleoperator.equations().at(0));
    EXPECT_THAT(violated(stability), testing::ElementsAre(squares)) << gain;
    EXPECT_TRUE(std::isinf(outcome(stability, squares).violated.back().high.value));
  }
  EXPECT_TRUE(llewellyn(*position_force(0).equations().at(0)).holds());
}

TEST(Llewellyn, FindsTheNarrowResonanceThatAGridMisses) {
  const TwoPort network = narrow_resonance();
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 100; ++i) {
    const double omega = std::pow(10.0, -1.0 + 4.0 * i / 99.0);
    smallest = std::min(smallest, condition_values(network.matrix(RadPerSec(omega))).r11);
  }
  EXPECT_NEAR(smallest, 0.9995, 5e-5);

  const AbsoluteStability stability = llewellyn(network);
  EXPECT_EQ(stability.verdict, StabilityVerdict::unstable);
  ASSERT_EQ(outcome(stability, resistance_1).violated.size(), 1u);
  const ViolatedBand& band = outcome(stability, resistance_1).violated.front();
  // r₁₁ = 1 − 1.01 (ω/50)²/((100 − ω²)² + (ω/50)²) is zero at |100 − ω²| = √0.01 ω/50
  EXPECT_NEAR(band.low.value, -0.001 + std::sqrt(100.0 + 1e-6), 1e-9);
  EXPECT_NEAR(band.high.value, 0.001 + std::sqrt(100.0 + 1e-6), 1e-9);
  EXPECT_NEAR(band.worst.value, 10.0, 1e-5);
  EXPECT_NEAR(band.value, -0.01, 1e-6);
}

TEST(Llewellyn, NamesEntriesWithPolesOnTheRight) {
  const AbsoluteStability stability =
      llewellyn(two_port(Form::z, {{{{5}, {1}}, {{1}, {1, -1}}, {{0}, {1}}, {{5}, {1}}}}));
  EXPECT_THAT(violated(stability), testing::ElementsAre(right_poles));
  EXPECT_THAT(outcome(stability, right_poles).violated.front().detail,
              AllOf(testing::HasSubstr("z12"), testing::HasSubstr("s = 1")));
}

TEST(Llewellyn, AsksForSimplePolesOnTheAxisWithPositiveResidues) {
  for (const Entry& z11 : {Entry{{1}, {1, 0, 0}}, Entry{{-1}, {1, 0}}, Entry{{-1, 0}, {1}}, Entry{{1, 0, 0}, {1}},
                           Entry{{-1, 0}, {1, 0, 4}}}) {
    const AbsoluteStability stability = llewellyn(two_port(Form::z, {{z11, {{0}, {1}}, {{0}, {1}}, {{1}, {1}}}}));
    EXPECT_THAT(violated(stability), testing::Contains(axis_poles));
  }
}

TEST(Llewellyn, AsksForJointResiduesThatTheTheoremDoesNotName) {
  // every condition of theorem 4.1 holds, and a free port 2 makes port 1 a spring of 1 − 2·2 < 0
  for (const Entry& spring : {Entry{{1}, {1, 0}}, Entry{{1, 0}, {1}}, Entry{{1, 0}, {1, 0, 9}}}) {
    Entry twice = spring;
    for (double& c : twice.numerator) c *= 2.0;
    const TwoPort weak = two_port(Form::z, {{spring, twice, twice, spring}});
    EXPECT_THAT(violated(llewellyn(weak)), testing::ElementsAre(axis_poles));
    const TwoPort strong = two_port(Form::z, {{twice, spring, spring, twice}});
    EXPECT_TRUE(llewellyn(strong).holds());
  }
}

TEST(Llewellyn, NeverCallsAPassiveTwoPortUnstableInAnyForm) {
  numeric::Random random(20130401);
  for (int trial = 0; trial < 25; ++trial) {
    const TwoPort passive = random_passive(random);
    for (const Form form : kForms) {
      const auto converted = convert(passive, form);
      ASSERT_TRUE(converted) << trial << word_of(form) << converted.error().line();
      EXPECT_TRUE(llewellyn(*converted).holds()) << "trial " << trial << " as " << word_of(form);
      EXPECT_TRUE(is_absolutely_stable(*converted));
    }
  }
}

TEST(Llewellyn, AgreesWithADenseGridAndInEveryForm) {
  numeric::Random random(7);
  int stable = 0, unstable = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const TwoPort network = random_near_passive(random);
    const AbsoluteStability stability = llewellyn(network);
    (stability.holds() ? stable : unstable) += 1;
    EXPECT_EQ(stability.holds(), is_absolutely_stable(network)) << trial;
    bool grid_holds = true;
    constexpr double kRounding = 1e-9;
    for (int i = 0; i < 2000; ++i) {
      const ConditionValues values =
          condition_values(network.matrix(RadPerSec(std::pow(10.0, -3.0 + 6.0 * i / 1999.0))));
      grid_holds = grid_holds && values.r11 > -kRounding && values.r22 > -kRounding && !(values.third < -kRounding);
    }
    EXPECT_TRUE(grid_holds || !stability.holds()) << trial;
    for (const StabilityCondition condition : {resistance_1, resistance_2, squares}) {
      for (const ViolatedBand& band : outcome(stability, condition).violated) EXPECT_LT(band.value, kRounding) << trial;
    }
    for (const Form form : kForms) {
      const auto converted = convert(network, form);
      ASSERT_TRUE(converted) << trial << word_of(form) << converted.error().line();
      EXPECT_EQ(is_absolutely_stable(*converted), stability.holds()) << trial << word_of(form);
    }
  }
  EXPECT_GT(stable, 5);
  EXPECT_GT(unstable, 5);
}

}  // namespace
}  // namespace mbk::teleop
