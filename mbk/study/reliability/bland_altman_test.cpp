#include "mbk/study/reliability/bland_altman.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::reliability {
namespace bland_altman_test {

TEST(ToleranceFactor, IsThatOfTheTables) {
  // Odeh (1978); ISO 16269-6, 95 % of the population with 95 % confidence, mean and standard deviation unknown
  EXPECT_NEAR(tolerance_factor(10, 0.95, 0.95), 3.393, 6e-4);
  EXPECT_NEAR(tolerance_factor(20, 0.95, 0.95), 2.760, 6e-4);
  EXPECT_NEAR(tolerance_factor(30, 0.95, 0.95), 2.555, 6e-4);
  EXPECT_NEAR(tolerance_factor(1'000'000, 0.95, 0.95), numeric::kNormal95, 5e-3);
}

/// The intervals against plain counting: of samples, how many intervals hold the limit, and tolerances 95 %?
TEST(BlandAltman, HoldsTheLimitsAsOftenAsItSays) {
  constexpr int kPeople = 8, kStudies = 1000;
  constexpr double kBias = 3.0, kSpread = 2.0;
  numeric::Random random(17);
  int upper = 0, lower = 0, bias = 0, content = 0;
  for (int study = 0; study < kStudies; ++study) {
    Vector first(kPeople), second(kPeople);
    for (Index i = 0; i < kPeople; ++i) {
      first[i] = 100.0 + 20.0 * random.normal();
      second[i] = first[i] + kBias + kSpread * random.normal();
    }
    const auto found = bland_altman(first, second);
    ASSERT_TRUE(found);
    const auto holds = [](const Interval& interval, double x) { return interval.first <= x && x <= interval.second; };
    upper += holds(found->upper.interval95, kBias + 1.96 * kSpread) ? 1 : 0;
    lower += holds(found->lower.interval95, kBias - 1.96 * kSpread) ? 1 : 0;
    bias += holds(found->bias95, kBias) ? 1 : 0;
    const auto below = [&](double x) { return numeric::normal_probability((x - kBias) / kSpread); };
    content += below(found->tolerance95.second) - below(found->tolerance95.first) >= 0.95 ? 1 : 0;
  }
  for (const int held : {upper, lower, bias, content}) {
    const auto [low, high] = numeric::binomial_interval(held, kStudies, 0.999);
    EXPECT_LE(low, 0.95);
    EXPECT_GE(high, 0.95);
  }
}

TEST(BlandAltman, ShiftsAndScalesWithItsNumbers) {
  const Vector first{{1.0, 2.0, 4.0, 3.0, 6.0, 5.0}}, second{{1.5, 2.5, 3.0, 3.5, 7.0, 5.5}};
  const auto one = bland_altman(first, second), other = bland_altman(10.0 * first, (10.0 * second).array() + 7.0);
  ASSERT_TRUE(one && other);
  constexpr double kQuantiles = 1e-8;
  EXPECT_NEAR(other->upper.interval95.second, 10.0 * one->upper.interval95.second + 7.0, kQuantiles);
  EXPECT_NEAR(other->lower.value, 10.0 * one->lower.value + 7.0, kQuantiles);
  const auto turned = bland_altman(second, first);
  EXPECT_NEAR(turned->lower.interval95.first, -one->upper.interval95.second, kQuantiles);
}

TEST(BlandAltman, SaysWhatItLacks) {
  EXPECT_EQ(bland_altman(Vector::Zero(4), Vector::Ones(4))->support, Support::too_few_people);
  const auto alike = bland_altman(Vector::Zero(6), Vector::Ones(6));
  EXPECT_EQ(alike->support, Support::no_variation);
  EXPECT_EQ(alike->bias, 1.0);
  EXPECT_FALSE(bland_altman(Vector::Zero(4), Vector::Ones(5)));
  EXPECT_FALSE(bland_altman(Vector::Zero(6), Vector::Constant(6, NAN)));
}

}  // namespace bland_altman_test
}  // namespace mbk::reliability
