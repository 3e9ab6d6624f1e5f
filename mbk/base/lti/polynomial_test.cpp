#include "mbk/base/lti/polynomial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/base/lti/test_polynomials.h"
#include "mbk/base/numeric/random.h"

namespace mbk::lti {
namespace {

using numeric::Random;

TEST(Exact, TakesADoubleForTheDecimalThatPrintsItShortest) {
  EXPECT_EQ(*exact(0.1), Rational(1, 10));
  EXPECT_EQ(*exact(-2.5e-3), Rational(-1, 400));
  EXPECT_EQ(*exact(1.326), Rational(1326, 1000));
  EXPECT_EQ(*exact(-0.0), 0);
  EXPECT_EQ(*exact(3e5), 300000);
}

TEST(Exact, GivesEveryDoubleBack) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double value = std::ldexp(random.normal(), static_cast<int>(random.below(1800)) - 900);
    EXPECT_EQ(to_double(*exact(value)), value);
  }
  for (const double value : {std::numeric_limits<double>::max(), std::numeric_limits<double>::min()}) {
    EXPECT_EQ(to_double(*exact(value)), value);
  }
}

TEST(Exact, RefusesWhatIsNotFinite) {
  EXPECT_FALSE(exact(std::nan("")));
  EXPECT_FALSE(exact(-std::numeric_limits<double>::infinity()));
  const double values[] = {1.0, std::nan("")};
  EXPECT_FALSE(Polynomial::from_decimals(values));
}

TEST(ToDouble, DividesNumbersThatNoDoubleHolds) {
  const Rational huge = *exact(1e300) * *exact(1e300);
  EXPECT_EQ(to_double(3 * huge / huge), 3.0);
  EXPECT_EQ(to_double((2 * huge + 1) / (4 * huge)), 0.5);
}

TEST(Polynomial, DropsZerosAtItsTop) {
  EXPECT_EQ((Polynomial{1, 2, 0, 0}).degree(), 1);
  EXPECT_TRUE((Polynomial{0}).is_zero());
  EXPECT_EQ(Polynomial().degree(), -1);
  EXPECT_EQ((Polynomial{1, 1} - Polynomial{0, 1}), Polynomial{1});
  EXPECT_EQ((Polynomial{1, 2}).coefficient(7), 0);
}

TEST(Polynomial, HasTheValuesOfItsSumsAndProducts) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Polynomial a = random_polynomial(random, 4), b = random_polynomial(random, 3);
    const Rational x = random_rational(random);
    EXPECT_EQ((a + b)(x), a(x) + b(x));
    EXPECT_EQ((a - b)(x), a(x) - b(x));
    EXPECT_EQ((a * b)(x), a(x) * b(x));
    EXPECT_EQ((a * b).derivative(), a.derivative() * b + a * b.derivative());
  }
}

TEST(Divide, GivesQuotientAndASmallerRemainder) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Polynomial a = random_polynomial(random, 6), b = random_polynomial(random, 1 + i % 7);
    const Division division = divide(a, b);
    EXPECT_EQ(division.quotient * b + division.remainder, a);
    EXPECT_LT(division.remainder.degree(), b.degree());
  }
}

TEST(Gcd, IsThePartThatTwoPolynomialsShare) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Polynomial shared = with_roots({random_rational(random), random_rational(random)});
    // x² + 1 and x² + 2 have no root in common with each other or with anything that has real roots
    const Polynomial a = shared * Polynomial{1, 0, 1}, b = shared * Polynomial{-4, 0, -2};
    EXPECT_EQ(gcd(a, b), shared);
  }
  EXPECT_EQ(gcd(Polynomial{3}, Polynomial{0, 5}), Polynomial{1});
  EXPECT_EQ(gcd(Polynomial(), Polynomial{2, 4}), (Polynomial{Rational(1, 2), 1}));
  EXPECT_TRUE(gcd(Polynomial(), Polynomial()).is_zero());
}

TEST(SquareFree, HasEachRootOnce) {
  EXPECT_EQ(square_free(Polynomial{3} * with_roots({1, 1, 1, 2, 5, 5})), with_roots({1, 2, 5}));
  EXPECT_EQ(square_free(Polynomial{7}), Polynomial{1});
}

TEST(SquareFreeFactors, SortRootsByTheirMultiplicity) {
  const auto factors = square_free_factors(Polynomial{-3} * with_roots({1, 1, 1, 2, 4, 5, 5, 5}));
  ASSERT_EQ(factors.size(), 3u);
  EXPECT_EQ(factors[0], with_roots({2, 4}));
  EXPECT_EQ(factors[1], Polynomial{1});
  EXPECT_EQ(factors[2], with_roots({1, 5}));
  EXPECT_TRUE(square_free_factors(Polynomial{7}).empty());
}

}  // namespace
}  // namespace mbk::lti
