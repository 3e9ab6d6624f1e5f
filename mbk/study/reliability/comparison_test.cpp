#include "mbk/study/reliability/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::reliability {
namespace comparison_test {

const Vector kFirst{{12.1, 9.8, 14.2, 11.0, 13.3, 10.4, 12.9}}, kSecond{{15.0, 13.2, 17.9, 12.2, 16.4}};

/// R 4.2.2, t.test(second, first), and its pt for the noncentrality.
TEST(Difference, OfTwoGroupsIsWelchs) {
  const auto found = difference(kFirst, kSecond, Pairing::unpaired);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value / found->standard_error, 2.480299812494954, 1e-12);
  EXPECT_NEAR(found->degrees_of_freedom, 6.737181081054857, 1e-12);
  EXPECT_NEAR(found->p, 0.043488483357342, 1e-12);
  EXPECT_NEAR(found->interval95.first, 0.116469859617459, 1e-10);
  EXPECT_NEAR(found->interval95.second, 5.849244426096825, 1e-10);
  EXPECT_NEAR(found->effect.d, 1.54718120589415, 1e-12);
  EXPECT_NEAR(found->effect.g, 1.42765466260110, 1e-12);
  EXPECT_NEAR(found->effect.interval95.first, 0.19041941484826, 1e-7);
  EXPECT_NEAR(found->effect.interval95.second, 2.84721865702565, 1e-7);
}

/// R 4.2.2, t.test(second, first, paired = TRUE).
TEST(Difference, OfPairsIsThatOfTheirDifferences) {
  const Vector first{{2.0, 2.5, 3.1, 3.9, 2.0, 2.2}}, second{{3.1, 2.2, 5.0, 4.1, 2.9, 3.3}};
  const auto found = difference(first, second, Pairing::paired);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value / found->standard_error, 2.5962656203193277, 1e-12);
  EXPECT_NEAR(found->p, 0.0484679003239601, 1e-12);
  EXPECT_NEAR(found->interval95.first, 0.0080789464145358, 1e-10);
  EXPECT_NEAR(found->interval95.second, 1.6252543869187974, 1e-10);
}

TEST(Difference, TurnsItsSignWithItsSamples) {
  const auto one = difference(kFirst, kSecond, Pairing::unpaired),
             other = difference(kSecond, kFirst, Pairing::unpaired);
  ASSERT_TRUE(one && other);
  EXPECT_DOUBLE_EQ(one->value, -other->value);
  EXPECT_NEAR(one->effect.interval95.first, -other->effect.interval95.second, 1e-9);
  EXPECT_DOUBLE_EQ(one->p, other->p);
}

TEST(Difference, SaysWhatItLacks) {
  EXPECT_EQ(difference(Vector{{1.0}}, kSecond, Pairing::unpaired)->support, Support::too_few_people);
  EXPECT_EQ(difference(Vector::Ones(3), Vector::Zero(3), Pairing::paired)->support, Support::no_variation);
  EXPECT_FALSE(difference(kFirst, kSecond, Pairing::paired));
  EXPECT_FALSE(difference(Vector{{1.0, NAN}}, kSecond, Pairing::unpaired));
}

/// All 792 by combn() of R 4.2.2.
TEST(Permutation, LooksAtEveryArrangementWhereTheyAreFew) {
  const auto found = permutation_test(kFirst, kSecond, Pairing::unpaired);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->exact);
  EXPECT_EQ(found->arrangements, 792);
  EXPECT_NEAR(found->p, 0.036616161616162, 1e-12);
  EXPECT_EQ(found->smallest_p, 1.0 / 792.0);
}

TEST(Permutation, OfPairsTurnsSigns) {
  // Only all signs alike reach |t|: two of 2⁶.
  const auto found = permutation_test(Vector::Zero(6), Vector{{1.0, 1.1, 0.9, 1.2, 0.8, 1.0}}, Pairing::paired);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->exact);
  EXPECT_DOUBLE_EQ(found->p, 2.0 / 64.0);
}

TEST(Permutation, DrawsWhereTheyAreManyAndAgreesWithTheExactOne) {
  for (const Pairing pairing : {Pairing::unpaired, Pairing::paired}) {
    const Vector second = pairing == Pairing::paired ? Vector{{12.0, 11.1, 15.3, 10.1, 15.9, 10.3, 14.8}} : kSecond;
    const auto exact = permutation_test(kFirst, second, pairing);
    PermutationOptions drawn;
    drawn.max_exact = 1;
    drawn.draws = 40'000;
    const auto estimate = permutation_test(kFirst, second, pairing, drawn);
    ASSERT_TRUE(exact && estimate);
    EXPECT_FALSE(estimate->exact);
    EXPECT_NEAR(estimate->p, exact->p, 5.0 * std::sqrt(exact->p / drawn.draws));
    EXPECT_GT(estimate->p, 0.0);
    EXPECT_EQ(estimate->p, permutation_test(kFirst, second, pairing, drawn)->p) << "the same seed";
  }
}

TEST(Permutation, SaysWhereNobodyCouldBeSignificant) {
  const auto three = permutation_test(Vector{{1.0, 1.1, 1.2}}, Vector{{9.0, 9.1, 9.2}}, Pairing::unpaired);
  ASSERT_TRUE(three);
  EXPECT_EQ(three->support, Support::too_few_people);
  EXPECT_DOUBLE_EQ(three->smallest_p, 0.1);
  EXPECT_DOUBLE_EQ(three->p, 0.1);
  const auto four = permutation_test(Vector{{1.0, 1.1, 1.2, 1.3}}, Vector{{9.0, 9.1, 9.2, 9.3}}, Pairing::unpaired);
  EXPECT_EQ(four->support, Support::enough);
  EXPECT_DOUBLE_EQ(four->p, 2.0 / 70.0);
  EXPECT_EQ(permutation_test(Vector::Ones(9), Vector::Ones(9), Pairing::unpaired)->support, Support::no_variation);
  EXPECT_FALSE(permutation_test(kFirst, kSecond, Pairing::unpaired, {.draws = 0}));
}

/// R 4.2.2, p.adjust.
TEST(Adjusted, AreThoseOfHolmAndOfBenjaminiAndHochberg) {
  const Vector p{{0.01, 0.04, 0.03, 0.005, 0.5}};
  const auto by_holm = holm(p), by_bh = benjamini_hochberg(p);
  ASSERT_TRUE(by_holm && by_bh);
  EXPECT_TRUE(by_holm->isApprox(Vector{{0.040, 0.090, 0.090, 0.020 + 0.005, 0.500}}, 1e-14));
  EXPECT_TRUE(by_bh->isApprox(Vector{{0.025, 0.050, 0.050, 0.025, 0.500}}, 1e-14));
  EXPECT_FALSE(holm(Vector{{0.1, 1.2}}));
  EXPECT_FALSE(benjamini_hochberg(Vector{{NAN}}));
  EXPECT_EQ(holm(Vector())->size(), 0);
}

/// Nothing differs: each test may say so in 5 % of the studies; small groups that vary unlike.
TEST(Difference, IsFoundByChanceAsOftenAsTheLevelSays) {
  constexpr int kStudies = 2000;
  numeric::Random random(5);
  int by_t = 0, by_permutation = 0, held = 0;
  for (int study = 0; study < kStudies; ++study) {
    Vector first(6), second(6);
    for (double& x : first) x = random.normal();
    for (double& x : second) x = random.normal();
    const auto found = difference(first, second, Pairing::unpaired);
    const auto permuted = permutation_test(first, second, Pairing::unpaired);
    ASSERT_TRUE(found && permuted);
    by_t += found->p <= 0.05 ? 1 : 0;
    by_permutation += permuted->p <= 0.05 ? 1 : 0;
    held += found->effect.interval95.first <= 0.0 && found->effect.interval95.second >= 0.0 ? 1 : 0;
  }
  const auto plausible = [](int count, double share) {
    const auto [low, high] = numeric::binomial_interval(count, kStudies, 0.999);
    return low <= share && share <= high;
  };
  EXPECT_TRUE(plausible(held, 0.95)) << held;
  EXPECT_TRUE(plausible(by_permutation, 46.0 / 924.0)) << by_permutation;  // of C(12, 6), an even number
  EXPECT_GT(by_t, 0.035 * kStudies);
  EXPECT_LT(by_t, 0.055 * kStudies);
}

}  // namespace comparison_test
}  // namespace mbk::reliability
